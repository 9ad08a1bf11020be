// Which triangles of a surface lie near any point in space.
#pragma once

#include "box_tree.hpp"
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
    Mesh mesh_;
    const double* position_ = nullptr;
    Array<uint32_t> sides_; // one half-edge of each triangle
    BoxTree tree_;
};

} // namespace hmf
