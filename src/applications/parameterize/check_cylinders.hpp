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
    // Circumference by du, divided by that by F.
    double least = 1, most = 1;
    double area = 0;      // sum of height * circumference by du
    uint64_t crossed = 0; // cylinders without a leaf that no zero has crossed; left out of the others
};

// zeros: of F, all of them where there are no marked vertices.
[[nodiscard]] hmf_status check_cylinders(State& state, const ZeroList& zeros, const SignBundle& bundle,
                                         const TwistedForm& du, CylinderCheck& out, Call& call);

} // namespace hmf
