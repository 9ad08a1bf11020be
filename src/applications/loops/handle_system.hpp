// Handle and tunnel loops of a surface in space.
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"
#include "../../core/curves/loops.hpp"

namespace hmf {

// On level `found`: a cut system of loops that bound inside the surface
// (null-homologous there), or outside of it.
[[nodiscard]] hmf_status handle_system(const hmf_hierarchy& hierarchy, size_t found, bool inside, Call& call,
                                       Loops& out);

} // namespace hmf
