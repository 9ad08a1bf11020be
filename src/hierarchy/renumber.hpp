// Numbers of vertices, edges and faces by level.
#pragma once

#include "../base/memory.hpp"
#include "hierarchy.hpp"

namespace hmf {

struct Numbering {
    Array<uint32_t> vertex, edge, face; // old number -> new number
};

// Numbers by level: what is removed between level k and k + 1 gets the numbers
// from the count of level k + 1 to that of level k, in ascending order of the
// old number; what is left on the coarsest level comes first.
hmf_status number_by_level(const Level* levels, size_t level_count, const Collapse* collapses, Numbering& out, Call& call);

inline uint32_t renumbered_side(const Array<uint32_t>& edge, uint32_t h) { return 2 * edge[edge_of(h)] + (h & 1u); }

// Rewrites records into new numbers.
void renumber_log(Collapse* collapses, size_t collapse_count, uint32_t* flips, size_t flip_count, const Numbering& numbers);

} // namespace hmf
