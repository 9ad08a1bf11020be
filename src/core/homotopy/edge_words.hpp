// The class of every edge path: each edge has the walk in the system of quads
// (quad_system.hpp) that it is homotopic to, once a tree that joins all
// vertices is contracted.  Nearly all of them are empty.
//
// The product of the walks around a triangle is contractible.  So all goes
// exactly with flips and splits, from the coarsest level to the finest:
//
//          k                     k
//        / | \                 / | \        flip: lk is l i, then i k
//       i--+--j      ..       i  |  j       split: ij is empty, jk is ik, lj is li
//        \ | /                 \ | /
//          l                     l
#pragma once

#include "half_edge_words.hpp"
#include "quad_system.hpp"

namespace hmf {

class EdgeWords {
public:
    // On a mesh without marked vertices, of genus 1 or more, with room for edge_capacity edges.
    Done start(const Mesh& mesh, uint32_t edge_capacity, Call& call);

    // After a flip of the same mesh, in either direction.
    Done flipped(const Mesh& mesh, uint32_t edge) {
        const uint32_t ahead = mesh.next[2 * edge], back = mesh.next[ahead];
        if (walks_.has(edge_of(ahead)) || walks_.has(edge_of(back))) return join(edge, ahead, back);
        walks_.clear(edge);
        return true;
    }
    // After these collapses were undone, the last one first.
    Done were_split(const Collapse* collapses, size_t count, Call& call);

    // The canonical walk of a closed curve that crosses half_edge(i) for i in [begin, end), each from its left to its
    // right, and none there and back again: the same for all in its class.  It is that of the edge path on the left
    // of the curve.
    template <class HalfEdge>
    Done canonical(const Mesh& mesh, uint64_t begin, uint64_t end, HalfEdge half_edge, Walk& walk) const {
        for (uint64_t i = begin; i < end; ++i) {
            const uint32_t h = half_edge(i), after = half_edge(i + 1 < end ? i + 1 : begin);
            const uint32_t ahead = mesh.next[twin(h)]; // crossed where the curve turns right
            if (after == ahead && !append(twin(mesh.next[ahead]), walk)) return false;
        }
        return quads_.canonical(walk, *memory_);
    }

private:
    Done append(uint32_t half_edge, Walk& walk) const; // the walk along a half-edge
    Done join(uint32_t edge, uint32_t ahead, uint32_t back);

    QuadSystem quads_;
    HalfEdgeWords walks_;
    Walk scratch_;
    Memory* memory_ = nullptr;
};

} // namespace hmf
