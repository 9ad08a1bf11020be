// The loops that the library makes (hmf.h, HMF_LOOPS_*).
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"
#include "find_loops.hpp"

namespace hmf {

// Where loops are searched for: the coarsest level with 1000 vertices and 420 for each handle, or with 10 000 from ten
// handles on; not level 0, whose triangles may have any shape, unless no other level has 1000.
size_t search_level(const hmf_hierarchy& hierarchy);

// Loops of a kind on a level.  They are found on search_level (if they need no
// care, on the coarsest level) and carried from level to level, shortened on
// each: loop c is in the same class on all of these.  On a level that is coarser
// they are found on that, and may be others (reference_loops.hpp brings them there).
[[nodiscard]] hmf_status library_loops(const hmf_hierarchy& hierarchy, size_t level, int32_t kind, Call& call,
                                       Loops& out, LoopCare care = LoopCare::shortest);

// Disjoint loops of a level, carried to a finer one the same way.
[[nodiscard]] hmf_status carry_to_finer(const hmf_hierarchy& hierarchy, size_t from, size_t level, Call& call,
                                        Loops& loops);

// The face before each crossing, in the form that read_loops accepts. If faces share several edges, the loops change
// within their classes.
[[nodiscard]] hmf_status name_by_triangles(const hmf_hierarchy& hierarchy, size_t level, Call& call, Loops& loops,
                                           Array<uint32_t>& faces);

} // namespace hmf
