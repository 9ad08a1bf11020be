#include "caller_numbers.hpp"

#include "../mesh/weights.hpp"

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

// Around a vertex with more neighbors the multigrid may not converge, and the work of a factor is not linear: two
// wheels of valence 40 000 take 3 s, of 60 000 11 s; of 100 000 they stall after 42 s.
static constexpr uint32_t MOST_NEIGHBORS = 50000;

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
