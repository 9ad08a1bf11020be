// Are given loops simple and disjoint?  Exact, in time linear in the crossings.
#pragma once

#include "multicurve.hpp"

namespace hmf {

// Are loops first .. last - 1 simple and disjoint?  If so their multicurve is left,
// traced, in `curves` (allocated), and the loop (from 0) of each component in
// loop_of, if wanted.
Done disjoint(const Mesh& mesh, const Loops& loops, size_t first, size_t last, Multicurve& curves,
              Array<uint32_t>* loop_of, Call& call, bool& answer);

// Is the last loop simple, and disjoint from those before, which are so?  Loops that it shares an edge with are looked
// at.  curves: allocated; what it holds then means nothing.
Done last_is_disjoint(const Mesh& mesh, const Loops& loops, Multicurve& curves, Call& call, bool& answer);

} // namespace hmf
