#include "quad_shape.hpp"

#include "surface_search.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

Point normal_at(const Mesh& mesh, const double* position, uint32_t h) {
    const Point a = point(position, mesh.origin[h]), b = point(position, mesh.target(h)),
                c = point(position, mesh.origin[mesh.prev(h)]);
    return of_length_one(cross(b - a, c - a));
}

namespace {

// In diagonals of a quad: on a sheet thinner than this it may lie on either side.
constexpr double LEEWAY = 0.02;

// A side or diagonal shorter than this part of the longest side is visually degenerate, and a corner with this sine
// counts as 0 or 180 degrees.
constexpr double NO_SIDE = 1e-6, NO_DIAGONAL = 1e-3, NO_SINE = 1e-5;

double least_sine(const Point* p, const Point& n) {
    double worst = 1, shortest = HUGE_VAL, longest = 0;
    for (int k = 0; k < 4; ++k) {
        const Point e = p[(k + 1) % 4] - p[k], b = p[(k + 3) % 4] - p[k];
        const double side = dot(e, e), size = std::sqrt(side * dot(b, b));
        const double sine = size > 0 ? dot(cross(e, b), n) / size : -1;
        if (sine < worst) worst = sine;
        if (side < shortest) shortest = side;
        if (side > longest) longest = side;
    }
    for (int k = 0; k < 2; ++k) {
        const Point diagonal = p[k + 2] - p[k];
        if (!(dot(diagonal, diagonal) > NO_DIAGONAL * NO_DIAGONAL * longest)) return -1;
    }
    if (!(shortest > NO_SIDE * NO_SIDE * longest)) return -1;
    return worst > NO_SINE ? worst : std::min(worst, 0.0);
}

// Of the diagonals, of length 1; 0 where they are parallel.
Point normal_of(const Point* p) { return of_length_one(cross(p[2] - p[0], p[3] - p[1])); }

} // namespace

double worst_corner(const QuadMesh& quads, size_t q) {
    Point p[4];
    for (size_t k = 0; k < 4; ++k) p[k] = at(quads, quads.quads[4 * q + k]);
    const Point n = normal_of(p);
    return dot(n, n) > 0 ? least_sine(p, n) : -1;
}

double worst_corner_from_outside(const SurfaceSearch& surface, const QuadMesh& quads, size_t q) {
    Point p[4];
    for (size_t k = 0; k < 4; ++k) p[k] = at(quads, quads.quads[4 * q + k]);
    const Point n = normal_of(p), diagonal = p[2] - p[0];
    if (!(dot(n, n) > 0)) return -1;
    const double room = LEEWAY * length_of(diagonal);
    return surface.is_behind(0.25 * ((p[0] + p[1]) + (p[2] + p[3])), n, room) ? -1 : least_sine(p, n);
}

Done QuadStars::build(const QuadMesh& quads, Memory& memory) {
    const uint32_t n = quads.vertex_count();
    Array<uint32_t> next;
    if (!first_.allocate_filled(memory, size_t{n} + 1, 0u) || !quads_.allocate(memory, quads.quads.size())
        || !next.allocate(memory, n))
        return false;
    for (const uint32_t v : quads.quads) ++first_[size_t{v} + 1];
    for (uint32_t v = 0; v < n; ++v) {
        first_[size_t{v} + 1] += first_[v];
        next[v] = first_[v];
    }
    for (uint32_t i = 0; i < quads.quads.size(); ++i) quads_[next[quads.quads[i]]++] = i / 4;
    return true;
}

bool QuadStars::is_outer(const QuadMesh& quads, uint32_t a, uint32_t b) const {
    for (const uint32_t* q = begin(a); q != end(a); ++q)
        for (size_t k = 0; k < 4; ++k)
            if (quads.quads[4 * size_t{*q} + k] == b && quads.quads[4 * size_t{*q} + (k + 1) % 4] == a) return false;
    return true;
}

double QuadStars::worst_corner(const SurfaceSearch& surface, const QuadMesh& quads, uint32_t v) const {
    double worst = 1;
    for (const uint32_t* q = begin(v); q != end(v); ++q) {
        const double corner = worst_corner_from_outside(surface, quads, *q);
        if (corner < worst) worst = corner;
    }
    return worst;
}

} // namespace hmf
