// Intrinsic Delaunay triangulation of a mesh and its weights.
#pragma once

#include "../base/memory.hpp"
#include "../base/two_doubles.hpp"
#include "mesh.hpp"

namespace hmf {

// Bound of the flips of intrinsic_delaunay.  Each flip lowers a positive sum
// (intrinsic.cpp), so that rounding cannot make an edge turn for ever; this
// bounds the length of the log as well.
constexpr uint64_t INTRINSIC_FLIPS_PER_EDGE = 16;

// A metric that is flat but for its vertices: lengths of the edges and areas
// of the triangles, both scaled by a power of two so that squares are
// harmless.  The area is kept beside the lengths because it cannot be had
// from them in a needle or cap thinner than the square root of the precision.
struct Metric {
    Array<double> length;     // per edge
    Array<double> four_areas; // per face
    // Of a mesh with thin triangles the flips go by these; else they are empty.  An angle as small as 1e-5 has
    // an area that lengths of 53 bits know to 6 digits, so that the weights would depend on the order of the flips.
    Array<TwoDoubles> square;    // of the length, per edge
    Array<TwoDoubles> fine_area; // four areas, per face
};

// The metric of positions (3 per vertex).  Unless sum is NULL, it gets the cotangents of
// the two angles opposite to each edge, added.  sides: the half-edges of each
// face in 4 words, the last one unused; NULL if they are not at hand.
Done measure(const Mesh& mesh, const double* position, const uint32_t* sides, Metric& metric, double* sum, Call& call);

// All edges get longer by the least amount that keeps every triangle
// inequality by a margin of factor * mean length [Sharp and Crane 2020].  sum as
// for measure.
Done mollify(const Mesh& mesh, double factor, Metric& metric, double* sum, Call& call);

// If there are thin triangles, by the sums of cotangents: squares and areas to 31 digits, and the sums from them.
// position: as for measure; NULL: the lengths count as they are (mollify).
Done measure_thin(const Mesh& mesh, const double* position, Metric& metric, double* sum, Call& call);

// Can every edge stay?
bool is_delaunay(const Mesh& mesh, const double* sum, const Parallel& parallel = Parallel());

// Flips until every edge is Delaunay, and counts; metric and sum follow.  Two
// vertices may get several edges, a vertex edges to itself.  Writes the first
// `capacity` of the flipped edges.  The same input gives the same sequence.
[[nodiscard]] hmf_status intrinsic_delaunay(Mesh& mesh, Metric& metric, double* sum, uint32_t* flips, size_t capacity,
                                            size_t& flip_count, Call& call, double from, double to);

// From sums of cotangents to weights, in place: raised to the floor and cut at
// the cap.  Returns the number of weights that were negative beyond rounding.
uint64_t intrinsic_weights(const Mesh& mesh, double* sum, const Parallel& parallel = Parallel());

} // namespace hmf
