#include "front_cylinders.hpp"

namespace hmf {

namespace {

// Triangles of a leaf of the double as ones of the surface: its way in front, for an
// arc, or all of it, what is behind seen through the mirror.
Done add_front_leaf(const uint32_t* leaf, size_t n, bool is_arc, uint32_t m, Array<uint32_t>& triangles) {
    const size_t first = triangles.size();
    size_t start = 0;
    // An arc begins where the leaf comes to the front.
    while (is_arc && start < n && (leaf[start] >= m || leaf[(start + n - 1) % n] < m)) ++start;
    for (size_t i = 0; i < n; ++i) {
        const uint32_t t = leaf[(start + i) % n];
        if (is_arc && t >= m) break;
        const uint32_t front = t < m ? t : t - m;
        if (triangles.size() > first && triangles.back() == front) continue;
        if (!triangles.push(front)) return false;
    }
    while (!is_arc && triangles.size() > first + 1 && triangles.back() == triangles[first]) triangles.pop();
    return true;
}

} // namespace

hmf_status keep_front_cylinders(const hmf_loop_set& loops, const Array<int64_t>& factor, uint32_t m,
                                CylindersWithLeaves cylinders, Call& call) {
    Array<hmf_cylinder>& list = cylinders.list;
    Array<uint64_t> offsets;
    Array<uint32_t> front;
    offsets.start(call.memory);
    front.start(call.memory);
    cylinders.is_arc.start(call.memory);
    if (!offsets.push(0)) return call.out_of_memory();
    size_t kept = 0;
    for (size_t c = 0; c < list.size(); ++c) {
        hmf_cylinder cylinder = list[c];
        if (cylinder.loop >= loops.count) continue; // behind
        const bool is_arc = loops.arcs && loops.arcs[cylinder.loop] != 0, is_round = factor[cylinder.loop] == 2;
        if (is_round) cylinder.height *= 0.5;
        if (is_arc) cylinder.circumference *= 0.5;
        if (is_arc || is_round) cylinder.area *= 0.5;
        cylinder.modulus = cylinder.height / cylinder.circumference;
        list[kept++] = cylinder;
        const uint64_t begin = cylinders.offsets[c], end = cylinders.offsets[c + 1];
        if (!add_front_leaf(cylinders.triangles.data() + begin, static_cast<size_t>(end - begin), is_arc, m, front)
            || !offsets.push(front.size()) || !cylinders.is_arc.push(is_arc))
            return call.out_of_memory();
    }
    while (list.size() > kept) list.pop();
    cylinders.offsets.swap(offsets);
    cylinders.triangles.swap(front);
    return HMF_OK;
}

} // namespace hmf
