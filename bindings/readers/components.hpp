// What a triangle mesh is made of: components, edges, boundaries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh_formats.hpp"

namespace readers {

// The component of each triangle, numbered in the order in which they come; triangles that share a vertex are in one.
// Linear time.
std::vector<uint32_t> component_of_triangles(const std::vector<uint32_t>& triangles, size_t vertex_count);

// The edges of a mesh, numbered by their first appearance in the triangle array, as hmf numbers them on level 0: so the
// edges of a component have the order that they have in the whole mesh.
struct Edges {
    std::vector<uint32_t> vertices;  // 2 per edge, in the order of that first side
    std::vector<uint32_t> triangles; // 3 per triangle; side s joins corners s and s + 1
    size_t count() const { return vertices.size() / 2; }
};
Edges edges_of(const TriangleMesh& mesh);

// Chains of edges with one triangle; where two touch they count as one.
size_t boundary_count(const TriangleMesh& mesh);

} // namespace readers
