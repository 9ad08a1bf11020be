// An exactly symmetric foliation of a double, in the class of one that is symmetric
// up to the residual only.
//
// The tree of a symmetric class has an isometry s that belongs to the mirror image.
// A foliation places the vertices in this tree.  If each vertex b of the boundary
// lies on the fixed set of s (of its lift), then the places of the front and their
// images under s are one symmetric foliation: equivariant, in the same tree, hence
// in the same class with the same weights.  On the edges of the front its values
// are those that are there, and on the back the same.
//
// So only vertices of the boundary have to move.  On a boundary curve, or on the part
// of one between two marked vertices, which never move:
//
//     leaves cross it    the fixed set is the path of the tree that the curve has when
//                        it is pulled tight.  Where it turns back, its cluster moves
//                        in that direction until it does not:
//
//                              v             --v--
//                             / \     ->                  as far as the first
//                          --'   '--       --     --      neighbor or branch point
//
//     none does          then it shrinks to one point.  If it has a cylinder around it,
//                        the point goes to the middle of that.
//
// All of it is moves of whole clusters along the tree, which keep the class and make
// no pole.  Each but the last of a curve joins a neighbor to the cluster or gives it
// a direction, so they end.
#pragma once

#include "../foliation/foliation.hpp"

namespace hmf {

// The mirror image of a double, on half-edges: origin to origin, target to target.
struct Reflection {
    Array<uint32_t> half_edge;  // of each; itself on the boundary
    Array<uint8_t> is_front;    // of each: the triangle left of it lies on the surface
    Array<uint8_t> is_boundary; // per vertex

    bool on_boundary(uint32_t h) const { return half_edge[h] == h; }
};

struct Symmetrized {
    bool exact = false;
    SingularityCount count; // of f as it is now, if exact
};

// exact: false, and f is unchanged, if a cluster that surrounds a part of the surface or contains a marked vertex would
// have to be divided, or if f is so far from symmetric that this takes longer than about a sweep over the mesh.
[[nodiscard]] hmf_status make_symmetric(Foliation& f, const Reflection& reflection, Call& call, Symmetrized& made);

} // namespace hmf
