// hmf_loops on a closed surface, in the order of [W] 3.3:
//
//   hierarchy    the reference hierarchy: the caller's triangles with the default options
//   candidates   strips of triangles on one of its coarse levels: cut_system.cpp, pants_decomposition.cpp and
//                handle_system.cpp, with loop_search.hpp and hole_joins.hpp
//   choice       the strips with the shortest classes: class_lengths.hpp
//   loops        carried up to finer levels (carry_loops.hpp), and shortened on each (shorten_loops.cpp); down to
//                coarser ones by the restriction of a foliation
//
// A search on a fine level would take 20 s on a million triangles; carried loops are as short.
#include "library_loops.hpp"

#include "../../core/base/cyclic.hpp"
#include "../common/caller_lists.hpp"
#include "../common/cylinder_leaves.hpp"
#include "../../core/solve/state.hpp"
#include "carry_loops.hpp"
#include "class_lengths.hpp"
#include "handle_system.hpp"
#include "loop_parameters.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr int UNIT_BITS = 20; // of a weight of 1

// ---- hierarchy ----

// Made with the options of the reference hierarchy?
bool is_reference(const hmf_hierarchy& h) {
    const BuildOptions usual;
    if (h.made_with.ratio != usual.ratio || h.made_with.collapse != usual.collapse) return false;
    const auto coarsest = [&](BuildOptions options) {
        options.marked_count = h.input.marked_count; // of a double
        return coarsest_vertices(options, h.genus, h.input.vertex_count);
    };
    const uint64_t vertices = coarsest(h.made_with);
    return h.made_with.coarsest == 0 || (vertices >= USUAL_COARSEST && vertices == coarsest(usual));
}

hmf_status build_reference(const hmf_hierarchy& h, hmf_hierarchy& made, Call& call) {
    const uint32_t n = h.input.vertex_count;
    Array<double> position;
    Array<uint32_t> marked;
    marked.start(call.memory);
    if (!position.allocate(call.memory, size_t{3} * n)) return call.out_of_memory();
    for (uint32_t v = 0; v < n; ++v) {
        const uint32_t inside = h.vertex_internal[v];
        for (size_t c = 0; c < 3; ++c) position[size_t{3} * v + c] = h.levels[0].position[size_t{3} * inside + c];
        if (h.input.is_marked(inside) && !marked.push(v)) return call.out_of_memory();
    }
    BuildOptions options;
    options.mollify = h.made_with.mollify;
    options.sphere_allowed = true;
    options.marked_vertices = marked.data();
    options.marked_count = marked.size();
    return build_hierarchy(made, position.data(), n, 0, h.triangle_vertices, h.input.face_count, options, call);
}

// ---- candidates and choice ----

// The coarsest level with 1000 vertices and 420 for each handle, or with 10 000 from ten handles on; not level 0, whose
// triangles may have any shape, unless no other level has 1000.
size_t search_level(const hmf_hierarchy& h) {
    const uint64_t wanted = h.genus < MANY_HANDLES ? VERTICES_OF_HANDLE * h.genus : MEASURED_VERTICES;
    size_t level = h.level_count - 1;
    while (level > 0 && h.levels[level].mesh.vertex_count < USUAL_COARSEST) --level;
    while (level > 1 && h.levels[level].mesh.vertex_count < wanted) --level;
    return level;
}

hmf_status find_loops(const hmf_hierarchy& h, size_t found, int32_t kind, LoopCare care, Call& call, Loops& out) {
    const Mesh& mesh = loop_mesh(h, found);
    const double* position = h.levels[found].position;
    ClassLengths lengths(h, found, call, care);
    if (h.genus == 0 && kind == HMF_LOOPS_CUT) return mark_loops(mesh, position, lengths, call, out);
    if (h.genus == 0 && (kind == HMF_LOOPS_HANDLE || kind == HMF_LOOPS_TUNNEL))
        return call.fail(HMF_ERROR_MESH_GENUS, HMF_ELEMENT_NONE, 0,
                         "A surface of genus 0 has no handles. Use HMF_LOOPS_CUT or HMF_LOOPS_PANTS, which go around "
                         "marked vertices, or give loops.");
    switch (kind) {
    case HMF_LOOPS_CUT: return cut_system(mesh, position, nullptr, lengths, call, out);
    case HMF_LOOPS_HANDLE: return handle_system(h, found, true, call, out);
    case HMF_LOOPS_TUNNEL: return handle_system(h, found, false, call, out);
    case HMF_LOOPS_PANTS: return pants_decomposition(mesh, position, lengths, call, out);
    default:
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There is no loop kind %d. Use HMF_LOOPS_*.",
                         static_cast<int>(kind));
    }
}

// ---- loops ----

// Crossings on level 0 of one hierarchy as those of another one of the same triangles.
hmf_status hand_over(const hmf_hierarchy& from, const hmf_hierarchy& to, Loops& loops, Call& call) {
    Array<uint32_t> triangles;
    if (caller_triangles(from, loops.crossings, triangles, call)) return call.status();
    for (size_t i = 0; i < triangles.size(); ++i) {
        uint32_t& h = loops.crossings[i];
        const uint32_t t = triangles[i];
        uint32_t there = internal_side(to, t);
        for (uint32_t side = internal_side(from, t); side != h; side = from.input.next[side])
            there = to.input.next[there];
        h = there;
    }
    return HMF_OK;
}

// Disjoint loops of a level on a coarser one: with the weights 1, 2, 3, .. they are a foliation, whose restriction is
// exact; the core of its cylinder of height c there is loop c.
hmf_status restrict_loops(const hmf_hierarchy& h, size_t from, size_t level, Loops& loops, Call& call) {
    const size_t n = loops.count();
    State state;
    Array<int64_t> weight;
    if (!state.allocate(h, from, call.memory) || !weight.allocate(call.memory, n)) return call.out_of_memory();
    for (size_t c = 0; c < n; ++c) weight[c] = (static_cast<int64_t>(c) + 1) << UNIT_BITS;
    state.load(from, Triangulation::input);
    Foliation& f = state.foliation;
    initial_foliation(f.mesh, loops, weight.data(), f.value);
    if (!state.go_to(level, call)) return call.stopped();
    Cylinders cylinders;
    Curves middle;
    if (cylinders.build(f, nullptr, nullptr, call) || middle_leaves(f, cylinders, nullptr, middle, call))
        return call.status();
    Array<uint32_t> of_loop;
    if (!of_loop.allocate_filled(call.memory, n, NONE)) return call.out_of_memory();
    for (uint32_t k = 0; k < cylinders.list.size(); ++k) {
        const int64_t height = cylinders.list[k].height >> UNIT_BITS;
        if (height >= 1 && height <= static_cast<int64_t>(n)) of_loop[static_cast<size_t>(height - 1)] = k;
    }
    loops.offsets.start(call.memory);
    loops.crossings.start(call.memory);
    if (!loops.offsets.push(0)) return call.out_of_memory();
    for (size_t c = 0; c < n; ++c) {
        if (of_loop[c] == NONE)
            return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, c,
                             "Loop %llu is lost between two levels. Please report it.",
                             static_cast<unsigned long long>(c));
        for (uint64_t i = middle.offsets[of_loop[c]]; i < middle.offsets[of_loop[c] + 1]; ++i)
            if (!loops.crossings.push(middle.crossings[i].half_edge)) return call.out_of_memory();
        if (!loops.offsets.push(loops.crossings.size())) return call.out_of_memory();
    }
    return pull_tight(loop_mesh(h, level), call, loops);
}

} // namespace

hmf_status carry_to_finer(const hmf_hierarchy& h, size_t from, size_t level, Call& call, Loops& out) {
    if (level == from) return pull_tight(loop_mesh(h, level), call, out);
    LoopCarrier carrier;
    if (!carrier.load(h, from, level, out, call.memory)) return call.out_of_memory();
    while (carrier.level() > level) {
        if (!carrier.refine(call) || !carrier.read(0, out.count(), out, call)) return call.stopped();
        const hmf_status status = shorten_loops(carrier.mesh(), h.levels[carrier.level()].position, call, out);
        if (status) return status;
        if (carrier.level() > level && !carrier.replace(out)) return call.out_of_memory();
    }
    return pull_tight(loop_mesh(h, level), call, out);
}

hmf_status library_loops(const hmf_hierarchy& h, size_t level, int32_t kind, Call& call, Loops& out, LoopCare care) {
    const size_t found = care == LoopCare::quick ? h.level_count - 1 : std::max(level, search_level(h));
    const hmf_status status = find_loops(h, found, kind, care, call, out);
    return status ? status : carry_to_finer(h, found, level, call, out);
}

hmf_status reference_loops(const hmf_hierarchy& h, size_t level, int32_t kind, Call& call, Loops& out) {
    const size_t search = search_level(h);
    const bool is_own = is_reference(h);
    if (is_own && level <= search) return library_loops(h, level, kind, call, out);
    Call part(&call); // HMF_PROGRESS_FINISH is ignored here: there is no partial result without loops
    const auto failed = [&] {
        if (call.cancelled()) return call.was_cancelled();
        if (call.memory.failure()) return call.out_of_memory();
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                         "The loops could not be brought to this hierarchy (%d). Please report it.",
                         static_cast<int>(part.status()));
    };
    if (is_own) {
        if (library_loops(h, search, kind, call, out)) return call.status();
        return restrict_loops(h, search, level, out, part) ? failed() : HMF_OK;
    }
    hmf_hierarchy made(h, call.memory);
    if (build_reference(h, made, part)) return failed();
    if (library_loops(made, 0, kind, call, out)) return call.status();
    if (hand_over(made, h, out, part)) return failed();
    if (level == 0) return pull_tight(h.input, call, out);
    return restrict_loops(h, 0, level, out, part) ? failed() : HMF_OK;
}

hmf_status name_by_triangles(const hmf_hierarchy& h, size_t level, Call& call, Loops& loops, Array<uint32_t>& faces) {
    const Mesh& mesh = loop_mesh(h, level);
    if (!faces.allocate(call.memory, loops.crossings.size())) return call.out_of_memory();
    for (size_t i = 0; i < faces.size(); ++i) faces[i] = mesh.face[loops.crossings[i]];
    Loops again;
    const hmf_status status =
        read_loops(mesh, HMF_PATH_TRIANGLES, loops.count(), loops.offsets.data(), faces.data(), call, again);
    if (status) return status;
    for (size_t c = 0; c < loops.count(); ++c) {
        const size_t n = loops.length(c);
        if (again.length(c) == n && same_cycle(again.loop(c), loops.loop(c), n)) continue;
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_LOOP, c,
                         "Loop %llu passes triangles of level %llu that share several edges, so triangles do not name "
                         "it. Use a finer level.",
                         static_cast<unsigned long long>(c), static_cast<unsigned long long>(level));
    }
    return HMF_OK;
}

} // namespace hmf
