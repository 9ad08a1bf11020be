// Finer quads.
#pragma once

#include "quad_mesh.hpp"

namespace hmf {

// Each quad becomes four, on the surface.
[[nodiscard]] hmf_status refine_quads(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call);

} // namespace hmf
