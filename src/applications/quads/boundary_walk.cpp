#include "boundary_walk.hpp"

#include <cmath>

#include "line_walk.hpp"

namespace hmf {

namespace {

// The other edge of the boundary where h ends, pointing away.
uint32_t other_on_rim(const Mesh& mesh, uint32_t h) {
    for (const uint32_t g : mesh.around_from(twin(h)))
        if (g != twin(h) && (is_on_rim(mesh, g) || is_on_rim(mesh, twin(g)))) return g;
    return NONE;
}

} // namespace

uint32_t rim_near(const Mesh& mesh, const double* position, uint32_t side, const double* p) {
    uint32_t best = NONE, h = side;
    double nearest = HUGE_VAL;
    for (int k = 0; k < 3; ++k, h = mesh.next[h])
        for (const uint32_t g : mesh.around_from(h))
            for (const uint32_t rim : {g, twin(g)}) {
                double point[3], t = 0;
                if (!is_on_rim(mesh, rim)) continue;
                const double square = nearest_on_edge(mesh, position, rim, p, point, t);
                if (!(square < nearest)) continue;
                nearest = square;
                best = rim;
            }
    return best;
}

uint32_t next_on_rim(const Mesh& mesh, uint32_t h) { return other_on_rim(mesh, h); }

uint32_t slide_along_rim(const Mesh& mesh, const double* position, uint32_t h, const Point& p, double length,
                         double* reached) {
    const uint32_t found =
        slide_along_line(mesh, position, h, p, length, reached, [&](uint32_t g) { return other_on_rim(mesh, g); });
    return is_on_rim(mesh, found) ? found : twin(found);
}

} // namespace hmf
