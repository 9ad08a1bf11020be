#include "caller_numbers.hpp"

namespace hmf {

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

Done side_of_triangles(const hmf_hierarchy& h, size_t level, Array<uint32_t>& side, Memory& memory) {
    const Mesh& mesh = level == 0 ? h.input : h.levels[level].mesh;
    if (!side.allocate(memory, mesh.face_count)) return false;
    if (level == 0) {
        for (uint32_t t = 0; t < mesh.face_count; ++t) side[t] = internal_side(h, t);
    } else {
        for (uint32_t h = 2 * mesh.edge_count; h-- > 0;) side[mesh.face[h]] = h;
    }
    return true;
}

hmf_status caller_faces(const hmf_hierarchy& h, Array<uint32_t>& face, Call& call) {
    if (!face.allocate(call.memory, h.input.face_count)) return call.out_of_memory();
    for (uint32_t t = 0; t < h.input.face_count; ++t) face[t] = internal_face(h, t);
    return HMF_OK;
}

hmf_status inverse_numbers(const uint32_t* internal, size_t count, Array<uint32_t>& caller, Call& call) {
    if (!caller.allocate(call.memory, count)) return call.out_of_memory();
    for (size_t i = 0; i < count; ++i) caller[internal[i]] = static_cast<uint32_t>(i);
    return HMF_OK;
}

} // namespace hmf
