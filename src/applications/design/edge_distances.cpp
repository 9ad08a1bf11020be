#include "edge_distances.hpp"

namespace hmf {

Done EdgeDistances::start() {
    const uint32_t n = mesh_.vertex_count;
    heap_.start(memory_);
    order_.start(memory_);
    if (!length_.allocate(memory_, mesh_.edge_count) || !area_.allocate_filled(memory_, n, 0.0)
        || !distance_.allocate(memory_, n) || !order_.reserve(n))
        return false;
    const auto at = [this](uint32_t v) { return position_ + size_t{3} * v; };
    whole_ = 0;
    for (uint32_t h = 0; h < 2 * mesh_.edge_count; ++h) {
        const double *p = at(mesh_.origin[h]), *q = at(mesh_.target(h)), *r = at(mesh_.origin[mesh_.prev(h)]);
        const double a[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, b[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
        const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
        const double third = std::sqrt(x * x + y * y + z * z) / 6;
        length_[edge_of(h)] = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
        area_[mesh_.origin[h]] += third;
        whole_ += third;
    }
    return true;
}

Done EdgeDistances::diameter(uint32_t vertex, const DiskLimit& limit, const uint8_t* left_out, uint32_t (&ends)[2]) {
    double area = 0;
    uint32_t reached = 0, first = vertex, second = vertex;
    ends[0] = ends[1] = NONE;
    Array<uint8_t> disk;
    if (!search(vertex, nullptr, first,
                [&](uint32_t v) {
                    area += area_[v];
                    const double r = distance_[v];
                    return ++reached >= limit.vertices && (area > limit.area * whole_ || area < limit.shape * r * r);
                })
        || !disk.allocate_filled(memory_, mesh_.vertex_count, uint8_t{0}))
        return false;
    for (const uint32_t v : order_) disk[v] = !left_out || !left_out[v];
    if (!disk[first]) return true;
    if (!search(first, disk.data(), second) || !search(second, disk.data(), first)) return false;
    if (first == second) return true;
    ends[0] = first;
    ends[1] = second;
    return true;
}

} // namespace hmf
