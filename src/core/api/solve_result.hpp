// The end of a solve: report, unit of the values, exact symmetry of a double, and the sentence.
#pragma once

#include "../solve/class_guard.hpp"
#include "foliation_object.hpp"

namespace hmf {

// From a state that a cascade has left to the foliation of the caller.  status: why it ended.
// unit_of_heights: a unit that all heights are multiples of.
[[nodiscard]] hmf_status finish_solve(State& state, hmf_status status, const SolveOptions& options,
                                      double unit_of_heights, SolveLog& log, Call& call, const ClassGuard& guard,
                                      hmf_foliation** out);

} // namespace hmf
