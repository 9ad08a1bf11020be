// The connected components of a triangle mesh; triangles that share a vertex are
// in one.
#pragma once

#include "../../../include/hmf/applications.h"
#include "../../core/base/memory.hpp"

namespace hmf {

// Components in the order of their first triangles; the elements of each keep the
// order that they have in the mesh.
struct Components {
    Array<hmf_component> list;                  // places and counts of vertices, edges, triangles; else 0
    Array<uint32_t> vertices, edges, triangles; // one component after the other: numbers in the whole mesh
    // Of each vertex and triangle its component, and its number there; NONE: a vertex without a triangle.
    Array<uint32_t> vertex_component, vertex_number, triangle_component, triangle_number;
};

// Edges are numbered by their first side, as on level 0.  Linear time; refuses
// triangles with vertices that do not exist.
[[nodiscard]] hmf_status find_components(const uint32_t* triangles, size_t triangle_count, size_t vertex_count,
                                         Call& call, Components& out);

} // namespace hmf
