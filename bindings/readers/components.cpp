#include "components.hpp"

#include "mesh_sides.hpp"

namespace readers {

namespace {} // namespace

std::vector<uint32_t> component_of_triangles(const std::vector<uint32_t>& triangles, size_t vertex_count) {
    Classes parts(vertex_count);
    for (size_t k = 0; k < triangles.size(); k += 3) {
        parts.unite(triangles[k], triangles[k + 1]);
        parts.unite(triangles[k], triangles[k + 2]);
    }
    std::vector<uint32_t> number(vertex_count, NONE), component(triangles.size() / 3);
    uint32_t count = 0;
    for (size_t t = 0; t < component.size(); ++t) {
        uint32_t& n = number[parts.of(triangles[3 * t])];
        if (n == NONE) n = count++;
        component[t] = n;
    }
    return component;
}

Edges edges_of(const TriangleMesh& mesh) {
    const Groups sides = group_sides(mesh.triangles, mesh.vertex_count());
    Edges edges;
    edges.triangles.resize(mesh.triangles.size());
    std::vector<uint32_t> group(mesh.triangles.size()), number(sides.count(), NONE);
    for (uint32_t g = 0; g < sides.count(); ++g)
        for (const uint32_t* side = sides.begin_of(g); side != sides.end_of(g); ++side) group[*side] = g;
    for (uint32_t side = 0; side < group.size(); ++side) {
        uint32_t& n = number[group[side]];
        if (n == NONE) {
            n = static_cast<uint32_t>(edges.count());
            edges.vertices.insert(edges.vertices.end(), {mesh.triangles[side], mesh.triangles[next_corner(side)]});
        }
        edges.triangles[side] = n;
    }
    return edges;
}

size_t boundary_count(const TriangleMesh& mesh) {
    const Groups sides = group_sides(mesh.triangles, mesh.vertex_count());
    Classes chains(mesh.vertex_count());
    std::vector<uint8_t> has_boundary(mesh.vertex_count(), 0);
    for (size_t g = 0; g < sides.count(); ++g) {
        if (sides.size_of(g) != 1) continue;
        const uint32_t side = *sides.begin_of(g), from = mesh.triangles[side], to = mesh.triangles[next_corner(side)];
        chains.unite(from, to);
        has_boundary[from] = has_boundary[to] = 1;
    }
    size_t count = 0;
    for (uint32_t v = 0; v < has_boundary.size(); ++v) count += has_boundary[v] && chains.of(v) == v;
    return count;
}

} // namespace readers
