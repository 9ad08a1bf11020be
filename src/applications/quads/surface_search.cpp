#include "surface_search.hpp"

#include "surface_walk.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr size_t TRIANGLES_EACH = 4; // of a box without children
constexpr size_t DEEPEST = 2 * 32;   // nodes that wait, of a tree over 2^32 triangles

} // namespace

Done SurfaceSearch::build(const Mesh& mesh, const double* position, Memory& memory) {
    mesh_ = mesh;
    position_ = position;
    sides_.start(memory);
    if (!sides_.reserve(mesh.face_count)) return false;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h)
        if (mesh.face[h] != NONE && h < mesh.next[h] && h < mesh.prev(h) && !sides_.push(h)) return false;
    while (leaves_ * TRIANGLES_EACH < sides_.size()) leaves_ *= 2;
    const Box empty{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    if (!boxes_.allocate_filled(memory, 2 * leaves_, empty)) return false;
    for (size_t i = 0; i < sides_.size(); ++i) {
        Box& box = boxes_[leaves_ + i / TRIANGLES_EACH];
        uint32_t h = sides_[i];
        for (int corner = 0; corner < 3; ++corner, h = mesh.next[h])
            for (size_t k = 0; k < 3; ++k) {
                const double x = position[size_t{3} * mesh.origin[h] + k];
                box.low[k] = std::min(box.low[k], x);
                box.high[k] = std::max(box.high[k], x);
            }
    }
    for (size_t i = leaves_ - 1; i > 0; --i)
        for (size_t k = 0; k < 3; ++k) {
            boxes_[i].low[k] = std::min(boxes_[2 * i].low[k], boxes_[2 * i + 1].low[k]);
            boxes_[i].high[k] = std::max(boxes_[2 * i].high[k], boxes_[2 * i + 1].high[k]);
        }
    return true;
}

double SurfaceSearch::square_distance(size_t node, const Point& p) const {
    const Box& box = boxes_[node];
    const double x[3] = {p.x, p.y, p.z};
    double sum = 0;
    for (size_t k = 0; k < 3; ++k) {
        const double off = std::max(std::max(box.low[k] - x[k], x[k] - box.high[k]), 0.0);
        sum += off * off;
    }
    return sum;
}

bool SurfaceSearch::is_behind(const Point& p, const Point& n, double room) const {
    struct Waiting {
        size_t node;
        double square;
    } waiting[DEEPEST];
    const double at[3] = {p.x, p.y, p.z};
    double limit = HUGE_VAL, agrees = HUGE_VAL; // squares
    size_t count = 0;
    waiting[count++] = {1, 0};
    while (count > 0) {
        const Waiting now = waiting[--count];
        if (!(now.square < std::min(limit, agrees))) continue;
        if (now.node < leaves_) {
            Waiting a{2 * now.node, square_distance(2 * now.node, p)};
            Waiting b{2 * now.node + 1, square_distance(2 * now.node + 1, p)};
            if (a.square < b.square) std::swap(a, b);
            waiting[count++] = a;
            waiting[count++] = b;
            continue;
        }
        const size_t first = (now.node - leaves_) * TRIANGLES_EACH;
        for (size_t i = first; i < std::min(first + TRIANGLES_EACH, sides_.size()); ++i) {
            const uint32_t h = sides_[i];
            double nearest[3];
            int on = 0;
            const double square = nearest_in_triangle(at, position_ + size_t{3} * mesh_.origin[h],
                                                      position_ + size_t{3} * mesh_.target(h),
                                                      position_ + size_t{3} * mesh_.origin[mesh_.prev(h)], nearest, on);
            limit = std::min(limit, square + room * room);
            if (square < agrees && dot(normal_at(mesh_, position_, h), n) > 0) agrees = square;
        }
    }
    return agrees > limit;
}

} // namespace hmf
