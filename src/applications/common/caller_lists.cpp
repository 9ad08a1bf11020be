#include "caller_lists.hpp"

namespace hmf {

namespace {
constexpr uint32_t NUMBERS_STRIDE = 131072; // elements between two reports
} // namespace

hmf_status caller_faces(const hmf_hierarchy& h, Array<uint32_t>& face, Call& call) {
    if (!face.allocate(call.memory, h.input.face_count)) return call.out_of_memory();
    const auto look_up = [&](size_t begin, size_t end) {
        for (size_t t = begin; t < end; ++t) face[t] = internal_face(h, t);
    };
    return call.pass(face.size(), 0, look_up) ? HMF_OK : call.was_cancelled();
}

// Their edges are marked by the caller's numbers, so that the pass over the
// triangles reads these in order and looks up the internal ones for a few.
hmf_status caller_triangles(const hmf_hierarchy& h, const Array<uint32_t>& half_edges, Array<uint32_t>& triangles,
                            Call& call) {
    const Mesh& mesh = h.input;
    Array<uint8_t> wanted, by_caller; // per edge
    Array<uint32_t> of_face;
    if (!wanted.allocate_filled(call.memory, mesh.edge_count, uint8_t{0})
        || !by_caller.allocate(call.memory, mesh.edge_count) || !of_face.allocate(call.memory, mesh.face_count)
        || !triangles.allocate(call.memory, half_edges.size()))
        return call.out_of_memory();
    for (const uint32_t x : half_edges) wanted[edge_of(x)] = 1;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (e % NUMBERS_STRIDE == 0 && !call.tick(0)) return call.was_cancelled();
        by_caller[e] = wanted[h.edge_internal[e]];
    }
    for (uint32_t t = 0; t < mesh.face_count; ++t) {
        if (t % NUMBERS_STRIDE == 0 && !call.tick(0)) return call.was_cancelled();
        const uint32_t* const edges = h.triangle_edges + size_t{3} * t;
        if (by_caller[edges[0]] | by_caller[edges[1]] | by_caller[edges[2]]) of_face[internal_face(h, t)] = t;
    }
    for (size_t i = 0; i < half_edges.size(); ++i) triangles[i] = of_face[mesh.face[half_edges[i]]];
    return HMF_OK;
}

hmf_status inverse_numbers(const uint32_t* internal, size_t count, Array<uint32_t>& caller, Call& call) {
    if (!caller.allocate(call.memory, count)) return call.out_of_memory();
    const auto invert = [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) caller[internal[i]] = static_cast<uint32_t>(i);
    };
    return call.pass(count, 0, invert) ? HMF_OK : call.was_cancelled();
}

} // namespace hmf
