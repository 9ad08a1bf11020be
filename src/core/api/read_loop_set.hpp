// The caller's loops, checked, as crossings with integer weights.
#pragma once

#include "../curves/loops.hpp"
#include "foliation_object.hpp"

namespace hmf {

struct WeightedLoops {
    size_t level = 0;
    Loops loops;            // on loop_mesh(level), pulled tight
    Array<int64_t> weights; // per loop, in units
    double unit = 1;
    Array<uint32_t> of;    // of a double: the caller's loop of each; else empty
    Array<int64_t> factor; // likewise: 2 for a loop around a boundary, else 1

    uint32_t callers(uint32_t loop) const { return loop < of.size() ? of[loop] : loop; }
};

// is_round: as in SurfaceLoops, if it is known, else NULL.
[[nodiscard]] hmf_status read_loop_set(const hmf_hierarchy& hierarchy, const hmf_loop_set* set, const uint8_t* is_round,
                                       WeightedLoops& out, Call& call);

// Weights of 1 for loops on a closed surface.
[[nodiscard]] hmf_status set_unit_weights(WeightedLoops& loops, Call& call);

} // namespace hmf
