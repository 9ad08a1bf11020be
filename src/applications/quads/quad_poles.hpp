// Quads at a pole.  A marked vertex with one prong has two quads, which share
// the two edges there and are poor; one quad takes their place:
//
//     x---b---y        x---b---y
//     |   |   |        |       |       over the tip, with a and b, which lie on
//     |   P   |   ->   |       |       both sides of it, as corners; these have
//     |  / \  |         \     /        three edges then
//     a     a              a           (both sides of the arc are one)
//
// a moves to where the pole was, so that the tip stays.  Where an arc joins two
// poles by two columns, its middle is left out as well: a cap of one quad with
// four vertices of three edges.
#pragma once

#include "quad_mesh.hpp"

namespace hmf {

// left: vertices with two quads that stay, because one beside them would have two.
Done quads_over_poles(QuadMesh& mesh, size_t& left, Call& call);

} // namespace hmf
