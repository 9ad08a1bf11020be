// The mirror image of a double as its hierarchy knows it, and a state made symmetric.
#pragma once

#include "state.hpp"
#include "../leaves/mirror_symmetry.hpp"

namespace hmf {

// On the half-edges of level 0.
[[nodiscard]] hmf_status read_reflection(const hmf_hierarchy& h, Reflection& reflection, Call& call);

// The state, on the caller's side of level 0 of a double, becomes exactly symmetric if it can.
[[nodiscard]] hmf_status make_symmetric(State& state, Call& call, Symmetrized& made);

} // namespace hmf
