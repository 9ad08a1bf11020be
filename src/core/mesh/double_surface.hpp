// The closed double of a surface with boundary [Schiffer and Spencer 1954]: the
// surface and its mirror image, glued along the boundary.
//
//       front              triangles 0 .. m - 1 are the caller's, m + t is the
//      /-----\  boundary   mirror image of t; boundary vertices belong to both,
//      \-----/             the others have a copy behind the caller's vertices
//       back
//
// A harmonic foliation of the surface, free at the boundary, is half of the one
// of the double.  What is solved is the double; the caller sees the front.  Two
// vertices of the boundary that are joined inside have two edges in the double,
// and a triangle with two sides on the boundary leaves a vertex of degree two.
#pragma once

#include "../base/memory.hpp"
#include "mesh.hpp"

namespace hmf {

// Where a vertex of the surface, or of the double, is on the other side.
struct Mirror {
    uint32_t vertex_count = 0, triangle_count = 0; // of the surface; 0 triangles: nothing is doubled
    const uint32_t* vertex = nullptr;              // of each vertex of the surface: its copy, itself on the boundary

    bool is_boundary(uint32_t v) const { return vertex[v] == v; }
    // The vertex of the surface that a vertex of the double is a copy of.
    uint32_t front(uint32_t v) const {
        uint32_t of = v;
        if (triangle_count > 0 && v >= vertex_count)
            for (of = 0; vertex[of] != v;) ++of;
        return of;
    }
};

// What the double is made of, in the numbers of the caller.
struct Doubling {
    uint32_t vertex_count = 0; // of the double
    uint64_t marked_count = 0; // likewise
    uint32_t boundary_count = 0;
    Array<double> positions;      // 3 * vertex_count
    Array<uint32_t> marked;       // marked_count
    Array<uint8_t> boundary_side; // 3 * triangle_count: the side has one triangle
};

// sides: those with one triangle, as 3 * triangle + side.  triangles: those of
// the surface, 3 * triangle_count, with space for as many again, which are filled in.
// mirror: one for each vertex, filled.  marked: vertices that exist, none twice.
[[nodiscard]] hmf_status double_surface(const double* positions, size_t vertex_count, size_t position_stride,
                                        uint32_t* triangles, size_t triangle_count, const Array<uint32_t>& sides,
                                        const uint32_t* marked, uint64_t marked_count, uint32_t* mirror, Doubling& out,
                                        Call& call);

} // namespace hmf
