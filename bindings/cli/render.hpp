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

// checkerboard: squares of (u, v) in place of the stripes; NULL: stripes.
Image render(const Foliation& foliation, const Potential& potential, const hmf_parameterization* checkerboard,
             const std::vector<Line>& loops);

} // namespace cli
