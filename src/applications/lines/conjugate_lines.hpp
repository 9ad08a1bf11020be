// Leaves of the conjugate foliation |dv|, which cross those of F at right angles.
#pragma once

#include "../common/cylinder_leaves.hpp"
#include "polyline.hpp"

namespace hmf {

// A closed leaf of F as places on edges that do not depend on its integers.
struct OnEdge {
    uint32_t half_edge; // crossed from left to right
    double fraction;    // from its origin
};

struct ConjugateLevels {
    Array<uint64_t> offsets; // per cylinder, + 1
    Array<OnEdge> middle;    // leaf in the middle
    Array<double> height;    // units
};
[[nodiscard]] hmf_status read_levels(const Foliation& f, const Cylinders& cylinders, ConjugateLevels& out, Call& call);

// Values of g: |dv|; du: |du|, both exact and every triangle flat in both.
//
// Lines across each cylinder from side to side, about `spacing` apart (units).
[[nodiscard]] hmf_status add_conjugate_levels(Lines& lines, const Foliation& g, const int64_t* du,
                                              const ConjugateLevels& levels, double spacing, double unit,
                                              const double* position, Call& call);

// Lines out of every prong of every zero of g.
[[nodiscard]] hmf_status add_conjugate_prongs(Lines& lines, Foliation& g, const double* position, Call& call);

} // namespace hmf
