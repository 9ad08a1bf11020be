// From ordered triangles to a closed, connected, oriented manifold mesh: every
// defect has its own status.  Boundary is found on the way; the double of such a
// surface (double_surface.hpp) comes here a second time.
#pragma once

#include "../base/memory.hpp"
#include "double_surface.hpp"
#include "mesh.hpp"
#include "spatial_order.hpp"

namespace hmf {

// What must be known before memory is taken: NULL, counts, stride.
[[nodiscard]] hmf_status validate_arguments(const double* positions, size_t vertex_count, size_t position_stride,
                                            const uint32_t* triangles, size_t triangle_count, Call& call);

// The arrays of the caller, for messages, and where his vertices went.
struct CallerMesh {
    const uint32_t* triangles;       // 3 * triangle_count
    const uint32_t* vertex_internal; // caller's vertex -> internal vertex
    bool flat_allowed;               // triangles without area are no defect
    Mirror mirror;                   // of a double, else empty
    const uint8_t* boundary_side;    // of a double: Doubling::boundary_side
};

// Refuses triangles without area, and everything that is not an oriented
// edge-manifold.  Sides with one triangle go to `boundary` (as 3 * triangle of
// the caller + side); if there are any, the mesh is not to be used.  Fills mesh
// (whose arrays have room for 3/2 edges a triangle) and degree; the corners in
// `ordered` become half-edges.  part (vertex_count) becomes a forest of
// disjoint_sets.hpp over vertices that are connected.
[[nodiscard]] hmf_status link_triangles(OrderedTriangles& ordered, const double* position, const CallerMesh& caller,
                                        Mesh& mesh, Array<uint32_t>& degree, uint32_t* part, Array<uint32_t>& boundary,
                                        Call& call);

// Refuses unused vertices, vertices with several fans, and several components.
[[nodiscard]] hmf_status check_connection(const Mesh& mesh, const Array<uint32_t>& degree, const CallerMesh& caller,
                                          uint32_t* part, Call& call);

// Numbers edges by their first appearance in the caller's triangles: fills
// triangle_edges (3 * triangle_count), which is as order_triangles left it, and
// edge_internal.  scratch: edge_count.
[[nodiscard]] hmf_status number_edges(const OrderedTriangles& ordered, const Mesh& mesh, uint32_t* triangle_edges,
                                      uint32_t* edge_internal, uint32_t* scratch, Call& call);

} // namespace hmf
