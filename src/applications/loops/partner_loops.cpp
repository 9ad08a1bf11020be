// A basis of the homology from a cut system a_1 .. a_g: one after another, a_j
// is replaced by a loop b_j that crosses it once and meets neither b_1 .. b_j-1
// nor a_j+1 .. a_g.  It is a path in the surface cut along all of these and
// a_j, from one side of a_j to the other, and exists as they do not separate.
// So <a_i, b_j> is 0 for i > j and 1 or -1 for i = j.
#include "../../core/curves/cut_surface.hpp"
#include "../../core/curves/disjoint.hpp"
#include "find_loops.hpp"

#include <algorithm>

namespace hmf {

namespace {

// The shortest way from the left of a component to its right, as crossings.
Done cross_once(const CutSurface& cut, const Multicurve& curves, size_t component, Memory& memory,
                Array<uint32_t>& path) {
    // At its first crossing, on the side where it comes in.
    const uint32_t crossing = curves.begin[component],
                   e = edge_of(curves.components.crossings[curves.components.offsets[component]]);
    const size_t segment = cut.segment_first[e] + (crossing - curves.first[e]);
    const uint32_t from = cut.region[2 * segment + 1], to = cut.region[2 * segment + 3];
    Array<uint32_t> reached, queue;
    if (!reached.allocate_filled(memory, cut.region_count, NONE) || !queue.allocate(memory, cut.region_count))
        return false;
    size_t begin = 0, end = 0;
    queue[end++] = from;
    path.start(memory);
    while (begin < end && (reached[to] == NONE || to == from)) {
        const uint32_t r = queue[begin++];
        for (uint32_t i = 0; i < 3; ++i) {
            const uint32_t link = cut.link[3 * size_t{r} + i];
            if (link == NONE) break;
            const uint32_t next = cut.region[link ^ 1u];
            if (next == from || reached[next] != NONE) continue;
            reached[next] = link;
            queue[end++] = next;
        }
    }
    if (reached[to] == NONE) return true;
    for (uint32_t r = to; r != from; r = cut.region[reached[r]])
        if (!path.push(reached[r])) return false;
    std::reverse(path.begin(), path.end());
    for (uint32_t& link : path) link = cut.half_edge(link);
    return true;
}

} // namespace

hmf_status partner_loops(const Mesh& mesh, const Loops& loops, Call& call, Loops& out) {
    Memory& memory = call.memory;
    const size_t g = loops.count();
    Multicurve curves;
    if (!out.start(memory) || !curves.allocate(mesh, memory)) return call.out_of_memory();
    for (size_t j = 0; j < g; ++j) {
        if (!call.tick(0, true)) return call.was_cancelled();
        Loops all;
        Array<uint32_t> loop_of, path;
        CutSurface cut;
        if (!all.start(memory)) return call.out_of_memory();
        for (size_t c = 0; c < g; ++c)
            if (!all.add(c < j ? out : loops, c)) return call.out_of_memory();
        bool are_disjoint = false;
        if (!disjoint(mesh, all, 0, g, curves, &loop_of, call, are_disjoint)) return call.out_of_memory();
        if (!are_disjoint)
            return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, j, "Partners are not disjoint. Please report this.");
        if (!cut.build(mesh, curves, true, call)) return call.stopped();
        size_t component = 0;
        while (component < g && loop_of[component] != j) ++component;
        if (!cross_once(cut, curves, component, memory, path)) return call.out_of_memory();
        size_t begin = 0, end = 0;
        remove_backtracking(path, begin, end);
        if (begin == end)
            return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, j,
                             "No partner of a loop was found. Please report this.");
        if (!out.add(path.data() + begin, end - begin)) return call.out_of_memory();
    }
    return HMF_OK;
}

} // namespace hmf
