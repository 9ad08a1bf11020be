// The triangles of a surface near any point in space: a tree of boxes over the triangles in their order, which is
// a spatial one.
//
//     1                 node i has the children 2i and 2i + 1; each of the last ones has a few triangles
//     2       3
//     4   5   6   7
#pragma once

#include "quad_shape.hpp"

namespace hmf {

class SurfaceSearch {
public:
    // Triangles with the number NONE are no part of the surface.
    Done build(const Mesh& mesh, const double* position, Memory& memory);

    // Whether what lies at p and looks along n is seen from behind: the nearest triangle that looks that way is farther
    // from p than the nearest one of all.  Squared distances may differ by room^2: as much as where one foot lies
    // beside the other at a distance of `room`, so that both sides of a thin sheet count where p is near to it.
    bool is_behind(const Point& p, const Point& n, double room) const;

private:
    struct Box {
        double low[3], high[3];
    };
    double square_distance(size_t node, const Point& p) const;

    Mesh mesh_;
    const double* position_ = nullptr;
    Array<uint32_t> sides_; // one half-edge of each triangle
    Array<Box> boxes_;
    size_t leaves_ = 1;
};

} // namespace hmf
