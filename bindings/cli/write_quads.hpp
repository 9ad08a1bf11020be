// Quad meshes as files.
#pragma once

#include <string>
#include <vector>

#include "library.hpp"

namespace cli {

// All components in one file, by its extension: .obj, .ply (binary), .off; .glb, which knows no quads, as two
// triangles each, cut along the shorter diagonal, in single precision relative to the node.  Throws Failure.
void write_quads(const std::string& path, const std::vector<Owned<hmf_quad_mesh>>& components);

} // namespace cli
