// The global conformal parameterization ([W] section 5) in the caller's terms:
//
//   foliation --flat_cone_metric--> (du, dv) --cut_through_cones--> seams
//             --layout--> (u, v) per corner --> transitions, maps of the triangles
#pragma once

#include "dilatation.hpp"
#include "flat_cone_metric.hpp"
#include "seams.hpp"

namespace hmf {

// Refuses values whose residual of [W] Eq. 4 is above the tolerance, except at a few vertices that may have moved
// between the two triangulations of level 0. Those are relaxed.
[[nodiscard]] hmf_status check_harmonic(State& state, double tolerance, Call& call);

// From an edge's first triangle to its second: (u', v') = sign * (u, v) + (u, v of this).
struct Transition {
    int8_t sign;
    int64_t u, v;
};

// Everything on the caller's side of the level, by internal numbers.
struct Parameterization {
    Layout layout;
    Seams seams;
    Array<int32_t> cone;  // per vertex, multiples of pi
    Array<double> length; // per edge, in space

    // mesh: of the caller's side, with positions.  start: where the layout begins
    // if there are no cones.  seam_edges: internal numbers where seams cost nothing.
    [[nodiscard]] hmf_status build(const Mesh& mesh, const double* position, const FlatConeMetric& flat, uint32_t start,
                                   const Array<uint32_t>& seam_edges, Call& call);
    // From face(h) to face(twin h).
    Transition transition(const Mesh& mesh, const SignBundle& bundle, uint32_t h) const;
    bool is_seam(uint32_t edge, const Transition& t) const {
        return seams.on[edge] || t.sign < 0 || t.u != 0 || t.v != 0;
    }
    // The map of the triangle whose side 0 is half-edge `side`.
    AffineMap map_of(const Mesh& mesh, const double* position, uint32_t side, double unit) const;
};

} // namespace hmf
