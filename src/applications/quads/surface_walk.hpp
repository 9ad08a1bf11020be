// The point of a surface nearest to a point in space, searched from a given triangle: across the side or around the
// corner on which the nearest point of the triangle lies, as long as the distance decreases. So a point never jumps to
// another part of the surface nearby.
#pragma once

#include "../../core/mesh/mesh.hpp"
#include "point.hpp"

namespace hmf {

struct NearestPoint {
    Point at;
    double square = HUGE_VAL; // of the distance
    int on = 0;               // 0 inside the triangle a, b, c, 1 to 3 on its side a-b, b-c, c-a, 4 to 6 at a, b, c
};
NearestPoint nearest_in_triangle(const Point& p, const Point& a, const Point& b, const Point& c);
// Of the triangle left of h, which is its side a-b.
NearestPoint nearest_in_face(const Mesh& mesh, const double* position, uint32_t h, const Point& p);

// side: a half-edge of the triangle to start from; nearest: the point found.
// Returns a half-edge of its triangle.  Triangles with the number NONE are no part of the surface.
uint32_t walk_to_nearest(const Mesh& mesh, const double* position, uint32_t side, const Point& p, Point& nearest);

} // namespace hmf
