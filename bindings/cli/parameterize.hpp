// The global parameterisation of a foliation, for files and pictures.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "../../include/hmf/hmf.h"
#include "potential.hpp"

namespace cli {

struct Parameterization {
    std::vector<double> corner_uv;  // 2 per corner, 6 per triangle
    hmf_parameterization numbers{}; // statistics; its arrays are gone
};

// Throws Failure.
Parameterization parameterize(const hmf_hierarchy* hierarchy, const Foliation& foliation, hmf_progress_fn progress,
                              void* progress_user, const std::string& name);

} // namespace cli
