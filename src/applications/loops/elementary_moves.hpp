// Elementary moves of a pants decomposition (Hatcher, Thurston: A presentation for
// the mapping class group of a closed orientable surface, 1980; Hatcher: Pants
// decompositions of surfaces, 1999): one curve is replaced by another one in the
// component that all other curves leave around it.
//
//      four-holed sphere             one-holed torus
//
//       A         B                   _________
//        \   c   /                   /   ___   \    c around the handle,
//         \  |  /                    |  / d \  |    d through it
//       d  --|--  d                  \ c\___/  |
//         /  |  \                     \__   __/
//        /       \                       | |
//       C         D
//
// Any two decompositions are joined by such moves.  Each curve becomes the shortest
// of its component, and each two that bound a pair of pants together the shortest
// two, until none changes: so an early tie in the choice of the curves does not determine the last ones.
#pragma once

#include "class_lengths.hpp"

namespace hmf {

// loops: a pants decomposition.
[[nodiscard]] hmf_status shorten_by_moves(const Mesh& mesh, const double* position, ClassLengths& lengths, Call& call,
                                          Loops& loops);

} // namespace hmf
