// Edges along which a surface is folded, and the way along them.
#pragma once

#include "quad_shape.hpp"

namespace hmf {

// Whether the faces of an edge differ by more than 40 degrees.
bool is_sharp(const Mesh& mesh, const double* position, uint32_t h);

// Whether three or more sharp edges meet at a vertex.
bool is_sharp_corner(const Mesh& mesh, const double* position, uint32_t v);

// The point nearest to p on the sharp line of the edge of h, searched from that edge on as long as
// the next one is nearer.  A corner, where a line ends or several meet, is not passed:
//
//        x             x: corners
//        |     o p
//        |     |
//    ----x-----+-----x
//
// Returns a half-edge of the edge found.
uint32_t walk_along_sharp_edges(const Mesh& mesh, const double* position, uint32_t h, const double* p, double* nearest);

// From p on the sharp edge of h along its line by a length, backwards if that is negative, to a corner at most.
// Returns a half-edge of the edge reached.
uint32_t slide_along_sharp_edges(const Mesh& mesh, const double* position, uint32_t h, const Point& p, double length,
                                 double* reached);

} // namespace hmf
