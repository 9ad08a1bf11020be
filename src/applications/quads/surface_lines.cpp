#include "surface_lines.hpp"

#include "quad_numbers.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr int MOST_EDGES_OF_SLIDE = 4096; // so that the time is bounded

// The other sharp edge at the vertex where h ends, pointing away; NONE at a corner.
uint32_t next_sharp_edge(const Mesh& mesh, const double* position, uint32_t h) {
    uint32_t found = NONE;
    for (const uint32_t g : mesh.around(mesh.target(h))) {
        if (g == twin(h) || !is_sharp(mesh, position, g)) continue;
        if (found != NONE) return NONE;
        found = g;
    }
    return found;
}

// next(h): the half-edge by which the line goes on where h ends, NONE if it does not.
template <class Next>
uint32_t slide(const Mesh& mesh, const double* position, uint32_t h, Point p, double length, Point& reached,
               const Next& next) {
    if (length < 0) h = twin(h);
    length = std::fabs(length);
    for (int k = 0; k < MOST_EDGES_OF_SLIDE; ++k) {
        const Point end = point(position, mesh.target(h));
        const double left = length_of(end - p);
        if (length < left) {
            p = p + (length / left) * (end - p);
            break;
        }
        p = end;
        length -= left;
        const uint32_t other = length > 0 ? next(h) : NONE;
        if (other == NONE) break;
        h = other;
    }
    reached = p;
    return h;
}

} // namespace

bool is_sharp(const Mesh& mesh, const double* position, uint32_t h) {
    Point normal[2];
    for (Point& n : normal) {
        const Point o = point(position, mesh.origin[h]);
        n = cross(point(position, mesh.target(h)) - o, point(position, mesh.origin[mesh.prev(h)]) - o);
        h = twin(h);
    }
    const double size = square_of(normal[0]) * square_of(normal[1]);
    return size > 0 && dot(normal[0], normal[1]) <= SHARP * std::sqrt(size);
}

bool is_sharp_corner(const Mesh& mesh, const double* position, uint32_t v) {
    int edges = 0;
    for (const uint32_t h : mesh.around(v)) edges += is_sharp(mesh, position, h);
    return edges > 2;
}

uint32_t next_on_rim(const Mesh& mesh, uint32_t h) {
    for (const uint32_t g : mesh.around_from(twin(h)))
        if (g != twin(h) && (is_on_rim(mesh, g) || is_on_rim(mesh, twin(g)))) return g;
    return NONE;
}

uint32_t rim_near(const Mesh& mesh, const double* position, uint32_t side, const Point& p) {
    uint32_t best = NONE, h = side;
    double nearest = HUGE_VAL;
    for (int k = 0; k < 3; ++k, h = mesh.next[h])
        for (const uint32_t g : mesh.around_from(h))
            for (const uint32_t rim : {g, twin(g)}) {
                if (!is_on_rim(mesh, rim)) continue;
                const double square = square_of(p - nearest_on_edge(mesh, position, rim, p));
                if (!(square < nearest)) continue;
                nearest = square;
                best = rim;
            }
    return best;
}

Point nearest_on_edge(const Mesh& mesh, const double* position, uint32_t h, const Point& p) {
    const Point a = point(position, mesh.origin[h]), way = point(position, mesh.target(h)) - a;
    const double square = square_of(way), t = square > 0 ? dot(p - a, way) / square : 0;
    return a + std::min(std::max(t, 0.0), 1.0) * way;
}

uint32_t slide_along_rim(const Mesh& mesh, const double* position, uint32_t h, const Point& p, double length,
                         Point& reached) {
    const uint32_t found =
        slide(mesh, position, h, p, length, reached, [&](uint32_t g) { return next_on_rim(mesh, g); });
    return is_on_rim(mesh, found) ? found : twin(found);
}

uint32_t slide_along_sharp_edges(const Mesh& mesh, const double* position, uint32_t h, const Point& p, double length,
                                 Point& reached) {
    return slide(mesh, position, h, p, length, reached, [&](uint32_t g) { return next_sharp_edge(mesh, position, g); });
}

} // namespace hmf
