// Triangle meshes from files.
#pragma once

#include <string>

#include "../readers/mesh_formats.hpp"

namespace cli {

using readers::TriangleMesh;

// In sentences.
std::string shown(const std::string& path);

// The whole file, "-" standard input; throws Failure(EXIT_RESOURCES) when it cannot be read.
std::string read_file(const std::string& path);

// See readers::read_mesh.  The extension says the format; where there is none, the content.  Throws Failure.
TriangleMesh read_mesh(const std::string& path);

// Lower-case extension with its dot, or "".
std::string extension_of(const std::string& path);
// Of a mesh: ".obj" also of "a.obj.gz".
std::string mesh_extension(const std::string& path);

} // namespace cli
