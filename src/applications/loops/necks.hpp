// Necks of handles: for a loop around a handle, the loop around the handle as a
// whole, which separates it from the rest of the surface.
//
//            ______                   It runs along A, over a shortest way from one side
//           /  A   \                  of A to the other, back along A on that side, and
//          |  _||_  |                 back over the way:  A w A^-1 w^-1.
//           \_\  /_/
//          __/ way \__    <- neck
//
// A pants decomposition should contain the short ones, but a cut system may cross them: whether its next loop passes
// between the feet of a handle or beside them hardly affects its length.
#pragma once

#include "class_lengths.hpp"

namespace hmf {

// Necks of the loops of a cut system that are shorter than another of its loops: disjoint from each
// other and from the loops that are shorter.  Shortest first.  crossed: one meets a loop that is longer.
[[nodiscard]] hmf_status find_necks(const Mesh& mesh, const double* position, const Loops& cut, ClassLengths& lengths,
                                    Call& call, Loops& out, bool& crossed);

} // namespace hmf
