// Free homotopy of closed curves on a surface without its marked vertices, decided exactly and in linear time.
//
// The group of curves there is free, so each half-edge has a word: of the curve that comes from the middle of a
// polygon, crosses the half-edge from its left to its right, and goes back.  The polygon is the surface cut along
// a tree through all vertices and 2 * genus edges more (tree_cotree.hpp).  Its letters:
//
//            *           gaps: a walk around the tree, with it on the right, comes to marked
//          0 | 1         vertices; each side of an edge has the number of times that it
//      0     |    1      did before.  A curve that crosses an edge of the tree from gap a to
//     *------+------*    gap b leaves the polygon through one and enters it through the other,
//         2     2        a^-1 b.  Gap 0 is 1, so that branches without marked vertices give nothing
//
//     sides: the other edges that are cut, each a letter of its own.  Where the walk passes one
//     within a gap it goes through the polygon, and what follows has that letter behind its gap
//
// A marked vertex where the walk comes by twice counts as two beside each other, between which no curve goes.  In a
// free group two closed words are conjugate if they are the same once all pairs x x^-1 are gone, up to a rotation.
//
// The product of the words around a vertex is 1 if it is not marked.  So all goes exactly with flips and splits.
// A new triangle belongs to the polygon as a neighbor does:
//
//          k                     k
//        / | \                 / | \        flip: both triangles as the left one was, so that the word w of ij goes
//       i--+--j      ..       i  |  j       to the sides of the right one, w x, and kl is empty; or both as the right
//        \ | /                 \ | /        one, whichever gives fewer letters
//          l                     l          split: ijk as the triangle beyond jk, lji as the one beyond lj, so that
//                                           jk and lj are empty; ij is what a walk around j crosses besides
//
// The edges ij of all splits of a level join the new vertices to the old ones in a forest.  So on the mesh after them
// their words follow from the walks around the new vertices, leaves of the forest first.
#pragma once

#include "half_edge_words.hpp"

namespace hmf {

class CrossingWords {
public:
    // On a mesh with marked vertices, with room for edge_capacity edges.
    Done start(const Mesh& mesh, uint32_t edge_capacity, Call& call);

    // After a flip of the same mesh (mesh.hpp), or its reversal.
    Done flipped(const Mesh& mesh, uint32_t edge, bool reversed);
    // After these collapses were undone, all that the mesh has new vertices from.
    Done were_split(const Mesh& mesh, const Collapse* collapses, size_t count, Call& call);

    // Of a closed curve that crosses half_edge(i) for i in [begin, end), each from its left to its right: the same word
    // for all in its class, whatever their direction.  Empty: contractible.
    template <class HalfEdge>
    Done canonical(uint64_t begin, uint64_t end, HalfEdge half_edge, Walk& word) const {
        for (uint64_t i = begin; i < end; ++i)
            if (!append(half_edge(i), word)) return false;
        return canonical(word);
    }

private:
    Done append(uint32_t half_edge, Walk& word) const;
    Done product(uint32_t first, uint32_t second, Walk& word) const;
    Done canonical(Walk& word) const;
    Done close_round(const Mesh& mesh, uint32_t half_edge);

    HalfEdgeWords words_;
    Walk scratch_;
    Memory* memory_ = nullptr;
};

} // namespace hmf
