// The conjugate v along leaves and edges, and points of a line at given v.
#pragma once

#include "../common/cylinder_leaves.hpp"
#include "../parameterize/flat_cone_metric.hpp"
#include "point.hpp"

namespace hmf {

// v of the flat metric, in units of the foliation.
class Conjugate {
public:
    Conjugate(const Foliation& f, const FlatConeMetric& flat, double unit) : f_(f), flat_(flat), unit_(unit) {}

    // Growth of v along a leaf from crossing c to the next one.  In a triangle that is turned over in (u, v) it falls.
    double step(const Crossing& c) const {
        const uint32_t k = twin(c.half_edge);
        const Crossing next = follow(f_, c);
        const double from = (1 - fraction(c)) * dv(k), t = fraction(next);
        const double to =
            next.half_edge == f_.mesh.next[k] ? dv(k) + t * dv(next.half_edge) : (t - 1) * dv(next.half_edge);
        // The leaf comes over k from its right to its left, and leaves over `next` from left to right.
        return unit_ * (to - from) * sign(du(k) != 0 ? du(k) : -du(next.half_edge));
    }

private:
    static double sign(int64_t x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }
    int64_t du(uint32_t h) const { return flat_.du.at(flat_.bundle, h); }
    double dv(uint32_t h) const { return static_cast<double>(flat_.dv.at(flat_.bundle, h)); }
    double fraction(const Crossing& c) const {
        return static_cast<double>(c.at) / static_cast<double>(width(f_, c.half_edge));
    }

    const Foliation& f_;
    const FlatConeMetric& flat_;
    double unit_;
};

// A polyline with v along it, for points at given v.  v does not fall: where it would, in triangles that are turned
// over in (u, v) and beside a zero on its way to a vertex, it stays until the line has caught up.
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
        return v.push(v.empty() || value > v.back() ? value : v.back()) && points.push(p) && sides.push(side);
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
    // The ends of the line, also where v does not grow at once.
    uint32_t begin(Point& p) const {
        p = points[0];
        return sides[0];
    }
    uint32_t end(Point& p) const {
        p = points.back();
        return sides[sides.size() - 2];
    }
};

} // namespace hmf
