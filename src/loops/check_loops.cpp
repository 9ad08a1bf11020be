// Are the loops simple, disjoint, essential and pairwise not freely homotopic?
// Decided in integers, in time linear in mesh and crossings.
//
// (a) Disjoint simple loops without backtracking form a normal multicurve,
//     which its crossing numbers determine.  So add the crossing numbers,
//     trace the multicurve that has them, and compare: its components must be
//     the loops.
// (b) Cut along it.  A piece of Euler characteristic 1 is a disk and its loop
//     trivial, if at most one marked vertex is inside; one of characteristic 0
//     without marked vertices is an annulus:
//
//      loop c  (   annulus   )  loop d      c and d are freely homotopic,
//                                           unless c = d (on a torus)
#include "../base/disjoint_sets.hpp"
#include "cut_surface.hpp"
#include "disjoint.hpp"
#include "../base/heap_sort.hpp"

namespace hmf {

namespace {

using Long = unsigned long long;

// An element of loop d that loop c has as well (c = d: one that it has twice);
// NONE if there is none, or no memory to find it.
uint32_t common_element(const GivenLoops* given, size_t c, size_t d, Memory& memory) {
    if (!given) return NONE;
    Array<uint32_t> sorted;
    const uint64_t first = given->offsets[c], n = given->offsets[c + 1] - first;
    if (!sorted.allocate(memory, n)) return NONE;
    for (uint64_t i = 0; i < n; ++i) sorted[i] = given->elements[first + i];
    heap_sort(sorted.data(), sorted.size(), [](uint32_t a, uint32_t b) { return a < b; });
    if (c == d) {
        for (uint64_t i = 1; i < n; ++i)
            if (sorted[i] == sorted[i - 1]) return sorted[i];
        return NONE;
    }
    for (uint64_t i = given->offsets[d]; i < given->offsets[d + 1]; ++i) {
        uint64_t low = 0, high = n;
        while (low < high) {
            const uint64_t middle = (low + high) / 2;
            if (sorted[middle] < given->elements[i]) low = middle + 1;
            else high = middle;
        }
        if (low < n && sorted[low] == given->elements[i]) return given->elements[i];
    }
    return NONE;
}

// Names the first loop that meets itself or, if there is none, the first one
// that crosses an earlier one.
hmf_status name_crossing(const Mesh& mesh, const Loops& loops, Multicurve& curves, const GivenLoops* given,
                         Call& call) {
    const char* const word = given && given->element_kind == HMF_LOOP_TRIANGLES ? "triangle" : "vertex";
    for (size_t c = 0; c < loops.count(); ++c) {
        if (c % 256 == 0 && !call.tick(0, true)) return call.was_cancelled();
        bool is_simple = false;
        if (!disjoint(mesh, loops, c, c + 1, curves, nullptr, call.memory, is_simple)) return call.out_of_memory();
        if (is_simple) continue;
        const uint32_t at = common_element(given, c, c, call.memory);
        if (at == NONE)
            return call.fail(HMF_ERROR_LOOP_NOT_SIMPLE, HMF_ELEMENT_LOOP, c,
                             "Loop %llu crosses itself. Give a loop that does not.", static_cast<Long>(c));
        return call.fail(HMF_ERROR_LOOP_NOT_SIMPLE, HMF_ELEMENT_LOOP, c,
                         "Loop %llu crosses itself; it passes %s %llu twice. Give a loop that does not.",
                         static_cast<Long>(c), word, static_cast<Long>(at));
    }
    // Loops 0 .. good - 1 are disjoint, loops 0 .. bad - 1 are not.
    size_t good = 1, bad = loops.count();
    while (good + 1 < bad) {
        const size_t middle = good + (bad - good) / 2;
        if (!call.tick(0, true)) return call.was_cancelled();
        bool are_disjoint = false;
        if (!disjoint(mesh, loops, 0, middle, curves, nullptr, call.memory, are_disjoint)) return call.out_of_memory();
        if (are_disjoint) good = middle;
        else bad = middle;
    }
    // Which of them?
    const size_t d = bad - 1;
    Loops two;
    if (!two.start(call.memory)) return call.out_of_memory();
    for (size_t c = 0; c < d; ++c) {
        if (c % 256 == 0 && !call.tick(0, true)) return call.was_cancelled();
        two.keep_first(0);
        if (!two.add(loops, c) || !two.add(loops, d)) return call.out_of_memory();
        bool are_disjoint = false;
        if (!disjoint(mesh, two, 0, 2, curves, nullptr, call.memory, are_disjoint)) return call.out_of_memory();
        if (are_disjoint) continue;
        const uint32_t at = common_element(given, c, d, call.memory);
        if (at == NONE)
            return call.fail(HMF_ERROR_LOOP_CROSSING, HMF_ELEMENT_LOOP, d,
                             "Loop %llu crosses loop %llu. Loops must be disjoint; they may touch.",
                             static_cast<Long>(d), static_cast<Long>(c));
        return call.fail(
            HMF_ERROR_LOOP_CROSSING, HMF_ELEMENT_LOOP, d,
            "Loop %llu crosses loop %llu, which it meets at %s %llu. Loops must be disjoint; they may touch.",
            static_cast<Long>(d), static_cast<Long>(c), word, static_cast<Long>(at));
    }
    return call.fail(HMF_ERROR_LOOP_CROSSING, HMF_ELEMENT_LOOP, d,
                     "Loop %llu crosses an earlier loop. Loops must be disjoint; they may touch.",
                     static_cast<Long>(d));
}

// Disks and annuli among the pieces that the curves leave.
hmf_status check_pieces(const Mesh& mesh, const Multicurve& curves, const Array<uint32_t>& loop_of, Call& call) {
    Memory& memory = call.memory;
    CutSurface cut;
    Array<uint32_t> parent, component_of, border, marks;
    Array<int64_t> euler;
    const size_t n = loop_of.size();
    if (!cut.build(mesh, curves, false, call) || !parent.allocate(memory, cut.region_count)
        || !component_of.allocate(memory, n) || !border.allocate_filled(memory, cut.region_count, NONE)
        || !euler.allocate_filled(memory, cut.region_count, int64_t{0})
        || !marks.allocate_filled(memory, cut.region_count, 0u))
        return call.stopped();
    if (!call.tick(0, true)) return call.was_cancelled();
    for (uint32_t r = 0; r < cut.region_count; ++r) parent[r] = r;
    for (size_t s = 0; s < cut.segment_count; ++s) unite(parent.data(), cut.region[2 * s], cut.region[2 * s + 1]);
    for (uint32_t r = 0; r < cut.region_count; ++r) ++euler[find_root(parent.data(), r)];
    for (size_t s = 0; s < cut.segment_count; ++s) --euler[find_root(parent.data(), cut.region[2 * s])];
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        // The segment that begins at the vertex is the first or last of its edge.
        const uint32_t h = mesh.out[v], e = edge_of(h);
        const uint32_t piece =
            find_root(parent.data(), cut.region[2 * size_t{cut.segment_first[e] + (h & 1u ? curves.count[e] : 0)}]);
        ++euler[piece];
        marks[piece] += mesh.is_marked(v);
    }
    if (!call.tick(0, true)) return call.was_cancelled();
    for (size_t k = 0; k < n; ++k) component_of[loop_of[k]] = static_cast<uint32_t>(k);
    for (int round = 0; round < 2; ++round) // disks first
        for (size_t c = 0; c < n; ++c) {
            const uint32_t crossed = curves.components.crossings[curves.components.offsets[component_of[c]]];
            const uint32_t e = edge_of(crossed);
            const uint32_t j = curves.begin[component_of[c]] - curves.first[e];
            for (uint32_t side = 0; side < 2; ++side) {
                const uint32_t piece =
                    find_root(parent.data(), cut.region[2 * size_t{cut.segment_first[e] + j + side}]);
                if (round == 0 && euler[piece] == 1 && marks[piece] == 0)
                    return call.fail(HMF_ERROR_LOOP_TRIVIAL, HMF_ELEMENT_LOOP, c,
                                     mesh.marked_count == 0
                                         ? "Loop %llu bounds a disk. Give one that goes round a handle."
                                         : "Loop %llu bounds a disk without marked vertices. Give one that goes round "
                                           "a handle or at least two marked vertices.",
                                     static_cast<Long>(c));
                if (round == 0 && euler[piece] == 1 && marks[piece] == 1)
                    return call.fail(HMF_ERROR_LOOP_TRIVIAL, HMF_ELEMENT_LOOP, c,
                                     "Loop %llu goes round a single marked vertex. Give one that goes round a handle "
                                     "or at least two marked vertices.",
                                     static_cast<Long>(c));
                if (round == 0 || euler[piece] != 0 || marks[piece] != 0) continue;
                if (border[piece] == NONE) border[piece] = static_cast<uint32_t>(c);
                else if (border[piece] != c)
                    return call.fail(
                        HMF_ERROR_LOOP_PARALLEL, HMF_ELEMENT_LOOP, c,
                        "Loops %llu and %llu are freely homotopic. Give one of them, with the sum of their weights.",
                        static_cast<Long>(border[piece]), static_cast<Long>(c));
            }
        }
    return HMF_OK;
}

} // namespace

hmf_status check_loops(const Mesh& mesh, const Loops& loops, Call& call, const GivenLoops* given) {
    const size_t count = loops.count();
    if (count == 0)
        return call.fail(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_LOOP, 0, "There are no loops. Give at least one.");
    for (size_t c = 0; c < count; ++c)
        if (loops.offsets[c] == loops.offsets[c + 1])
            return call.fail(HMF_ERROR_LOOP_TRIVIAL, HMF_ELEMENT_LOOP, c,
                             "Loop %llu goes back the way it came. Give one that goes round a handle.",
                             static_cast<Long>(c));
    if (loops.offsets[count] >= MULTICURVE_LIMIT)
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_LOOP, 0,
                         "The loops cross more than 2^29 edges. Give shorter ones.");
    Multicurve curves;
    Array<uint32_t> loop_of;
    if (!curves.allocate(mesh, call.memory)) return call.out_of_memory();
    if (!call.tick(0, true)) return call.was_cancelled();
    bool are_disjoint = false;
    if (!disjoint(mesh, loops, 0, count, curves, &loop_of, call.memory, are_disjoint)) return call.out_of_memory();
    if (!are_disjoint) return name_crossing(mesh, loops, curves, given, call);
    if (!call.tick(0, true)) return call.was_cancelled();
    return check_pieces(mesh, curves, loop_of, call);
}

} // namespace hmf
