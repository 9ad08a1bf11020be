// Leaves as the caller asks for them (hmf_trace).
#pragma once

#include "conjugate_lines.hpp"

namespace hmf {

// Of the foliation, whose cylinders are given.  side: half-edge of side 0 of
// each triangle that points may lie in.
hmf_status trace_leaves(const hmf_trace_options& all, const Array<uint32_t>& side, Cylinders& cylinders, Lines& made,
                        Call& call);

// Of the conjugate.  levels: of the foliation, in units of `unit`; only read
// with spacing.  state: where the foliation is solved, ends on the caller's side
// with the values |dv|.  made: lines of state.foliation.
hmf_status trace_conjugate(State& state, double unit, const hmf_trace_options& all, const Array<uint32_t>& side,
                           ConjugateLevels& levels, Lines& made, Call& call);

} // namespace hmf
