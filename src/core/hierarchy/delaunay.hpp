// Delaunay flips of a coarse level, in space ([W] 4.1, after Dyer et al. 2007).
#pragma once

#include "simplify.hpp"

namespace hmf {

// In space no energy decreases in every flip, so the number is bounded.
constexpr uint64_t COARSE_FLIPS_PER_EDGE = 2;

// Flips edges whose opposite angles add up to more than 180 degrees, unless
// the other diagonal exists already.  Appends the edges to flips.  Expects a
// mesh that is compact (renumber.hpp).
[[nodiscard]] hmf_status delaunay_flips(WorkMesh& work, Array<uint32_t>& flips, Call& call, double fraction);

} // namespace hmf
