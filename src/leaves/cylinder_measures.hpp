// What belongs to a cylinder at the minimum: circumference, modulus, area, and
// the loop whose class it fills.
#pragma once

#include "../../include/hmf/uses.h"
#include "../loops/loops.hpp"
#include "cylinder_classes.hpp"

namespace hmf {

// cylinders: of `foliation` on its level (level 0: the caller's side), with
// find_vertices done.  solved: the same foliation where it is solved, at
// the minimum; unit: of its values.  Fills circumference, modulus and area;
// heights are there.
[[nodiscard]] hmf_status measure_cylinders(const Foliation& foliation, const Cylinders& cylinders, State& solved,
                                           double unit, Array<hmf_cylinder>& out, Call& call);

// Fills out[c].loop.  loops: on `level`, with weights in units of loops_unit;
// unit: of the cylinders.
[[nodiscard]] hmf_status match_loops(const hmf_hierarchy& h, const State& state, const Cylinders& cylinders,
                                     double unit, size_t level, const Loops& loops, const Array<int64_t>& weights,
                                     double loops_unit, Array<hmf_cylinder>& out, Call& call);

} // namespace hmf
