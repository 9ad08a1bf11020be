// hmf.h: what a hierarchy consists of.
#include "../mesh/weights.hpp"
#include "result.hpp"

using namespace hmf;

namespace {

// Level 0: the caller's triangles, or the original sheet of a double.
void write_input(const hmf_hierarchy& h, uint32_t* edge_vertices, uint32_t* triangle_vertices,
                 uint32_t* triangle_edges) {
    const size_t sides = size_t{3} * h.surface_triangles;
    std::memcpy(triangle_vertices, h.triangle_vertices, sides * sizeof(uint32_t));
    std::memcpy(triangle_edges, h.triangle_edges, sides * sizeof(uint32_t));
    for (size_t t = h.surface_triangles; t-- > 0;) // the first triangle decides the order
        for (size_t s = 3; s-- > 0;) {
            const size_t e = h.triangle_edges[3 * t + s];
            edge_vertices[2 * e] = h.triangle_vertices[3 * t + s];
            edge_vertices[2 * e + 1] = h.triangle_vertices[3 * t + (s + 1) % 3];
        }
}

// Half the cotangents on level 0, triangle by triangle: an edge of the boundary has one.
void write_input_weights(const hmf_hierarchy& h, double* weights) {
    const double* const x = h.levels[0].position;
    for (uint32_t e = 0; e < h.surface_edges; ++e) weights[e] = 0;
    for (size_t side = 0; side < size_t{3} * h.surface_triangles; ++side) {
        const size_t first = side - side % 3;
        const auto corner = [&](size_t k) {
            return x + size_t{3} * h.vertex_internal[h.triangle_vertices[first + (side + k) % 3]];
        };
        weights[h.triangle_edges[side]] += 0.5 * cotangent(corner(2), corner(0), corner(1));
    }
}

void write_faces(const Mesh& mesh, uint32_t* triangle_vertices, uint32_t* triangle_edges) {
    for_each_face(mesh, 0, 2 * mesh.edge_count, [&](uint32_t a, uint32_t b, uint32_t c) {
        const uint32_t side[3] = {a, b, c};
        for (size_t s = 0; s < 3; ++s) {
            triangle_vertices[size_t{3} * mesh.face[a] + s] = mesh.origin[side[s]];
            triangle_edges[size_t{3} * mesh.face[a] + s] = edge_of(side[s]);
        }
    });
}

} // namespace

extern "C" {

const hmf_hierarchy_info* hmf_hierarchy_describe(const hmf_hierarchy* hierarchy) {
    return hierarchy ? &hierarchy->info : nullptr;
}

hmf_status hmf_level(const hmf_hierarchy* hierarchy, size_t level, const hmf_control* control, hmf_level_mesh** out,
                     hmf_error* error) {
    Entry entry(hierarchy, control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, out) || check_level(*hierarchy, level, call)) return call.status();
    const hmf_hierarchy& h = *hierarchy;
    const Level& from = h.levels[level];
    hmf_level_mesh result{};
    result.struct_size = sizeof result;
    const size_t V = result.vertex_count = h.shown_vertices(level), E = result.edge_count = h.shown_edges(level),
                 T = result.triangle_count = h.shown_triangles(level);
    if (!call.tick(0)) return call.was_cancelled();
    ResultBlock block;
    block.room(result, result.positions, 3 * V);
    block.array(result, result.edge_vertices, 2 * E, level > 0 ? from.mesh.origin : nullptr);
    block.room(result, result.triangle_vertices, 3 * T);
    block.room(result, result.triangle_edges, 3 * T);
    block.array(result, result.weights, E, level > 0 ? from.weight : nullptr);
    hmf_level_mesh* const made = block.make(result, h, call);
    if (!made) return call.status();
    double* const positions = fill(made->positions);
    for (size_t v = 0; v < V; ++v) {
        const double* const at = from.position + 3 * (level == 0 ? size_t{h.vertex_internal[v]} : v);
        for (size_t c = 0; c < 3; ++c) positions[3 * v + c] = at[c] / h.scale;
    }
    if (level == 0) {
        write_input(h, fill(made->edge_vertices), fill(made->triangle_vertices), fill(made->triangle_edges));
        write_input_weights(h, fill(made->weights));
    } else {
        write_faces(from.mesh, fill(made->triangle_vertices), fill(made->triangle_edges));
    }
    *out = made;
    return entry.end();
}

} // extern "C"
