// Better triangles on the flat parts of a surface.
#pragma once

#include "../../core/leaves/mirror_symmetry.hpp"

namespace hmf {

// CAD programs and ear clipping fill a flat face with triangles whose angles are near 0 and 180 degrees.  A leaf that
// is straight on each of these shows little of the foliation.  Edges between coplanar triangles are flipped until they
// are Delaunay:
//
//        c                c
//       / \              /|\        a b c d in one plane; the angles at c and d
//      /   \            / | \       add up to more than 180 degrees
//     a-----b    ->    a  |  b
//      \   /            \ | /
//       \ /              \|/
//        d                d
//
// The surface stays as it is, and the foliation in its class.
// mirror: of a double, which stays exactly symmetric; NULL: the surface is closed.
[[nodiscard]] hmf_status flip_flat_parts(Foliation& f, const double* position, const Reflection* mirror, Call& call);

} // namespace hmf
