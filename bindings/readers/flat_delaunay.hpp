// Better triangles on the flat parts of a mesh: edges between coplanar triangles are flipped until they are Delaunay.
#pragma once

#include <cstddef>

#include "mesh_formats.hpp"

namespace readers {

// CAD programs and ear clipping fill a flat face with triangles whose angles are near 0 and 180 degrees. Values that
// are linear on such a triangle say little about the surface. Flips inside a flat part keep the surface:
//
//        c                c
//       / \              /|\        a b c d in one plane; the angles at c and d
//      /   \            / | \       add up to more than 180 degrees
//     a-----b    ->    a  |  b
//      \   /            \ | /
//       \ /              \|/
//        d                d
//
// Vertices stay. Triangles keep their numbers, but not their corners. An edge that is sharp, on a boundary, shared by
// more than two triangles, or whose new edge exists already, stays. Gives the number of flips, at most 64 for each
// triangle.
size_t make_flat_parts_delaunay(TriangleMesh& mesh);

} // namespace readers
