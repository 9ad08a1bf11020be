// Loops of the library as a property of the surface: the same classes for every
// hierarchy of the same triangles.
//
// They are found on one hierarchy, that of the default options.  A caller who has
// another one gets them from there:
//
//     triangles --default options--> hierarchy --library_loops--> level 0
//                                                                    | same triangles
//     the caller's hierarchy:  level k  <----- restriction ------ level 0
//
// The restriction is that of a foliation, which is exact: the loops with the
// weights 1, 2, 3, .. are a foliation on level 0, and the cylinder of height c
// that it has on level k goes round the loop of weight c.
#pragma once

#include "../hierarchy/hierarchy.hpp"
#include "../loops/loops.hpp"

namespace hmf {

// As library_loops, for a closed surface.
[[nodiscard]] hmf_status canonical_loops(const hmf_hierarchy& hierarchy, size_t level, int32_t kind, Call& call,
                                         Loops& out);

} // namespace hmf
