// A symmetric matrix in compressed rows, for the linear solver.
#pragma once

#include "../base/memory.hpp"

namespace hmf {

// Owned by the caller.  Columns in any order; a column may come twice, the
// values then add up.  Entries on the diagonal have to be 0.  Rows without
// entries and with diagonal 0 are left alone by the solver.
struct SignedMatrix {
    uint32_t n;
    const uint32_t* offset; // n + 1
    const uint32_t* column; // offset[n]
    const double* entry;    // offset[n], off-diagonal values with their signs
    const double* diagonal; // n
};

// The equations A x = b.
struct LinearSystem {
    SignedMatrix matrix;
    const double* right;
    double* x;               // start, then solution
    const uint8_t* is_fixed; // unknowns whose row and column are 0
    const float* row_scale;  // makes a row of the residual that of the caller
    bool is_singular;        // if no unknown is fixed or held, x is known up to a constant
};

} // namespace hmf
