// Loops as closed lines in space, for the picture.
#pragma once

#include <array>
#include <vector>

#include "potential.hpp"

namespace cli {

using Line = std::vector<std::array<double, 3>>; // closed

// Loops of the input mesh: through their vertices, or through the middles of
// the edges that their triangles share, smoothed a little.
std::vector<Line> loop_lines(const Foliation& foliation, const hmf_loop_set& loops);

} // namespace cli
