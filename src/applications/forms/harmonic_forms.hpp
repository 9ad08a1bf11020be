// Harmonic 1-forms of a closed surface: in each class of closed forms the one of least energy, as linear functions on
// the triangles.  The forms are in integers: closed and with the periods of their class exactly, harmonic up to the
// solver and the rounding.
//
//     closed_forms     a canonical basis of the classes, a[i] and b[i]
//        |  Laplacian (the twisted one with a trivial sign bundle): form += d(w)
//        v
//     harmonic form on the triangulation where it is solved
//        |  flips reversed: a side is minus the sum of the two others
//        v
//     the same on the caller's triangles
//
// Star is the conjugation: the integral of x ^ *y is the inner product of x and y, so on the canonical basis, whose
// integrals are S, it is the matrix S^-1 M of the inner products M.  Its square is -1 up to discretization.  M is
// replaced by the geometric mean of M and S M^-1 S^T, for which it is -1, by the iteration
// M = (M + S M^-1 S^T) / 2, which does not depend on the basis.  Then a[i] + sum over j of (X + iY)(i, j) b[j] is
// holomorphic for
//
//     Y = M(b, b)^-1,   X = -M(a, b) Y        period matrix X + iY
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"

namespace hmf {

// Output arrays, for n = 2 genus forms.
struct HarmonicForms {
    double* values;                         // n x edges
    int32_t* intersections;                 // n x n: integrals of the products
    double *inner_products, *conjugation;   // n x n
    double *period_real, *period_imaginary; // genus x genus
    double residual = 0, conjugation_error = 0;
};

// half_edge: of the input triangulation of the level, for each edge of the caller in its direction.
[[nodiscard]] hmf_status harmonic_forms(const hmf_hierarchy& hierarchy, size_t level, const Array<uint32_t>& half_edge,
                                        HarmonicForms& out, Call& call);

} // namespace hmf
