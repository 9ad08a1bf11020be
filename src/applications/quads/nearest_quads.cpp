// Dijkstra's algorithm from the corners of the triangles in which vertices of the quads lie.
#include "nearest_quads.hpp"

#include "../../core/base/nearest_first.hpp"
#include "surface_walk.hpp"

#include <cmath>

namespace hmf {

Done NearestQuads::build(const Mesh& mesh, const double* position, const Reflection* front, const QuadMesh& quads,
                         const QuadStars& stars, Call& call) {
    position_ = position;
    quads_ = &quads;
    stars_ = &stars;
    const uint32_t n = mesh.vertex_count;
    NearestFirst heap;
    Array<double> distance;
    heap.start(call.memory);
    if (!distance.allocate_filled(call.memory, n, HUGE_VAL) || !owner_.allocate_filled(call.memory, n, NONE)
        || !before_.allocate_filled(call.memory, n, NONE))
        return false;
    const auto length = [](const Point& a) { return std::sqrt(dot(a, a)); };
    const auto offer = [&](uint32_t x, double d, uint32_t v, uint32_t from) -> Done {
        if (!(d < distance[x])) return true;
        distance[x] = d;
        owner_[x] = v;
        before_[x] = from;
        return heap.push({d, x});
    };
    for (uint32_t v = 0; v < quads.vertex_count(); ++v) {
        uint32_t h = quads.sides[v];
        for (int k = 0; k < 3; ++k, h = mesh.next[h])
            if (!offer(mesh.origin[h], length(at(quads, v) - point(position, mesh.origin[h])), v, NONE)) return false;
    }
    for (size_t i = 0; !heap.empty(); ++i) {
        if (i % 16384 == 0 && !call.tick(0)) return false;
        const NearestFirst::Entry top = heap.pop();
        const uint32_t x = top.item;
        if (top.distance > distance[x]) continue;
        for (const uint32_t h : mesh.around(x)) {
            if (front && !front->is_front[h] && !front->is_front[twin(h)]) continue;
            const uint32_t y = mesh.target(h);
            const double d = top.distance + length(point(position, x) - point(position, y));
            if (!offer(y, d, owner_[x], x)) return false;
        }
    }
    return true;
}

NearestQuads::Place NearestQuads::find(uint32_t x, double least) const {
    Place found;
    for (const uint32_t* q = stars_->begin(owner_[x]); q != stars_->end(owner_[x]); ++q) {
        const double* corner[4];
        for (size_t k = 0; k < 4; ++k) corner[k] = &quads_->positions[size_t{3} * quads_->quads[4 * size_t{*q} + k]];
        const Point a = point(corner[0], 0) - point(corner[2], 0), b = point(corner[1], 0) - point(corner[3], 0);
        const size_t turn = dot(a, a) <= dot(b, b) ? 0 : 1;
        for (size_t half = 0; half < 4; half += 2) {
            double nearest[3];
            int on = 0;
            const double square =
                nearest_in_triangle(position_ + size_t{3} * x, corner[(turn + half) % 4], corner[(turn + half + 1) % 4],
                                    corner[(turn + half + 2) % 4], nearest, on);
            if (!(square > least)) return {NONE, 0};
            if (square < found.square) found = {*q, square};
        }
    }
    return found;
}

} // namespace hmf
