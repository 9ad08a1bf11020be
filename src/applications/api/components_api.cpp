// applications.h: the components of a mesh, and marked vertices proposed for each.
#include "../design/suggest_marks.hpp"
#include "../components/components.hpp"
#include "../../core/mesh/marked_vertices.hpp"
#include "../../core/mesh/spatial_order.hpp"
#include "../../core/mesh/validate.hpp"
#include "mesh_entry.hpp"
#include "../../core/api/result.hpp"

using namespace hmf;

namespace {

// The components of the caller's mesh with their arrays for a build.
class SplitMesh {
public:
    SplitMesh(const hmf_hierarchy& like, const BuildOptions& options, Call& call) :
        like_(like), options_(options), call_(call) {}

    hmf_status find(const double* positions, size_t vertex_count, const uint32_t* triangles, size_t triangle_count) {
        if (validate_arguments(positions, vertex_count, static_cast<size_t>(options_.position_stride), triangles,
                               triangle_count, call_)
            || find_components(triangles, triangle_count, vertex_count, call_, all_))
            return call_.status();
        if (!positions_.allocate(call_.memory, 3 * all_.vertices.size())
            || !triangles_.allocate(call_.memory, 3 * triangle_count))
            return call_.out_of_memory();
        for (size_t n = 0; n < all_.vertices.size(); ++n)
            std::memcpy(&positions_[3 * n],
                        position_at(positions, static_cast<size_t>(options_.position_stride), all_.vertices[n]),
                        3 * sizeof(double));
        for (size_t n = 0; n < triangle_count; ++n)
            for (size_t s = 0; s < 3; ++s)
                triangles_[3 * n + s] = all_.vertex_number[triangles[3 * size_t{all_.triangles[n]} + s]];
        return divide_marks();
    }

    // Fills the status, genus and boundaries of each.
    hmf_status check() {
        for (size_t k = 0; k < count(); ++k) {
            hmf_component& c = all_.list[k];
            enter(k);
            hmf_error error{};
            hmf_hierarchy scratch(like_, call_.memory);
            Call part(&call_, &error);
            c.status = check_surface(scratch, positions_of(c), vertices_of(c), triangles_of(c), faces_of(c),
                                     options_of(c), part);
            if (refuses_call(c.status)) return call_.status();
            if (c.status == HMF_OK || c.status == HMF_ERROR_MESH_GENUS) {
                c.genus = scratch.surface_genus;
                c.boundary_count = scratch.boundary_count;
                continue;
            }
            c.element = error.element;
            c.index = error.index;
            if (c.element == HMF_ELEMENT_VERTEX) c.index = all_.vertices[c.first_vertex + c.index];
            if (c.element == HMF_ELEMENT_TRIANGLE) c.index = all_.triangles[c.first_triangle + c.index];
        }
        return HMF_OK;
    }

    // Those of hmf_suggest_marks, by the caller's numbers.
    hmf_status suggest(Array<uint32_t>& marks) {
        marks.start(call_.memory);
        for (size_t k = 0; k < count(); ++k) {
            const hmf_component& c = all_.list[k];
            enter(k);
            Array<uint32_t> own;
            hmf_hierarchy scratch(like_, call_.memory);
            Call part(&call_);
            BuildOptions options = options_;
            options.position_stride = 0;
            if (refuses_call(suggest_marks(scratch, positions_of(c), vertices_of(c), 0, triangles_of(c), faces_of(c),
                                           options, part, own)))
                return call_.status();
            if (part.status()) continue;
            for (const uint32_t v : own)
                if (!marks.push(all_.vertices[c.first_vertex + v])) return call_.out_of_memory();
        }
        return HMF_OK;
    }

    size_t count() const { return all_.list.size(); }

    hmf_component_set* result() const {
        hmf_component_set set{};
        set.struct_size = sizeof set;
        set.count = count();
        set.vertex_count = all_.vertex_component.size();
        set.edge_count = all_.edges.size();
        set.triangle_count = all_.triangles.size();
        set.used_vertex_count = all_.vertices.size();
        set.marked_count = marks_.size();
        ResultBlock block;
        block.array(set, set.list, count(), all_.list.data());
        block.array(set, set.part_positions, positions_.size(), positions_.data());
        block.array(set, set.part_triangles, triangles_.size(), triangles_.data());
        block.array(set, set.part_marks, marks_.size(), marks_.data());
        block.array(set, set.whole_vertices, all_.vertices.size(), all_.vertices.data());
        block.array(set, set.whole_edges, all_.edges.size(), all_.edges.data());
        block.array(set, set.whole_triangles, all_.triangles.size(), all_.triangles.data());
        block.array(set, set.vertex_component, all_.vertex_component.size(), all_.vertex_component.data());
        block.array(set, set.vertex_part, all_.vertex_number.size(), all_.vertex_number.data());
        block.array(set, set.triangle_component, all_.triangle_component.size(), all_.triangle_component.data());
        block.array(set, set.triangle_part, all_.triangle_number.size(), all_.triangle_number.data());
        return block.make(set, like_, call_);
    }

private:
    // Marked vertices one component after the other, each in the caller's order.
    hmf_status divide_marks() {
        Array<uint8_t> is_marked;
        const uint64_t given = options_.marked_count;
        if (find_marked(options_.marked_vertices, given, all_.vertex_component.size(), nullptr, is_marked, call_))
            return call_.status();
        uint64_t used = 0;
        const auto component = [&](uint64_t n) { return all_.vertex_component[options_.marked_vertices[n]]; };
        for (uint64_t n = 0; n < given; ++n)
            if (component(n) != NONE) ++all_.list[component(n)].marked_count, ++used;
        if (!marks_.allocate(call_.memory, static_cast<size_t>(used))) return call_.out_of_memory();
        uint64_t first = 0;
        for (hmf_component& c : all_.list) {
            c.first_mark = first;
            first += c.marked_count;
            c.marked_count = 0;
        }
        for (uint64_t n = 0; n < given; ++n) {
            if (component(n) == NONE) continue;
            hmf_component& c = all_.list[component(n)];
            marks_[c.first_mark + c.marked_count++] = all_.vertex_number[options_.marked_vertices[n]];
        }
        return HMF_OK;
    }

    // What is wrong with a component is no defect of the call.
    bool refuses_call(hmf_status status) {
        if (status == HMF_CANCELLED) call_.was_cancelled();
        else if (status == HMF_ERROR_MEMORY || status == HMF_ERROR_MEMORY_LIMIT) call_.out_of_memory();
        return call_.status() != HMF_OK;
    }

    // Components have their shares of the progress.
    void enter(size_t k) {
        const auto share = [&](size_t n) {
            return 0.15 + 0.85 * static_cast<double>(n) / static_cast<double>(count());
        };
        call_.range(share(k), share(k + 1));
    }

    const double* positions_of(const hmf_component& c) const { return &positions_[3 * c.first_vertex]; }
    const uint32_t* triangles_of(const hmf_component& c) const { return &triangles_[3 * c.first_triangle]; }
    static size_t vertices_of(const hmf_component& c) { return static_cast<size_t>(c.vertex_count); }
    static size_t faces_of(const hmf_component& c) { return static_cast<size_t>(c.triangle_count); }
    BuildOptions options_of(const hmf_component& c) const {
        BuildOptions options;
        options.mollify = options_.mollify;
        options.marked_vertices = marks_.data() + c.first_mark;
        options.marked_count = c.marked_count;
        return options;
    }

    const hmf_hierarchy& like_;
    const BuildOptions& options_;
    Call& call_;
    Components all_;
    Array<double> positions_;
    Array<uint32_t> triangles_, marks_;
};

// The beginning of both calls; work(hierarchy, options, call) makes the result.
template <class Result, class Work>
hmf_status begin(const hmf_hierarchy_options* options, const hmf_control* control, Result** out, hmf_error* error,
                 Work&& work) {
    MeshEntry entry(options, control, error);
    if (entry.check(out) || entry.check_options()) return entry.call.status();
    *out = work(entry.hierarchy, entry.options, entry.call);
    if (*out) entry.call.finished();
    return entry.call.status();
}

hmf_mark_set* mark_set(const Array<uint32_t>& marks, const hmf_hierarchy& h, Call& call) {
    hmf_mark_set set{sizeof(hmf_mark_set), 0, marks.size(), nullptr};
    ResultBlock block;
    block.array(set, set.marked_vertices, marks.size(), marks.data());
    return block.make(set, h, call);
}

} // namespace

extern "C" {

hmf_status hmf_components(const double* positions, size_t vertex_count, const uint32_t* triangles,
                          size_t triangle_count, const hmf_hierarchy_options* options, const hmf_control* control,
                          hmf_component_set** out, hmf_error* error) {
    return begin(options, control, out, error,
                 [&](const hmf_hierarchy& h, const BuildOptions& build, Call& call) -> hmf_component_set* {
                     SplitMesh parts(h, build, call);
                     if (parts.find(positions, vertex_count, triangles, triangle_count) || parts.check())
                         return nullptr;
                     return parts.result();
                 });
}

hmf_status hmf_suggest_marks(const double* positions, size_t vertex_count, const uint32_t* triangles,
                             size_t triangle_count, const hmf_hierarchy_options* options, const hmf_control* control,
                             hmf_mark_set** out, hmf_error* error) {
    return begin(options, control, out, error, [&](hmf_hierarchy& h, BuildOptions build, Call& call) -> hmf_mark_set* {
        build.marked_count = 0;
        Array<uint32_t> found;
        {
            SplitMesh parts(h, build, call);
            if (parts.find(positions, vertex_count, triangles, triangle_count)) return nullptr;
            if (parts.count() > 1 && parts.suggest(found)) return nullptr;
            if (parts.count() > 1) return mark_set(found, h, call);
        }
        if (suggest_marks(h, positions, vertex_count, static_cast<size_t>(build.position_stride), triangles,
                          triangle_count, build, call, found))
            return nullptr;
        return mark_set(found, h, call);
    });
}

} // extern "C"
