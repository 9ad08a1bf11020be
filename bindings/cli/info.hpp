// hmf info: is a mesh usable, and what is it like?
#pragma once

#include <string>

#include "prepare_mesh.hpp"

namespace cli {

struct InfoRequest {
    std::string mesh;
    bool json = false;
    MeshRequest prepare;
};

// Prints to standard output; throws Failure where no component of the mesh is usable.
void info(const InfoRequest& request);

} // namespace cli
