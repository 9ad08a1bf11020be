// A quad mesh along leaves fitted to its surface.
#pragma once

#include "../../core/leaves/mirror_symmetry.hpp"
#include "quad_mesh.hpp"

namespace hmf {

constexpr uint64_t MOST_RELAX_STEPS = 1000;

// Optimizes quads in at most `sweeps` sweeps at a time, with vertices on tips and sharp edges, then divides each quad
// into four `halvings` times. inverted: number of inverted quads in the result (quad_figures.hpp). front: the original
// sheet of a double, of which `mesh` and the quads are a part; NULL: the surface is closed.
[[nodiscard]] hmf_status fit_quads(const Mesh& mesh, const double* position, const Reflection* front, int sweeps,
                                   int halvings, QuadMesh& quads, uint64_t& inverted, Call& call);

} // namespace hmf
