// Numbers of vertices and triangles by their place in space: what is near on
// the surface is near in memory, in whatever order the input comes.
#pragma once

#include "../base/memory.hpp"
#include "mesh.hpp"

namespace hmf {

// Position of a vertex in a strided array; stride 0 is packed.
inline const double* position_at(const double* positions, size_t stride, size_t vertex) {
    return reinterpret_cast<const double*>(reinterpret_cast<const char*>(positions) + vertex * (stride ? stride : 24));
}

// Four words for each triangle, in spatial order: its corners, which make room
// for its half-edges later, and the caller's number.
struct OrderedTriangles {
    Array<uint32_t> words; // 4 * triangle_count
    uint32_t number(uint32_t face) const { return words[size_t{4} * face + 3]; }
};

// Fills vertex_internal (caller's vertex -> internal vertex) and position (3 * vertex_count, internal order, times
// scale). scale is a power of two that brings coordinates to a size whose fourth power neither overflows nor
// underflows; 1 for all reasonable units. Refuses coordinates that are not finite.
[[nodiscard]] hmf_status order_vertices(const double* positions, size_t vertex_count, size_t position_stride,
                                        uint32_t* vertex_internal, double* position, double& scale, Call& call);

// Refuses indices out of range and triangles with a repeated vertex.  sides: room
// for 3 words for each of the caller's triangles, where its corners are left.
[[nodiscard]] hmf_status order_triangles(const uint32_t* triangles, size_t triangle_count,
                                         const uint32_t* vertex_internal, size_t vertex_count, uint32_t* sides,
                                         OrderedTriangles& out, Call& call);

} // namespace hmf
