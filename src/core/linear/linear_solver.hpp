// The linear solver of a level, for matrices of any kind. Each solve starts on the lowest rung that may do;
// once the direct solver was needed, it stays:
//
//   multigrid, setup of an earlier matrix   the signs of few rows have changed: a setup costs as much as ten iterations
//   multigrid, setup of this matrix
//   direct                                  single precision does not suffice: weights of 1e5 beside weights of 1e-6
#pragma once

#include "direct_solver.hpp"

namespace hmf {

class LinearSolver {
public:
    // changed: per row, not 0 if its entries are not those of the last call; it is cleared.
    // options: see SignedMultigrid::solve; row_scale is taken from the system.
    Done solve(const LinearSystem& system, uint8_t* changed, double accuracy, LinearOptions options, Call& call);

private:
    Done solve_directly(const LinearSystem& system, const LinearOptions& options, Call& call);
    Done refresh(const SignedMatrix& matrix, uint8_t* changed, Call& call);

    SignedMultigrid multigrid_;
    enum class Rung { setup, multigrid, direct } rung_ = Rung::setup;
    bool is_own_ = false; // the setup is that of the current matrix
};

} // namespace hmf
