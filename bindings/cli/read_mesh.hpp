// Triangle meshes from files: .obj .off .ply .stl.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cli {

struct TriangleMesh {
    std::vector<double> positions;   // 3 per vertex, in the order of the file
    std::vector<uint32_t> triangles; // 3 per triangle; polygons become fans from their first corner
    size_t vertex_count() const { return positions.size() / 3; }
    size_t triangle_count() const { return triangles.size() / 3; }
};

// The whole file; throws Failure(EXIT_RESOURCES) when it cannot be read.
std::string read_file(const std::string& path);

// Keeps vertices and triangles as they are in the file; only in .stl, which
// has no vertices of its own, equal points become one vertex.  Throws Failure.
TriangleMesh read_mesh(const std::string& path);

// Lower-case extension with its dot, or "".
std::string extension_of(const std::string& path);

} // namespace cli
