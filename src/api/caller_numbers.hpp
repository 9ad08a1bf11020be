// Between the caller's numbers of level 0 and the internal ones.  On other
// levels they are the same.
#pragma once

#include "../leaves/mirror_symmetry.hpp"
#include "../solve/state.hpp"

namespace hmf {

// Internal half-edge of side 0 of a triangle of the caller: the side of its
// first edge that is followed by its second one; and its face.
uint32_t internal_side(const hmf_hierarchy& h, size_t triangle);
uint32_t internal_face(const hmf_hierarchy& h, size_t triangle);

// Half-edge of side 0 of each triangle of the caller's mesh or of a coarser level.
Done side_of_triangles(const hmf_hierarchy& h, size_t level, Array<uint32_t>& side, Call& call);

// Internal face of each triangle of the caller.
[[nodiscard]] hmf_status caller_faces(const hmf_hierarchy& h, Array<uint32_t>& face, Call& call);

// caller[internal[i]] = i
[[nodiscard]] hmf_status inverse_numbers(const uint32_t* internal, size_t count, Array<uint32_t>& caller, Call& call);

// The mirror image on the half-edges of a double.
[[nodiscard]] hmf_status read_reflection(const hmf_hierarchy& h, Reflection& reflection, Call& call);

// The state, on the caller's side of level 0 of a double, becomes exactly symmetric if it can.
[[nodiscard]] hmf_status make_symmetric(State& state, Call& call);

} // namespace hmf
