// The borders between the cells of a Voronoi diagram on a cut surface, and the best segment of each.
#pragma once

#include "../../core/base/disjoint_sets.hpp"
#include "../../core/curves/cut_surface.hpp"

namespace hmf {

class CellBorders {
public:
    // is_border(s): the segment lies between two cells.  Its neighbors belong to the same border where they meet at
    // a point with two such segments that is not is_end(p).  length(s): the quantity that the best one minimizes.
    template <class IsBorder, class IsEnd, class Length>
    Done find(const CutSurface& cut, IsBorder is_border, IsEnd is_end, Length length, Memory& memory) {
        if (!border_.allocate_filled(memory, cut.segment_count, NONE)
            || !best_.allocate_filled(memory, cut.segment_count, NONE)
            || !degree_.allocate_filled(memory, cut.point_count, 0u)
            || !at_.allocate_filled(memory, cut.point_count, NONE))
            return false;
        for (uint32_t s = 0; s < cut.segment_count; ++s) {
            if (!is_border(s)) continue;
            border_[s] = s;
            for (size_t end = 0; end < 2; ++end) ++degree_[cut.point[2 * size_t{s} + end]];
        }
        for (uint32_t s = 0; s < cut.segment_count; ++s)
            for (size_t end = 0; border_[s] != NONE && end < 2; ++end) {
                const uint32_t p = cut.point[2 * size_t{s} + end];
                if (is_end(p) || degree_[p] != 2) continue;
                if (at_[p] != NONE) unite(border_.data(), s, at_[p]);
                at_[p] = s;
            }
        for (uint32_t s = 0; s < cut.segment_count; ++s) {
            if (border_[s] == NONE) continue;
            uint32_t& best = best_[find_root(border_.data(), s)];
            if (best == NONE || length(s) < length(best)) best = s;
        }
        return true;
    }
    const Array<uint32_t>& best() const { return best_; } // per segment, at the root of its border; else NONE

private:
    Array<uint32_t> border_, best_; // per segment
    Array<uint32_t> degree_, at_;   // per point
};

} // namespace hmf
