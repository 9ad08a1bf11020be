#include "sharp_edges.hpp"

#include <cmath>

#include "line_walk.hpp"

namespace hmf {

namespace {

constexpr double SHARP = 0.766; // cosine of 40 degrees

// The cosine of the angle between the faces of an edge, 1 where they lie in one plane.
double fold(const Mesh& mesh, const double* position, uint32_t h) {
    double normal[2][3];
    for (uint32_t side = 0; side < 2; ++side, h = twin(h)) {
        const double* const o = position + size_t{3} * mesh.origin[h];
        const double* const a = position + size_t{3} * mesh.target(h);
        const double* const b = position + size_t{3} * mesh.origin[mesh.prev(h)];
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            normal[side][k] = (a[i] - o[i]) * (b[j] - o[j]) - (a[j] - o[j]) * (b[i] - o[i]);
        }
    }
    double dot = 0, one = 0, two = 0;
    for (int k = 0; k < 3; ++k) {
        dot += normal[0][k] * normal[1][k];
        one += normal[0][k] * normal[0][k];
        two += normal[1][k] * normal[1][k];
    }
    return one > 0 && two > 0 ? dot / std::sqrt(one * two) : 1;
}

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

} // namespace

bool is_sharp(const Mesh& mesh, const double* position, uint32_t h) { return fold(mesh, position, h) <= SHARP; }

bool is_sharp_corner(const Mesh& mesh, const double* position, uint32_t v) {
    int edges = 0;
    for (const uint32_t h : mesh.around(v)) edges += is_sharp(mesh, position, h);
    return edges > 2;
}

uint32_t walk_along_sharp_edges(const Mesh& mesh, const double* position, uint32_t h, const double* p,
                                double* nearest) {
    return walk_along_line(mesh, position, h, p, nearest,
                           [&](uint32_t g) { return next_sharp_edge(mesh, position, g); });
}

uint32_t slide_along_sharp_edges(const Mesh& mesh, const double* position, uint32_t h, const Point& p, double length,
                                 double* reached) {
    return slide_along_line(mesh, position, h, p, length, reached,
                            [&](uint32_t g) { return next_sharp_edge(mesh, position, g); });
}

} // namespace hmf
