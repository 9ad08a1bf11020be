#include "caller_numbers.hpp"

#include "../mesh/weights.hpp"

namespace hmf {

namespace {
constexpr uint32_t NUMBERS_STRIDE = 131072; // elements between two reports
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
        return call.pass(mesh.face_count, 0, [&](size_t begin, size_t end) {
            for (size_t t = begin; t < end; ++t) side[t] = internal_side(h, t);
        });
    }
    return call.pass(size_t{2} * mesh.edge_count, 0, [&](size_t begin, size_t end) {
        for_each_face(mesh, static_cast<uint32_t>(begin), static_cast<uint32_t>(end),
                      [&](uint32_t first, uint32_t, uint32_t) { side[mesh.face[first]] = first; });
    });
}

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

namespace {

// Around a vertex with more neighbors the multigrid may not converge, and the work of a factor is not linear: two
// wheels of valence 40 000 take 3 s, of 60 000 11 s; of 100 000 they stall after 42 s.
constexpr uint32_t MOST_NEIGHBORS = 50000;

} // namespace

hmf_status refuse_hubs(const hmf_hierarchy& h, size_t level, Call& call) {
    const Mesh& mesh = h.levels[level].mesh;
    if (mesh.edge_count <= MOST_NEIGHBORS / 2) return HMF_OK;
    constexpr uint32_t block = 4096;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        if (v % block == 0 && !call.tick(0, true)) return call.was_cancelled();
        const uint32_t neighbors = mesh.degree(v);
        if (neighbors <= MOST_NEIGHBORS) continue;
        uint32_t shown = 0;
        while (level == 0 && shown < h.surface_vertices && h.vertex_internal[shown] != v) ++shown;
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_VERTEX, level == 0 ? shown : v,
                         "Vertex %u has %u neighbors after flips to the intrinsic Delaunay triangulation; at most %u "
                         "are solved for. Divide the triangles around it.",
                         level == 0 ? shown : v, neighbors, MOST_NEIGHBORS);
    }
    return HMF_OK;
}

} // namespace hmf
