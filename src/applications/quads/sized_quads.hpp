// Quads of a requested size or number, fitted to the surface: quad_mesh, then fit_quads.
#pragma once

#include "../../core/leaves/mirror_symmetry.hpp"
#include "quad_figures.hpp"

namespace hmf {

struct SizedQuads {
    double edge_length = 0; // 0: by count
    uint64_t count = 0;     // 0: by edge_length; both 0: half as many as triangles
    int relax = 0;          // steps
    bool merge = false, keep_poles = false;
    double share = 1;                       // of the mesh, that the caller sees: 1/2 of a double
    const FrontParts* front = nullptr;      // of a double
    const Reflection* reflection = nullptr; // likewise
    const Conjugate* conjugate = nullptr;
};

// area: of what the caller sees.  figures: of the quads made.
[[nodiscard]] hmf_status make_sized_quads(Foliation& f, const double* position, const Cylinders& cylinders,
                                          const SizedQuads& wish, QuadMesh& out, double& area, QuadFigures& figures,
                                          Call& call);

} // namespace hmf
