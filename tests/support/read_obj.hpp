// A small reader for OBJ: vertices and polygons (fanned), everything else is skipped.
#pragma once

#include <string>

#include "meshes.hpp"

namespace test {

// Number of "v" lines; 0 if the file cannot be read.
size_t count_obj_vertices(const std::string& path);

// False if the file cannot be read.  The genus is from Euler's formula.
bool read_obj(const std::string& path, TriMesh& mesh);

} // namespace test
