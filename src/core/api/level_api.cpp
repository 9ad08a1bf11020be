// hmf.h: levels.
#include "../mesh/weights.hpp"
#include "entry.hpp"

using namespace hmf;

extern "C" {

size_t hmf_level_count(const hmf_hierarchy* hierarchy) { return hierarchy ? hierarchy->level_count : 0; }

size_t hmf_genus(const hmf_hierarchy* hierarchy) { return hierarchy ? hierarchy->surface_genus : 0; }

size_t hmf_boundary_count(const hmf_hierarchy* hierarchy) { return hierarchy ? hierarchy->boundary_count : 0; }

hmf_status hmf_level_counts(const hmf_hierarchy* hierarchy, size_t level, hmf_level_info* out, hmf_error* error) {
    Entry entry(hierarchy, nullptr, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, static_cast<const void*>(out)) || check_level(*hierarchy, level, call))
        return call.status();
    const Level& from = hierarchy->levels[level];
    out->vertex_count = hierarchy->shown_vertices(level);
    out->edge_count = hierarchy->shown_edges(level);
    out->triangle_count = hierarchy->shown_triangles(level);
    out->raised_count = from.raised_count;
    return HMF_OK;
}

hmf_status hmf_level_edge_vertices(const hmf_hierarchy* hierarchy, size_t level, uint32_t* edge_vertices,
                                   size_t capacity, hmf_error* error) {
    Entry entry(hierarchy, nullptr, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, static_cast<const void*>(edge_vertices)) || check_level(*hierarchy, level, call))
        return call.status();
    const Mesh& mesh = hierarchy->levels[level].mesh;
    if (check_capacity(capacity, size_t{2} * hierarchy->shown_edges(level), "edge_vertices", call))
        return call.status();
    if (level > 0) {
        std::memcpy(edge_vertices, mesh.origin, size_t{2} * mesh.edge_count * sizeof(uint32_t));
        return HMF_OK;
    }
    for (size_t t = hierarchy->surface_triangles; t-- > 0;) // the first triangle decides the order
        for (size_t s = 3; s-- > 0;) {
            const size_t e = hierarchy->triangle_edges[3 * t + s];
            edge_vertices[2 * e] = hierarchy->triangle_vertices[3 * t + s];
            edge_vertices[2 * e + 1] = hierarchy->triangle_vertices[3 * t + (s + 1) % 3];
        }
    return HMF_OK;
}

hmf_status hmf_level_triangle_edges(const hmf_hierarchy* hierarchy, size_t level, uint32_t* triangle_edges,
                                    size_t capacity, hmf_error* error) {
    Entry entry(hierarchy, nullptr, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, static_cast<const void*>(triangle_edges)) || check_level(*hierarchy, level, call))
        return call.status();
    const Mesh& mesh = hierarchy->levels[level].mesh;
    if (check_capacity(capacity, size_t{3} * hierarchy->shown_triangles(level), "triangle_edges", call))
        return call.status();
    if (level == 0) {
        std::memcpy(triangle_edges, hierarchy->triangle_edges,
                    size_t{3} * hierarchy->surface_triangles * sizeof(uint32_t));
        return HMF_OK;
    }
    for_each_face(mesh, 0, 2 * mesh.edge_count, [&](uint32_t a, uint32_t b, uint32_t c) {
        uint32_t* const edges = triangle_edges + size_t{3} * mesh.face[a];
        edges[0] = edge_of(a);
        edges[1] = edge_of(b);
        edges[2] = edge_of(c);
    });
    return HMF_OK;
}

hmf_status hmf_level_triangle_vertices(const hmf_hierarchy* hierarchy, size_t level, uint32_t* triangle_vertices,
                                       size_t capacity, hmf_error* error) {
    Entry entry(hierarchy, nullptr, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, static_cast<const void*>(triangle_vertices)) || check_level(*hierarchy, level, call))
        return call.status();
    const Mesh& mesh = hierarchy->levels[level].mesh;
    if (check_capacity(capacity, size_t{3} * hierarchy->shown_triangles(level), "triangle_vertices", call))
        return call.status();
    if (level == 0) {
        std::memcpy(triangle_vertices, hierarchy->triangle_vertices,
                    size_t{3} * hierarchy->surface_triangles * sizeof(uint32_t));
        return HMF_OK;
    }
    for_each_face(mesh, 0, 2 * mesh.edge_count, [&](uint32_t a, uint32_t b, uint32_t c) {
        uint32_t* const vertices = triangle_vertices + size_t{3} * mesh.face[a];
        vertices[0] = mesh.origin[a];
        vertices[1] = mesh.origin[b];
        vertices[2] = mesh.origin[c];
    });
    return HMF_OK;
}

hmf_status hmf_level_weights(const hmf_hierarchy* hierarchy, size_t level, double* weights, size_t capacity,
                             hmf_error* error) {
    Entry entry(hierarchy, nullptr, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, static_cast<const void*>(weights)) || check_level(*hierarchy, level, call))
        return call.status();
    const Level& from = hierarchy->levels[level];
    const uint32_t n = hierarchy->shown_edges(level);
    if (check_capacity(capacity, n, "weights", call)) return call.status();
    if (level > 0) {
        std::memcpy(weights, from.weight, n * sizeof(double));
        return HMF_OK;
    }
    const Mesh& mesh = hierarchy->input;
    const double* x = from.position;
    if (hierarchy->is_double()) { // triangle by triangle: an edge of the boundary has one
        for (uint32_t e = 0; e < n; ++e) weights[e] = 0;
        for (size_t side = 0; side < size_t{3} * hierarchy->surface_triangles; ++side) {
            const size_t first = side - side % 3;
            const auto corner = [&](size_t k) {
                const uint32_t v = hierarchy->triangle_vertices[first + (side + k) % 3];
                return x + size_t{3} * hierarchy->vertex_internal[v];
            };
            weights[hierarchy->triangle_edges[side]] += 0.5 * cotangent(corner(2), corner(0), corner(1));
        }
        return HMF_OK;
    }
    for (uint32_t e = 0; e < n; ++e) {
        const uint32_t h = 2 * hierarchy->edge_internal[e], t = twin(h);
        const double* i = x + size_t{3} * mesh.origin[h];
        const double* j = x + size_t{3} * mesh.origin[t];
        weights[e] = 0.5
                   * (cotangent(x + size_t{3} * mesh.origin[mesh.prev(h)], i, j)
                      + cotangent(x + size_t{3} * mesh.origin[mesh.prev(t)], j, i));
    }
    return HMF_OK;
}

hmf_status hmf_level_positions(const hmf_hierarchy* hierarchy, size_t level, double* positions, size_t capacity,
                               hmf_error* error) {
    Entry entry(hierarchy, nullptr, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, static_cast<const void*>(positions)) || check_level(*hierarchy, level, call))
        return call.status();
    const Level& from = hierarchy->levels[level];
    const size_t n = hierarchy->shown_vertices(level);
    if (check_capacity(capacity, 3 * n, "positions", call)) return call.status();
    for (size_t v = 0; v < n; ++v) {
        const double* const at = from.position + 3 * (level == 0 ? size_t{hierarchy->vertex_internal[v]} : v);
        for (size_t c = 0; c < 3; ++c) positions[3 * v + c] = at[c] / hierarchy->scale;
    }
    return HMF_OK;
}

} // extern "C"
