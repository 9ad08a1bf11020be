// Cotangent weights ([W] Eq. 5): half the sum of the cotangents of the two
// angles opposite to an edge.
#pragma once

#include "mesh.hpp"

namespace hmf {

// Cotangent of the angle at apex between the points a and b; 3 coordinates
// each.  Finite, also for triangles without area and for extreme units.
double cotangent(const double* apex, const double* a, const double* b);

// Bounds of the weights that the solver sees.
constexpr double COARSE_WEIGHT_FLOOR = 1e-3, COARSE_WEIGHT_CAP = 1e3;
constexpr double INTRINSIC_WEIGHT_FLOOR = 1e-9, INTRINSIC_WEIGHT_CAP = 1e6;

// Weights of the edges from begin to end - 1 of a coarse level, raised to the
// floor and cut at the cap.  Returns the number of negative ones before that.
uint64_t coarse_weights(const Mesh& mesh, const double* position, uint32_t begin, uint32_t end, double* weight);

} // namespace hmf
