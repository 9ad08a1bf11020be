// Cylinders on a surface with boundary: those of its double, seen from in front.
#pragma once

#include "../../../include/hmf/applications.h"
#include "../../core/base/memory.hpp"

namespace hmf {

// Cylinders with the triangles of their middle leaves.
struct CylindersWithLeaves {
    Array<hmf_cylinder>& list;
    Array<uint64_t>& offsets; // list.size() + 1, into triangles
    Array<uint32_t>& triangles;
    Array<uint8_t>& is_arc; // made
};

// Leaves those of the caller's loops, which they were matched with, with the sizes that they have in front, where the
// surface has m triangles.  factor: as in WeightedLoops.
[[nodiscard]] hmf_status keep_front_cylinders(const hmf_loop_set& loops, const Array<int64_t>& factor, uint32_t m,
                                              CylindersWithLeaves cylinders, Call& call);

} // namespace hmf
