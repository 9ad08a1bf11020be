// Are given loops simple and disjoint?  Exact, in time linear in the crossings.
#pragma once

#include "multicurve.hpp"

namespace hmf {

// Tests whether loops first .. last - 1 are simple and disjoint. If so, `curves` (allocated by the caller) holds their
// traced multicurve, and loop_of, if not NULL, the loop (from 0) of each component.
Done disjoint(const Mesh& mesh, const Loops& loops, size_t first, size_t last, Multicurve& curves,
              Array<uint32_t>* loop_of, Call& call, bool& answer);

// Tests whether one loop is simple and disjoint from the others, which must be simple and disjoint. Only
// loops that share an edge with it are examined. curves: allocated; its contents are unspecified afterwards.
Done one_is_disjoint(const Mesh& mesh, const Loops& loops, size_t one, Multicurve& curves, Call& call, bool& answer);

} // namespace hmf
