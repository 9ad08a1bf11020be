// Checks a finished atlas by its coordinates in the square: no two triangles have common inner points.
//
// All triangles turn to the left.  So each point lies in as many of them as their edges, those that two of
// them share left out, wind round it:
//
//        .---->----.            Nothing overlaps if no two of these edges cross, and if the
//        |   1     |   0        winding number is 1 on the left of each and 0 on its right.
//        '----<----'
#pragma once

#include "atlas.hpp"

namespace hmf {

struct AtlasCheck {
    uint64_t turned = 0;    // triangles without positive area that are no specks
    uint64_t crossings = 0; // of edges, and edges with another winding number
    uint64_t specks = 0;    // triangles less than SPECK units across or without area, which are left out
    uint64_t edges = 0;     // that were compared
};

// In whole units, exactly.  sides: a half-edge of each triangle.
[[nodiscard]] hmf_status check_atlas(const Atlas& atlas, const Mesh& mesh, const Array<uint32_t>& sides,
                                     AtlasCheck& out, Call& call);

} // namespace hmf
