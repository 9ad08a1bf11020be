// A quad mesh along leaves fitted to its surface.
#pragma once

#include "../leaves/mirror_symmetry.hpp"
#include "quad_mesh.hpp"

namespace hmf {

// Relaxed in so many steps, with vertices on tips and sharp edges, then each quad cut in four
// so many times.  inverted: quads that stay so, and may be fewer than were asked for then.
// front: of a double, only what lies in front; NULL: the surface is closed.
[[nodiscard]] hmf_status fit_quads(const Mesh& mesh, const double* position, const Reflection* front, int steps,
                                   int halvings, QuadMesh& quads, uint64_t& inverted, Call& call);

} // namespace hmf
