// The caller's loops, checked, as crossings with integer weights.
#pragma once

#include "../loops/library_loops.hpp"
#include "foliation_object.hpp"

namespace hmf {

struct WeightedLoops {
    size_t level = 0;
    Loops loops;            // on loop_mesh(level), pulled tight
    Array<int64_t> weights; // per loop, in units
    double unit = 1;
    Array<uint32_t> of; // of a double: the caller's loop of each; else empty

    uint32_t callers(uint32_t loop) const { return loop < of.size() ? of[loop] : loop; }
};

// set NULL: the library's cut system on level `own`, weights 1.
[[nodiscard]] hmf_status read_loop_set(const hmf_hierarchy& hierarchy, const hmf_loop_set* set, size_t own,
                                       WeightedLoops& out, Call& call);

} // namespace hmf
