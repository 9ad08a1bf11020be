#include "mesh_sides.hpp"

#include <algorithm>

#include "mesh_formats.hpp"

namespace readers {

namespace {

// Sorts what is in order by key(i) < key_count, and keeps the order where keys are equal.
template <class Key>
void sort_by(std::vector<uint32_t>& order, std::vector<uint32_t>& sorted, std::vector<uint32_t>& first,
             size_t key_count, const Key& key) {
    first.assign(key_count + 1, 0);
    for (const uint32_t i : order) ++first[key(i) + 1];
    for (size_t k = 0; k < key_count; ++k) first[k + 1] += first[k];
    for (const uint32_t i : order) sorted[first[key(i)]++] = i;
    order.swap(sorted);
}

// keys: the last one counts least.
template <class... Key>
Groups group(size_t count, size_t key_count, const Key&... key) {
    Groups groups;
    groups.order.resize(count);
    for (size_t i = 0; i < count; ++i) groups.order[i] = static_cast<uint32_t>(i);
    std::vector<uint32_t> sorted(count), first;
    (sort_by(groups.order, sorted, first, key_count, key), ...);
    for (size_t n = 0; n < count; ++n) {
        const uint32_t i = groups.order[n], before = groups.order[n == 0 ? 0 : n - 1];
        if (n == 0 || ((key(i) != key(before)) || ...)) groups.starts.push_back(static_cast<uint32_t>(n));
    }
    groups.starts.push_back(static_cast<uint32_t>(count));
    return groups;
}

void check_count(const std::vector<uint32_t>& triangles) {
    if (triangles.size() > 0x80000000u)
        throw MeshError("the mesh has more than 2^31 / 3 triangles; simplify or divide it");
}

} // namespace

Groups group_sides(const std::vector<uint32_t>& triangles, size_t vertex_count) {
    check_count(triangles);
    const auto end = [&](uint32_t side) { return triangles[next_corner(side)]; };
    return group(
        triangles.size(), vertex_count, [&](uint32_t side) { return std::max(triangles[side], end(side)); },
        [&](uint32_t side) { return std::min(triangles[side], end(side)); });
}

Groups group_triangles(const std::vector<uint32_t>& triangles, size_t vertex_count) {
    check_count(triangles);
    const auto least = [&](uint32_t t) { return *std::min_element(&triangles[3 * t], &triangles[3 * t] + 3); };
    const auto largest = [&](uint32_t t) { return *std::max_element(&triangles[3 * t], &triangles[3 * t] + 3); };
    // With a vertex twice the sum says which: no two sets of three have the same three keys.
    const auto middle = [&](uint32_t t) {
        const uint32_t sum = triangles[3 * t] + triangles[3 * t + 1] + triangles[3 * t + 2]; // modulo 2^32
        return sum - least(t) - largest(t);
    };
    return group(triangles.size() / 3, vertex_count, largest, middle, least);
}

} // namespace readers
