// After Ericson, Real-Time Collision Detection, 5.1.5 (nearest point of a
// triangle by its Voronoi regions); see surface_walk.hpp.
#include "surface_walk.hpp"

namespace hmf {

namespace {

constexpr int MOST_TRIANGLES = 4096; // that one walk looks at

double dot3(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
void subtract(const double* a, const double* b, double* out) {
    for (int k = 0; k < 3; ++k) out[k] = a[k] - b[k];
}

} // namespace

double nearest_in_triangle(const double* p, const double* a, const double* b, const double* c, double* nearest,
                           int& on) {
    double ab[3], ac[3], ap[3], bp[3], cp[3];
    subtract(b, a, ab);
    subtract(c, a, ac);
    subtract(p, a, ap);
    subtract(p, b, bp);
    subtract(p, c, cp);
    const double d1 = dot3(ab, ap), d2 = dot3(ac, ap), d3 = dot3(ab, bp), d4 = dot3(ac, bp), d5 = dot3(ab, cp),
                 d6 = dot3(ac, cp);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    double v = 0, w = 0; // barycentric coordinates of b and c
    if (d1 <= 0 && d2 <= 0) on = 4;
    else if (d3 >= 0 && d4 <= d3) {
        on = 5;
        v = 1;
    } else if (d6 >= 0 && d5 <= d6) {
        on = 6;
        w = 1;
    } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        on = 1;
        v = d1 - d3 > 0 ? d1 / (d1 - d3) : 0;
    } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        on = 3;
        w = d2 - d6 > 0 ? d2 / (d2 - d6) : 0;
    } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        on = 2;
        w = (d4 - d3) + (d5 - d6) > 0 ? (d4 - d3) / ((d4 - d3) + (d5 - d6)) : 0;
        v = 1 - w;
    } else {
        on = 0;
        const double sum = va + vb + vc;
        v = sum > 0 ? vb / sum : 0;
        w = sum > 0 ? vc / sum : 0;
    }
    double square = 0;
    for (int k = 0; k < 3; ++k) {
        nearest[k] = on == 5 ? b[k] : on == 6 ? c[k] : a[k] + v * ab[k] + w * ac[k];
        const double d = p[k] - nearest[k];
        square += d * d;
    }
    return square;
}

uint32_t walk_to_nearest(const Mesh& mesh, const double* position, uint32_t side, const double* p, double* nearest) {
    const auto look = [&](uint32_t h, double* point, int& on) {
        return nearest_in_triangle(p, position + size_t{3} * mesh.origin[h], position + size_t{3} * mesh.target(h),
                                   position + size_t{3} * mesh.origin[mesh.prev(h)], point, on);
    };
    int on = 0;
    double best = look(side, nearest, on);
    for (int looked = 0; on != 0 && looked < MOST_TRIANGLES;) {
        const uint32_t from = side;
        uint32_t h = side;
        for (int k = on > 3 ? on - 4 : on - 1; k > 0; --k) h = mesh.next[h];
        // Across a side, or all around a corner.
        const uint32_t first = on > 3 ? h : twin(h);
        const bool corner = on > 3;
        uint32_t g = first;
        do {
            double point[3] = {0, 0, 0};
            int there = 0;
            const double square = mesh.face[g] == NONE ? best : look(g, point, there);
            ++looked;
            if (square < best) {
                best = square;
                side = g;
                on = there;
                for (int k = 0; k < 3; ++k) nearest[k] = point[k];
            }
            g = corner ? mesh.rotate_ccw(g) : first;
        } while (g != first && looked < MOST_TRIANGLES);
        if (side == from) break;
    }
    return side;
}

} // namespace hmf
