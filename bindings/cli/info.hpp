// hmf info: is a mesh usable, and what is it like?
#pragma once

#include <string>

namespace cli {

struct InfoRequest {
    std::string mesh;
    bool json = false;
    bool repairs = false, joins = false;
};

// Prints to standard output; throws Failure where no component of the mesh is usable.
void info(const InfoRequest& request);

} // namespace cli
