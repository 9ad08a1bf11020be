// hmf batch: solves every mesh of a folder.
#pragma once

#include <string>
#include <vector>

#include "failure.hpp"
#include "options.hpp"

namespace cli {

// One line of JSON for each mesh: its report, or what is wrong with it.  Meshes that have a line already are left out.
// Throws Failure.
ExitStatus batch(const std::vector<std::string>& words, const Describe* help);

} // namespace cli
