// Vertices of quads at the places that stick out from them.
#pragma once

#include "../../core/leaves/mirror_symmetry.hpp"
#include "quad_shape.hpp"

namespace hmf {

// moved: how many; they are held from then on.  front: of a double, only what lies in front.
[[nodiscard]] hmf_status reach_tips(const Mesh& mesh, const double* position, const SurfaceSearch& surface,
                                    const Reflection* front, QuadMesh& quads, size_t& moved, Call& call);

} // namespace hmf
