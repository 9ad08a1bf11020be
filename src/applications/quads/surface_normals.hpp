// Normals of a surface that vary continuously: between the vertices of a triangle, where they are means by angle.
#pragma once

#include "quad_shape.hpp"

namespace hmf {

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

} // namespace hmf
