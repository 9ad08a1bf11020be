// Relaxation of a quad mesh on its surface.
#pragma once

#include "quad_mesh.hpp"

namespace hmf {

constexpr uint64_t MOST_RELAX_STEPS = 1000;

// How long quads that stay inverted are tried: before the mesh is changed again, or for the last time.
enum class Untangle { some, all };

// Vertices move towards where each of their quads would have them as a square and where the quads cover more,
// and back to the nearest point of the surface.  Held ones stay.  Then quads that
// are inverted, or look inwards if that is asked for, are turned out where their
// vertices can be moved so.
[[nodiscard]] hmf_status relax_quads(const Mesh& mesh, const double* position, int steps, Untangle most, bool outwards,
                                     QuadMesh& quads, Call& call);

// Each quad becomes four.
[[nodiscard]] hmf_status refine_quads(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call);

} // namespace hmf
