// Leaves of an exact foliation, followed from edge to edge as normal curves are
// (compare multicurve.hpp, where every crossing is written down).
//
// A leaf crosses edge e at a place, counted from one end in half units: 0 and
// 2 F_e are the ends.  In a triangle it turns around the corner that it cuts off:
//
//              k               entering over the twin of k -> i .. at distance t
//             / \              from corner i:
//            /   \               t < 2 a_i:  out over the other side of i, at t
//           /  .--\              t > 2 a_i:  out over the side opposite to i,
//          / .'    \                         at the same distance from the
//         i--|------j                        corner that it turns round
//            t
//
// Vertices and branch points of tripods lie at even places.  So a leaf at an
// odd place meets none of them, ever: it closes exactly, no two cross, and
// nothing depends on rounding.  Half a unit is 2^-49 of the largest weight.
#pragma once

#include "../foliation/foliation.hpp"

namespace hmf {

// A leaf passes from the triangle left of half_edge to the one right of it.
// The target of half_edge is on the left of the leaf.
struct Crossing {
    uint32_t half_edge = NONE;
    int64_t at = 0; // half units from the origin of half_edge
};

inline bool operator==(const Crossing& a, const Crossing& b) { return a.half_edge == b.half_edge && a.at == b.at; }

// The edge in half units.
inline int64_t width(const Foliation& f, uint32_t h) { return 2 * f.at(h); }

// Where the branch point of the triangle left of h lies on h, half units from its origin.
inline int64_t branch(const Foliation& f, uint32_t h) { return f.corner2(h); }

// The same leaf, run through backwards.
inline Crossing reversed(const Foliation& f, const Crossing& c) {
    return {twin(c.half_edge), width(f, c.half_edge) - c.at};
}

// The next crossing of the leaf; for odd places.
inline Crossing follow(const Foliation& f, const Crossing& c) {
    const uint32_t k = twin(c.half_edge);
    const int64_t at = width(f, k) - c.at;
    if (at < branch(f, k)) {
        const uint32_t left = f.mesh.prev(k);
        return {left, width(f, left) - at};
    }
    return {f.mesh.next[k], c.at};
}

} // namespace hmf
