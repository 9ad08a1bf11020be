// The point of a surface nearest to a point in space, searched from a given triangle: across the side or around the
// corner on which the nearest point of the triangle lies, as long as the distance decreases. So a point never jumps to
// another part of the surface nearby.
#pragma once

#include "../../core/mesh/mesh.hpp"

namespace hmf {

// Of the triangle a, b, c; on: 0 inside, 1 to 3 on its side a-b, b-c, c-a, 4 to 6 at a, b, c.
// Returns the squared distance.
double nearest_in_triangle(const double* p, const double* a, const double* b, const double* c, double* nearest,
                           int& on);

// side: a half-edge of the triangle to start from; nearest: the point found.
// Returns a half-edge of its triangle.  Triangles with the number NONE are no part of the surface.
uint32_t walk_to_nearest(const Mesh& mesh, const double* position, uint32_t side, const double* p, double* nearest);

} // namespace hmf
