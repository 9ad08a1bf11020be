// Intrinsic Delaunay triangulation of a mesh and its weights.
#pragma once

#include "../base/memory.hpp"
#include "mesh.hpp"

namespace hmf {

// Each flip makes the Delaunay energy smaller, so the sequence ends; rounding
// on hopeless triangles must not change that.
constexpr uint64_t INTRINSIC_FLIPS_PER_EDGE = 16;

// Lengths of the edges in space, scaled so that squares are harmless.
bool edge_lengths(const Mesh& mesh, const double* position, Memory& memory, Array<double>& length);

// Can every edge stay?
bool is_delaunay(const Mesh& mesh, const Array<double>& length);

// Flips until every edge is Delaunay, and counts.  Writes the first `capacity`
// of the flipped edges.  The same input gives the same sequence.
hmf_status intrinsic_delaunay(Mesh& mesh, Array<double>& length, uint32_t* flips, size_t capacity, size_t& flip_count, Call& call,
                              double from, double to);

// Weights from lengths, raised to the floor and cut at the cap.  Returns the
// number of weights that were negative beyond rounding.
uint64_t intrinsic_weights(const Mesh& mesh, const Array<double>& length, double* weight);

} // namespace hmf
