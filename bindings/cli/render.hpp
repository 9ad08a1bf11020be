// A picture of a foliation: stripes along the leaves or squares of the
// parameterisation, zeros blue, poles yellow, loops green.
#pragma once

#include <cstdint>
#include <vector>

#include "library.hpp"
#include "loop_lines.hpp"
#include "potential.hpp"

namespace cli {

struct Image {
    unsigned width = 0, height = 0;
    std::vector<uint8_t> rgb; // 3 per pixel, rows from the top
};

// Period of the stripes: about 22 pairs along the size of the object.
double pattern_period(const Foliation& foliation, const Potential& potential);

// corner_uv: squares of the (u, v) of each corner in place of the stripes; NULL: stripes.  Components without a
// foliation are grey.
Image render(const Foliation& foliation, const Potential& potential, const double* corner_uv,
             const std::vector<Line>& loops);

} // namespace cli
