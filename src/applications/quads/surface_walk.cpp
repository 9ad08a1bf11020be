// After Ericson, Real-Time Collision Detection, 5.1.5 (nearest point of a
// triangle by its Voronoi regions); see surface_walk.hpp.
#include "surface_walk.hpp"

namespace hmf {

namespace {

constexpr int MOST_TRIANGLES = 4096; // that one walk looks at

}

NearestPoint nearest_in_triangle(const Point& p, const Point& a, const Point& b, const Point& c) {
    const Point ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
                 d6 = dot(ac, cp);
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    double v = 0, w = 0; // barycentric coordinates of b and c
    int on = 0;
    if (d1 <= 0 && d2 <= 0) on = 4;
    else if (d3 >= 0 && d4 <= d3) on = 5;
    else if (d6 >= 0 && d5 <= d6) on = 6;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
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
        const double sum = va + vb + vc;
        v = sum > 0 ? vb / sum : 0;
        w = sum > 0 ? vc / sum : 0;
    }
    const Point at = on == 5 ? b : on == 6 ? c : a + (v * ab + w * ac);
    return {at, square_of(p - at), on};
}

NearestPoint nearest_in_face(const Mesh& mesh, const double* position, uint32_t h, const Point& p) {
    return nearest_in_triangle(p, point(position, mesh.origin[h]), point(position, mesh.target(h)),
                               point(position, mesh.origin[mesh.prev(h)]));
}

uint32_t walk_to_nearest(const Mesh& mesh, const double* position, uint32_t side, const Point& p, Point& nearest) {
    NearestPoint best = nearest_in_face(mesh, position, side, p);
    for (int looked = 0; best.on != 0 && looked < MOST_TRIANGLES;) {
        const uint32_t from = side;
        uint32_t h = side;
        const bool corner = best.on > 3; // all around it, else across a side
        for (int k = corner ? best.on - 4 : best.on - 1; k > 0; --k) h = mesh.next[h];
        const uint32_t first = corner ? h : twin(h);
        uint32_t g = first;
        do {
            ++looked;
            if (mesh.face[g] != NONE) {
                const NearestPoint there = nearest_in_face(mesh, position, g, p);
                if (there.square < best.square) {
                    best = there;
                    side = g;
                }
            }
            g = corner ? mesh.rotate_ccw(g) : first;
        } while (g != first && looked < MOST_TRIANGLES);
        if (side == from) break;
    }
    nearest = best.at;
    return side;
}

} // namespace hmf
