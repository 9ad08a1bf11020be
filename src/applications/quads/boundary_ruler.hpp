// A line along leaves of a double that may run on the boundary of the surface.
#pragma once

#include "quad_input.hpp"

namespace hmf {

class BoundaryRuler : public Ruler {
public:
    // A vertex of the boundary, with those that lie between the one before and it: past parts that no leaf
    // crosses.  ahead: the line runs with the front on its left; round: once round, if it is the same vertex.
    // Other vertices are left out.
    Done push_on_boundary(const QuadInput& in, double value, uint32_t vertex, bool ahead, bool round = false);

private:
    uint32_t last_ = NONE; // vertex of the boundary
};

} // namespace hmf
