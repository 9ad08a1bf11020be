// The coarsest level of the multigrid: a Cholesky factor of some hundred unknowns.
//
// The matrix is singular if the foliation is orientable, and for components that are left out; a shift of the diagonal
// keeps the kernel bounded.  In single precision that is 1e-3.  On a mesh of round
// triangles the least eigenvalues are far above it.  On long triangles that lie along a limb they are not: there
//
//      o==o==o==o     == a million times as heavy as |, and rings of heavy edges are only joined by light ones:
//      |  |  |  |     each has a wave of its own, of an eigenvalue like the light edges.  Such waves have to be solved
//      on
//      o==o==o==o     this level, and where a shift hides them, conjugate gradients need hundreds of steps.
//
// If the pivots show this, the factor is computed again in double precision, with a smaller shift.
#pragma once

#include "signed_matrix.hpp"

namespace hmf {

class DenseFactor {
public:
    // scale: of each row and column; 0 leaves them out.
    // call: to report to, or NULL.
    Done build(const SignedMatrix& matrix, const Array<float>& scale, Memory& memory, Call* call);
    void clear() { *this = DenseFactor(); }
    uint32_t size() const { return n_; }

    // Room for a right side, which solve() makes the solution.
    float* vector() { return b_.data(); }
    const float* vector() const { return b_.data(); }
    void solve();

private:
    // L below the diagonal by columns, its transpose above.
    template <class Real>
    struct Factor {
        Array<Real> entry;   // n * n
        Array<Real> inverse; // 1 / diagonal of L

        // matrix: n * n, its lower part by columns, which is changed.  weak: pivots below a number, or null.
        Done build(uint32_t n, Array<Real>& matrix, Real least_pivot, Real weak_pivot, uint32_t& weak, Memory& memory,
                   Call* call);
        void solve(uint32_t n, Real* b) const;
    };

    uint32_t n_ = 0;
    Factor<float> single_;
    Factor<double> double_; // empty: the other one is good enough
    Array<float> b_;
    Array<double> wide_b_; // with double_
};

} // namespace hmf
