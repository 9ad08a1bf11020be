// Which triangles of a chart turn over or overlap, decided in integers.
#pragma once

#include "../../core/mesh/mesh.hpp"

namespace hmf {

// Corners of triangles on a grid: at most 2^30 apart, so that areas fit 64 bits.
struct GridLayout {
    Array<int64_t> x, y;   // per half-edge: of the corner origin(h) of face(h)
    Array<uint32_t> chart; // per face
    uint32_t chart_count = 0;
};

// Twice the signed area of the face of h.
int64_t grid_area(const Mesh& mesh, const GridLayout& layout, uint32_t h);

// Corners of both triangles next to edge e coincide.
bool is_joined(const Mesh& mesh, const GridLayout& layout, uint32_t e);

// Moves interior vertices of inverted triangles to the center of their neighbors, if that increases the least area
// around them; each at most once in a pass.
Done turn_back(const Mesh& mesh, const Array<uint32_t>& side, GridLayout& layout, Call& call);

// Sets `bad` to 1 for triangles that are inverted or overlap another one of their chart; the others do not overlap.
// Triangles smaller than `speck` are not tested.  side: a half-edge of each face.
Done find_overlaps(const Mesh& mesh, const Array<uint32_t>& side, const GridLayout& layout, int64_t speck,
                   Array<uint8_t>& bad, Call& call);

// Places a triangle next to one of its neighbors where it overlaps nothing, if possible; `bad` triangles are ignored.
// flatter: its height over the side, as a part of what it is.
bool go_over(const Mesh& mesh, const Array<uint32_t>& side, const Array<uint8_t>& bad, uint32_t face, double flatter,
             GridLayout& layout);

} // namespace hmf
