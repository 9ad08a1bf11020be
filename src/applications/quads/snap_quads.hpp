// Vertices of quads on sharp edges of the surface.
#pragma once

#include "quad_shape.hpp"

namespace hmf {

// Where a row or a column of quads runs along edges sharper than 40 degrees, within
// half a side of a quad, its vertices move onto them and are held there.
// front: of a double, only the edges inside the surface count.  snapped: how many.
[[nodiscard]] hmf_status snap_to_sharp_edges(const Mesh& mesh, const double* position, const SurfaceSearch& surface,
                                             const Reflection* front, QuadMesh& quads, size_t& snapped, Call& call);

} // namespace hmf
