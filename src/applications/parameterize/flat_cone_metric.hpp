// The flat metric of a harmonic foliation: the forms (du, dv) on the
// triangulation that is solved on, and on the caller's.
#pragma once

#include "../../core/solve/state.hpp"
#include "twisted_form.hpp"

namespace hmf {

// What the checks of du and dv measured; 1, or 0 for the error, where nothing is lost.
struct FlatFigures {
    double energy_ratio = 1; // of du, divided by that of the foliation
    double area_error = 0;   // of the image, relative to the energy
    double covered = 1;      // area of the image, that of flipped triangles counted as positive, by the energy of F
    double circumference_least = 1, circumference_most = 1; // of cylinders, by du divided by that of the foliation
};

struct FlatConeMetric {
    SignBundle bundle;
    TwistedForm du, dv;
    uint32_t iterations = 0; // of the linear solver
    FlatFigures figures;
};

// On the caller's side of the level.  state: a harmonic foliation on its intrinsic side, up to a residual; it stays
// as it is.
[[nodiscard]] hmf_status flat_cone_metric(State& state, double residual, FlatConeMetric& flat, Call& call);

// Cone angle of each vertex as a multiple of pi.  They add up to the number of
// faces: each face has one corner in the middle, by u, then v, then number.
// charts: of the mesh; the angle is an odd multiple exactly where they are odd.
// False: out of memory or cancelled.
Done cone_angles(const Mesh& mesh, const FlatConeMetric& flat, const VertexCharts& charts, int32_t* cone, Call& call);

// Cone angles, and which vertices are cones: where the chart comes back with the opposite sign, and zeros that are
// visible.
Done find_cones(const Mesh& mesh, const FlatConeMetric& flat, const VertexCharts& charts, Array<int32_t>& cone,
                Array<uint8_t>& is_cone, Call& call);

// No edge of the star has lost its (u, v) to rounding, as in limbs where the foliation is 0.
bool is_visible(Stars::Star star, const FlatConeMetric& flat);

} // namespace hmf
