// Boundaries of a triangle mesh: how long they are, which could be joined, and small holes filled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh_formats.hpp"

namespace readers {

// A closed path along edges with one triangle.
struct Hole {
    std::vector<uint32_t> vertices; // in the order in which a triangle that closes it goes around
    double length = 0;
};

// All of them, by their first side in the triangle array.  Where several touch in a vertex each is a path of its own.
// Sides that no path closes, as of patches that turn against each other, are in none.
std::vector<Hole> holes_of(const TriangleMesh& mesh);

// Vertices on boundaries that lie at the point of an earlier one there, as at seams of a texture.
size_t doubled_boundary_vertices(const TriangleMesh& mesh);

// Closes every hole of at most so many edges: by a polygon, or where a diagonal is an edge already, by a new vertex in
// the middle.  A triangle alone stays.  Returns how many; new elements come last.
size_t fill_holes(TriangleMesh& mesh, size_t most_edges);

} // namespace readers
