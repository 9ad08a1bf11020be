// Are given loops simple and disjoint?  Exact, in time linear in the crossings.
#pragma once

#include "multicurve.hpp"

namespace hmf {

// Are loops first .. last - 1 simple and disjoint?  If so their multicurve is left,
// traced, in `curves` (allocated), and the loop (from 0) of each component in
// loop_of, if wanted.
Done disjoint(const Mesh& mesh, const Loops& loops, size_t first, size_t last, Multicurve& curves,
              Array<uint32_t>* loop_of, Memory& memory, bool& answer);

// Where the least rotation of a cyclic sequence begins; linear time.
size_t least_rotation(const uint32_t* sequence, size_t n);

// Are two cyclic sequences of length n the same, wherever they begin?
bool same_cycle(const uint32_t* a, const uint32_t* b, size_t n);

} // namespace hmf
