// Intrinsic Delaunay triangulation of a mesh and its weights.
#pragma once

#include "../base/memory.hpp"
#include "../base/two_doubles.hpp"
#include "mesh.hpp"

namespace hmf {

// Bound of the flips of intrinsic_delaunay, and so of the length of its log. Beyond FLIPS_PER_EDGE_ALONE, single flips
// are likely to need many times as many; flat polygons are then retriangulated in one step (flat_polygons.hpp).
constexpr uint64_t INTRINSIC_FLIPS_PER_EDGE = 16, FLIPS_PER_EDGE_ALONE = 2;

// The edges that were flipped, in order: all are counted, the first `capacity` are written.
struct FlipLog {
    uint32_t* edges = nullptr;
    size_t capacity = 0, count = 0;

    void add(uint32_t edge) {
        if (count < capacity) edges[count] = edge;
        ++count;
    }
};

// A metric that is flat except at its vertices: lengths of the edges and areas of the triangles, both scaled by a power
// of two so that squares neither overflow nor underflow.  The area is stored beside the lengths because it cannot be
// computed from them in a needle or cap thinner
// than the square root of the precision.
struct Metric {
    Array<double> length;     // per edge
    Array<double> four_areas; // per face
    // Of a mesh with thin triangles the flips go by these; else they are empty.  An angle as small as 1e-5 has
    // an area that lengths of 53 bits know to 6 digits, so that the weights would depend on the order of the flips.
    Array<TwoDoubles> square;    // of the length, per edge
    Array<TwoDoubles> fine_area; // four areas, per face

    bool is_fine() const { return !square.empty(); }
    TwoDoubles square_of(uint32_t edge) const {
        return is_fine() ? square[edge] : TwoDoubles::of_product(length[edge], length[edge]);
    }
    TwoDoubles area_of(uint32_t face) const { return is_fine() ? fine_area[face] : TwoDoubles{four_areas[face], 0}; }
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

// Does the edge need a flip?
bool needs_flip(const Mesh& mesh, const double* sum, uint32_t edge);
// Of the angles opposite to the edge, by the metric.
double cotangent_sum(const Mesh& mesh, const Metric& metric, uint32_t edge);

// Flips until every edge is Delaunay or the bound is reached; metric and sum follow.  Two
// vertices may get several edges, a vertex edges to itself.  The same input gives the same sequence.
[[nodiscard]] hmf_status intrinsic_delaunay(Mesh& mesh, Metric& metric, double* sum, FlipLog& flips, Call& call,
                                            double from, double to);

// Certificate of the flips, by another route: at each flipped edge the cotangents follow from the sides of the two
// triangles alone, and their sum is as it was computed and not negative beyond rounding.  bad: the first edge
// that fails, or NONE.
Done find_bad_flip(const Mesh& mesh, const Metric& metric, const double* sum, const FlipLog& flips, Call& call,
                   double fraction, uint32_t& bad);

} // namespace hmf
