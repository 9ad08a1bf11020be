// Free homotopy of closed curves on a sphere without its marked vertices, decided
// exactly and in linear time.
//
// A tree of edges through all vertices cuts the sphere into a disk.  A walk round the
// tree, with it on the right, comes to marked vertices; each side of an edge has the
// number of times that it did before.
//
//            *           numbers of the sides: a curve that crosses an edge of the tree
//          0 | 1         from a side with number a to one with number b leaves the disk
//      0     |    1      in gap a and enters it in gap b.  As a word that is a^-1 b; the
//     *------+------*    gaps generate a free group, gap 0 is its 1.  Other edges, and
//         2     2        branches without marked vertices, have one number on both sides,
//                        and give nothing.
//
// A marked vertex where the walk comes by twice counts as two beside each other, between
// which no curve goes.  In a free group two closed words are conjugate if they are the
// same once all pairs x x^-1 are gone, up to a rotation.
#pragma once

#include "../base/memory.hpp"
#include "../mesh/mesh.hpp"

namespace hmf {

class SphereWords {
public:
    // Of a sphere with vertex 0 marked.
    Done start(const Mesh& mesh, Memory& memory);
    bool empty() const { return gap_.empty(); }

    // The word of the closed curve that crosses these half-edges, each from its left to its right: the same for all
    // curves in a class, whatever their direction.  word: started.  Empty: contractible.
    Done canonical(const uint32_t* crossings, size_t n, Array<uint32_t>& word) const;

private:
    Array<uint32_t> gap_; // per half-edge: of its side, the left one
};

} // namespace hmf
