// The local potential u of a foliation: |u_i - u_j| = F_ij in each triangle.
#pragma once

#include <hmf/hmf.h>

#include <array>
#include <cstdint>
#include <vector>

namespace cli {

// A foliation on the input mesh, as flat arrays in the numbering of level 0.
struct Foliation {
    std::vector<double> positions;         // 3 per vertex
    std::vector<uint32_t> triangles;       // 3 per triangle
    std::vector<uint32_t> triangle_edges;  // 3 per triangle; side s joins corners s and s+1
    std::vector<uint32_t> edge_vertices;   // 2 per edge
    std::vector<double> values;            // F, 1 per edge
    std::vector<hmf_singularity> singular; // zeros and poles
    std::vector<double> loop_weights;      // all > 0
    std::vector<double> stripe_values;     // values with the same leaves that the stripes follow; empty: F
    std::vector<uint32_t> component;       // of each triangle; empty: all are one
    std::vector<uint8_t> is_bare;          // of each component, where there are several: without a foliation
    bool is_bare_at(size_t t) const { return !component.empty() && is_bare[component[t]]; }
    size_t triangle_count() const { return triangles.size() / 3; }
};

enum class Piece : uint8_t {
    linear, // the corners lie on a segment of the tree; u is linear
    tripod, // u[c] is the distance of corner c from the branch point
    zero,   // all three corners are one point of the tree
};

struct Potential {
    std::vector<std::array<double, 3>> u;
    std::vector<Piece> piece;
    double period = 1; // that u has been reduced by
};

// u is 0 at the zeros.  An even function of u with this period is continuous on the surface if it divides the weights
// of the values that the stripes follow.
Potential local_potential(const Foliation& foliation, double period);

// About 22 pairs of stripes along the size of the object.  The root mean square of the gradient: unlike the mean it
// does not fall much where limbs without leaves make up most of the area.
double wanted_period(const Foliation& foliation);

// The period nearest to the wanted one that divides all weights, so that an even pattern has no seams; 0 if there is
// none near it.
double common_period(const std::vector<double>& weights, double wanted);

} // namespace cli
