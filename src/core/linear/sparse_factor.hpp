// A direct solver for matrices on which the multigrid fails: weights of 10^5 beside weights of 10^-6 exceed the range
// of single precision.
//
//     L D L^T, row by row, in double precision
//
// Unknowns are numbered by nested dissection (George 1973): of a connected set one layer of a breadth first search,
// which starts at its edge, is numbered last, and what is on both sides of it before, in the same way.
//
//      o o o|S|o o o
//      o o o|S|o o o      first the left ones, then the right ones, then S
//      o o o|S|o o o
//
// For n unknowns of a surface L has some n log n entries: 20 to 40 a row up to 10 000.
#pragma once

#include "signed_matrix.hpp"

namespace hmf {

class SparseFactor {
public:
    // Done, with an empty factor, also for more than MOST_UNKNOWNS, or where it would have more than most_entries:
    // then there is no solution from here.  Rows with the diagonal 0 are left out.
    // shift: is added to the diagonal, which bounds what is near a kernel.
    Done build(const SignedMatrix& matrix, Call& call, double shift = 0);
    bool empty() const { return n_ == 0; }
    // A x = b; x may be b.  Another solve for what rounding leaves of b makes that no smaller.
    template <class Real>
    void solve(const Real* b, Real* x);

    static constexpr uint32_t MOST_UNKNOWNS = 500000;
    static uint64_t most_entries(uint64_t n) { return n < 200000 ? 200 * n : 40000000; } // of n unknowns

private:
    Done number_unknowns(const SignedMatrix& matrix, Call& call);
    Done find_tree(const SignedMatrix& matrix, Call& call, uint64_t& entries);
    Done eliminate(const SignedMatrix& matrix, Call& call, double shift);

    uint32_t n_ = 0;
    Array<uint32_t> unknown_, place_; // the k-th one that is eliminated, and k of each
    Array<uint32_t> parent_;          // of the elimination tree
    Array<uint64_t> first_;           // n + 1; column k of L: row_[first_[k]], ..
    Array<uint32_t> row_;
    Array<double> entry_, diagonal_; // of L, of D
    Array<double> y_;                // of solve(), in the order of elimination
};

} // namespace hmf
