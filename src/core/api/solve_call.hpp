// Code shared by the calls that solve, with loops of the caller or of the library.
#pragma once

#include "read_loop_set.hpp"

namespace hmf {

// The solve options with all defaults in place.
[[nodiscard]] hmf_status read_solve_options(const hmf_solve_options* from, const hmf_hierarchy& h,
                                            SolveOptions& options, Call& call);

// The level on which a solve starts: the coarsest one, to which loops and foliations of finer levels are restricted.
size_t first_level(const hmf_hierarchy& h, const SolveOptions& options);

// The harmonic foliation of loops.
[[nodiscard]] hmf_status solve_loops(const hmf_hierarchy& h, const WeightedLoops& loops, const SolveOptions& options,
                                     Call& call, hmf_foliation** out);

} // namespace hmf
