// The even design of a surface with boundary: the caller's marked vertices, or else
// the suggested ones (corners of a disk; none on other surfaces), the sharp corners of
// the boundary or pairs at the tips of limbs; the pants loops of the surface, and
// weights for these.
#pragma once

#include "../loops/surface_loops.hpp"
#include "even_design.hpp"

namespace hmf {

struct MeshArrays {
    const double* positions;
    size_t vertex_count;
    const uint32_t* triangles;
    size_t triangle_count;
};

// `like` gives the allocator.  out: all but the loops, which are in `loops`, by the
// caller's numbers.
[[nodiscard]] hmf_status boundary_design(const hmf_hierarchy& like, const MeshArrays& mesh, const BuildOptions& build,
                                         const DesignOptions& design, Call& call, EvenDesign& out, FoundLoops& loops);

} // namespace hmf
