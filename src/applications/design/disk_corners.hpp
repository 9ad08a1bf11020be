// Marked vertices for a disk if the caller has chosen none.
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"

namespace hmf {

// The four sharp corners of a disk if it has exactly four. Otherwise four vertices that divide its boundary into about
// equal lengths, sharp ones if there are any nearby. None if the boundary is short: the disk is a sphere with a small
// hole.
// h: of the double of the disk.
Done corners_of_disk(const hmf_hierarchy& h, Array<uint32_t>& marks, Call& call);

} // namespace hmf
