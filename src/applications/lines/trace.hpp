// Leaves in the form of hmf_trace.
#pragma once

#include "../parameterize/flat_cone_metric.hpp"
#include "conjugate_lines.hpp"

namespace hmf {

// The cylinders are those of the foliation. side: half-edge of side 0 of each triangle that points may lie in.
[[nodiscard]] hmf_status trace_leaves(const hmf_trace_options& all, const Array<uint32_t>& side, Cylinders& cylinders,
                                      Lines& made, Call& call);

// Of the conjugate.  flat: on the side of the caller, in units of `unit`.
// levels: of the foliation, in the same; only read with spacing.  g: room for
// |dv| on the mesh of that side, which the lines are made on.
[[nodiscard]] hmf_status trace_conjugate(Foliation& g, const double* position, const FlatConeMetric& flat, double unit,
                                         const hmf_trace_options& all, const Array<uint32_t>& side,
                                         const ConjugateLevels& levels, Lines& made, Call& call);

} // namespace hmf
