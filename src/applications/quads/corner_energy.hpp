// The energy of one corner of a quad on a surface:
//
//        b |             a = (e x b).n / D        signed area, n the normal of the surface, D the area wished
//          |____         s = (|e|^2 + |b|^2) / 2D, c = e.b / D
//            e           barrier(a) = (a + root(eps^2 + a^2)) / 2
//
//     (s + SIZE (a^2 + 1) / 2) / barrier + ANGLE (c / barrier)^2
//
// is least, 1 + SIZE, for a square of the area D.  For eps = 0 it is infinite where the corner is folded over, so that
// a descent from a corner that is not never folds it; for eps > 0 it is large there, but falls towards a corner that
// is not folded (after Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021, Foldover-free maps in 50 lines of
// code).
#pragma once

#include "quad_numbers.hpp"

#include <cmath>

namespace hmf {

struct CornerEnergy {
    double value, by_s, by_a, by_c; // of f, its slopes by s, a and the cotangent
    double sa, aa;                  // its curvatures
    double cot_c, cot_a;            // slopes of the cotangent
};

inline double corner_barrier(double a, double eps) {
    const double root = std::sqrt(eps * eps + a * a);
    return a > 0 ? 0.5 * (a + root) : 0.5 * eps * eps / (root - a);
}

inline CornerEnergy corner_energy(double s, double a, double c, double eps) {
    const double barrier = corner_barrier(a, eps), per = 1 / barrier, bend = 1 / std::sqrt(eps * eps + a * a),
                 cot = c * per;
    const double f = (s + 0.5 * SIZE * (a * a + 1)) * per;
    CornerEnergy e;
    e.value = f + ANGLE * cot * cot;
    e.by_s = per;
    e.by_a = SIZE * a * per - f * bend;
    e.by_c = 2 * ANGLE * cot;
    e.sa = -bend * per;
    e.aa = (SIZE - 2 * SIZE * a * bend) * per + 2 * f * bend * bend;
    e.cot_c = per;
    e.cot_a = -cot * bend;
    return e;
}

} // namespace hmf
