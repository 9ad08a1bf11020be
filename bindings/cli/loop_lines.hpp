// Loops as closed lines in space, for the picture.
#pragma once

#include <array>
#include <vector>

#include "potential.hpp"

namespace cli {

using Line = std::vector<std::array<double, 3>>; // closed

// Loops of the input mesh: through their vertices, or the shortest closed curve in the strip of their triangles.
std::vector<Line> loop_lines(const Foliation& foliation, const hmf_loop_set& loops);

} // namespace cli
