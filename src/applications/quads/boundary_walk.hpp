// The boundary of a surface, and the way along it.  Triangles with the number NONE are no part of the surface.
#pragma once

#include "quad_shape.hpp"

namespace hmf {

// Whether the surface lies left of h and ends there.
inline bool is_on_rim(const Mesh& mesh, uint32_t h) { return mesh.face[h] != NONE && mesh.face[twin(h)] == NONE; }

// Of the boundary edges at the corners of the triangle left of `side` the one nearest to p; NONE: there is none.
uint32_t rim_near(const Mesh& mesh, const double* position, uint32_t side, const double* p);

// The half-edge of the boundary after h, which is one.
uint32_t next_on_rim(const Mesh& mesh, uint32_t h);

// From p on the edge of h, one of the boundary, along it by a length, backwards if that is negative.  Returns the
// half-edge reached, the surface on its left.
uint32_t slide_along_rim(const Mesh& mesh, const double* position, uint32_t h, const Point& p, double length,
                         double* reached);

} // namespace hmf
