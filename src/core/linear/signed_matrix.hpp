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

} // namespace hmf
