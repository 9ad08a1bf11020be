// Where the vertices of quads lie on the boundary of their surface.
#pragma once

#include "quad_mesh.hpp"

namespace hmf {

// In the order in which they come along the boundary, each at a place of its own; and corners of the boundary are taken
// by vertices, those of one quad first, which are AT_CORNER from then on.  The others lie between them in proportion to
// the length, and slide (AT_BOUNDARY).
//
//      ---b----.        --------b      b: a vertex of one quad goes to the corner, those beside it follow
//         |    |   ->      |    |
//         |    a           |----a
[[nodiscard]] hmf_status place_on_boundary(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call);

} // namespace hmf
