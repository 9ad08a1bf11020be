// Checks du against the cylinders of the foliation, each by itself: a fold on a small handle is as visible as one on
// the whole surface.
//
// The flux of du through a leaf is the circumference of its cylinder in (u, v).  As du is coclosed, and in the class
// of F with its zeros elsewhere, it is the same through all leaves that no zero has crossed, and
//
//     energy of du  =  sum of height * circumference
#pragma once

#include "../../core/solve/state.hpp"
#include "twisted_form.hpp"

namespace hmf {

struct CylinderCheck {
    // Of the cylinders with a leaf that no zero has crossed.
    double least = 1, most = 1; // circumference by du, divided by that by F
    double area = 0;            // sum of height * circumference by du
    uint64_t open = 0;          // u changes along the leaf
    // Of the others, which are thinner than the triangles: a zero crosses all of their leaves.
    uint64_t crossed = 0;
    double crossed_area = 0; // sum of height * circumference by F
};

[[nodiscard]] hmf_status check_cylinders(State& state, const MovedZeros& moved, const SignBundle& bundle,
                                         const TwistedForm& du, CylinderCheck& out, Call& call);

} // namespace hmf
