#include "surface_search.hpp"

#include "surface_walk.hpp"

namespace hmf {

Done SurfaceSearch::build(const Mesh& mesh, const double* position, Memory& memory) {
    mesh_ = mesh;
    position_ = position;
    sides_.start(memory);
    if (!sides_.reserve(mesh.face_count)) return false;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h)
        if (mesh.face[h] != NONE && h < mesh.next[h] && h < mesh.prev(h) && !sides_.push(h)) return false;
    const auto corner = [&](size_t i, int k) {
        const uint32_t h = sides_[i];
        return point(position, mesh.origin[k == 0 ? h : k == 1 ? mesh.next[h] : mesh.prev(h)]);
    };
    return tree_.build(sides_.size(), 3, corner, memory);
}

bool SurfaceSearch::is_behind(const Point& p, const Point& n, double room) const {
    double limit = HUGE_VAL, agrees = HUGE_VAL; // squares
    tree_.search(p, HUGE_VAL, [&](size_t i) {
        const double square = nearest_in_face(mesh_, position_, sides_[i], p).square;
        limit = std::min(limit, square + room * room);
        if (square < agrees && dot(normal_at(mesh_, position_, sides_[i]), n) > 0) agrees = square;
        return std::min(limit, agrees);
    });
    return agrees > limit;
}

} // namespace hmf
