// From a fine unit to one that is 2^bits as large, exactly: the class stays, no
// triangle inequality breaks, no pole comes.
//
//      0        16        32       the tree near two zeros, in fine units: the
//      *----.--.-+----.---*        distances of the zeros are multiples of
//           5  8     27            2^bits = 16, for heights are weights
//
//      *---------+--------*        each vertex goes to the nearest multiple of
//      5 -> 0, 8 and 27 -> 16, 32  16 on its own edge of the tree
//
// Rounding values edge by edge would break triangle inequalities.  This moves
// points of the tree: a value is the distance of the new places, hence a multiple
// of 2^bits, and a regular vertex that keeps its order among its neighbors
// becomes no extremum.
//
// Where on its edge a vertex lies, modulo 2^bits, is found by walking over the
// mesh from a zero (a vertex, or the branch point of a triangle), which lies at
// 0: along half-edge h from i to j the position changes by the value, and its
// sense is the sign of the direction in which h leaves i and its twin leaves j.
#pragma once

#include "../foliation/foliation.hpp"

namespace hmf {

// The values of f, without poles, in the coarser unit.  exact: false if zeros are
// no multiples of 2^bits apart; then nothing was changed.
Done to_coarser_unit(Foliation& f, uint32_t bits, Memory& memory, bool& exact);

} // namespace hmf
