// A quad mesh along leaves fitted to its surface.
#pragma once

#include "../../core/leaves/mirror_symmetry.hpp"
#include "quad_mesh.hpp"

namespace hmf {

constexpr uint64_t MOST_RELAX_STEPS = 1000;

// Optimized in at most so many sweeps at a time, with vertices on tips and sharp edges, then each quad cut in four so
// many times.  inverted: quads that are so in the end (quad_figures.hpp).
// front: of a double, only what lies in front, in `mesh` as well; NULL: the surface is closed.
[[nodiscard]] hmf_status fit_quads(const Mesh& mesh, const double* position, const Reflection* front, int sweeps,
                                   int halvings, QuadMesh& quads, uint64_t& inverted, Call& call);

} // namespace hmf
