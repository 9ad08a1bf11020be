#include "double_surface.hpp"

#include "../base/disjoint_sets.hpp"
#include "spatial_order.hpp"

namespace hmf {

hmf_status double_surface(const double* positions, size_t vertex_count, size_t position_stride, uint32_t* triangles,
                          size_t triangle_count, const Array<uint32_t>& sides, const uint32_t* marked,
                          uint64_t marked_count, uint32_t* mirror, Doubling& out, Call& call) {
    const uint32_t n = static_cast<uint32_t>(vertex_count);
    if (triangle_count > 0x40000000u / 3 || vertex_count > 0x40000000u / 3)
        return call.fail(HMF_ERROR_MESH_COUNTS, HMF_ELEMENT_NONE, 0,
                         "A mesh with boundary has at most 2^30 / 3 vertices and triangles. Simplify or divide it.");
    if (!out.boundary_side.allocate_filled(call.memory, 3 * triangle_count, uint8_t{0})) return call.out_of_memory();
    // Vertices of one boundary curve are connected along its sides.
    Array<uint32_t> curve;
    if (!curve.allocate_filled(call.memory, vertex_count, NONE)) return call.out_of_memory();
    const auto end = [&](uint32_t side, uint32_t which) { return triangles[side - side % 3 + (side % 3 + which) % 3]; };
    for (const uint32_t side : sides) {
        out.boundary_side[side] = 1;
        for (uint32_t which = 0; which < 2; ++which) curve[end(side, which)] = end(side, which);
    }
    for (const uint32_t side : sides) unite(curve.data(), end(side, 0), end(side, 1));
    if (!call.tick(0.09)) return HMF_CANCELLED;
    out.vertex_count = n;
    for (uint32_t v = 0; v < n; ++v) {
        out.boundary_count += curve[v] == v;
        mirror[v] = curve[v] == NONE ? out.vertex_count++ : v;
    }
    for (size_t t = 0; t < triangle_count; ++t) { // turned over
        const uint32_t* front = triangles + 3 * t;
        uint32_t* back = triangles + 3 * (triangle_count + t);
        back[0] = mirror[front[0]];
        back[1] = mirror[front[2]];
        back[2] = mirror[front[1]];
    }
    if (!call.tick(0.1)) return HMF_CANCELLED;
    if (!out.positions.allocate(call.memory, size_t{3} * out.vertex_count)) return call.out_of_memory();
    for (uint32_t v = 0; v < n; ++v)
        for (size_t c = 0; c < 3; ++c)
            out.positions[size_t{3} * v + c] = out.positions[size_t{3} * mirror[v] + c] =
                position_at(positions, position_stride, v)[c];
    out.marked.start(call.memory);
    for (uint64_t k = 0; k < marked_count; ++k) {
        const uint32_t v = marked[k];
        if (!out.marked.push(v) || (mirror[v] != v && !out.marked.push(mirror[v]))) return call.out_of_memory();
    }
    out.marked_count = out.marked.size();
    return HMF_OK;
}

} // namespace hmf
