// Loops that the library searches for: cut systems, dual loops, pants.
#pragma once

#include "../../../include/hmf/applications.h"
#include "../../core/curves/loops.hpp"

namespace hmf {

// Loops for which labels add up to 0.
struct LoopCondition {
    const uint64_t* label; // per edge, read with a minus from half-edge 2e + 1
    const Loops* free;     // the cut system without the condition
    const Loops* gates;    // each loop that meets the condition crosses one of these
};

class ClassLengths; // class_lengths.hpp

// How loops are chosen: by the lengths of their classes, or the first ones, by
// the lengths of the strips in which they are found.
enum class LoopCare : uint8_t { shortest, quick };

// genus many disjoint simple loops, jointly non-separating, each with the shortest
// class that is found one after another.  position: 3 per vertex of the mesh.
// condition: NULL for none.  is_wide: of many handles, with searches where strips are longer by SLACK.  This hardly
// shortens cut loops, but the choice among equally long ones with which pants begin does not depend on the order of the
// vertices then.
[[nodiscard]] hmf_status cut_system(const Mesh& mesh, const double* position, const LoopCondition* condition,
                                    ClassLengths& lengths, Call& call, Loops& out, bool is_wide = false);
// Measured on the mesh itself.
[[nodiscard]] hmf_status cut_system(const Mesh& mesh, const double* position, Call& call, Loops& out);

// Loops that each cross one of the disjoint loops that they are given, and for the others only earlier ones: disjoint
// as well, and with them a basis of the homology. Puts the given loops in that order.
[[nodiscard]] hmf_status dual_loops(const Mesh& mesh, Loops& loops, Call& call, Loops& out);

// 3 genus - 3 + marked vertices disjoint loops (one for a torus without those),
// pairwise not freely homotopic: they cut the surface into pairs of pants, whose
// boundaries are loops and marked vertices.  The first are a cut system.
[[nodiscard]] hmf_status pants_decomposition(const Mesh& mesh, const double* position, ClassLengths& lengths,
                                             Call& call, Loops& out);

// On a sphere: loops each round two marked vertices that are close, and no
// vertex in two of them; as many as there are, but one for four vertices.
[[nodiscard]] hmf_status mark_loops(const Mesh& mesh, const double* position, ClassLengths& lengths, Call& call,
                                    Loops& out);

// Shortens simple disjoint loops within their classes, from loop `first` on; they stay disjoint, in their order and
// with their directions.
[[nodiscard]] hmf_status shorten_loops(const Mesh& mesh, const double* position, Call& call, Loops& loops,
                                       size_t first = 0);

} // namespace hmf
