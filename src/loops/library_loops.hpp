// The loops that the library makes (hmf.h, HMF_LOOPS_*).
#pragma once

#include "../hierarchy/hierarchy.hpp"
#include "loops.hpp"

namespace hmf {

// The mesh on which loops of a level are given: level 0 is the caller's.
inline const Mesh& loop_mesh(const hmf_hierarchy& h, size_t level) {
    return level == 0 ? h.input : h.levels[level].mesh;
}

// Loops of a kind on a level.  They are found on the coarsest level and
// carried from level to level, shortened on each: loop c is in the same class
// on every level.
[[nodiscard]] hmf_status library_loops(const hmf_hierarchy& hierarchy, size_t level, int32_t kind, Call& call,
                                       Loops& out, LoopCare care = LoopCare::shortest);

// Disjoint loops on the coarsest level, the same way.
[[nodiscard]] hmf_status carry_from_coarsest(const hmf_hierarchy& hierarchy, size_t level, Call& call, Loops& loops);

// The face before each crossing, such that read_loops gives the loops back.
// Where faces share several edges, the loops change within their classes.
[[nodiscard]] hmf_status name_by_triangles(const hmf_hierarchy& hierarchy, size_t level, Call& call, Loops& loops,
                                           Array<uint32_t>& faces);

} // namespace hmf
