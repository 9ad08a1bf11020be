// Doubles of the caller as integers in a power-of-two unit: weights of loops, and the
// values of a foliation.
#pragma once

#include "../solve/solve.hpp"

namespace hmf {

// Unit for weights whose largest is `largest`: it is below 2^48 units, so values up to 32 weights are exact doubles.
double unit_of_weights(double largest);

// Values of the front of a double, and the same on its back.
[[nodiscard]] hmf_status mirror_values(const hmf_hierarchy& h, const double* values, Array<double>& both, Call& call);

// Values of the caller into a state on its level.  Finds the unit.  Validates:
// finite, exact, triangle inequalities, parity; counts the poles.
[[nodiscard]] hmf_status read_values(State& state, const double* values, size_t count, double& unit, uint64_t& poles,
                                     Call& call);

} // namespace hmf
