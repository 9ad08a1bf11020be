// The loops that the library makes (hmf.h, HMF_LOOPS_*).
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"
#include "find_loops.hpp"

namespace hmf {

// Loops of a kind on a closed surface: in isotopy classes that belong to the surface, those of the reference hierarchy.
//
//     triangles --default options--> reference hierarchy --library_loops--> its level 0
//                                                                               | same triangles
//     the caller's hierarchy:  level k  <------------ restriction --------- level 0
//
// Levels of the reference hierarchy that are coarser than its search level get them by restriction from that.
[[nodiscard]] hmf_status reference_loops(const hmf_hierarchy& hierarchy, size_t level, int32_t kind, Call& call,
                                         Loops& out);

// The same with the given hierarchy instead of the reference hierarchy: found on its search level (quick: on the
// coarsest level) and carried to `level`; on a coarser one they are found there, and may be others.
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
