// Delaunay triangulation of a polygon without points inside, in expected time O(n) [Chew, Building Voronoi diagrams
// for convex polygons in linear expected time, 1990].
//
// Corners are removed in random order until three are left, and inserted again in the reverse order.  A corner q that
// returns between a and b adds the triangle a q b; then the edges opposite to q are flipped while that is needed:
//
//       a-----b             a-----b            A triangle of the wrong orientation is flipped away as well, so a
//      / \   /      ->     / \   /|            polygon may be slightly concave at its corners; the result tells
//     /   \q/             /   q   |            whether all triangles came out right.
//    ...               ...
#pragma once

#include "../base/memory.hpp"
#include "../base/two_doubles.hpp"

namespace hmf {

struct PlanePoint {
    TwoDoubles x, y;
};

inline PlanePoint operator-(const PlanePoint& a, const PlanePoint& b) { return {a.x - b.x, a.y - b.y}; }
inline TwoDoubles cross(const PlanePoint& a, const PlanePoint& b) { return a.x * b.y - a.y * b.x; }
inline TwoDoubles dot(const PlanePoint& a, const PlanePoint& b) { return a.x * b.x + a.y * b.y; }

class PolygonDelaunay {
public:
    static constexpr uint32_t OUTSIDE = 0xffffffffu;

    // Corners in counter-clockwise order.  false: out of memory.
    Done triangulate(Memory& memory, const PlanePoint* corner, uint32_t count);
    // Has every triangle a positive area?
    bool is_valid() const { return valid_; }

    // Sides: 3 * triangle + s goes from corner s of the triangle to the next.
    uint32_t side_from(uint32_t corner) const { return hull_[corner]; } // the side of the polygon that begins there
    uint32_t begin(uint32_t side) const { return corner_[side]; }
    uint32_t apex(uint32_t side) const { return corner_[after(after(side))]; }
    uint32_t across(uint32_t side) const { return across_[side]; } // OUTSIDE: a side of the polygon
    static uint32_t after(uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }

private:
    bool choose_first(const PlanePoint* corner, uint32_t count);
    void add_triangle(uint32_t a, uint32_t b, uint32_t c);
    void set_across(uint32_t side, uint32_t other);
    void insert(uint32_t q);
    bool should_flip(uint32_t side) const; // opposite to the corner that is inserted
    void flip(uint32_t side);

    const PlanePoint* point_ = nullptr;
    Array<uint32_t> corner_, across_;        // per side
    Array<uint32_t> hull_, next_, previous_; // per corner
    Array<uint32_t> order_, waiting_;
    uint32_t first_[3] = {};
    bool valid_ = false;
};

} // namespace hmf
