#include "caller_numbers.hpp"

namespace hmf {

namespace {
constexpr uint32_t STRIDE = 131072; // elements between two reports
} // namespace

uint32_t internal_side(const hmf_hierarchy& h, size_t triangle) {
    const uint32_t* edges = h.triangle_edges + 3 * triangle;
    const uint32_t second = h.edge_internal[edges[1]], third = h.edge_internal[edges[2]];
    uint32_t side = 2 * h.edge_internal[edges[0]];
    for (uint32_t turn = 0; turn < 2; ++turn, side = twin(side)) {
        const uint32_t a = edge_of(h.input.next[side]), b = edge_of(h.input.prev(side));
        if ((a == second && b == third) || (a == third && b == second)) break;
    }
    return side;
}

uint32_t internal_face(const hmf_hierarchy& h, size_t triangle) { return h.input.face[internal_side(h, triangle)]; }

Done side_of_triangles(const hmf_hierarchy& h, size_t level, Array<uint32_t>& side, Call& call) {
    const Mesh& mesh = level == 0 ? h.input : h.levels[level].mesh;
    if (!side.allocate(call.memory, mesh.face_count)) return false;
    if (level == 0) {
        for (uint32_t t = 0; t < mesh.face_count; ++t) {
            if (t % STRIDE == 0 && !call.tick(0)) return false;
            side[t] = internal_side(h, t);
        }
    } else {
        for (uint32_t h = 2 * mesh.edge_count; h-- > 0;) side[mesh.face[h]] = h;
    }
    return true;
}

hmf_status caller_faces(const hmf_hierarchy& h, Array<uint32_t>& face, Call& call) {
    if (!face.allocate(call.memory, h.input.face_count)) return call.out_of_memory();
    for (uint32_t t = 0; t < h.input.face_count; ++t) {
        if (t % STRIDE == 0 && !call.tick(0)) return call.was_cancelled();
        face[t] = internal_face(h, t);
    }
    return HMF_OK;
}

hmf_status inverse_numbers(const uint32_t* internal, size_t count, Array<uint32_t>& caller, Call& call) {
    if (!caller.allocate(call.memory, count)) return call.out_of_memory();
    for (size_t i = 0; i < count; ++i) {
        if (i % STRIDE == 0 && !call.tick(0)) return call.was_cancelled();
        caller[internal[i]] = static_cast<uint32_t>(i);
    }
    return HMF_OK;
}

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
