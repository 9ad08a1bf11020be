// A mesh of few triangles in more of them, for what is drawn on it needs vertices.
#pragma once

#include <cstddef>

#include "mesh_formats.hpp"

namespace readers {

// Halves the longest edge, again and again, until there are so many triangles: the surface stays as it is, vertices
// keep their numbers, new ones come last.  Every triangle at an edge is cut with it, so that a surface stays one, and
// where three or more meet they still do.  Two triangles with the same three vertices stay.
//
//        c                c
//       / .              /|.
//      /   .     ->     / | .       a b: the longest edge of all, so that of both triangles
//     a-----b          a--m--b
//      .   /            . | /
//       . /              .|/
//        d                d
//
// n log n steps for n triangles in the end.
void refine(TriangleMesh& mesh, size_t triangles);

} // namespace readers
