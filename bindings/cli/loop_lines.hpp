// Loops as closed lines in space, for the picture.
#pragma once

#include <array>
#include <vector>

#include "potential.hpp"

namespace cli {

using Line = std::vector<std::array<double, 3>>; // closed

// Loops of the input mesh, straight but for corners where more than a half turn lies on both sides; those through
// vertices near where they lie.
std::vector<Line> loop_lines(const Foliation& foliation, const hmf_loop_set& loops);

} // namespace cli
