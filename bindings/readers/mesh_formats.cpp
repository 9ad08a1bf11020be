#include "mesh_formats.hpp"

#include <algorithm>

#include "byte_order.hpp"
#include "polygon.hpp"
#include "text_cursor.hpp"

namespace readers {

namespace {

// As programs for the Macintosh wrote them once.
bool has_old_line_ends(std::string_view bytes) {
    return bytes.find('\n') == bytes.npos && bytes.find('\r') != bytes.npos;
}

std::string with_line_feeds(std::string_view bytes) {
    std::string copy(bytes);
    std::replace(copy.begin(), copy.end(), '\r', '\n');
    return copy;
}

// By its byte order mark. Shells of Windows write such files.
bool is_utf_16(std::string_view bytes) { return bytes.substr(0, 2) == "\xff\xfe" || bytes.substr(0, 2) == "\xfe\xff"; }

} // namespace

const char* name_of(Format format) {
    switch (format) {
    case Format::obj: return "OBJ";
    case Format::off: return "OFF";
    case Format::ply: return "PLY";
    case Format::stl: return "STL";
    case Format::medit: return "Medit";
    case Format::gmsh: return "Gmsh";
    case Format::vtk: return "VTK";
    default: return "glTF";
    }
}

std::optional<Format> format_of_extension(std::string_view extension) {
    if (extension == ".obj") return Format::obj;
    if (extension == ".off") return Format::off;
    if (extension == ".ply") return Format::ply;
    if (extension == ".stl") return Format::stl;
    if (extension == ".mesh") return Format::medit;
    if (extension == ".msh") return Format::gmsh;
    if (extension == ".vtk") return Format::vtk;
    if (extension == ".gltf" || extension == ".glb") return Format::gltf;
    return {};
}

std::optional<Format> format_of_content(std::string_view bytes) {
    if (bytes.substr(0, 4) == "glTF") return Format::gltf;
    if (bytes.substr(0, 5) == "# vtk") return Format::vtk;
    std::string copy;
    if (has_old_line_ends(bytes.substr(0, 1u << 16))) bytes = copy = with_line_feeds(bytes.substr(0, 1u << 16));
    if (bytes.size() >= 84 && 84 + uint64_t{50} * load<uint32_t>(bytes.data() + 80) == bytes.size()) return Format::stl;
    const std::string_view start = bytes.substr(0, 1u << 16); // comments may come first
    TextCursor text(start);
    if (!text.more_lines()) return {};
    const std::string_view word = text.word();
    if (word == "ply") return Format::ply;
    if (word == "solid") return Format::stl;
    if (word[0] == '{') return Format::gltf;
    if (word == "MeshVersionFormatted") return Format::medit;
    if (word == "$MeshFormat") return Format::gmsh;
    if (word.size() <= 7 && word.size() >= 3 && word.substr(word.size() - 3) == "OFF") return Format::off;
    for (const char* statement : {"v", "vt", "vn", "o", "g", "s", "mtllib", "usemtl"})
        if (word == statement) return Format::obj;
    return {};
}

TriangleMesh read_mesh(std::string_view bytes, Format format, const Neighbor& neighbor) {
    if (bytes.empty()) throw MeshError("the file is empty");
    if (format != Format::stl && is_utf_16(bytes))
        throw MeshError("the text is in UTF-16, two bytes a character; save the file as UTF-8", 1);
    // A PLY may be binary behind its header.
    if (format == Format::ply && has_old_line_ends(bytes))
        throw MeshError("the lines end in carriage returns alone; save the file with line feeds", 1);
    std::string copy;
    const bool is_lines =
        format == Format::obj || format == Format::off || (format == Format::stl && is_stl_text(bytes));
    if (is_lines && has_old_line_ends(bytes)) bytes = copy = with_line_feeds(bytes);
    TriangleMesh mesh;
    switch (format) {
    case Format::obj: mesh = read_obj(bytes); break;
    case Format::off: mesh = read_off(bytes); break;
    case Format::ply: mesh = read_ply(bytes); break;
    case Format::stl: mesh = read_stl(bytes); break;
    case Format::gltf: mesh = read_gltf(bytes, neighbor); break;
    case Format::medit: mesh = read_medit(bytes); break;
    case Format::gmsh: mesh = read_gmsh(bytes); break;
    case Format::vtk: mesh = read_vtk(bytes); break;
    }
    if (mesh.positions.empty() || mesh.triangles.empty())
        throw MeshError("the file has no "
                        + std::string(format == Format::gltf   ? "triangles"
                                      : mesh.positions.empty() ? "vertices"
                                                               : "faces")
                        + "; is it " + name_of(format) + "?" + (mesh.notes.empty() ? "" : " (" + mesh.notes[0] + ")"));
    if (mesh.vertex_count() > 0x7fffffff || mesh.triangle_count() > 0x7fffffff)
        throw MeshError("the mesh has more than 2^31 vertices or triangles; divide it");
    triangulate_polygons(mesh);
    return mesh;
}

} // namespace readers
