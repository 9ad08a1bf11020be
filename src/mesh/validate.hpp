// From the arrays of the caller to a closed, connected, oriented manifold
// mesh: every defect has its own status.
#pragma once

#include "../base/memory.hpp"
#include "mesh.hpp"

namespace hmf {

// Side s of triangle t is side 3 t + s; it joins the corners s and s + 1.
struct Sides {
    Array<uint32_t> opposite; // 3 * triangle_count: the same edge in the neighbouring triangle
    uint32_t edge_count = 0;
};

// All local checks; components and genus show during the numbering
// (hierarchy/renumber.cpp).  Fills triangle_vertices and triangle_edges (3 * triangle_count each; edges
// numbered by first appearance) and sides.  Returns the first defect.
hmf_status validate(const double* positions, size_t vertex_count, size_t position_stride, const uint32_t* triangles,
                    size_t triangle_count, uint32_t* triangle_vertices, uint32_t* triangle_edges, Sides& sides, Call& call);

// What must be known before memory is taken: NULL, counts, stride.
hmf_status validate_arguments(const double* positions, size_t vertex_count, size_t position_stride,
                              const uint32_t* triangles, size_t triangle_count, Call& call);

// Position of a vertex in a strided array; stride 0 is packed.
inline const double* position_at(const double* positions, size_t stride, size_t vertex) {
    return reinterpret_cast<const double*>(reinterpret_cast<const char*>(positions) + vertex * (stride ? stride : 24));
}

} // namespace hmf
