// Repairs of a triangle mesh that lose nothing: the same triangles at the same places afterwards, joined in a way that
// is a surface where that is possible.
//
// Only indices decide, and where points are joined a distance.  Linear time but for edges with many triangles, and for
// points that crowd within the distance of others without being joined.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mesh_formats.hpp"

namespace readers {

// The repairs made, in this order, and the remaining defects.
struct Repairs {
    size_t joined_vertices = 0;   // became one with another vertex at the same point, or in reach
    size_t repeated_vertex = 0;   // triangles dropped: they name one vertex twice
    size_t duplicates = 0;        // triangles dropped: an earlier one has the same corners in the same sense
    size_t back_sides = 0;        // triangles dropped: an earlier one has the same corners in the other sense
    size_t split_vertices = 0;    // had several fans of triangles, and became as many
    size_t cut_edges = 0;         // had three or more triangles that nothing pairs: all came apart there
    size_t turned_triangles = 0;  // as their patch turns the other way
    size_t unused_vertices = 0;   // dropped
    size_t crowded_edges = 0;     // left: with three or more triangles all the same; rare
    size_t one_sided_patches = 0; // left: they have no orientation

    std::vector<uint32_t> vertices;  // of each vertex: its number before
    std::vector<uint32_t> triangles; // of each triangle: its number before

    size_t count() const {
        return joined_vertices + repeated_vertex + duplicates + back_sides + split_vertices + cut_edges
             + turned_triangles + unused_vertices;
    }
    // One sentence for each kind of repair made, then for the remaining defects.
    std::vector<std::string> sentences() const;
};

// Repairs the mesh.
//
//   join points   (asked for) vertices at the same point count as one from here on, where triangles meet there; so do
//                 those that are not further apart than the distance, and those that are joined by others between them
//   drop          triangles that name a vertex twice, or repeat an earlier one; the back sides of sheets that are
//                 listed from both sides, where a plain sheet remains
//   pair sides    two triangles at an edge are neighbors.  Of three and more those are that have the same vertices
//                 before points were joined; then those that belong to one patch; then those that one fan of neighbors
//                 begins and ends with; then two that remain.  Three or more that remain come apart
//   split         a vertex becomes one for each fan of neighbors: sheets that touch in a vertex or an edge come apart
//   turn          in each patch the fewer triangles, so that all neighbors turn the same way
//   drop          vertices without a triangle
//
// Vertices and triangles keep their order; what was split off comes last.  A mesh without a defect stays as it is.
Repairs repair(TriangleMesh& mesh, std::optional<double> join_points = {});

// Drops the vertices without a triangle; returns their number.
size_t drop_unused_vertices(TriangleMesh& mesh);

} // namespace readers
