// How well quads cover their surface.
#pragma once

#include "quad_shape.hpp"

namespace hmf {

struct QuadFigures {
    uint64_t irregular = 0; // vertices with another number of quads than 4, on the boundary than 2
    uint64_t inverted = 0; // quads with a corner of at most 0 or at least 180 degrees, or seen from behind (quad_shape)
    double area = 0;       // sum of the areas of the quads
    double distance = 0;   // of a vertex of the surface from the quads, the greatest
};

// Triangles with the number NONE are no part of the surface.
[[nodiscard]] hmf_status quad_figures(const Mesh& mesh, const double* position, const QuadMesh& quads,
                                      QuadFigures& figures, Call& call);

// The number of inverted quads alone.
Done count_inverted(const SurfaceSearch& surface, const QuadMesh& quads, uint64_t& inverted, Call& call);

} // namespace hmf
