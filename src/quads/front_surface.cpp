#include "front_surface.hpp"

#include "boundary_walk.hpp"
#include "quad_shape.hpp"

namespace hmf {

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
        const double* const p = &quads.positions[size_t{3} * v];
        const uint32_t rim = rim_near(mesh_, position, quads.sides[v], p);
        if (rim != NONE) quads.sides[v] = rim;
        if (rim == NONE || is_marked(position, rim, p)) quads.held[v] = AT_CORNER;
    }
}

// Whether p is a marked vertex at an end of the boundary edge.
bool FrontSurface::is_marked(const double* position, uint32_t rim, const double* p) const {
    for (const uint32_t v : {mesh_.origin[rim], mesh_.target(rim)}) {
        const Point off = point(position, v) - point(p, 0);
        if (mesh_.is_marked(v) && !(dot(off, off) > 0)) return true;
    }
    return false;
}

} // namespace hmf
