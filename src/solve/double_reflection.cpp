#include "double_reflection.hpp"

#include "../hierarchy/caller_numbers.hpp"

namespace hmf {

namespace {
constexpr uint32_t STRIDE = 131072; // triangles between two reports
} // namespace

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
    for (size_t t = 0; t < m; ++t) {
        if (t % STRIDE == 0 && !call.tick(0, true)) return call.was_cancelled();
        const uint32_t front = internal_side(h, t), back = internal_side(h, m + t);
        for (size_t s = 0; s < 3; ++s) {
            uint32_t a = front, b = back;
            while (edge_of(a) != h.edge_internal[h.triangle_edges[3 * t + s]]) a = mesh.next[a];
            while (edge_of(b) != h.edge_internal[h.triangle_edges[3 * (m + t) + 2 - s]]) b = mesh.next[b];
            reflection.half_edge[a] = twin(b);
            reflection.half_edge[twin(b)] = a;
            reflection.half_edge[b] = twin(a);
            reflection.half_edge[twin(a)] = b;
            reflection.is_front[a] = 1;
            if (a == twin(b)) reflection.is_boundary[mesh.origin[a]] = reflection.is_boundary[mesh.target(a)] = 1;
        }
    }
    return HMF_OK;
}

hmf_status make_symmetric(State& state, Call& call) {
    if (state.level > 0 || !state.hierarchy->is_double()) return HMF_OK;
    Reflection reflection;
    bool exact = false;
    if (read_reflection(*state.hierarchy, reflection, call)) return call.status();
    return make_symmetric(state.foliation, reflection, call, exact);
}

} // namespace hmf
