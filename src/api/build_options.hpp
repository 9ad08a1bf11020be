// The build options of the caller.
#pragma once

#include "entry.hpp"

namespace hmf {

// The options with all defaults in place; false: they are unusable, and `all` names no allocator.
bool read_build_options(const hmf_build_options* from, hmf_build_options& all, BuildOptions& options);
hmf_status refuse_build_options(Call& call);

} // namespace hmf
