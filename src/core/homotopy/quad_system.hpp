// Free homotopy of closed curves, decided exactly and in linear time (Lazarus
// and Rivaud, Erickson and Whittlesey: the system of quads).
//
// Cut along a tree of edges through all vertices and 2g more edges the surface
// is a polygon.  With the tree contracted it has 4g sides and 4g corners; all
// corners are one point a.  A spoke joins each corner to the middle b of the
// polygon.  The spokes cut the surface into 2g quads, one for each pair of
// sides, and 4g of them meet at a and at b.
//
//        a---side---a          an edge of the mesh inside the polygon runs from
//        |\        /|          a corner p to a corner q and may be pulled over
//        | \spoke / |          the middle: it is the walk p q of two spokes,
//        |  \    /  |          out of a along p, and back to a along q
//        |   \  /   |
//        |    b     |          spokes are numbered as the corners, 0 .. 4g - 1,
//                              counter-clockwise round b
//
// A walk is a sequence of spokes, alternately to b and to a.  At each vertex
// it turns: the number of quads on its right, modulo 4g.
//
//     turn 0         a spur: both spokes go
//     1 2 .. 2 1     a bracket: it goes around three sides of a row of quads on
//                    its right, and gets shorter by two on the fourth; -1 -2 .. -2 -1
//                    is the same on the left.  A closed walk that turns by 1 once and by 2
//                    everywhere else gets shorter in the same way, past all of the row
//
// For g >= 2 a closed walk without spurs and brackets is a shortest one in its
// class, and all of these become one when each -1, with the -2 on both its
// sides, is pushed over the quads on its left (and the walk that turns by -2
// everywhere likewise).  On the torus the class is the homology.
#pragma once

#include "half_edge_words.hpp"

namespace hmf {

class QuadSystem {
public:
    // twin_side: per side of the polygon the one that is glued to it.  False: out of memory.
    bool start(const Array<uint32_t>& twin_side, Memory& memory);
    uint32_t size() const { return static_cast<uint32_t>(at_a_.size()); } // 4g

    // Appends a spoke to a walk that starts at a, and takes out the spur or
    // the brackets that this makes.  False: out of memory.
    bool append(Walk& walk, uint32_t spoke) const { return push(walk, false, spoke); }

    // The same for all walks in a class, whatever their direction.  walk: closed, from a to a,
    // changed.  Empty: contractible.  Torus: the two numbers of the homology.  False: out of memory.
    bool canonical(Walk& walk, Memory& memory) const;

private:
    uint32_t turned(bool at_b, uint32_t spoke, uint32_t quads) const; // counter-clockwise
    uint32_t turn(bool at_b, uint32_t in, uint32_t out) const;        // quads on the right
    bool push(Walk& walk, bool from_b, uint32_t spoke) const;
    bool place(Walk& walk, bool from_b, uint32_t spoke, Walk& waiting) const; // one spoke; a bracket's row: to waiting
    bool canonical_directed(Walk& walk, Memory& memory) const;
    bool shorten_round(Walk& walk, bool& from_b, Memory& memory) const;
    bool homology(Walk& walk) const;
    static bool rotate(Walk& walk, bool& from_b, size_t first, Memory& memory);

    Array<uint32_t> at_a_;    // place of each spoke around a, counter-clockwise
    Array<uint32_t> spoke_;   // and back
    Array<int32_t> homology_; // torus: two numbers per corner, of the way to it from corner 0
};

} // namespace hmf
