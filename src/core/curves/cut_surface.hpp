// The surface cut along a normal multicurve.  Curves cut a triangle with n
// arcs into n + 1 regions and an edge with n crossings into n + 1 segments:
//
//                k
//               /3\          region 0 is the one in the middle, with three
//              /___\         segments; those at the corners have two
//             /     \        .
//            /\  0  /\       .
//           /1 |   |2 \      .
//          i---|---|---j     segments 0, 1, 2 of edge ij
//
// With every side of every curve shrunk to a point this is a cell complex of
// closed surfaces: regions, segments and points.
#pragma once

#include "multicurve.hpp"

namespace hmf {

// Half-segment 2s + b is segment s seen from half-edge 2e + b of its edge.
struct CutSurface {
    uint32_t region_count = 0, segment_count = 0, point_count = 0;
    Array<uint32_t> segment_first; // per edge; segments from the origin of half-edge 2e
    Array<uint32_t> segment_edge;
    Array<uint32_t> region_first; // per face: its middle region
    Array<uint32_t> region;       // per half-segment
    Array<uint32_t> point;        // per segment two: its beginning and end.  Vertices, then
                                  // vertex_count + 2 * component + (0: left, 1: right side)
    Array<uint32_t> link;         // three per region: its half-segments, or NONE

    // curves: traced.
    Done build(const Mesh& mesh, const Multicurve& curves, bool with_links, Call& call);
    uint32_t half_edge(uint32_t half_segment) const {
        return 2 * segment_edge[half_segment >> 1] + (half_segment & 1u);
    }

private:
    Done cut_edges(const Mesh& mesh, const Multicurve& curves, Call& call);
    void count_regions(const Mesh& mesh, const Multicurve& curves, const Array<uint32_t>& side);
    void cut_face(const Mesh& mesh, const Multicurve& curves, uint32_t f, uint32_t side);
};

} // namespace hmf
