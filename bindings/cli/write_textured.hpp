// The mesh with texture coordinates (u, v) / period.  corner_uv: (u, v) of each corner.  All throw
// Failure(EXIT_RESOURCES) when the disk refuses.
#pragma once

#include <string>

#include "potential.hpp"

namespace cli {

// FILE.mtl and FILE.png (tiles x tiles tiles of a checkerboard) beside it.
void write_textured_obj(const std::string& path, const Foliation& foliation, const double* corner_uv, double period,
                        unsigned tiles = 1);
// Binary, with s and t of each vertex; a vertex on a seam is there once for each of its (u, v).
void write_textured_ply(const std::string& path, const Foliation& foliation, const double* corner_uv, double period);
// glTF 2.0 in one file, with the tiles; single precision relative to the node, vertices as in the PLY.
void write_textured_glb(const std::string& path, const Foliation& foliation, const double* corner_uv, double period,
                        unsigned tiles = 1);

} // namespace cli
