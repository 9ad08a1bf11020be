// Coordinates for a checkerboard without seams.
#pragma once

#include <hmf/applications.h>

#include <cstdint>
#include <vector>

namespace cli {

// (u, v) of each corner, changed as little as needed: smoothly, and so that across each seam they differ by a sign and
// multiples of the period.  Then a pattern that is even and has the period has no seams.  Empty where the multiples
// cannot be chosen.  triangles, triangle_edges: of the level that was parameterized.
std::vector<double> closed_pattern(const std::vector<uint32_t>& triangles, const std::vector<uint32_t>& triangle_edges,
                                   const hmf_parameterization& p, double period);

} // namespace cli
