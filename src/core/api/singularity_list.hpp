// Zeros and poles in the numbers of the caller, with their places in space.
#pragma once

#include "../solve/state.hpp"
#include "result.hpp"

namespace hmf {

// Of values on the caller's side of a level; of a double what touches its front.
[[nodiscard]] hmf_status list_singularities(State& state, Call& call, hmf_singularity_set** out);

} // namespace hmf
