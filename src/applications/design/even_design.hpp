// The even design: marked vertices, loops and weights for which the scale of
// the harmonic foliation is as even as it gets.
#pragma once

#include "even_search.hpp"

namespace hmf {

struct EvenDesign {
    Array<uint32_t> marks; // vertices of the caller
    Loops loops;           // on level 0 of the hierarchy: the caller's mesh in internal numbers
    Array<double> weights; // whole numbers
    double unevenness_before = 0, unevenness = 0;
    uint64_t solves = 0;
};

struct DesignOptions {
    bool poles = true;
    uint64_t solves = 0; // budget; 0: by the size of the mesh
};

// `hierarchy` is freshly made; level 0 and the numbers of the caller can be
// used afterwards.  Of the build options, position_stride, mollify and marked
// vertices, which are part of every design.  With boundary (hierarchy.is_double())
// see boundary_design.hpp.
hmf_status even_design(hmf_hierarchy& hierarchy, const double* positions, size_t vertex_count,
                       const uint32_t* triangles, size_t triangle_count, const BuildOptions& build,
                       const DesignOptions& options, Call& call, EvenDesign& out);

} // namespace hmf
