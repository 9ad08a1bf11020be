// Which cycles of regions separate?  One word per segment answers it.
//
// A spanning tree of the regions and one of the points (vertices, and the
// shrunk sides of the earlier loops) that crosses none of its links leave
// 2 * genus segments.  Each closes a cycle of points; the set of these that a
// segment lies on, as the exclusive or of one random word per cycle, is its
// signature.  The signatures along a cycle of regions cancel if it separates;
// if they do not, it does not separate.
//
// So a cycle that does not separate crosses a segment with a signature.  There
// are few of these: they are where fronts of the search that made the tree of
// the regions meet on the far side of a handle.
#pragma once

#include "../../core/curves/cut_surface.hpp"

namespace hmf {

struct Signatures {
    Array<uint64_t> of; // per segment; 0: on no cycle
    // The tree of the regions, breadth first.
    Array<uint32_t> reached; // per region: the half-segment it was reached through, seen from there; NONE: the root
    Array<uint32_t> rank;    // per region: its place in the order of the search

    // Those of `trivial`, sorted, count as 0.
    Array<uint64_t> trivial;

    Done build(const CutSurface& cut, Call& call);

    // Instead: along a cycle of regions in a planar piece the signatures add up to
    // the words of the holes on one side of it.  Trivial: at most one on a side.
    Done build_holes(const CutSurface& cut, const Array<uint8_t>& is_hole, Call& call);

    // Instead: on a surface with holes, whatever its genus.  The signatures along a cycle of regions add up to 0 if it
    // separates, with all holes on one side.  Trivial: separates one hole from the others.
    Done build_punctured(const CutSurface& cut, const Array<uint8_t>& is_hole, Call& call);
    bool is_trivial(uint64_t signature) const {
        size_t low = 0, high = trivial.size();
        while (low < high) {
            const size_t middle = (low + high) / 2;
            if (trivial[middle] < signature) low = middle + 1;
            else high = middle;
        }
        return low < trivial.size() && trivial[low] == signature;
    }

    // Length of the cycle that a segment closes in the tree of the regions; of a part of it
    // if that is above `enough`.
    double cycle(const CutSurface& cut, uint32_t segment, const Array<double>& edge_length, double enough) const;
};

} // namespace hmf
