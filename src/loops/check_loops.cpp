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
#include "cut_surface.hpp"
#include "heap_sort.hpp"

namespace hmf {

namespace {

using Long = unsigned long long;

hmf_status cancelled(Call& call) {
    return call.fail(HMF_CANCELLED, HMF_ELEMENT_NONE, 0, "Cancelled by the progress callback.");
}

// Where the least rotation of a cyclic sequence begins; linear time.
size_t least_rotation(const uint32_t* s, size_t n) {
    size_t i = 0, j = 1, k = 0;
    while (i < n && j < n && k < n) {
        const size_t p = i + k < n ? i + k : i + k - n, q = j + k < n ? j + k : j + k - n;
        if (s[p] == s[q]) { ++k; continue; }
        if (s[p] > s[q]) i += k + 1;
        else j += k + 1;
        if (i == j) ++j;
        k = 0;
    }
    return i < j ? i : j;
}

// Sequences in a form that neither the start nor the direction changes.
struct Canonical {
    Array<uint32_t> sequence;
    Array<uint64_t> offsets;
    Array<uint32_t> order; // of the sequences, sorted

    bool less(uint32_t a, uint32_t b) const {
        const uint64_t n = offsets[a + 1] - offsets[a], m = offsets[b + 1] - offsets[b];
        if (n != m) return n < m;
        const uint32_t* const s = sequence.data() + offsets[a];
        const uint32_t* const t = sequence.data() + offsets[b];
        for (uint64_t i = 0; i < n; ++i)
            if (s[i] != t[i]) return s[i] < t[i];
        return a < b;
    }

    // Loops first .. last - 1.  False: out of memory.
    bool build(const Loops& loops, size_t first, size_t last, Memory& memory) {
        const uint64_t begin = loops.offsets[first], total = loops.offsets[last] - begin;
        Array<uint32_t> reversed;
        if (!sequence.allocate(memory, total) || !reversed.allocate(memory, total) || !offsets.allocate(memory, last - first + 1) ||
            !order.allocate(memory, last - first))
            return false;
        offsets[0] = 0;
        for (size_t c = first; c < last; ++c) {
            const uint32_t* const s = loops.crossings.data() + loops.offsets[c];
            const size_t n = loops.offsets[c + 1] - loops.offsets[c];
            uint32_t* const r = reversed.data();
            for (size_t i = 0; i < n; ++i) r[i] = twin(s[n - 1 - i]);
            const size_t at_s = least_rotation(s, n), at_r = least_rotation(r, n);
            bool forward = true;
            for (size_t i = 0; i < n; ++i) {
                const uint32_t x = s[(at_s + i) % n], y = r[(at_r + i) % n];
                if (x != y) { forward = x < y; break; }
            }
            const uint32_t* const chosen = forward ? s : r;
            const size_t at = forward ? at_s : at_r;
            uint32_t* const to = sequence.data() + offsets[c - first];
            for (size_t i = 0; i < n; ++i) to[i] = chosen[(at + i) % n];
            offsets[c - first + 1] = offsets[c - first] + n;
            order[c - first] = static_cast<uint32_t>(c - first);
        }
        heap_sort(order.data(), order.size(), [this](uint32_t a, uint32_t b) { return less(a, b); });
        return true;
    }

    bool same(size_t a, const Canonical& other, size_t b) const {
        const uint64_t n = offsets[a + 1] - offsets[a];
        if (n != other.offsets[b + 1] - other.offsets[b]) return false;
        for (uint64_t i = 0; i < n; ++i)
            if (sequence[offsets[a] + i] != other.sequence[other.offsets[b] + i]) return false;
        return true;
    }
};

enum class Answer { yes, no, out_of_memory };

// Are loops first .. last - 1 simple and disjoint?  Leaves their multicurve
// in `curves`, and the loop (from 0) of each component in loop_of, if wanted.
Answer disjoint(const Mesh& mesh, const Loops& loops, size_t first, size_t last, Multicurve& curves, Array<uint32_t>* loop_of, Memory& memory) {
    curves.clear();
    if (!curves.add(loops.crossings.data() + loops.offsets[first], loops.offsets[last] - loops.offsets[first])) return Answer::out_of_memory;
    if (!curves.is_normal(mesh)) return Answer::no;
    if (!curves.trace(mesh, memory)) return Answer::out_of_memory;
    const size_t n = last - first;
    if (curves.components.count() != n) return Answer::no;
    Canonical given, traced;
    if (!given.build(loops, first, last, memory) || !traced.build(curves.components, 0, n, memory)) return Answer::out_of_memory;
    if (loop_of && !loop_of->allocate(memory, n)) return Answer::out_of_memory;
    for (size_t i = 0; i < n; ++i) {
        if (!given.same(given.order[i], traced, traced.order[i])) return Answer::no;
        if (loop_of) (*loop_of)[traced.order[i]] = given.order[i];
    }
    return Answer::yes;
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
