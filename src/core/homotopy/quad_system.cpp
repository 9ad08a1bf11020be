// Reduction of walks to canonical ones; see quad_system.hpp.
#include "quad_system.hpp"

#include <algorithm>

namespace hmf {

namespace {

// Does edge i of a walk start at b?
bool starts_at_b(bool from_b, size_t i) { return (i % 2 == 1) != from_b; }

void shrink(Walk& walk, size_t n) {
    while (walk.size() > n) walk.pop();
}

} // namespace

bool QuadSystem::start(const Array<uint32_t>& twin_side, Memory& memory) {
    const uint32_t n = static_cast<uint32_t>(twin_side.size());
    if (!at_a_.allocate(memory, n) || !spoke_.allocate(memory, n)) return false;
    // The corner ahead of the twin of the side that comes in.
    uint32_t corner = 0;
    for (uint32_t i = 0; i < n; ++i) {
        at_a_[corner] = i;
        spoke_[i] = corner;
        corner = twin_side[(corner + n - 1) % n];
    }
    if (n != 4) return true;
    if (!homology_.allocate_filled(memory, 8, 0)) return false;
    int32_t x[2] = {0, 0};
    uint32_t pairs = 0, pair_of[4] = {0, 0, 0, 0};
    for (uint32_t c = 0; c < 4; ++c) {
        homology_[2 * c] = x[0];
        homology_[2 * c + 1] = x[1];
        const bool first = twin_side[c] > c;
        pair_of[c] = first ? pairs++ : pair_of[twin_side[c]];
        x[pair_of[c]] += first ? 1 : -1;
    }
    return true;
}

uint32_t QuadSystem::turned(bool at_b, uint32_t spoke, uint32_t quads) const {
    const uint32_t n = size();
    return at_b ? (spoke + quads) % n : spoke_[(at_a_[spoke] + quads) % n];
}

uint32_t QuadSystem::turn(bool at_b, uint32_t in, uint32_t out) const {
    const uint32_t n = size(), from = at_b ? in : at_a_[in], to = at_b ? out : at_a_[out];
    return to >= from ? to - from : to + n - from;
}

// Rows that remain after brackets are postponed and processed last row first: brackets can follow from one another as
// often as the walk is long, which is too deep for recursion.
bool QuadSystem::push(Walk& walk, bool from_b, uint32_t spoke) const {
    Walk waiting;
    waiting.start(walk.memory());
    for (;;) {
        if (!place(walk, from_b, spoke, waiting)) return false;
        if (waiting.empty()) return true;
        spoke = waiting.back();
        waiting.pop();
    }
}

bool QuadSystem::place(Walk& walk, bool from_b, uint32_t spoke, Walk& waiting) const {
    if (!walk.empty() && walk.back() == spoke) {
        walk.pop();
        return true;
    }
    if (!walk.push(spoke)) return false;
    const size_t n = walk.size();
    if (size() < 8 || n < 3) return true;
    // A bracket that ends here?
    const uint32_t side = turn(starts_at_b(from_b, n - 1), walk[n - 2], walk[n - 1]);
    if (side != 1 && side != size() - 1) return true;
    const uint32_t twice = side == 1 ? 2 : size() - 2;
    size_t first = n - 3;
    while (first > 0 && turn(starts_at_b(from_b, first + 1), walk[first], walk[first + 1]) == twice) --first;
    if (turn(starts_at_b(from_b, first + 1), walk[first], walk[first + 1]) != side) return true;
    // Along the other side of the row.
    uint32_t along = turned(starts_at_b(from_b, first), walk[first], size() - side);
    bool at_b = !starts_at_b(from_b, first);
    shrink(walk, first);
    const size_t before = waiting.size();
    for (size_t i = first; i + 2 < n; ++i) {
        if (!waiting.push(along)) return false;
        along = turned(at_b, along, size() - twice);
        at_b = !at_b;
    }
    std::reverse(waiting.begin() + before, waiting.end());
    return true;
}

// Turns the closed walk so that it starts with edge `first`.
bool QuadSystem::rotate(Walk& walk, bool& from_b, size_t first, Memory& memory) {
    Walk other;
    if (!other.allocate(memory, walk.size())) return false;
    for (size_t i = 0; i < walk.size(); ++i) other[i] = walk[(first + i) % walk.size()];
    if (first % 2) from_b = !from_b;
    walk.swap(other);
    return true;
}

bool QuadSystem::shorten_round(Walk& walk, bool& from_b, Memory& memory) const {
    for (;;) {
        Walk shorter;
        shorter.start(memory);
        for (const uint32_t spoke : walk)
            if (!push(shorter, from_b, spoke)) return false;
        // Spurs where it closes.
        size_t begin = 0, end = shorter.size();
        while (end - begin >= 2 && shorter[begin] == shorter[end - 1]) {
            ++begin;
            --end;
        }
        if (begin % 2) from_b = !from_b;
        walk.clear();
        for (size_t i = begin; i < end; ++i)
            if (!walk.push(shorter[i])) return false;
        const size_t n = walk.size();
        const auto turn_after = [&](size_t i) {
            return turn(starts_at_b(from_b, (i + 1) % n), walk[i % n], walk[(i + 1) % n]);
        };
        // A row of quads all round, with one corner.
        size_t corner = NONE, rest = 0;
        uint32_t once = 0;
        for (size_t i = 0; i < n && corner == NONE; ++i) {
            once = turn_after(i);
            if (once == 1 || once == size() - 1) corner = i;
        }
        const uint32_t all_else = once == 1 ? 2 : size() - 2;
        for (size_t i = 0; corner != NONE && i < n; ++i) rest += i != corner && turn_after(i) == all_else;
        if (corner != NONE && n > 2 && rest + 1 == n) {
            const size_t next = (corner + 2) % n;
            const bool at_b = starts_at_b(from_b, next);
            const uint32_t rung = turned(at_b, walk[next], size() - once);
            uint32_t along = turned(!at_b, rung, size() - once);
            from_b = !at_b;
            shrink(walk, n - 2);
            for (size_t i = 0; i + 2 < n; ++i) {
                walk[i] = along;
                along = turned(starts_at_b(from_b, i + 1), along, size() - all_else);
            }
            continue;
        }
        // Brackets there.
        size_t found = NONE;
        for (size_t i = 0; i < n && found == NONE; ++i) {
            const uint32_t side = turn_after(i);
            if (side != 1 && side != size() - 1) continue;
            const uint32_t twice = side == 1 ? 2 : size() - 2;
            size_t edges = 3; // of the bracket
            while (edges < n && turn_after(i + edges - 2) == twice) ++edges;
            if (edges <= n && turn_after(i + edges - 2) == side) found = i;
        }
        if (found == NONE) return true;
        if (!rotate(walk, from_b, found, memory)) return false;
    }
}

bool QuadSystem::canonical_directed(Walk& walk, Memory& memory) const {
    bool from_b = false;
    if (!shorten_round(walk, from_b, memory)) return false;
    const size_t n = walk.size();
    if (n == 0) return true;
    const uint32_t one = size() - 1, two = size() - 2; // to the left
    const auto turn_after = [&](size_t i) {
        return turn(starts_at_b(from_b, (i + 1) % n), walk[i % n], walk[(i + 1) % n]);
    };
    size_t pushed = 0;
    for (size_t quiet = 0, i = 0; quiet < n && pushed < 4 * n + 16; i = (i + 1) % n, ++quiet) {
        if (turn_after(i) != one) continue;
        size_t before = 0, after = 0;
        while (before + 1 < n && turn_after(i + n - 1 - before) == two) ++before;
        while (before + after + 1 < n && turn_after(i + 1 + after) == two) ++after;
        const size_t edges = before + after + 2, first = (i + n - before) % n;
        if (edges > n) continue;
        uint32_t along = turned(starts_at_b(from_b, first), walk[first], 1);
        for (size_t k = 0; k < edges; ++k) {
            const size_t at = (first + k) % n;
            walk[at] = along;
            // On the right now: 1 2 .. 2 3 2 .. 2 1, or without the 3 if the -1 was at an end.
            const bool corner =
                (k == 0 && (before > 0 || after == 0)) || (k + 2 == edges && (after > 0 || before == 0));
            along = turned(!starts_at_b(from_b, at), along,
                           corner                                   ? 1
                           : k == before && after > 0 && before > 0 ? 3
                                                                    : 2);
        }
        quiet = 0;
        ++pushed;
    }
    bool all = true;
    for (size_t i = 0; i < n && all; ++i) all = turn_after(i) == two;
    if (all) {
        const uint32_t across = turned(from_b, walk[0], 1);
        from_b = !from_b;
        walk[0] = turned(from_b, across, 1);
        for (size_t i = 1; i < n; ++i) walk[i] = turned(starts_at_b(from_b, i), walk[i - 1], 2);
    }
    // Of all starts at a the one with the least sequence.
    size_t best = from_b ? 1 : 0;
    for (size_t start = best + 2; start < n + best; start += 2)
        for (size_t i = 0; i < n; ++i) {
            const uint32_t x = walk[(start + i) % n], y = walk[(best + i) % n];
            if (x == y) continue;
            if (x < y) best = start;
            break;
        }
    return rotate(walk, from_b, best, memory);
}

bool QuadSystem::homology(Walk& walk) const {
    int64_t x[2] = {0, 0};
    for (size_t i = 0; i + 1 < walk.size(); i += 2)
        for (uint32_t k = 0; k < 2; ++k) x[k] += homology_[2 * walk[i + 1] + k] - homology_[2 * walk[i] + k];
    walk.clear();
    if (x[0] == 0 && x[1] == 0) return true;
    const int64_t sign = x[0] < 0 || (x[0] == 0 && x[1] < 0) ? -1 : 1;
    return walk.push(static_cast<uint32_t>(sign * x[0])) && walk.push(static_cast<uint32_t>(sign * x[1]));
}

bool QuadSystem::canonical(Walk& walk, Memory& memory) const {
    if (size() == 4) return homology(walk);
    Walk back;
    if (!back.allocate(memory, walk.size())) return false;
    for (size_t i = 0; i < walk.size(); ++i) back[i] = walk[walk.size() - 1 - i];
    if (!canonical_directed(walk, memory) || !canonical_directed(back, memory)) return false;
    for (size_t i = 0; i < walk.size() && i < back.size(); ++i) {
        if (walk[i] == back[i]) continue;
        if (back[i] < walk[i]) walk.swap(back);
        break;
    }
    return true;
}

} // namespace hmf
