// The shape of single quads on a surface.
#pragma once

#include "quad_mesh.hpp"

namespace hmf {

class SurfaceSearch; // surface_search.hpp

// Normal of the triangle left of a half-edge, of length 1; 0 without area.
Point normal_at(const Mesh& mesh, const double* position, uint32_t h);

// Normals that vary continuously: between the vertices of a triangle, where they are means by angle.
class SurfaceNormals {
public:
    Done build(const Mesh& mesh, const double* position, Memory& memory);

    // Of length 1; at a point of the triangle left of a half-edge.
    Point at(uint32_t side, const Point& p) const;

private:
    Mesh mesh_;
    const double* position_ = nullptr;
    Array<Point> of_vertex_;
};

// The least sine of its corners, as seen along its normal (of the diagonals).  With `surface` it is at most 0 where the
// quad is seen from behind: the surface near its middle looks the other way.  Where a quad is as wide as a limb its
// middle lies off the surface, and more quads count than are folded over, but none fewer.
double worst_corner(const QuadMesh& quads, size_t q, const SurfaceSearch* surface = nullptr);

// The quads around each vertex.
class QuadStars {
public:
    Done build(const QuadMesh& quads, Memory& memory);
    const uint32_t* begin(uint32_t v) const { return quads_.data() + first_[v]; }
    const uint32_t* end(uint32_t v) const { return quads_.data() + first_[size_t{v} + 1]; }

    // next: per vertex of the boundary, the one to which a side of only one quad leads; else NONE.
    Done follow_boundary(const QuadMesh& quads, Array<uint32_t>& next, Memory& memory) const;

    // The least of the quads around v, from outside, if v were at p.
    double worst_corner(const SurfaceSearch& surface, QuadMesh& quads, uint32_t v, const Point& p) const;

private:
    bool is_outer(const QuadMesh& quads, uint32_t a, uint32_t b) const;

    Array<uint32_t> first_, quads_;
};

} // namespace hmf
