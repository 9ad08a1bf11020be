// The first steps of every command: reading the mesh, the requested repairs, notes and warnings.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "../readers/repair.hpp"
#include "options.hpp"
#include "read_mesh.hpp"

namespace cli {

constexpr const char* MESH_FILES = ".obj .off .ply .stl .gltf .glb .mesh .msh .vtk, also .gz, or - for standard input";

struct MeshRequest {
    bool repairs = false;        // repairs that lose nothing
    std::optional<double> joins; // points that are not further apart
    uint64_t fills = 0;          // holes of at most so many edges
    bool closed = false;         // a boundary is refused
};
// Rows of the tables of every command that reads a mesh.
Options mesh_options(MeshRequest& request);

struct PreparedMesh {
    TriangleMesh mesh;
    readers::Repairs repairs;
    size_t dropped = 0, filled = 0; // vertices without a triangle; holes
    size_t doubled = 0;             // vertices on boundaries that lie at points of others
    std::vector<std::string> warnings;
    bool is_changed() const { return repairs.count() + dropped + filled > 0; }
    // One for each kind of repair.
    std::vector<std::string> sentences() const;
};

// Says on standard error what was done and what looks wrong.  Throws Failure.
PreparedMesh prepare_mesh(const std::string& path, const MeshRequest& request);

} // namespace cli
