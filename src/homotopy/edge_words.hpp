// The class of every edge path: each edge has the walk in the system of quads
// (quad_system.hpp) that it is homotopic to, once a tree that joins all
// vertices is contracted.  Nearly all of them are empty.
//
// The product of the walks round a triangle is contractible.  So all goes
// exactly with flips and splits, from the coarsest level to the finest:
//
//          k                     k
//        / | \                 / | \        flip: lk is l i, then i k
//       i--+--j      ..       i  |  j       split: ij is empty, jk is ik, lj is li
//        \ | /                 \ | /
//          l                     l
//
// Walks are kept once, and edges have their numbers; a bit says that an edge
// has one, so that the others cost a look at a small table.
#pragma once

#include "quad_system.hpp"

namespace hmf {

class EdgeWords {
public:
    // On a mesh, with room for edge_capacity edges.
    Done start(const Mesh& mesh, uint32_t edge_capacity, Memory& memory);

    // After a flip, in either direction, and after a split, of the same mesh.
    Done flipped(const Mesh& mesh, uint32_t edge) {
        const uint32_t ahead = mesh.next[2 * edge], back = mesh.next[ahead];
        if (has(edge_of(ahead)) || has(edge_of(back))) return join(edge, ahead, back);
        clear(edge);
        return true;
    }
    void was_split(const Collapse& c) {
        clear(edge_of(c.h));
        copy(c.ki, twin(c.jk));
        copy(c.il, twin(c.lj));
    }

    // Appends the walk along a half-edge.
    Done append(uint32_t half_edge, Walk& walk) const;
    const QuadSystem& quads() const { return quads_; }

private:
    bool has(uint32_t edge) const { return bits_[edge / 64] >> edge % 64 & 1; }
    void clear(uint32_t edge) { bits_[edge / 64] &= ~(uint64_t{1} << edge % 64); }
    void set(uint32_t half_edge, uint32_t word, bool reversed); // of the half-edge
    // The same path: from and to are half-edges in the same direction.
    void copy(uint32_t from, uint32_t to) {
        if (!has(edge_of(from))) clear(edge_of(to));
        else set(to, word_[edge_of(from)] >> 1, (word_[edge_of(from)] ^ from) & 1);
    }
    Done join(uint32_t edge, uint32_t ahead, uint32_t back);
    Done number_of(const Walk& walk, uint32_t& word);

    QuadSystem quads_;
    Array<uint64_t> bits_;   // per edge: the walk is not empty
    Array<uint32_t> word_;   // per edge: 2 * its number, + 1 if it is that of half-edge 2e + 1
    Array<uint64_t> offset_; // of the walks
    Array<uint32_t> spoke_;
    Array<uint32_t> table_; // numbers of the walks by their contents, NONE where free
    Walk scratch_;
    Memory* memory_ = nullptr;
};

} // namespace hmf
