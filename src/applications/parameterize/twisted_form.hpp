// Closed 1-forms with values in the sign bundle of a foliation, in integers.
//
// Every face has a chart: a local choice of the sign of u.  Edge e separates
// face(2e) from face(2e+1); turn[e] = -1 where their charts have opposite
// signs.  A form is one integer per edge, its integral along half-edge 2e in
// the chart of face(2e); seen from the other side
//
//     at(2e+1) = - turn[e] * at(2e)
//
// and it is closed: in every face the three sides add up to 0.  Going around a
// vertex the chart comes back, or with the opposite sign where an odd number
// of zeros sits.  So F = |du| has its zeros at vertices here, and every face
// is the affine image of a triangle in the (u, v) plane.
#pragma once

#include "../../core/foliation/foliation.hpp"
#include "../../core/hierarchy/hierarchy.hpp"
#include "../../core/leaves/critical_graph.hpp"
#include "stars.hpp"

namespace hmf {

struct SignBundle {
    Array<int8_t> turn; // per edge
};

struct TwistedForm {
    Array<int64_t> value; // per edge
    int64_t at(const SignBundle& bundle, uint32_t h) const {
        const uint32_t e = edge_of(h);
        return h & 1 ? -bundle.turn[e] * value[e] : value[e];
    }
    // Adds to the integral along h, in the chart of face(h).
    void add(const SignBundle& bundle, uint32_t h, int64_t x) {
        const uint32_t e = edge_of(h);
        value[e] += h & 1 ? -bundle.turn[e] * x : x;
    }
};

// A vertex takes over the chart of face(out[v]), continued counter-clockwise:
// chart[h] is the sign of the chart of face(h) in it, for h out of v.
struct VertexCharts {
    Stars stars;         // of the mesh
    Array<int8_t> chart; // per half-edge
    Array<uint8_t> odd;  // per vertex: the chart comes back with the opposite sign
    Done build(const Mesh& mesh, const SignBundle& bundle, Call& call);
};

// The zeros of a foliation, and the ways by which they come to vertices.
struct MovedZeros {
    ZeroList zeros;           // without the marked vertices that are none
    Array<uint8_t> untouched; // per vertex: no zero is there, came, or passed by; the fluxes of du are those of F
    Array<uint32_t>
        crossed; // half-edges: a leaf of F that turns around the origin in the face may be crossed by a zero
};

// Which corner of a tripod takes its zero.
enum class CornerChoice : uint8_t {
    nearest,
    keeps_class, // the nearest of those whose move passes the image of no vertex of the star
};

// The sign bundle and du of a foliation, |du| = F but beside the tripods:
// the zero in each moves to one of its corners, or to a vertex near by.
// HMF_ERROR_UNSUPPORTED if the mesh is so coarse that there are not enough.
// energy: of the foliation, in units.
[[nodiscard]] hmf_status form_of_foliation(const Foliation& f, const double* weight, double energy, CornerChoice choice,
                                           SignBundle& bundle, TwistedForm& du, MovedZeros& moved, Call& call);

// Sums over the triangles: whether both forms are closed, and the area of the image, with signs and without.
struct ImageSum {
    double area = 0, absolute_area = 0;
    uint64_t open = 0;
    void operator+=(const ImageSum& part) {
        area += part.area;
        absolute_area += part.absolute_area;
        open += part.open;
    }
};
ImageSum sum_image(const Mesh& mesh, const SignBundle& bundle, const TwistedForm& du, const TwistedForm& dv,
                   const Parallel& parallel);

// Reverses a flip of an edge of a mesh, of which `next` is enough, its bundle and two forms on it.
void unflip_forms(uint32_t* next, uint32_t edge, SignBundle& bundle, TwistedForm& du, TwistedForm& dv);

} // namespace hmf
