// What an atlas does to the surface: how unevenly it stretches, and where it is cut.
#pragma once

#include "atlas.hpp"

namespace hmf {

struct AtlasMeasures {
    double unevenness = 0; // standard deviation of the log scale, by area; triangles without area are left out
    uint64_t seam_edges = 0;
    double seam_length = 0; // in space
};

// sides: a half-edge of each triangle, in the order in which they are summed.
[[nodiscard]] hmf_status measure_atlas(const Atlas& atlas, const Mesh& mesh, const double* position,
                                       const Array<uint32_t>& sides, AtlasMeasures& out, Call& call);

} // namespace hmf
