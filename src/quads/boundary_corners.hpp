// Corners of the boundary of the surface that a side of the quads cuts off.
#pragma once

#include "quad_mesh.hpp"

namespace hmf {

// The nearer end of the side moves to the corner, where no quad is the worse for it:
//
//      -----c                 -----b
//        a   \                  a   |      marked vertices of the boundary stay
//     ---'-.  |        ->     ---'--|
//           '-b                     |
//
// mesh: of a double, front: its reflection; sides of the quads lie in front.  moved: how many.
[[nodiscard]] hmf_status take_boundary_corners(const Mesh& mesh, const double* position, const Reflection& front,
                                               QuadMesh& quads, size_t& moved, Call& call);

} // namespace hmf
