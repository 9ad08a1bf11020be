// hmf info: is a mesh usable, and what is it like?
#pragma once

#include <string>

namespace cli {

// Prints to standard output; throws Failure where the mesh is refused.
void info(const std::string& path, bool json);

} // namespace cli
