// The loops that the library makes on a surface with boundary, as loops and arcs
// of triangles of the caller.
#pragma once

#include "../../../include/hmf/applications.h"
#include "../../core/hierarchy/hierarchy.hpp"

namespace hmf {

struct FoundLoops {
    Array<uint64_t> offsets;
    Array<uint32_t> triangles; // in the caller's numbers
    Array<uint8_t> arcs;
    Array<uint32_t> arc_sides; // two per loop, as in hmf_loop_set
    Array<uint8_t> is_round;   // a boundary without marked vertices, and nothing else; see double_loops.hpp
    size_t count() const { return arcs.size(); }
    hmf_loop_set set() const {
        return {sizeof(hmf_loop_set), HMF_PATH_TRIANGLES, 0, count(), offsets.data(), triangles.data(), nullptr,
                arcs.data(),          arc_sides.data()};
    }
};

// kind: HMF_LOOPS_CUT or HMF_LOOPS_PANTS; others are refused.
[[nodiscard]] hmf_status surface_loops(const hmf_hierarchy& hierarchy, int32_t kind, Call& call, FoundLoops& out);

} // namespace hmf
