// Whole numbers of quads along every arc of the critical graph and across every
// cylinder.
#pragma once

#include "cylinders.hpp"

namespace hmf {

// conjugate_length: of each arc side; step: the wished edge length, in the same
// unit as the heights of the cylinders.  columns: per arc side, the same for
// both sides of an arc, so that both boundaries of a cylinder have equally many,
// 0 where the zeros at both ends have to become one; rows: per cylinder.
[[nodiscard]] hmf_status quad_sizes(const Cylinders& cylinders, const Array<double>& conjugate_length, double step,
                                    Array<int64_t>& columns, Array<int64_t>& rows, Call& call);

} // namespace hmf
