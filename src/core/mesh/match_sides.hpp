// The sides of triangles that belong together become edges; what is not an
// oriented edge-manifold is refused.
#pragma once

#include "../base/memory.hpp"
#include "double_surface.hpp"
#include "mesh.hpp"
#include "spatial_order.hpp"

namespace hmf {

// The arrays of the caller, for messages, and where his vertices went.
struct CallerMesh {
    const uint32_t* triangles;       // 3 * triangle_count
    const uint32_t* vertex_internal; // caller's vertex -> internal vertex
    Mirror mirror;                   // of a double, else empty
    const uint8_t* boundary_side;    // of a double: Doubling::boundary_side
};

// Fills mesh, whose arrays have room for 3/2 edges a triangle, and degree; the
// corners in `ordered` become half-edges.  Sides with one triangle go to
// `boundary` (as 3 * triangle of the caller + side); if there are any, the mesh
// is not to be used.  part (vertex_count) becomes a forest of disjoint_sets.hpp
// over vertices that are connected, and part_count the number of its trees: all
// that are connected are in one, if that number is above 1.
[[nodiscard]] hmf_status match_sides(OrderedTriangles& ordered, const CallerMesh& caller, Mesh& mesh,
                                     Array<uint32_t>& degree, uint32_t* part, uint32_t& part_count,
                                     Array<uint32_t>& boundary, Call& call);

} // namespace hmf
