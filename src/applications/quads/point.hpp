// Points and vectors in space.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace hmf {

struct Point {
    double x = 0, y = 0, z = 0;
};
inline Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Point operator*(double s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Point cross(const Point& a, const Point& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double square_of(const Point& a) { return dot(a, a); }
inline double length_of(const Point& a) { return std::sqrt(dot(a, a)); }
inline Point of_length_one(const Point& a) { // 0 stays 0
    const double length = length_of(a);
    return length > 0 ? (1 / length) * a : Point{};
}
inline Point point(const double* positions, uint32_t v) {
    const double* const p = positions + size_t{3} * v;
    return {p[0], p[1], p[2]};
}

} // namespace hmf
