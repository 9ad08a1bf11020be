// From a parameterization by internal numbers to the arrays of the caller.
#pragma once

#include "../../../include/hmf/applications.h"
#include "../parameterize/parameterization.hpp"
#include "../../core/api/foliation_object.hpp"

namespace hmf {

// The triangles of the caller by internal faces: half-edge of side 0, and number.
struct CallerTriangles {
    struct Of {
        uint32_t side, triangle;
    };
    Array<Of> of_face;
    Done build(const hmf_hierarchy& h, size_t level, Call& call);
};

// Fills the arrays of a result that has its counts, and the sums over triangles and
// seams.  mesh: of the caller's side of the level of the foliation.
[[nodiscard]] hmf_status write_parameterization(const Parameterization& from, const hmf_foliation& foliation,
                                                const Mesh& mesh, const FlatConeMetric& flat, double unit,
                                                const CallerTriangles& triangles, hmf_parameterization& to, Call& call);

} // namespace hmf
