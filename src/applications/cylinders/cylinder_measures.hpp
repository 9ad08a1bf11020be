// Measures of a cylinder at the minimum: circumference, modulus, area, twist, and the loop of its class.
//
// Cylinders of the caller's triangulation, of the intrinsic one, and loops are matched by their free homotopy classes
// (curve_classes.hpp), on the surface without its marked vertices.
#pragma once

#include "../../../include/hmf/applications.h"
#include "../../core/curves/loops.hpp"
#include "../common/cylinder_leaves.hpp"
#include "../../core/solve/state.hpp"

namespace hmf {

// A foliation on its level (level 0: the caller's side) and its cylinders.
struct GivenCylinders {
    const State& state;
    Cylinders& cylinders;
    double unit; // of the values
};

struct Twists { // as in hmf_cylinder_set
    Array<double> twist, places;
    Array<uint64_t> offsets;
    Array<uint32_t> vertices;
};

// On a closed surface.  found: per entry of list its number in `measured`, the cylinders of the solved foliation.  The
// circumferences in list are there.
[[nodiscard]] hmf_status measure_twists(const State& solved, const Cylinders& measured, const Array<uint32_t>& found,
                                        const Array<hmf_cylinder>& list, double unit, Twists& out, Call& call);

// Fills circumference, modulus and area, loop unless loops is NULL, and twists unless that is NULL.
// solved: the same foliation where it is solved, at the minimum; unit: of its
// values.  The heights in out are there.
[[nodiscard]] hmf_status measure_cylinders(const GivenCylinders& given, const WeightedLoops* loops, State& solved,
                                           double unit, Array<hmf_cylinder>& out, Twists* twists, Call& call);

} // namespace hmf
