// Where to mark the boundary of a surface if the caller has chosen no vertices: its corners.
#pragma once

#include "../../core/hierarchy/hierarchy.hpp"

namespace hmf {

// The four sharp corners of a disk if it has exactly four. Otherwise four vertices that divide its boundary into about
// equal lengths, sharp ones if there are any nearby. None if the boundary is short: the disk is a sphere with a small
// hole.
// h: of the double of the disk.
Done corners_of_disk(const hmf_hierarchy& h, Array<uint32_t>& marks, Call& call);

// The sharp convex corners of all boundary curves that have more than one, each as curved as one pole; none if there
// are more than `most`.
Done corners_of_boundaries(const hmf_hierarchy& h, size_t most, Array<uint32_t>& marks, Call& call);

} // namespace hmf
