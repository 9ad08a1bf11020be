// Retriangulates flat polygons of an intrinsic triangulation, each in one step.
//
// Where two chains of many vertices face each other across a flat strip, as on a wall between two fans, edges that are
// flipped one after the other and stay straight need n^2 / 2 flips:
//
//     +--+--+--+--+--+           +--+--+--+--+--+
//     |  two fans    |    ->     |/ |/ |/ |/ |/ |
//     +--+--+--+--+--+           +--+--+--+--+--+
//
// A polygon of n triangles has a Delaunay triangulation that is found in the plane in time O(n), and 2 n flips of the
// connectivity lead there by way of a fan, whose triangles may overlap in the plane meanwhile.
#pragma once

#include "intrinsic.hpp"

namespace hmf {

// Around each edge that needs a flip, polygons are grown from triangles and get their Delaunay triangulation.  mesh,
// metric and sum follow; the flipped edges are appended to flips, at most 2 for each edge of the mesh.
// Checked at the end, by the angles alone: around each vertex they add up to what they did.
[[nodiscard]] hmf_status triangulate_polygons(Mesh& mesh, Metric& metric, double* sum, FlipLog& flips, Call& call,
                                              double fraction);

} // namespace hmf
