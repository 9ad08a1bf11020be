// The library's loops on any hierarchy of a surface: always in the same isotopy
// classes, those that are found on the reference hierarchy, made of the same
// triangles with the default options.
//
//     triangles --default options--> reference hierarchy --library_loops--> its level 0
//                                                                               | same triangles
//     the caller's hierarchy:  level k  <------------ restriction --------- level 0
//
// Levels of the reference hierarchy that are coarser than its search level get them by
// restriction from that.
//
// The restriction is that of a foliation, which is exact: the loops with the
// weights 1, 2, 3, .. are a foliation on level 0, and the core of the cylinder of
// height c that it has on level k is the loop of weight c.
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"
#include "../../core/curves/loops.hpp"

namespace hmf {

// As library_loops, for a closed surface.
[[nodiscard]] hmf_status reference_loops(const hmf_hierarchy& hierarchy, size_t level, int32_t kind, Call& call,
                                         Loops& out);

} // namespace hmf
