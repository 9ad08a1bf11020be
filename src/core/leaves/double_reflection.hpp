// The mirror image of a double as its hierarchy knows it, and a foliation made symmetric.
#pragma once

#include "../hierarchy/hierarchy.hpp"
#include "mirror_symmetry.hpp"

namespace hmf {

// On the half-edges of level 0.
[[nodiscard]] hmf_status read_reflection(const hmf_hierarchy& h, Reflection& reflection, Call& call);

// On the input triangulation of level 0 of a double the foliation becomes exactly symmetric if it can.
[[nodiscard]] hmf_status make_symmetric(const hmf_hierarchy& h, size_t level, Foliation& f, Call& call,
                                        Symmetrized& made);

} // namespace hmf
