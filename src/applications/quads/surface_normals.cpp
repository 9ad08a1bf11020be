#include "surface_normals.hpp"

namespace hmf {

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
