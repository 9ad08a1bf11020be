#include "run.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "../readers/components.hpp"
#include "../readers/refine.hpp"
#include "counted.hpp"
#include "draw_loops.hpp"
#include "marks.hpp"
#include "read_mesh.hpp"
#include "read_values.hpp"
#include "split_mesh.hpp"
#include "write_results.hpp"

namespace cli {

namespace {

constexpr size_t most_named = 5; // components in a sentence

} // namespace

void Run::read() {
    PreparedMesh prepared = prepare_mesh(r_.mesh, r_.prepare);
    if (prepared.is_changed() && r_.save_mesh.empty() && !outputs_of(options_).empty())
        std::fprintf(stderr, "%s: the outputs refer to the changed mesh; --save-mesh FILE.obj writes it\n",
                     name_.c_str());
    mesh_ = std::move(prepared.mesh);
    repairs_ = prepared.sentences();
    warnings_ = std::move(prepared.warnings);
    refine();
    origin_ = std::move(mesh_.origin);
    if (r_.marks != "auto" && r_.marks != "none") marks_ = read_marks(r_.marks, mesh_.vertex_count());
    if (kind_ != 0 || has_start_) return;
    if (!r_.through.empty()) {
        read_ = draw_loops(r_.through, mesh_);
        return;
    }
    try {
        read_ = read_loops(r_.loops, mesh_.vertex_count(), mesh_.triangle_count());
    } catch (const Failure& failure) {
        if (failure.exit_status != EXIT_RESOURCES) throw;
        throw Failure(EXIT_RESOURCES, "--loops: neither a kind of loops nor a file that can be read has the name \""
                                          + r_.loops + "\"; the kinds are cut, handle, tunnel, pants and even");
    }
}

// Loops of a file are on the mesh as it is.
void Run::refine() {
    const bool of_file = kind_ == 0 && r_.through.empty();
    if (r_.refine == 0 || of_file) return;
    const size_t before = mesh_.triangle_count();
    readers::refine(mesh_, r_.refine);
    if (mesh_.triangle_count() == before) return;
    std::fprintf(stderr, "%s: cut into %zu triangles\n", name_.c_str(), mesh_.triangle_count());
    if (r_.save_mesh.empty() && !(r_.save_loops.empty() && r_.save_marks.empty()))
        std::fprintf(stderr, "%s: loops and marks refer to these triangles, --save-mesh FILE.obj writes them\n",
                     name_.c_str());
}

void Run::split() {
    std::vector<MeshPart> parts = split_mesh(mesh_, name_);
    const bool alone = parts.size() == 1;
    for (MeshPart& part : parts) {
        const std::string subject = alone ? name_ : name_ + ", " + name_of_component(part, components_.size());
        components_.emplace_back(std::move(part), subject, alone, origin_);
    }
    loop_numbers_.resize(components_.size());
}

void Run::build() {
    for (const std::string& path : outputs_of(options_)) {
        check_writable(path);
        outcome_.uses_stdout = outcome_.uses_stdout || path == "-";
    }
    attempt("--save-mesh", !r_.save_mesh.empty(), [&] { write_mesh_obj(r_.save_mesh, mesh_, 17); });
    split();
    take_marks();
    take_loops();
    std::vector<uint32_t> designed;
    uint64_t coarsest = r_.coarsest;
    size_t done = 0;
    for (Component& c : components_) {
        const hmf_control* const control = share("build", 0, 0.35, done, c);
        if (c.is_refused()) continue;
        c.build(r_, meter_, control);
        if (c.is_mollified()) std::fprintf(stderr, "%s: %s\n", c.subject().c_str(), MOLLIFIED);
        if (c.is_refused()) continue;
        if (coarsest > 0) coarsest = std::max<uint64_t>(coarsest, 40 * c.genus() + 10 * c.marks().size());
        if (kind_ == LOOPS_EVEN)
            for (const uint32_t v : c.marks()) designed.push_back(c.whole_vertex(v));
        if (r_.marks != "auto" || kind_ == LOOPS_EVEN) continue;
        for (const uint32_t v : c.marks()) marks_.push_back(c.whole_vertex(v));
        tipped_ += !c.marks().empty();
        has_tips_ = has_tips_ || (!c.marks().empty() && c.boundaries() == 0);
    }
    r_.coarsest = coarsest;
    if (kind_ == LOOPS_EVEN) marks_ = designed;
    refuse_if_none();
}

void Run::take_marks() {
    if (marks_.empty()) return;
    if (is_alone()) return components_[0].take_marks(marks_);
    std::vector<uint8_t> is_marked(mesh_.vertex_count(), 0);
    for (const uint32_t v : marks_) is_marked[v] = 1;
    for (Component& c : components_) {
        std::vector<uint32_t> own;
        for (uint32_t v = 0; v < c.mesh().vertex_count(); ++v)
            if (is_marked[c.whole_vertex(v)]) own.push_back(v);
        c.take_marks(std::move(own));
    }
}

void Run::take_loops() {
    if (read_.count() == 0) return;
    if (is_alone()) {
        for (size_t c = 0; c < read_.count(); ++c) loop_numbers_[0].push_back(c);
        components_[0].take_loops(read_);
        return;
    }
    const bool triangles = read_.element_kind == HMF_PATH_TRIANGLES;
    std::vector<std::array<uint32_t, 2>> place(triangles ? mesh_.triangle_count() : mesh_.vertex_count());
    std::vector<LoopList> lists(components_.size());
    for (uint32_t k = 0; k < components_.size(); ++k) {
        lists[k].element_kind = read_.element_kind;
        const TriangleMesh& mesh = components_[k].mesh();
        const size_t count = triangles ? mesh.triangle_count() : mesh.vertex_count();
        for (uint32_t i = 0; i < count; ++i)
            place[triangles ? components_[k].whole_triangle(i) : components_[k].whole_vertex(i)] = {k, i};
    }
    for (size_t loop = 0; loop < read_.count(); ++loop) {
        const uint32_t component = place[read_.elements[read_.offsets[loop]]][0];
        LoopList& list = lists[component];
        for (uint64_t i = read_.offsets[loop]; i < read_.offsets[loop + 1]; ++i) {
            const auto [other, number] = place[read_.elements[i]];
            if (other != component)
                throw Failure(EXIT_BAD_INPUT,
                              r_.name_of_loop(read_.lines[loop]) + ": the loop lies on several components of the mesh");
            list.elements.push_back(number);
        }
        list.offsets.push_back(list.elements.size());
        list.arcs.push_back(read_.arcs[loop]);
        for (const size_t end : {0, 1}) list.arc_sides.push_back(read_.arc_sides[2 * loop + end]);
        list.lines.push_back(read_.lines[loop]);
        loop_numbers_[component].push_back(loop);
    }
    for (size_t k = 0; k < components_.size(); ++k) {
        if (lists[k].count() == 0) components_[k].refuse(HMF_ERROR_LOOP_COUNT, "no loop lies on it");
        else components_[k].take_loops(std::move(lists[k]));
    }
}

void Run::refuse_if_none() const {
    size_t named = 0;
    std::string reasons;
    for (const Component& c : components_) {
        if (!c.is_refused()) return;
        if (named++ < most_named) reasons += (named == 1 ? "" : "; ") + c.refusal().substr(name_.size() + 2);
    }
    if (named > most_named) reasons += "; and so on";
    throw Failure(EXIT_BAD_INPUT, name_ + ": none of " + std::to_string(components_.size())
                                      + " components carries a foliation: " + reasons);
}

void Run::choose_loops() {
    const bool fine = r_.method == HMF_METHOD_SINGLE_LEVEL;
    size_t count = read_.count();
    for (size_t k = 0; kind_ != 0 && !has_start_ && k < components_.size(); ++k) {
        Component& c = components_[k];
        if (!c.is_refused()) c.make_loops(kind_, fine, nullptr);
        for (uint64_t n = 0; !c.is_refused() && n < c.loops().count; ++n) loop_numbers_[k].push_back(count++);
    }
    refuse_if_none();
    loop_count_ = count;
    weights_given_ = !r_.weights.empty();
    // Without loops the weights are for the pictures only.
    if (!weights_given_) r_.weights = own_weights(count);
    if (r_.weights.size() != count && !has_start_)
        throw Failure(EXIT_USAGE, "--weights: " + counted(r_.weights.size(), "weight") + " for "
                                      + counted(count, "loop") + "; give one weight per loop");
}

std::vector<double> Run::own_weights(size_t count) const {
    if (!read_.weights.empty()) return read_.weights;
    std::vector<double> weights(has_start_ ? 1 : count, 1.0);
    for (size_t k = 0; kind_ == LOOPS_EVEN && k < components_.size(); ++k)
        for (size_t n = 0; n < loop_numbers_[k].size(); ++n)
            weights[loop_numbers_[k][n]] = components_[k].loops().weights[n];
    return weights;
}

hmf_loop_set Run::fine_loops() {
    if (is_alone()) return components_[0].fine_loops(control_);
    if (read_.count() == 0)
        for (Component& c : components_) {
            if (c.is_refused()) continue;
            const hmf_loop_set& own = c.fine_loops(control_);
            read_.element_kind = own.element_kind;
            for (uint64_t n = 0; n < own.count; ++n) {
                for (uint64_t i = own.offsets[n]; i < own.offsets[n + 1]; ++i)
                    read_.elements.push_back(c.whole_triangle(own.elements[i]));
                read_.offsets.push_back(read_.elements.size());
                read_.arcs.push_back(own.arcs ? own.arcs[n] : 0);
                for (const size_t end : {0, 1})
                    read_.arc_sides.push_back(own.arc_sides ? own.arc_sides[2 * n + end] : HMF_NONE);
            }
        }
    return read_.view();
}

std::vector<std::vector<double>> Run::start_values() {
    if (!has_start_) return {};
    const readers::Edges edges = readers::edges_of(is_alone() ? components_[0].mesh() : mesh_);
    std::vector<double> all = read_values(r_.start, edges.vertices);
    if (is_alone()) return {std::move(all)};
    std::vector<std::vector<double>> values;
    std::vector<uint8_t> seen(edges.count(), 0);
    for (Component& c : components_) {
        values.emplace_back();
        for (uint32_t t = 0; t < c.mesh().triangle_count(); ++t)
            for (size_t s = 0; s < 3; ++s) {
                const uint32_t e = edges.triangles[size_t{3} * c.whole_triangle(t) + s];
                if (seen[e]) continue;
                seen[e] = 1;
                values.back().push_back(all[e]);
            }
        const bool is_zero = std::count(values.back().begin(), values.back().end(), 0.0)
                          == static_cast<std::ptrdiff_t>(values.back().size());
        if (is_zero && !c.is_refused())
            c.refuse(HMF_ERROR_LOOP_COUNT, "the values of " + shown(r_.start) + " are 0 there");
    }
    refuse_if_none();
    return values;
}

} // namespace cli
