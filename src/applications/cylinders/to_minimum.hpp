// The minimum near a foliation that is harmonic already, for what is measured
// there.
#pragma once

#include "../../core/solve/solve.hpp"

namespace hmf {

// Nothing to do for what a solve left; values of the caller may have moved on
// the way to the intrinsic triangulation.  state: on that side of level 0.  unit:
// of its values, changes if they need a finer one.  Fails if the energy was
// more than 1 % above the minimum.
[[nodiscard]] hmf_status to_minimum(State& state, double& unit, Call& call);

} // namespace hmf
