// Loops and arcs of a surface with boundary, as loops of its double:
//
//     closed loop c         ->  c and its mirror image, or, if these two bound an
//                               annulus (c goes around one boundary), c alone with
//                               twice the weight: leaves run along that boundary
//     arc a, boundary to    ->  a and back along its mirror image: leaves meet
//     boundary                  the boundary at right angles
//
// The result begins with the loops of the caller, in their order; their mirror images follow.
#pragma once

#include "../hierarchy/hierarchy.hpp"
#include "loops.hpp"

namespace hmf {

// given: in the caller's numbers of level 0.  is_round: per loop, does it bound an annulus with its mirror image?
// NULL: that is not known.  out: all but the weights.
[[nodiscard]] hmf_status double_loops(const hmf_hierarchy& hierarchy, const hmf_loop_set& given,
                                      const uint8_t* is_round, Call& call, WeightedLoops& out);

} // namespace hmf
