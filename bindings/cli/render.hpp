// A picture of a foliation: stripes along the leaves, zeros blue, poles yellow.
#pragma once

#include <cstdint>
#include <vector>

#include "potential.hpp"

namespace cli {

struct Image {
    unsigned width = 0, height = 0;
    std::vector<uint8_t> rgb; // 3 per pixel, rows from the top
};

Image render(const Foliation& foliation, const Potential& potential);

} // namespace cli
