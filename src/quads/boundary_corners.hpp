// Corners of the boundary of the surface that a side of the quads cuts off.
#pragma once

#include "quad_mesh.hpp"

namespace hmf {

// The nearer end of the side moves to the corner, where no quad is the worse for it:
//
//      -----c                 -----b
//        a   \                  a   |      what is at a corner stays
//     ---'-.  |        ->     ---'--|
//           '-b                     |
//
// Vertices of the quads AT_BOUNDARY lie on edges of it; those moved become AT_CORNER.  moved: how many.
[[nodiscard]] hmf_status take_boundary_corners(const Mesh& mesh, const double* position, QuadMesh& quads, size_t& moved,
                                               Call& call);

} // namespace hmf
