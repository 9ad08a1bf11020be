// Loops and arcs of a surface with boundary, as loops of its double:
//
//     closed loop c         ->  c and its mirror image, or, if these two bound an
//                               annulus (c goes around one boundary), c alone with
//                               twice the weight: leaves run along that boundary
//     arc a, boundary to    ->  a and back along its mirror image: leaves meet
//     boundary                  the boundary at right angles
//
// The result begins with the loops of the caller, in their order; their mirror images follow.
#pragma once

#include "../hierarchy/hierarchy.hpp"
#include "loops.hpp"

namespace hmf {

struct SurfaceLoops {
    int32_t element_kind; // HMF_PATH_*
    size_t count;
    const uint64_t* offsets;
    const uint32_t* elements;  // in the caller's numbers of level 0
    const uint8_t* arcs;       // per loop, or NULL: none is an arc
    const uint32_t* arc_sides; // two per loop, as in hmf_loop_set, or NULL
    const uint8_t* is_round;   // per loop, if that is known: it bounds an annulus with its mirror image
};

struct DoubledLoops {
    Loops loops;             // on the input side of level 0
    Array<uint32_t> of;      // per loop of the double: that of the caller
    Array<int64_t> factor;   // likewise, of its weight: 1 or 2
    Array<uint64_t> offsets; // with `elements` what a message may name: the caller's elements
    Array<uint32_t> elements;
};

[[nodiscard]] hmf_status double_loops(const hmf_hierarchy& hierarchy, const SurfaceLoops& given, Call& call,
                                      DoubledLoops& out);

} // namespace hmf
