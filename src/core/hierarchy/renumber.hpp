// Numbers of vertices, edges and faces by level.
#pragma once

#include "simplify.hpp"

namespace hmf {

// Permutations of the numbers of one level.
struct Numbering {
    uint32_t *vertex = nullptr, *edge = nullptr, *face = nullptr; // old number -> new number
};

// Numbers the remaining elements first and the removed ones after them, both in the old order.  records: the collapses
// since the numbers were last changed.
void number_level(const WorkMesh& work, const Collapse* records, size_t record_count, const Numbering& out,
                  const Parallel& parallel);

// Removes deleted elements and moves the others to their new numbers.
void compact(WorkMesh& work, const Numbering& numbers, const Parallel& parallel);

// Follows what stays on the coarser level to its number there; from
// number_level to the final numbers, if `coarser` has those.
void compose(const Level& level, const Numbering& numbers, const Level& coarser_level, const Numbering& coarser,
             const Parallel& parallel);

// Rewrites records into new numbers.
void renumber_collapses(Collapse* collapses, size_t count, const Numbering& numbers, const Parallel& parallel);

} // namespace hmf
