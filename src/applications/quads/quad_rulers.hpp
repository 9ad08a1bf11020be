// The conjugate v along leaves and edges, and points of a line at given v.
#pragma once

#include "../../core/leaves/leaf.hpp"

#include <cmath>

namespace hmf {

namespace quad_rulers {

struct Vector {
    double x, y, z;
};
inline Vector between(const double* a, const double* b) { return {b[0] - a[0], b[1] - a[1], b[2] - a[2]}; }
inline double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double cross_length(const Vector& a, const Vector& b) {
    const double x = a.y * b.z - a.z * b.y, y = a.z * b.x - a.x * b.z, z = a.x * b.y - a.y * b.x;
    return std::sqrt(x * x + y * y + z * z);
}

// An area that is nothing but rounding measures nothing, as a triangle without area.
constexpr double FLATTEST = 1e-12; // twice the area in squared sides
inline bool is_flat(const Vector& a, const Vector& b, double twice_area) {
    return !(twice_area > FLATTEST * (dot(a, a) + dot(b, b)));
}

} // namespace quad_rulers

class Conjugate {
public:
    Conjugate(const Foliation& f, const double* position) : f_(f), position_(position) {}

    // Growth of v along a leaf from crossing c to the next one.  With t the
    // distance from the corner i that it turns round:
    //   |grad u| * length = t |F_ij ik - F_ik ij|^2 / (F_ij F_ik |ij x ik|)
    double step(const Crossing& c) const {
        const uint32_t k = twin(c.half_edge);
        const bool left = turns_left(f_, c);
        const uint32_t r = left ? k : f_.mesh.next[k];
        const double t = 0.5 * static_cast<double>(left ? width(f_, k) - c.at : c.at);
        const double F = static_cast<double>(f_.at(r)), G = static_cast<double>(f_.at(f_.mesh.prev(r)));
        using namespace quad_rulers;
        const Vector a = between(at(f_.mesh.origin[r]), at(f_.mesh.target(r)));
        const Vector b = between(at(f_.mesh.origin[r]), at(f_.mesh.origin[f_.mesh.prev(r)]));
        const double area = cross_length(a, b);
        const Vector d = {b.x / G - a.x / F, b.y / G - a.y / F, b.z / G - a.z / F};
        return is_flat(a, b, area) ? 0 : t * dot(d, d) * F * G / area;
    }

    // Growth of v along a half-edge on which u grows: the mean of both triangles.
    double along(uint32_t h) const { return (in_face(h) + in_face(twin(h))) / 2; }

private:
    const double* at(uint32_t v) const { return position_ + size_t{3} * v; }

    // In the triangle left of h, where u is 0 at the origin, F at the target.
    double in_face(uint32_t h) const {
        const uint32_t p = f_.mesh.prev(h);
        const double F = static_cast<double>(f_.at(h));
        const bool behind = branch(f_, h) == 0;
        const bool tripod = !behind && branch(f_, f_.mesh.next[h]) > 0 && branch(f_, p) > 0;
        // Of a third corner off the segment, the branch point.
        const double u = behind ? -static_cast<double>(f_.at(p))
                       : tripod ? 0.5 * static_cast<double>(branch(f_, h))
                                : static_cast<double>(f_.at(p));
        using namespace quad_rulers;
        const Vector a = between(at(f_.mesh.origin[h]), at(f_.mesh.target(h)));
        const Vector b = between(at(f_.mesh.origin[h]), at(f_.mesh.origin[p]));
        const double area = cross_length(a, b);
        return is_flat(a, b, area) ? 0 : (F * dot(a, b) - u * dot(a, a)) / area;
    }

    const Foliation& f_;
    const double* position_;
};

// A polyline with v along it, for points at given v.
struct Ruler {
    Array<double> v, points;
    Array<uint32_t> sides; // left of which the line goes on
    void start(Memory& memory) {
        v.start(memory);
        points.start(memory);
        sides.start(memory);
    }
    void clear() {
        v.clear();
        points.clear();
        sides.clear();
    }
    Done push(double value, const double* p, uint32_t side) {
        return v.push(value) && points.push(p[0]) && points.push(p[1]) && points.push(p[2]) && sides.push(side);
    }
    Done reserve(size_t n) { return v.reserve(n) && points.reserve(3 * n) && sides.reserve(n); }
    // Where room for it has been reserved.
    void add(double value, const double* p, uint32_t side) {
        v.add(value);
        for (size_t k = 0; k < 3; ++k) points.add(p[k]);
        sides.add(side);
    }
    // Also the side of the triangle it lies in.
    uint32_t point(double value, double* p) const {
        size_t piece = 0;
        return point(value, p, piece);
    }
    // The same; piece: in which it may lie, the one before on a walk along the line.
    uint32_t point(double value, double* p, size_t& piece) const {
        piece = find(value, piece);
        const size_t low = piece, high = low + (v.size() > 1);
        const double length = v[high] - v[low];
        double t = length > 0 ? (value - v[low]) / length : 0;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        for (size_t k = 0; k < 3; ++k) p[k] = points[3 * low + k] + t * (points[3 * high + k] - points[3 * low + k]);
        return sides[low];
    }

private:
    // The last one that begins at a value or below, or the first.  v does not fall.
    size_t find(double value, size_t near) const {
        constexpr int most_steps = 8;
        const size_t last = v.size() > 1 ? v.size() - 2 : 0;
        for (int steps = 0; steps < most_steps; ++steps) {
            if (near > 0 && !(v[near] <= value)) --near;
            else if (near < last && v[near + 1] <= value) ++near;
            else return near;
        }
        size_t low = 0, high = last + 1;
        while (high - low > 1) {
            const size_t middle = low + (high - low) / 2;
            if (v[middle] <= value) low = middle;
            else high = middle;
        }
        return low;
    }
};

} // namespace hmf
