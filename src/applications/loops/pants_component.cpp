#include "pants_component.hpp"

#include "../../core/base/disjoint_sets.hpp"
#include "../../core/base/heap_sort.hpp"
#include "../../core/curves/disjoint.hpp"

#include <algorithm>

namespace hmf {

hmf_status PantsComponents::start(const Loops& loops, Call& call) {
    Memory& memory = call.memory;
    const size_t n = loops.count();
    Array<uint32_t> loop_of;
    bool are_disjoint = false;
    if (!curves_.allocate(mesh_, memory) || !side_.allocate(memory, 2 * n) || !component_of_.allocate(memory, n)
        || !disjoint(mesh_, loops, 0, n, curves_, &loop_of, call, are_disjoint))
        return call.out_of_memory();
    if (!are_disjoint)
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, n, "Loops are not disjoint. Please report this.");
    for (uint32_t c = 0; c < n; ++c) component_of_[loop_of[c]] = c;
    chosen_.start(memory);
    point_listed_.start(memory);
    region_.listed.start(memory);
    segment_.listed.start(memory);
    if (!cut_.build(mesh_, curves_, true, call) || !list_pants(call)
        || !region_.local.allocate_filled(memory, cut_.region_count, NONE)
        || !segment_.local.allocate_filled(memory, cut_.segment_count, NONE)
        || !point_local_.allocate_filled(memory, cut_.point_count, NONE))
        return call.stopped();
    return HMF_OK;
}

// Regions and segments of each pair of pants.
Done PantsComponents::list_pants(Call& call) {
    Memory& memory = call.memory;
    const uint32_t regions = cut_.region_count, segments = cut_.segment_count;
    Array<uint32_t> piece, number;
    if (!piece.allocate(memory, regions) || !number.allocate_filled(memory, regions, NONE)) return false;
    for (uint32_t r = 0; r < regions; ++r) piece[r] = r;
    for (size_t s = 0; s < segments; ++s) unite(piece.data(), cut_.region[2 * s], cut_.region[2 * s + 1]);
    uint32_t count = 0;
    for (uint32_t r = 0; r < regions; ++r) {
        uint32_t& of_root = number[find_root(piece.data(), r)]; // the root is the first of its piece
        if (of_root == NONE) of_root = count++;
        piece[r] = r == piece[r] ? r : find_root(piece.data(), r);
    }
    const auto pants_of = [&](uint32_t region) { return number[piece[region]]; };
    const auto list = [&](Lists& lists, uint32_t size, auto of) -> Done {
        if (!lists.first.allocate_filled(memory, count + size_t{1}, 0u) || !lists.items.allocate(memory, size))
            return false;
        for (uint32_t i = 0; i < size; ++i) ++lists.first[of(i)];
        for (uint32_t p = 1; p <= count; ++p) lists.first[p] += lists.first[p - 1];
        for (uint32_t i = size; i-- > 0;) lists.items[--lists.first[of(i)]] = i;
        return true;
    };
    if (!list(regions_, regions, pants_of)
        || !list(segments_, segments, [&](uint32_t s) { return pants_of(cut_.region[2 * size_t{s}]); }))
        return false;
    for (size_t k = 0; k < component_of_.size(); ++k) {
        const uint32_t c = component_of_[k], h = curves_.components.loop(c)[0], e = edge_of(h);
        // It leaves through half-edge 2e there: the segment before the crossing lies on its right.
        const uint32_t right = cut_.segment_first[e] + curves_.begin[c] - curves_.first[e];
        for (uint32_t left = 0; left < 2; ++left) side_[2 * k + left] = pants_of(cut_.region[2 * size_t{right + left}]);
    }
    return true;
}

// Those of the chosen pairs of pants, each by itself.
Done PantsComponents::number(Numbers& numbers, const Lists& lists, Memory& memory) {
    for (const uint32_t i : numbers.listed) numbers.local[i] = NONE;
    numbers.listed.clear();
    for (const uint32_t p : chosen_)
        for (uint32_t i = lists.first[p]; i < lists.first[p + 1]; ++i)
            if (!numbers.listed.push(lists.items[i])) return false;
    if (!numbers.parent.allocate(memory, numbers.listed.size())) return false;
    for (uint32_t i = 0; i < numbers.listed.size(); ++i) {
        numbers.parent[i] = i;
        numbers.local[numbers.listed[i]] = i;
    }
    return true;
}

Done PantsComponents::add_point(uint32_t point, Component& out, uint32_t& number) {
    number = point_local_[point];
    if (number != NONE) return true;
    number = point_local_[point] = static_cast<uint32_t>(point_listed_.size());
    const bool is_hole = point >= mesh_.vertex_count || mesh_.is_marked(point);
    return point_listed_.push(point) && out.is_hole.push(is_hole);
}

Done PantsComponents::build(const uint32_t* loops, size_t count, Component& out, Memory& memory) {
    chosen_.clear();
    for (size_t i = 0; i < 2 * count; ++i) {
        const uint32_t p = side_[2 * size_t{loops[i / 2]} + i % 2];
        if (std::find(chosen_.begin(), chosen_.end(), p) == chosen_.end() && !chosen_.push(p)) return false;
    }
    heap_sort(chosen_.data(), chosen_.size(), [](uint32_t a, uint32_t b) { return a < b; });
    if (!number(region_, regions_, memory) || !number(segment_, segments_, memory)) return false;
    // Together across each crossing of the loops that are taken out.
    for (size_t i = 0; i < count; ++i) {
        const uint32_t c = component_of_[loops[i]];
        uint32_t h = curves_.components.loop(c)[0], p = curves_.begin[c] - curves_.first[edge_of(h)];
        for (size_t k = 0; k < curves_.components.length(c); ++k) {
            const uint32_t e = edge_of(h), at = h & 1u ? curves_.count[e] - 1 - p : p, s = cut_.segment_first[e] + at;
            unite(segment_.parent.data(), segment_.local[s], segment_.local[s + 1]);
            for (uint32_t b = 0; b < 2; ++b)
                unite(region_.parent.data(), region_.local[cut_.region[2 * size_t{s} + b]],
                      region_.local[cut_.region[2 * size_t{s + 1} + b]]);
            curves_.step(mesh_, h, p);
        }
    }
    const auto compact = [](Numbers& numbers) { // local: the number of the set
        numbers.count = 0;
        for (uint32_t i = 0; i < numbers.listed.size(); ++i) {
            const uint32_t root = find_root(numbers.parent.data(), i);
            numbers.local[numbers.listed[i]] = root == i ? numbers.count++ : numbers.local[numbers.listed[root]];
        }
    };
    compact(region_);
    compact(segment_);
    CutSurface& surface = out.surface;
    surface.region_count = region_.count;
    surface.segment_count = segment_.count;
    Array<uint32_t> last; // of the segments that are one now; the first is that in `from`
    Array<uint32_t> from;
    if (!surface.segment_edge.allocate(memory, segment_.count) || !surface.region.allocate(memory, 2 * segment_.count)
        || !surface.point.allocate(memory, 2 * segment_.count)
        || !surface.link.allocate_filled(memory, 3 * size_t{region_.count}, NONE)
        || !from.allocate_filled(memory, segment_.count, NONE) || !last.allocate_filled(memory, segment_.count, 0u))
        return false;
    for (const uint32_t s : segment_.listed) {
        const uint32_t to = segment_.local[s];
        from[to] = std::min(from[to], s);
        last[to] = std::max(last[to], s);
        surface.segment_edge[to] = cut_.segment_edge[s];
        for (uint32_t b = 0; b < 2; ++b)
            surface.region[2 * size_t{to} + b] = region_.local[cut_.region[2 * size_t{s} + b]];
    }
    for (const uint32_t p : point_listed_) point_local_[p] = NONE;
    point_listed_.clear();
    out.is_hole.start(memory);
    for (size_t s = 0; s < segment_.count; ++s)
        if (!add_point(cut_.point[2 * size_t{from[s]}], out, surface.point[2 * s])
            || !add_point(cut_.point[2 * size_t{last[s]} + 1], out, surface.point[2 * s + 1]))
            return false;
    surface.point_count = static_cast<uint32_t>(point_listed_.size());
    for (const uint32_t r : region_.listed) {
        uint32_t* const links = &surface.link[3 * size_t{region_.local[r]}];
        for (uint32_t i = 0; i < 3; ++i) {
            const uint32_t link = cut_.link[3 * size_t{r} + i];
            if (link == NONE) break;
            const uint32_t to = 2 * segment_.local[link >> 1] + (link & 1u);
            uint32_t k = 0;
            while (k < 3 && links[k] != NONE && links[k] != to) ++k;
            assert(k < 3);
            if (k < 3) links[k] = to;
        }
    }
    return true;
}

// Each region of the cycle falls into a left and a right one, each segment likewise:
//
//        left   | right
//      s', new  |   s       the curve leaves through half-segment 2s
//     ----------+--------
Done Component::cut_along(const Mesh& mesh, const Array<uint32_t>& cycle, Component& out, Memory& memory) const {
    const uint32_t n = static_cast<uint32_t>(cycle.size()), segments = surface.segment_count,
                   regions = surface.region_count, points = surface.point_count;
    CutSurface& cut = out.surface;
    cut.segment_count = segments + n;
    cut.region_count = regions + n;
    cut.point_count = points + 2;
    const auto copy = [&](auto& to, const auto& from, size_t size) -> Done {
        if (!to.allocate(memory, size)) return false;
        for (size_t i = 0; i < from.size(); ++i) to[i] = from[i];
        return true;
    };
    if (!copy(cut.segment_edge, surface.segment_edge, segments + size_t{n})
        || !copy(cut.region, surface.region, 2 * (segments + size_t{n}))
        || !copy(cut.point, surface.point, 2 * (segments + size_t{n}))
        || !copy(cut.link, surface.link, 3 * (regions + size_t{n})) || !copy(out.is_hole, is_hole, points + size_t{2}))
        return false;
    const uint32_t hole[2] = {points, points + 1}; // right, left
    out.is_hole[points] = out.is_hole[points + 1] = 1;
    // Segment link >> 1 keeps its beginning.
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t s = cycle[i] >> 1, made = segments + i, end_is_left = cycle[i] & 1u ? 0 : 1;
        cut.segment_edge[made] = surface.segment_edge[s];
        cut.point[2 * size_t{s} + 1] = hole[!end_is_left];
        cut.point[2 * size_t{made}] = hole[end_is_left];
        cut.point[2 * size_t{made} + 1] = surface.point[2 * size_t{s} + 1];
    }
    // The half-segment of the left or right part of the segment that link i crosses, on the side of the link or beyond.
    const auto part = [&](uint32_t i, bool left, bool beyond) {
        const bool end_is_left = !(cycle[i] & 1u);
        const uint32_t segment = left == end_is_left ? segments + i : cycle[i] >> 1;
        return 2 * segment + ((cycle[i] & 1u) ^ (beyond ? 1u : 0u));
    };
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t before = i ? i - 1 : n - 1, out_link = cycle[i], in_link = cycle[before] ^ 1u;
        const uint32_t left = surface.region[out_link], right = regions + i;
        const uint32_t* const links = &surface.link[3 * size_t{left}];
        uint32_t third = NONE;
        for (int k = 0; k < 3; ++k)
            if (links[k] != NONE && links[k] != out_link && links[k] != in_link) third = links[k];
        const bool third_is_left = surface.half_edge(out_link) == mesh.next[surface.half_edge(in_link)];
        for (const bool is_left : {true, false}) {
            const uint32_t r = is_left ? left : right;
            const uint32_t sides[3] = {part(before, is_left, true), part(i, is_left, false),
                                       third != NONE && third_is_left == is_left ? third : NONE};
            for (uint32_t k = 0; k < 3; ++k) {
                cut.link[3 * size_t{r} + k] = sides[k];
                if (sides[k] != NONE) cut.region[sides[k]] = r;
            }
        }
    }
    return true;
}

} // namespace hmf
