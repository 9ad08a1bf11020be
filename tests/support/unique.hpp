// The harmonic foliation of a class is unique: whatever the hierarchy, the
// method and the start, the same curves on the input give the same energy.
#pragma once

#include "surface.hpp"

namespace test {

struct UniqueOptions {
    std::vector<double> ratios{0.3, 0.5, 0.7};
    std::vector<uint64_t> coarsest{500, 2000};
    bool paper = true;   // Whitehead moves as well
    bool relaxed = true; // from the initial foliation there and back, on the first hierarchy
};

// Solves with the library's loops of level 0 of one hierarchy, given to all.
void expect_unique(const TriMesh& mesh, const UniqueOptions& options = {});

} // namespace test
