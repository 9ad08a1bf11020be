// A quad mesh along leaves fitted to its surface.
#pragma once

#include "quad_shape.hpp"

namespace hmf {

constexpr uint64_t MOST_RELAX_STEPS = 1000;

// Places quads on the boundary and optimizes a copy of them, `fitted`, in at most `sweeps` sweeps at a time, with
// vertices on tips and sharp edges.  Triangles of the mesh with the number NONE are no part of the surface.
[[nodiscard]] hmf_status fit_quads(const Mesh& mesh, const double* position, int sweeps, QuadMesh& quads,
                                   QuadMesh& fitted, Call& call);

// Its steps:

// Vertices of the boundary come in their order along it, each at a place of its own.  Corners of it are taken, first by
// vertices of one quad, which are AT_CORNER from then on; the others lie between them in proportion to the length, and
// slide (AT_BOUNDARY).
//
//      ---b----.        --------b      b: a vertex of one quad goes to the corner, those beside it follow
//         |    |   ->      |    |
//         |    a           |----a
[[nodiscard]] hmf_status place_on_boundary(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call);

// Where a row or a column of quads runs along edges sharper than 40 degrees, within half a side of a quad, its vertices
// move onto them and are held there.  snapped: how many.
[[nodiscard]] hmf_status snap_to_sharp_edges(const Mesh& mesh, const double* position, const SurfaceSearch& surface,
                                             QuadMesh& quads, size_t& snapped, Call& call);

// Vertices go to places of the surface that stick out from the quads, and are held there.  moved: how many.
[[nodiscard]] hmf_status reach_tips(const Mesh& mesh, const double* position, const SurfaceSearch& surface,
                                    QuadMesh& quads, size_t& moved, Call& call);

} // namespace hmf
