#include "hole_joins.hpp"

#include "../../core/base/heap_sort.hpp"
#include "../../core/curves/loops.hpp"
#include "loop_parameters.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

// Where a half-segment ends another one of its region begins.
uint32_t HoleJoins::next_in_region(uint32_t half_segment) const {
    const uint32_t* const links = &surface_->link[3 * size_t{surface_->region[half_segment]}];
    const uint32_t next = mesh_.next[surface_->half_edge(half_segment)];
    uint32_t other = half_segment;
    for (int i = 0; i < 3; ++i) {
        if (links[i] == NONE || links[i] == half_segment) continue;
        other = links[i];
        if (surface_->half_edge(other) == next) break;
    }
    return other;
}

// Clockwise, with the hole on the right, once around it.
double HoleJoins::measure_round(uint32_t corner) const {
    double sum = 0;
    for (uint32_t at = corner;;) {
        sum += length_[surface_->segment_edge[at >> 1]];
        at = next_in_region(at ^ 1u);
        if (at == corner) return sum;
    }
}
Done HoleJoins::go_round(uint32_t corner, Array<uint32_t>& walk) const {
    for (uint32_t at = corner;;) {
        if (!walk.push(surface_->half_edge(at))) return false;
        at = next_in_region(at ^ 1u);
        if (at == corner) return true;
    }
}

Done HoleJoins::find(const CutSurface& surface, const Array<uint8_t>& holes, Array<Join>& found, Call& call) {
    surface_ = &surface;
    is_hole_ = &holes;
    found.start(call.memory);
    if (!count_holes(call) || !spread(call) || !find_borders(found, call)) return false;
    heap_sort(found.data(), found.size(), [](const Join& a, const Join& b) {
        if (a.length != b.length) return a.length < b.length;
        if (a.corner[0] != b.corner[0]) return a.corner[0] < b.corner[0];
        return a.corner[1] != b.corner[1] ? a.corner[1] < b.corner[1] : a.middle < b.middle;
    });
    while (!found.empty() && found.back().length > SLACK * found[0].length) found.pop();
    return true;
}

// Of each piece of the surface, at its root.
Done HoleJoins::count_holes(Call& call) {
    const uint32_t n = surface_->region_count;
    if (!around_.allocate_filled(call.memory, surface_->point_count, -1.0) || !piece_.allocate(call.memory, n)
        || !holes_.allocate_filled(call.memory, n, 0u) || !call.work(32 * uint64_t{surface_->segment_count}))
        return false;
    for (uint32_t r = 0; r < n; ++r) piece_[r] = r;
    for (size_t s = 0; s < surface_->segment_count; ++s)
        unite(piece_.data(), surface_->region[2 * s], surface_->region[2 * s + 1]);
    for (uint32_t k = 0; k < 2 * surface_->segment_count; ++k) {
        double& around = around_[begin_of(k)];
        if ((*is_hole_)[begin_of(k)] == NO_HOLE || around >= 0) continue;
        around = measure_round(k);
        ++holes_[find_root(piece_.data(), surface_->region[k])];
    }
    return true;
}

// The nearest hole of each region.
Done HoleJoins::spread(Call& call) {
    const size_t n = surface_->region_count;
    double least = HUGE_VAL;
    heap_.start(call.memory);
    if (!distance_.allocate_filled(call.memory, n, HUGE_VAL) || !corner_.allocate_filled(call.memory, n, NONE)
        || !from_.allocate_filled(call.memory, n, NONE) || !call.work(16 * uint64_t{surface_->segment_count}))
        return false;
    for (uint32_t k = 0; k < 2 * surface_->segment_count; ++k) {
        const uint32_t r = surface_->region[k];
        if (!is_joined(begin_of(k)) || corner_[r] != NONE || holes_around(r) <= 3) continue;
        corner_[r] = k;
        distance_[r] = 0;
        least = std::min(least, around_[begin_of(k)]);
        if (!heap_.push({0, r})) return false;
    }
    return grow_cells(least, call);
}

// The cells, from their holes. No path that is left is shorter than the next distance: it stops where that can make no
// curve that is short enough. least: length of the shortest hole.
Done HoleJoins::grow_cells(double least, Call& call) {
    double best = HUGE_VAL;
    while (!heap_.empty()) {
        const NearestFirst::Entry top = heap_.pop();
        if (!call.work(64)) return false;
        if (top.distance > distance_[top.item]) continue;
        if (2 * (least + top.distance) > SLACK * best) break;
        for (uint32_t i = 0; i < 3; ++i) {
            const uint32_t link = surface_->link[3 * size_t{top.item} + i];
            if (link == NONE) break;
            const uint32_t to = surface_->region[link ^ 1u], hole = owner(top.item);
            const double d = top.distance + length_[surface_->segment_edge[link >> 1]];
            if (corner_[to] != NONE && owner(to) != hole)
                best = std::min(best, around_[owner(to)] + around_[hole] + 2 * (d + distance_[to]));
            if (!(d < distance_[to])) continue;
            distance_[to] = d;
            corner_[to] = corner_[top.item];
            from_[to] = link;
            if (!heap_.push({d, to})) return false;
        }
    }
    return true;
}

HoleJoins::Join HoleJoins::contact(uint32_t s) const {
    const uint32_t r = surface_->region[2 * size_t{s}], q = surface_->region[2 * size_t{s} + 1];
    const double way = distance_[r] + length_[surface_->segment_edge[s]] + distance_[q];
    const uint32_t a = owner(r), b = owner(q);
    return {around_[a] + around_[b] + 2 * way, {a, b}, {corner_[r], corner_[q]}, 2 * s};
}

Done HoleJoins::find_borders(Array<Join>& found, Call& call) {
    const CutSurface& cut = *surface_;
    // Holes that meet in a region.
    for (uint32_t k = 0; k < 2 * cut.segment_count; ++k) {
        const uint32_t p = begin_of(k), r = cut.region[k];
        if (!is_joined(p) || corner_[r] == NONE || owner(r) == p) continue;
        const uint32_t q = owner(r);
        if (!found.push({around_[p] + around_[q], {std::min(p, q), std::max(p, q)}, {corner_[r], k}, NONE}))
            return false;
        if (q > p) std::swap(found.back().corner[0], found.back().corner[1]);
    }
    // Once for each two.
    const auto before = [](const Join& a, const Join& b) {
        return a.hole[0] != b.hole[0] ? a.hole[0] < b.hole[0]
             : a.hole[1] != b.hole[1] ? a.hole[1] < b.hole[1]
                                      : std::min(a.corner[0], a.corner[1]) < std::min(b.corner[0], b.corner[1]);
    };
    heap_sort(found.data(), found.size(), before);
    size_t kept = 0;
    for (size_t i = 0; i < found.size(); ++i)
        if (kept == 0 || found[kept - 1].hole[0] != found[i].hole[0] || found[kept - 1].hole[1] != found[i].hole[1])
            found[kept++] = found[i];
    while (found.size() > kept) found.pop();
    if (!call.work(128 * uint64_t{cut.segment_count})) return false;
    // The segments between two cells, in one piece as long as they meet at points of two cells.
    const auto is_border = [&](uint32_t s) {
        const uint32_t r = cut.region[2 * size_t{s}], q = cut.region[2 * size_t{s} + 1];
        return corner_[r] != NONE && corner_[q] != NONE && owner(r) != owner(q);
    };
    if (!borders_.find(
            cut, is_border, [&](uint32_t p) { return (*is_hole_)[p] != NO_HOLE; },
            [&](uint32_t s) { return contact(s).length; }, call.memory))
        return false;
    for (const uint32_t s : borders_.best())
        if (s != NONE && !found.push(contact(s))) return false;
    return true;
}

Done HoleJoins::walk(const Join& join, Array<uint32_t>& strip, Memory& memory) const {
    Array<uint32_t> round, way;
    round.start(memory);
    way.start(memory);
    if (join.middle != NONE) {
        for (uint32_t r = surface_->region[join.middle]; from_[r] != NONE; r = surface_->region[from_[r]])
            if (!way.push(from_[r])) return false;
        std::reverse(way.begin(), way.end());
        if (!way.push(join.middle)) return false;
        for (uint32_t r = surface_->region[join.middle ^ 1u]; from_[r] != NONE; r = surface_->region[from_[r]])
            if (!way.push(from_[r] ^ 1u)) return false;
    }
    if (!go_round(join.corner[0], round)) return false;
    for (const uint32_t link : way)
        if (!round.push(surface_->half_edge(link))) return false;
    if (!go_round(join.corner[1], round)) return false;
    for (size_t i = way.size(); i-- > 0;)
        if (!round.push(twin(surface_->half_edge(way[i])))) return false;
    size_t begin = 0, end = 0;
    remove_backtracking(round, begin, end);
    for (size_t i = begin; i < end; ++i)
        if (!strip.push(round[i])) return false;
    return true;
}

} // namespace hmf
