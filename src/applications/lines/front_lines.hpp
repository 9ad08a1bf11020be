// Leaves on a surface with boundary: those of its double, cut where they cross the boundary.
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"
#include "polyline.hpp"

namespace hmf {

// Leaves in `lines` what lies in front.  Edges of the points are by the caller's
// numbers.  A piece ends with HMF_END_BOUNDARY where it was cut; zeros and
// cylinders, which have other numbers on the double, are left out.
[[nodiscard]] hmf_status keep_front(const hmf_hierarchy& hierarchy, Lines& lines, Call& call);

} // namespace hmf
