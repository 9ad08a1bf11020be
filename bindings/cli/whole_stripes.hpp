// Whole numbers of stripes on each cylinder, whatever the weights.
#pragma once

#include <hmf/applications.h>

#include <cstdint>
#include <vector>

#include "potential.hpp"

namespace cli {

constexpr uint32_t CRITICAL = 0xffffffffu;

// Where a leaf crosses an edge.
struct Crossing {
    uint32_t edge;
    double at;         // from 0, its first vertex, to 1
    uint32_t cylinder; // whose middle leaf it is; or CRITICAL
};

// Where critical leaves and one leaf in the middle of each cylinder cross the edges.
// heights       of the cylinders; those of `lines` are added at the end
// whole_edges   in the foliation, of the edges that `lines` names; NULL: the same
void add_crossings(const Foliation& foliation, const hmf_lines& lines, const uint32_t* whole_edges,
                   std::vector<Crossing>& crossings, std::vector<double>& heights);

// One value for each edge: those of the foliation with the same leaves whose cylinders are as high as the nearest
// multiple of the period (at least one).  heights: of the cylinders.
std::vector<double> whole_stripes(const Foliation& foliation, std::vector<Crossing> crossings,
                                  const std::vector<double>& heights, double period);

} // namespace cli
