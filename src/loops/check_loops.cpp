// Are the loops simple, disjoint, essential and pairwise not freely homotopic?
// Decided in integers, in time linear in mesh and crossings.
//
// (a) Disjoint simple loops without backtracking form a normal multicurve,
//     which its crossing numbers determine.  So add the crossing numbers,
//     trace the multicurve that has them, and compare: its components must be
//     the loops.
// (b) Cut along it.  A piece of Euler characteristic 1 is a disk and its loop
//     trivial; one of characteristic 0 is an annulus:
//
//      loop c  (   annulus   )  loop d      c and d are freely homotopic,
//                                           unless c = d (on a torus)
#include "../base/disjoint_sets.hpp"
#include "cut_surface.hpp"
#include "disjoint.hpp"

namespace hmf {

namespace {

using Long = unsigned long long;

hmf_status cancelled(Call& call) {
    return call.fail(HMF_CANCELLED, HMF_ELEMENT_NONE, 0, "Cancelled by the progress callback.");
}

// Names the first loop that meets itself or, if there is none, the first one
// that crosses an earlier one.
hmf_status name_crossing(const Mesh& mesh, const Loops& loops, Multicurve& curves, Call& call) {
    for (size_t c = 0; c < loops.count(); ++c) {
        if (c % 256 == 0 && !call.tick(0, true)) return cancelled(call);
        const Answer answer = disjoint(mesh, loops, c, c + 1, curves, nullptr, call.memory);
        if (answer == Answer::out_of_memory) return call.out_of_memory();
        if (answer == Answer::no)
            return call.fail(HMF_ERROR_LOOP_NOT_SIMPLE, HMF_ELEMENT_LOOP, c, "Loop %llu meets itself. Give a loop that passes everywhere at most once.",
                             static_cast<Long>(c));
    }
    // Loops 0 .. good - 1 are disjoint, loops 0 .. bad - 1 are not.
    size_t good = 1, bad = loops.count();
    while (good + 1 < bad) {
        const size_t middle = good + (bad - good) / 2;
        if (!call.tick(0, true)) return cancelled(call);
        const Answer answer = disjoint(mesh, loops, 0, middle, curves, nullptr, call.memory);
        if (answer == Answer::out_of_memory) return call.out_of_memory();
        if (answer == Answer::yes) good = middle;
        else bad = middle;
    }
    return call.fail(HMF_ERROR_LOOP_CROSSING, HMF_ELEMENT_LOOP, bad - 1, "Loop %llu crosses an earlier loop. Loops must be disjoint.", static_cast<Long>(bad - 1));
}

// Disks and annuli among the pieces that the curves leave.
hmf_status check_pieces(const Mesh& mesh, const Multicurve& curves, const Array<uint32_t>& loop_of, Call& call) {
    Memory& memory = call.memory;
    CutSurface cut;
    Array<uint32_t> parent, component_of, border;
    Array<int64_t> euler;
    const size_t n = loop_of.size();
    if (!cut.build(mesh, curves, false, memory) || !parent.allocate(memory, cut.region_count) || !component_of.allocate(memory, n) ||
        !border.allocate_filled(memory, cut.region_count, NONE) || !euler.allocate_filled(memory, cut.region_count, int64_t{0}))
        return call.out_of_memory();
    if (!call.tick(0, true)) return cancelled(call);
    for (uint32_t r = 0; r < cut.region_count; ++r) parent[r] = r;
    for (size_t s = 0; s < cut.segment_count; ++s) unite(parent.data(), cut.region[2 * s], cut.region[2 * s + 1]);
    for (uint32_t r = 0; r < cut.region_count; ++r) ++euler[find_root(parent.data(), r)];
    for (size_t s = 0; s < cut.segment_count; ++s) --euler[find_root(parent.data(), cut.region[2 * s])];
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        // The segment that begins at the vertex is the first or last of its edge.
        const uint32_t h = mesh.out[v], e = edge_of(h);
        ++euler[find_root(parent.data(), cut.region[2 * size_t{cut.segment_first[e] + (h & 1u ? curves.count[e] : 0)}])];
    }
    if (!call.tick(0, true)) return cancelled(call);
    for (size_t k = 0; k < n; ++k) component_of[loop_of[k]] = static_cast<uint32_t>(k);
    for (int round = 0; round < 2; ++round) // disks first
        for (size_t c = 0; c < n; ++c) {
            const uint32_t crossed = curves.components.crossings[curves.components.offsets[component_of[c]]];
            const uint32_t e = edge_of(crossed);
            const uint32_t j = curves.begin[component_of[c]] - curves.first[e];
            for (uint32_t side = 0; side < 2; ++side) {
                const uint32_t piece = find_root(parent.data(), cut.region[2 * size_t{cut.segment_first[e] + j + side}]);
                if (round == 0 && euler[piece] == 1)
                    return call.fail(HMF_ERROR_LOOP_TRIVIAL, HMF_ELEMENT_LOOP, c, "Loop %llu bounds a disk. Give one that goes round a handle.", static_cast<Long>(c));
                if (round == 0 || euler[piece] != 0) continue;
                if (border[piece] == NONE) border[piece] = static_cast<uint32_t>(c);
                else if (border[piece] != c)
                    return call.fail(HMF_ERROR_LOOP_PARALLEL, HMF_ELEMENT_LOOP, c, "Loops %llu and %llu are freely homotopic. Give one of them, with the sum of their weights.",
                                     static_cast<Long>(border[piece]), static_cast<Long>(c));
            }
        }
    return HMF_OK;
}

} // namespace

hmf_status check_loops(const Mesh& mesh, const Loops& loops, Call& call) {
    const size_t count = loops.count();
    if (count == 0) return call.fail(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_LOOP, 0, "There are no loops. Give at least one.");
    for (size_t c = 0; c < count; ++c)
        if (loops.offsets[c] == loops.offsets[c + 1])
            return call.fail(HMF_ERROR_LOOP_TRIVIAL, HMF_ELEMENT_LOOP, c, "Loop %llu goes back the way it came. Give one that goes round a handle.", static_cast<Long>(c));
    if (loops.offsets[count] >= MULTICURVE_LIMIT)
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_LOOP, 0, "The loops cross more than 2^29 edges. Give shorter ones.");
    Multicurve curves;
    Array<uint32_t> loop_of;
    if (!curves.allocate(mesh, call.memory)) return call.out_of_memory();
    if (!call.tick(0, true)) return cancelled(call);
    const Answer answer = disjoint(mesh, loops, 0, count, curves, &loop_of, call.memory);
    if (answer == Answer::out_of_memory) return call.out_of_memory();
    if (answer == Answer::no) return name_crossing(mesh, loops, curves, call);
    if (!call.tick(0, true)) return cancelled(call);
    return check_pieces(mesh, curves, loop_of, call);
}

} // namespace hmf
