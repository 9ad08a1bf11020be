// Setup of the signed multigrid: one step from a level to the next coarser.
#pragma once

#include "galerkin.hpp"
#include "signed_multigrid.hpp"

namespace hmf {

// Called between pieces of work; not done: cancelled, or asked to finish.
inline Done continues(Call& call) { return call.tick(0, true) && !call.finishing(); }

// 1 / sqrt(diagonal); 0 for rows whose diagonal is not above the threshold.
Done unit_diagonal_scale(const SignedMatrix& matrix, double threshold, Array<float>& scale, const Parallel& parallel,
                         Memory& memory);

// Aggregates, prolongation and Galerkin product.
//   near_kernel   n values, the smooth vector up to signs (constant 1 for a
//                 Laplacian before scaling); replaced by that of the coarse level
//   strength      entries with a smaller share of their row are weak
// The prolongation still lacks the scaling of both levels.
Done coarsen(const SignedMatrix& matrix, MultigridLevel& level, float strength, Array<double>& near_kernel,
             CoarseMatrix& coarse, Call& call);

} // namespace hmf
