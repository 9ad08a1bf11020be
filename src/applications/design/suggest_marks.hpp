// Marked vertices for a sphere if the caller has chosen none.
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"

namespace hmf {

// Two vertices at the tip of each limb, at least four in all, one pair after
// the other; none on a surface of genus 1 or more.  `hierarchy` is freshly made
// and is used up.  marks: vertices of the caller.
[[nodiscard]] hmf_status suggest_marks(hmf_hierarchy& hierarchy, const double* positions, size_t vertex_count,
                                       size_t position_stride, const uint32_t* triangles, size_t triangle_count,
                                       const BuildOptions& options, Call& call, Array<uint32_t>& marks);

// On a surface of any kind: the sharp corners of the boundary, pairs at the tips of limbs, or those off the boundary.
enum class MarksAt { corners, limbs, limbs_inside };
[[nodiscard]] hmf_status marks_at(MarksAt where, hmf_hierarchy& hierarchy, const double* positions, size_t vertex_count,
                                  size_t position_stride, const uint32_t* triangles, size_t triangle_count,
                                  const BuildOptions& options, Call& call, Array<uint32_t>& marks);

// The tips of the limbs of a mesh, at least two, longest limbs first.  ends: two
// vertices for each, far enough from the tip for a limb that tapers, or NONE.
Done limb_tips(const Mesh& mesh, const double* position, Call& call, Array<uint32_t>& tips, Array<uint32_t>& ends);

} // namespace hmf
