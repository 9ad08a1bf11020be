// Disjoint simple loops without backtracking form a normal multicurve, which
// its crossing numbers determine.  So add the crossing numbers, trace the
// multicurve that has them, and compare: its components must be the loops.
#include "disjoint.hpp"

#include "../base/cyclic.hpp"
#include "../base/heap_sort.hpp"

#include <algorithm>

namespace hmf {

namespace {

// Sequences in a form that neither the start nor the direction changes.
struct Canonical {
    Array<uint32_t> sequence;
    Array<uint64_t> offsets;
    Array<uint32_t> order; // of the sequences, sorted

    bool less(uint32_t a, uint32_t b, uint64_t& steps) const {
        const uint64_t n = offsets[a + 1] - offsets[a], m = offsets[b + 1] - offsets[b];
        if (n != m) return n < m;
        const uint32_t* const s = sequence.data() + offsets[a];
        const uint32_t* const t = sequence.data() + offsets[b];
        uint64_t i = 0;
        while (i < n && s[i] == t[i]) ++i;
        steps += 8 + i;
        return i < n ? s[i] < t[i] : a < b;
    }

    // Loops first .. last - 1.
    Done build(const Loops& loops, size_t first, size_t last, Call& call) {
        const uint64_t begin = loops.offsets[first], total = loops.offsets[last] - begin;
        Array<uint32_t> reversed;
        if (!sequence.allocate(call.memory, total) || !reversed.allocate(call.memory, total)
            || !offsets.allocate(call.memory, last - first + 1) || !order.allocate(call.memory, last - first))
            return false;
        offsets[0] = 0;
        for (size_t c = first; c < last; ++c) {
            const uint32_t* const s = loops.crossings.data() + loops.offsets[c];
            const size_t n = loops.offsets[c + 1] - loops.offsets[c];
            if (!call.work(16 * n)) return false;
            uint32_t* const r = reversed.data();
            for (size_t i = 0; i < n; ++i) r[i] = twin(s[n - 1 - i]);
            const size_t at_s = least_rotation(s, n), at_r = least_rotation(r, n);
            bool forward = true;
            for (size_t i = 0; i < n; ++i) {
                const uint32_t x = s[(at_s + i) % n], y = r[(at_r + i) % n];
                if (x != y) {
                    forward = x < y;
                    break;
                }
            }
            const uint32_t* const chosen = forward ? s : r;
            const size_t at = forward ? at_s : at_r;
            uint32_t* const to = sequence.data() + offsets[c - first];
            for (size_t i = 0; i < n; ++i) to[i] = chosen[(at + i) % n];
            offsets[c - first + 1] = offsets[c - first] + n;
            order[c - first] = static_cast<uint32_t>(c - first);
        }
        uint64_t steps = 0;
        const auto lower = [&](uint32_t a, uint32_t b) { return less(a, b, steps); };
        const auto go_on = [&] {
            const uint64_t more = steps;
            steps = 0;
            return bool(call.work(more));
        };
        return heap_sort(order.data(), order.size(), lower, go_on);
    }

    bool same(size_t a, const Canonical& other, size_t b) const {
        const uint64_t n = offsets[a + 1] - offsets[a];
        if (n != other.offsets[b + 1] - other.offsets[b]) return false;
        for (uint64_t i = 0; i < n; ++i)
            if (sequence[offsets[a] + i] != other.sequence[other.offsets[b] + i]) return false;
        return true;
    }
};

} // namespace

Done disjoint(const Mesh& mesh, const Loops& loops, size_t first, size_t last, Multicurve& curves,
              Array<uint32_t>* loop_of, Call& call, bool& answer) {
    answer = false;
    curves.clear();
    if (!curves.add(loops.crossings.data() + loops.offsets[first], loops.offsets[last] - loops.offsets[first]))
        return false;
    if (!curves.is_normal(mesh)) return true;
    if (!curves.trace(mesh, call)) return false;
    const size_t n = last - first;
    if (curves.components.count() != n) return true;
    Canonical given, traced;
    if (!given.build(loops, first, last, call) || !traced.build(curves.components, 0, n, call)) return false;
    if (loop_of && !loop_of->allocate(call.memory, n)) return false;
    for (size_t i = 0; i < n; ++i) {
        if (!given.same(given.order[i], traced, traced.order[i])) return true;
        if (loop_of) (*loop_of)[traced.order[i]] = given.order[i];
    }
    return answer = true;
}

Done one_is_disjoint(const Mesh& mesh, const Loops& loops, size_t one, Multicurve& curves, Call& call, bool& answer) {
    Loops near;
    curves.clear();
    if (!near.start(call.memory) || !curves.add(loops.loop(one), loops.length(one))) return false;
    for (size_t c = 0; c < loops.count(); ++c) {
        if (!call.work(1 + loops.length(c))) return false;
        bool meets = c == one;
        for (size_t i = 0; i < loops.length(c) && !meets; ++i) meets = curves.count[edge_of(loops.loop(c)[i])] > 0;
        if (meets && !near.add(loops, c)) return false;
    }
    return disjoint(mesh, near, 0, near.count(), curves, nullptr, call, answer);
}

} // namespace hmf
