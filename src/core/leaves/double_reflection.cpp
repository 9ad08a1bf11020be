#include "double_reflection.hpp"

#include "../hierarchy/caller_numbers.hpp"

namespace hmf {

static constexpr uint32_t REFLECTION_STRIDE = 131072; // triangles between two reports

//        c0                 c0'        Side s of a triangle in front is side 2 - s of the
//       /  \                /  \        one behind it, run through the other way.
//     c1 -- c2   front   c2'-- c1'  back
hmf_status read_reflection(const hmf_hierarchy& h, Reflection& reflection, Call& call) {
    const Mesh& mesh = h.input;
    const size_t m = h.surface_triangles, sides = size_t{2} * mesh.edge_count;
    if (!reflection.half_edge.allocate_filled(call.memory, sides, NONE)
        || !reflection.is_front.allocate_filled(call.memory, sides, uint8_t{0})
        || !reflection.is_boundary.allocate_filled(call.memory, mesh.vertex_count, uint8_t{0}))
        return call.out_of_memory();
    // The half-edge of an edge that begins at a vertex of the caller.
    const auto from = [&](size_t place, uint32_t vertex) {
        const uint32_t side = 2 * h.edge_internal[h.triangle_edges[place]];
        return mesh.origin[side] == h.vertex_internal[vertex] ? side : twin(side);
    };
    for (size_t t = 0; t < m; ++t) {
        if (t % REFLECTION_STRIDE == 0 && !call.tick(0, true)) return call.was_cancelled();
        for (size_t s = 0; s < 3; ++s) {
            const uint32_t corner = h.triangle_vertices[3 * t + s];
            const uint32_t a = from(3 * t + s, corner), b = from(3 * (m + t) + 2 - s, h.mirror.vertex[corner]);
            reflection.half_edge[a] = b;
            reflection.half_edge[b] = a;
            reflection.half_edge[twin(a)] = twin(b);
            reflection.half_edge[twin(b)] = twin(a);
            reflection.is_front[a] = 1;
            if (a == b) reflection.is_boundary[mesh.origin[a]] = reflection.is_boundary[mesh.target(a)] = 1;
        }
    }
    return HMF_OK;
}

hmf_status make_symmetric(const hmf_hierarchy& h, size_t level, Foliation& f, Call& call, Symmetrized& made) {
    made.exact = false;
    if (level > 0 || !h.is_double()) return HMF_OK;
    Reflection reflection;
    if (read_reflection(h, reflection, call)) return call.status();
    return make_symmetric(f, reflection, call, made);
}

} // namespace hmf
