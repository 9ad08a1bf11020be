// Triangle meshes from the bytes of a file: OBJ, OFF, PLY, STL, glTF, Medit, Gmsh, legacy VTK.
//
// Who calls has the bytes already, from a file, a pipe or a network.  Memory and time are bounded by their number,
// whatever a header says.  Nothing but the standard library is needed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "origin.hpp"

namespace readers {

constexpr uint32_t NONE = UINT32_MAX; // no vertex, triangle or side

struct TriangleMesh {
    std::vector<double> positions;   // 3 per vertex, in the order of the file, all finite
    std::vector<uint32_t> triangles; // 3 per triangle; polygons are cut as polygon.hpp says
    Origin origin;                   // of a mesh as it was read
    std::vector<std::string> notes;  // a sentence for each kind of statement that was skipped or set right
    size_t vertex_count() const { return positions.size() / 3; }
    size_t triangle_count() const { return triangles.size() / 3; }
};

// What is wrong with a file and what to do, as one sentence.
struct MeshError : std::runtime_error {
    size_t line; // of a text, from 1; 0: the sentence says where
    explicit MeshError(const std::string& sentence, size_t at_line = 0) : std::runtime_error(sentence), line(at_line) {}
};

enum class Format { obj, off, ply, stl, gltf, medit, gmsh, vtk };
const char* name_of(Format format);

// The extensions in sentences.
constexpr const char* KNOWN_EXTENSIONS = ".obj, .off, .ply, .stl, .gltf, .glb, .mesh, .msh or .vtk";

// extension: in lower case, with its dot.
std::optional<Format> format_of_extension(std::string_view extension);
std::optional<Format> format_of_content(std::string_view bytes);

// A .gltf may name other files with its numbers.  Gives the bytes of the one with that name beside it; they have to
// stay until the mesh is read.
using Neighbor = std::function<std::string_view(const std::string& name)>;

// Keeps vertices and triangles as they are in the file.  Two formats differ: STL has no vertices of its own, and glTF
// splits them where a texture or a normal breaks; there equal points become one vertex.  Throws MeshError.
TriangleMesh read_mesh(std::string_view bytes, Format format, const Neighbor& neighbor = nullptr);

TriangleMesh read_obj(std::string_view text);
TriangleMesh read_off(std::string_view text);
TriangleMesh read_ply(std::string_view bytes);
TriangleMesh read_stl(std::string_view bytes);
bool is_stl_text(std::string_view bytes);
TriangleMesh read_gltf(std::string_view bytes, const Neighbor& neighbor);
TriangleMesh read_medit(std::string_view text);
TriangleMesh read_gmsh(std::string_view text);
TriangleMesh read_vtk(std::string_view text);

} // namespace readers
