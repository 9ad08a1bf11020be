// Where the surface is cut so that (u, v) has one value per corner, and the
// layout of the cut surface in the plane.
#pragma once

#include "twisted_form.hpp"

namespace hmf {

struct Seams {
    Array<uint8_t> on; // per edge: 1 on the cut graph
    // A spanning tree of the faces, along which the layout goes: a trunk, and what hangs on it.
    uint32_t root = 0;       // half-edge of a face of the trunk
    Array<uint8_t> trunk;    // per edge: 1 where the trunk crosses it
    Array<uint32_t> hanging; // half-edges h: face(h) hangs on face(twin(h)), what is further out first
    uint64_t edge_count = 0;
    double length = 0; // in the unit of the lengths
};

// Number and length of the seams among some edges.
struct SeamSum {
    uint64_t count = 0;
    double length = 0;
    void operator+=(const SeamSum& part) {
        count += part.count;
        length += part.length;
    }
};

// A short cut graph through all cones: shortest paths between cones and around the handles [Erickson and Whittlesey
// 2005].  length: per edge, > 0.  root:
// half-edge of the face where the tree begins.  false: out of memory or cancelled.
Done cut_through_cones(const Mesh& mesh, const Stars& stars, const double* length, const uint8_t* is_cone,
                       uint32_t root, Seams& seams, Call& call);

// (u, v) at the corner origin(h) of face(h), for each half-edge, below 2^53; 0 at the root of the tree.  The
// same from both sides of every edge that is not on a seam, but where a layout
// that is too wide is pushed back by 2^52.
struct Layout {
    struct Point {
        int64_t u, v;
    };
    Array<Point> at;     // per half-edge
    Array<int8_t> chart; // per face: sign of the layout in the chart of the face
    Done build(const Mesh& mesh, const SignBundle& bundle, const TwistedForm& du, const TwistedForm& dv,
               const Seams& seams, Call& call);
};

} // namespace hmf
