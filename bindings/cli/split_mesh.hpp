// The components of a mesh, one by one.
#pragma once

#include <string>
#include <vector>

#include "read_mesh.hpp"

namespace cli {

// A component; its vertices and triangles have the order that they have in the whole mesh.
struct MeshPart {
    TriangleMesh mesh;
    std::vector<uint32_t> vertices;  // of each vertex of it: the number in the whole mesh
    std::vector<uint32_t> triangles; // likewise
};

// The components; the only one takes the mesh as it is, whatever is wrong with it, without numbers of vertices and
// triangles.  All vertices belong to triangles.  Throws Failure.
std::vector<MeshPart> split_mesh(TriangleMesh& mesh, const std::string& mesh_name);

// In sentences.
std::string name_of_component(const MeshPart& part, size_t number);

} // namespace cli
