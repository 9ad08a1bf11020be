// The conjugate v along leaves and edges, and points of a line at given v.
#pragma once

#include "../common/cylinder_leaves.hpp"
#include "point.hpp"

namespace hmf {

// An area that is nothing but rounding measures nothing, as a triangle without area.
constexpr double FLATTEST = 1e-12; // twice the area in squared sides

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
        const Point o = at(f_.mesh.origin[r]), a = at(f_.mesh.target(r)) - o,
                    b = at(f_.mesh.origin[f_.mesh.prev(r)]) - o;
        const double area = twice_area(a, b);
        return area > 0 ? t * square_of((1 / G) * b - (1 / F) * a) * F * G / area : 0;
    }

    // Growth of v along a half-edge on which u grows: the mean of both triangles.
    double along(uint32_t h) const { return (in_face(h) + in_face(twin(h))) / 2; }

private:
    Point at(uint32_t v) const { return point(position_, v); }

    static double twice_area(const Point& a, const Point& b) {
        const double area = length_of(cross(a, b));
        return area > FLATTEST * (dot(a, a) + dot(b, b)) ? area : 0;
    }

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
        const Point o = at(f_.mesh.origin[h]), a = at(f_.mesh.target(h)) - o, b = at(f_.mesh.origin[p]) - o;
        const double area = twice_area(a, b);
        return area > 0 ? (F * dot(a, b) - u * dot(a, a)) / area : 0;
    }

    const Foliation& f_;
    const double* position_;
};

// A polyline with v along it, for points at given v.
struct Ruler {
    Array<double> v;
    Array<Point> points;
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
    Done push(double value, const Point& p, uint32_t side) {
        return v.push(value) && points.push(p) && sides.push(side);
    }
    double length() const { return v.back(); }
    // Also the side of the triangle it lies in.
    uint32_t point(double value, Point& p) const {
        size_t low = 0, high = v.size() > 1 ? v.size() - 1 : 1;
        while (high - low > 1) { // the last one that begins at the value or below, or the first; v does not fall
            const size_t middle = low + (high - low) / 2;
            if (v[middle] <= value) low = middle;
            else high = middle;
        }
        high = low + (v.size() > 1);
        const double length = v[high] - v[low];
        double t = length > 0 ? (value - v[low]) / length : 0;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        p = points[low] + t * (points[high] - points[low]);
        return sides[low];
    }
};

} // namespace hmf
