#include "quad_shape.hpp"

#include "quad_numbers.hpp"
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

bool is_seen_from_behind(const SurfaceSearch& surface, const Point* p, const Point& n) {
    return surface.is_behind(0.25 * ((p[0] + p[1]) + (p[2] + p[3])), n, LEEWAY * length_of(p[2] - p[0]));
}

} // namespace

double worst_corner(const QuadMesh& quads, size_t q, const SurfaceSearch* surface) {
    Point p[4];
    for (size_t k = 0; k < 4; ++k) p[k] = at(quads, quads.quads[4 * q + k]);
    const Point n = of_length_one(cross(p[2] - p[0], p[3] - p[1]));
    if (!(dot(n, n) > 0)) return -1;
    return surface && is_seen_from_behind(*surface, p, n) ? -1 : least_sine(p, n);
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

Done QuadStars::follow_boundary(const QuadMesh& quads, Array<uint32_t>& next, Memory& memory) const {
    if (!next.allocate_filled(memory, quads.vertex_count(), NONE)) return false;
    for (size_t i = 0; i < quads.quads.size(); ++i) {
        const uint32_t a = quads.quads[i], b = quads.quads[i / 4 * 4 + (i + 1) % 4];
        if (is_at_boundary(quads.held[a]) && is_at_boundary(quads.held[b]) && is_outer(quads, a, b)) next[a] = b;
    }
    return true;
}

bool QuadStars::is_outer(const QuadMesh& quads, uint32_t a, uint32_t b) const {
    for (const uint32_t* q = begin(a); q != end(a); ++q)
        for (size_t k = 0; k < 4; ++k)
            if (quads.quads[4 * size_t{*q} + k] == b && quads.quads[4 * size_t{*q} + (k + 1) % 4] == a) return false;
    return true;
}

double QuadStars::worst_corner(const SurfaceSearch& surface, QuadMesh& quads, uint32_t v, const Point& p) const {
    const Point from = at(quads, v);
    double worst = 1;
    quads.put(v, p, quads.sides[v]);
    for (const uint32_t* q = begin(v); q != end(v); ++q)
        worst = std::min(worst, hmf::worst_corner(quads, *q, &surface));
    quads.put(v, from, quads.sides[v]);
    return worst;
}

Done SurfaceNormals::build(const Mesh& mesh, const double* position, Memory& memory) {
    mesh_ = mesh;
    position_ = position;
    if (!of_vertex_.allocate_filled(memory, mesh.vertex_count, Point{})) return false;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) { // once for each corner of a triangle
        if (mesh.face[h] == NONE) continue;
        const Point a = point(position, mesh.origin[h]), b = point(position, mesh.target(h)),
                    c = point(position, mesh.origin[mesh.prev(h)]);
        // By the tangent of half the angle, at most of 45 degrees: nearly by the angle.
        const Point n = cross(b - a, c - a);
        const double size = std::sqrt(dot(n, n)),
                     whole = std::sqrt(dot(b - a, b - a) * dot(c - a, c - a)) + dot(b - a, c - a);
        Point& sum = of_vertex_[mesh.origin[h]];
        if (size > 0) sum = sum + (1 / (whole > size ? whole : size)) * n;
    }
    for (Point& n : of_vertex_) n = of_length_one(n);
    return true;
}

Point SurfaceNormals::at(uint32_t side, const Point& p) const {
    const uint32_t corner[3] = {mesh_.origin[side], mesh_.target(side), mesh_.origin[mesh_.prev(side)]};
    const Point a = point(position_, corner[0]) - p, b = point(position_, corner[1]) - p,
                c = point(position_, corner[2]) - p;
    // Barycentric, from the areas opposite to the corners.
    const Point bc = cross(b, c), ca = cross(c, a), ab = cross(a, b), whole = bc + ca + ab;
    const Point n = dot(bc, whole) * of_vertex_[corner[0]] + dot(ca, whole) * of_vertex_[corner[1]]
                  + dot(ab, whole) * of_vertex_[corner[2]];
    const double length = std::sqrt(dot(n, n));
    return length > 0 ? (1 / length) * n : of_vertex_[corner[0]];
}

} // namespace hmf
