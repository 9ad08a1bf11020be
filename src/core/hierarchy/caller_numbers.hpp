// Between the caller's numbers of level 0 and the internal ones.  On other
// levels they are the same.
#pragma once

#include "hierarchy.hpp"

namespace hmf {

// Internal half-edge of side 0 of a triangle of the caller: the side of its
// first edge that is followed by its second one; and its face.
uint32_t internal_side(const hmf_hierarchy& h, size_t triangle);
uint32_t internal_face(const hmf_hierarchy& h, size_t triangle);

// Half-edge of side 0 of each triangle of the caller's mesh or of a coarser level.
Done side_of_triangles(const hmf_hierarchy& h, size_t level, Array<uint32_t>& side, Call& call);

// Refuses a level with a vertex that has more neighbors than can be solved for; before the work starts.
[[nodiscard]] hmf_status refuse_hubs(const hmf_hierarchy& h, size_t level, Call& call);

} // namespace hmf
