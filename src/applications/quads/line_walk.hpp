// The point of a line of edges nearest to a point in space, searched from one edge on.
#pragma once

#include "../../core/mesh/mesh.hpp"
#include "quad_shape.hpp"

#include <cmath>

namespace hmf {

// The point of an edge nearest to p, at 0 <= t <= 1 of it; returns the squared distance.
inline double nearest_on_edge(const Mesh& mesh, const double* position, uint32_t h, const double* p, double* nearest,
                              double& t) {
    const double* const a = position + size_t{3} * mesh.origin[h];
    const double* const b = position + size_t{3} * mesh.target(h);
    double along = 0, length = 0, distance = 0;
    for (int k = 0; k < 3; ++k) {
        along += (p[k] - a[k]) * (b[k] - a[k]);
        length += (b[k] - a[k]) * (b[k] - a[k]);
    }
    t = length > 0 ? along / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int k = 0; k < 3; ++k) {
        nearest[k] = a[k] + t * (b[k] - a[k]);
        distance += (p[k] - nearest[k]) * (p[k] - nearest[k]);
    }
    return distance;
}

// On to the next edge as long as that is nearer.  next(h): the half-edge by which the line goes on where h
// ends, NONE if it does not.  Returns a half-edge of the edge found, in either direction.
template <class Next>
uint32_t walk_along_line(const Mesh& mesh, const double* position, uint32_t h, const double* p, double* nearest,
                         const Next& next) {
    double t = 0;
    double distance = nearest_on_edge(mesh, position, h, p, nearest, t);
    while (t == 0 || t == 1) {
        const uint32_t other = next(t == 1 ? h : twin(h));
        if (other == NONE) break;
        double point[3], at = 0;
        const double nearer = nearest_on_edge(mesh, position, other, p, point, at);
        if (!(nearer < distance)) break;
        distance = nearer;
        t = at;
        h = other;
        for (int k = 0; k < 3; ++k) nearest[k] = point[k];
    }
    return h;
}

// From p, a point of the edge of h, along its line by a length, in the direction of h if that is positive, as far as
// the line goes.  Returns a half-edge of the edge reached.
template <class Next>
uint32_t slide_along_line(const Mesh& mesh, const double* position, uint32_t h, const Point& p, double length,
                          double* reached, const Next& next) {
    constexpr int most_edges = 4096;
    Point here = p;
    if (length < 0) {
        h = twin(h);
        length = -length;
    }
    for (int k = 0; k < most_edges; ++k) {
        const Point end = point(position, mesh.target(h)), way = end - here;
        const double left = std::sqrt(dot(way, way));
        if (length < left) {
            here = here + (length / left) * way;
            break;
        }
        here = end;
        length -= left;
        const uint32_t other = length > 0 ? next(h) : NONE;
        if (other == NONE) break;
        h = other;
    }
    reached[0] = here.x;
    reached[1] = here.y;
    reached[2] = here.z;
    return h;
}

} // namespace hmf
