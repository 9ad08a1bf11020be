// How far the affine map of one triangle is from conformal.
#pragma once

namespace hmf {

// Beyond this a triangle counts as degenerate: its image has no area to speak of.
constexpr double LARGEST_DILATATION = 1000;

// Of the map (x, y) -> (u, v), in a frame of the triangle: x along its first
// side, y to the left of it.
struct AffineMap {
    double area = 0;                 // of the triangle in space
    double dilatation = 1;           // ratio of the singular values, >= 1; infinite if degenerate
    double determinant = 0;          // of the derivative; negative: flipped
    double differential[2] = {0, 0}; // (d(u + i v) / dz)^2, z = x + i y
};

// p: corners in space; u, v: their images.
AffineMap affine_map(const double* p0, const double* p1, const double* p2, const double u[3], const double v[3]);

} // namespace hmf
