// Corners of quads on a surface, made more like right angles.
#pragma once

#include "quad_mesh.hpp"

namespace hmf {

// Vertices round quads with a corner far from 90 degrees move on the surface, along their sharp edge or boundary if
// they lie on one, where that makes the corners and sides round them better or the quads cover more.  While more than
// a twentieth of all corners is farther off than SQUARE_ENOUGH, vertices of the worst quads leave their sharp edges
// and may move away from their tips.  No quad gets inverted.
// Where no more than a twentieth is farther off than `leave`, in cosines, nothing is done.
[[nodiscard]] hmf_status square_corners(const Mesh& mesh, const double* position, int sweeps, double leave,
                                        QuadMesh& quads, Call& call);

} // namespace hmf
