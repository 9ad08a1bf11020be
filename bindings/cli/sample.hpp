// The built-in sample of `hmf demo`.
#pragma once

#include "read_mesh.hpp"

namespace cli {

// A smooth surface of genus 3 with about 20 thousand vertices.
TriangleMesh make_sample();

} // namespace cli
