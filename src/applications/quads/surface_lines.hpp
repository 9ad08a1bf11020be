// Lines of edges on a surface: its boundary, and sharp edges, along which it is folded.  Triangles with the number
// NONE are no part of the surface.
#pragma once

#include "quad_shape.hpp"

namespace hmf {

// A half-edge from v, left of which the surface lies; NONE: there is none.
inline uint32_t side_at(const Mesh& mesh, uint32_t v) {
    for (const uint32_t h : mesh.around(v))
        if (mesh.face[h] != NONE) return h;
    return NONE;
}

// Whether the surface lies left of h and ends there.
inline bool is_on_rim(const Mesh& mesh, uint32_t h) { return mesh.face[h] != NONE && mesh.face[twin(h)] == NONE; }

// Whether the faces of an edge differ by more than 40 degrees.
bool is_sharp(const Mesh& mesh, const double* position, uint32_t h);

// Whether three or more sharp edges meet at a vertex.
bool is_sharp_corner(const Mesh& mesh, const double* position, uint32_t v);

// The half-edge of the boundary after h, which is one.
uint32_t next_on_rim(const Mesh& mesh, uint32_t h);

// Of the boundary edges at the corners of the triangle left of `side` the one nearest to p; NONE: there is none.
uint32_t rim_near(const Mesh& mesh, const double* position, uint32_t side, const Point& p);

// The point of an edge nearest to p.
Point nearest_on_edge(const Mesh& mesh, const double* position, uint32_t h, const Point& p);

// From p on the edge of h along its line by a length, backwards if that is negative, as far as the line goes: sharp
// lines end where one or several others begin.
//
//        x             x: ends
//        |     p---->
//    ----x-----+-----x
//
// Returns a half-edge of the edge reached; on the boundary the surface is on its left.
uint32_t slide_along_rim(const Mesh& mesh, const double* position, uint32_t h, const Point& p, double length,
                         Point& reached);
uint32_t slide_along_sharp_edges(const Mesh& mesh, const double* position, uint32_t h, const Point& p, double length,
                                 Point& reached);

} // namespace hmf
