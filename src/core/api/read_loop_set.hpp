// The caller's loops, checked, as crossings with integer weights.
#pragma once

#include "../curves/loops.hpp"
#include "foliation_object.hpp"

namespace hmf {

// Pulled tight.  is_round: as in double_loops.
[[nodiscard]] hmf_status read_loop_set(const hmf_hierarchy& hierarchy, const hmf_loop_set* set, const uint8_t* is_round,
                                       WeightedLoops& out, Call& call);

// Weights of 1 for loops on a closed surface.
[[nodiscard]] hmf_status set_unit_weights(WeightedLoops& loops, Call& call);

} // namespace hmf
