// Length of a loop: for each edge that it crosses, from the center of one
// triangle over the middle of the edge to the center of the other.
//
//     a---b---c     The center is that of the sides, not of the corners: a strip
//      \ / \ /      across thin triangles, up and down by turns, is straight
//       d---e       then, not a zig-zag of a third of their length.
#pragma once

#include "../../core/mesh/mesh.hpp"

namespace hmf {

class DualLength {
public:
    // position: 3 per vertex.
    DualLength(const Mesh& mesh, const double* position);

    // In units of the largest coordinate.
    double operator()(uint32_t edge) const;

private:
    double from_middle(uint32_t half_edge) const;

    const Mesh& mesh_;
    const double* position_;
    double largest_ = 0;
};

} // namespace hmf
