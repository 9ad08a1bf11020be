#include "front_surface.hpp"

#include "surface_lines.hpp"

namespace hmf {

namespace {

constexpr double NEAR = 1e-6; // of an edge on which a point is said to lie

}

Done FrontSurface::build(const Mesh& whole, const Reflection& reflection, Memory& memory) {
    const size_t sides = size_t{2} * whole.edge_count;
    reflection_ = &reflection;
    if (!face_.allocate(memory, sides)) return false;
    for (size_t h = 0; h < sides; ++h) face_[h] = reflection.is_front[h] ? whole.face[h] : NONE;
    mesh_ = whole;
    mesh_.face = face_.data();
    return true;
}

void FrontSurface::bring_forward(const double* position, QuadMesh& quads) const {
    for (uint32_t& side : quads.sides)
        if (mesh_.face[side] == NONE) side = twin(reflection_->half_edge[side]);
    for (uint32_t v = 0; v < quads.vertex_count(); ++v) {
        if (!is_at_boundary(quads.held[v])) continue;
        const Point p = at(quads, v);
        const uint32_t rim = rim_at(position, quads.sides[v], p);
        if (rim != NONE) quads.sides[v] = rim;
        else quads.held[v] = AT_CORNER;
    }
}

// The edge of the boundary on which p lies: the one that it is said to lie on or one beside that, for two edges may lie
// at the same place; else the nearest one at the triangle.
uint32_t FrontSurface::rim_at(const double* position, uint32_t side, const Point& p) const {
    const uint32_t said = is_on_rim(mesh_, side) ? side : NONE;
    if (said != NONE) {
        const auto square_to = [&](uint32_t h) { return square_of(p - nearest_on_edge(mesh_, position, h, p)); };
        uint32_t best = said;
        double least = square_to(said);
        for (const uint32_t h : {next_on_rim(mesh_, said), twin(next_on_rim(mesh_, twin(said)))}) {
            const double square = square_to(h);
            if (!(square < least)) continue;
            least = square;
            best = h;
        }
        const Point edge = point(position, mesh_.target(best)) - point(position, mesh_.origin[best]);
        if (!(least > NEAR * NEAR * dot(edge, edge))) return best;
    }
    return rim_near(mesh_, position, side, p);
}

} // namespace hmf
