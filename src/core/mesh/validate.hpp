// From ordered triangles to a closed, connected, oriented manifold mesh: every
// defect has its own status.  Boundary is found on the way (match_sides.hpp); the
// double of such a surface (double_surface.hpp) comes here a second time.
#pragma once

#include "../base/memory.hpp"
#include "match_sides.hpp"
#include "mesh.hpp"
#include "spatial_order.hpp"

namespace hmf {

// What must be known before memory is taken: NULL, counts, stride.
[[nodiscard]] hmf_status validate_arguments(const double* positions, size_t vertex_count, size_t position_stride,
                                            const uint32_t* triangles, size_t triangle_count, Call& call);

// Refuses triangles without area.
[[nodiscard]] hmf_status check_areas(const OrderedTriangles& ordered, const double* position, const CallerMesh& caller,
                                     Call& call);

// Refuses unused vertices, vertices with several fans, and several components.
// part, part_count: of match_sides.
[[nodiscard]] hmf_status check_connection(const Mesh& mesh, const Array<uint32_t>& degree, const CallerMesh& caller,
                                          uint32_t* part, uint32_t part_count, Call& call);

// Numbers edges by their first appearance in the caller's triangles: fills
// triangle_edges (3 * triangle_count) and edge_internal.  scratch: edge_count.
[[nodiscard]] hmf_status number_edges(const OrderedTriangles& ordered, const Mesh& mesh, uint32_t* triangle_edges,
                                      uint32_t* edge_internal, uint32_t* scratch, Call& call);

} // namespace hmf
