// Length of a loop: for each edge that it crosses, from the centre of one
// triangle over the middle of the edge to the centre of the other.
#pragma once

#include "../mesh/mesh.hpp"

namespace hmf {

class DualLength {
public:
    // position: 3 per vertex.
    DualLength(const Mesh& mesh, const double* position);

    // In units of the largest coordinate.  Eight times as long where two faces
    // share several edges: a loop of triangles does not say which of them it
    // crosses, so such edges are avoided.
    double operator()(uint32_t edge) const;

private:
    const Mesh& mesh_;
    const double* position_;
    double largest_ = 0;
};

} // namespace hmf
