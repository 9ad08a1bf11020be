// Cylinders on a surface with boundary: those of its double, seen from in front.
#pragma once

#include "../../../include/hmf/applications.h"
#include "../../core/base/memory.hpp"

namespace hmf {

// The caller's loops, which the cylinders were matched with.
struct FrontLoops {
    uint64_t count;
    const uint8_t* is_arc;        // per loop; NULL: none is
    const Array<int64_t>& factor; // per loop: 2 around a boundary, else 1
    uint32_t triangles_in_front;
};

// Cylinders with the triangles of their middle leaves.
struct CylindersWithLeaves {
    Array<hmf_cylinder>& list;
    Array<uint64_t>& offsets; // list.size() + 1, into triangles
    Array<uint32_t>& triangles;
    Array<uint8_t>& is_arc; // made
};

// Leaves those of the caller's loops, with the sizes that they have in front.
[[nodiscard]] hmf_status keep_front_cylinders(const FrontLoops& loops, CylindersWithLeaves cylinders, Call& call);

} // namespace hmf
