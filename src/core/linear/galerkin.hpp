// The coarse matrix P^T A P of the multigrid.
#pragma once

#include "block_rows.hpp"
#include "prolongation.hpp"
#include "signed_matrix.hpp"

namespace hmf {

// A matrix of the hierarchy while it is being built, in double precision: the entries of a row of a Laplacian nearly
// cancel, and the difference has to keep its digits.
struct CoarseMatrix {
    SparseRows<double> rows;
    Array<double> diagonal;
    SignedMatrix view() const {
        return {static_cast<uint32_t>(diagonal.size()), rows.offset.data(), rows.column.data(), rows.entry.data(),
                diagonal.data()};
    }
};

// P by columns and by rows.
Done galerkin(const SignedMatrix& matrix, const Prolongation& columns, const SparseRows<float>& rows,
              CoarseMatrix& coarse, Call& call);

} // namespace hmf
