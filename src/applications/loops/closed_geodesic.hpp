// A loop pulled straight: from a strip of triangles to the strip of a closed
// geodesic in the same class, and its length.
//
//        \  /\  /\  /           1  The strip is unfolded into the plane, and the shortest
//      ---\/--\/--\/---            curve in it found by pulling a string (Lee, Preparata,
//         /\  /\  /\               1984; the funnel).  It bends at vertices of the border.
//        /  \/  \/  \           2  Where the angle on the outer side of such a vertex is less
//                                  than a half turn, the strip goes around it on that side,
//                                  and the curve gets shorter (as in Sharp, Crane: You can
//                                  find geodesic paths in triangle meshes by just flipping
//                                  edges, 2020).
//
// Repeated until it gets no shorter, with a fixed point of the curve, alternately on opposite sides (Birkhoff's curve
// shortening, of two arcs).  A marked vertex stays on its side.
//
// A surface with bumps has several closed geodesics in a class.  So the strip is
// also pushed aside, over the vertices on one side of it, once or several times,
// and pulled straight from there:
//
//         /\  /\  /\  /          new strip: around the vertices v on its other side
//      --v---v---v---v--
//         \/  \/  \/  \          old strip
#pragma once

#include "../../core/curves/loops.hpp"

#include <cmath>

namespace hmf {

class ClosedGeodesic {
public:
    // position: 3 per vertex.  scale: unit of the lengths; 0: the largest coordinate.
    ClosedGeodesic(const Mesh& mesh, const double* position, double scale, Call& call);

    // Curve of a strip: where it bends, or one point on the first edge.
    struct Bend {
        double x, y;     // in the plane
        uint32_t portal; // crossing at which the vertex is an end
        bool left;       // of the loop
    };

    // Replaces the loop; its length.  At most `rounds` times step 2.  Half done, if it gets longer than is of interest.
    Done straighten(Array<uint32_t>& loop, size_t rounds, double& length, double interest = HUGE_VAL);

    // The shortest of those on both sides, up to a distance of some strips.
    Done straighten_widely(Array<uint32_t>& loop, size_t rounds, double& length);

    // Lengths of edges are kept from now on: for many loops.
    Done keep_lengths();

    double scale() const { return scale_; }

private:
    struct Point {
        double x, y;
    };
    struct Portal {
        Point left, right;
    };
    struct Held { // a point of the curve, on an edge that it crosses
        uint32_t crossing;
        double share; // 0 at the origin of the half-edge, 1 at its target
    };

    double edge_length(uint32_t edge) {
        if (edge_length_.empty()) return measure_edge(edge);
        double& length = edge_length_[edge];
        if (length < 0) length = measure_edge(edge);
        return length;
    }
    double measure_edge(uint32_t edge) const;
    Done unfold(const uint32_t* loop, size_t n, size_t portals);
    Done pull(Point from, size_t first, Point to, size_t last);
    Done look_outside(const uint32_t* loop, size_t n, size_t bend, Point from, Point to, size_t& first, size_t& count,
                      bool& shorter);
    Done push_aside(const Array<uint32_t>& loop, bool left, bool& moved);
    Done go_round(const uint32_t* loop, size_t n, Point from, Point to, bool& changed);
    Done take_next(Array<uint32_t>& loop, bool& taken);
    Held held_next(const uint32_t* loop, size_t n, Point from, Point to) const;
    double share_at(Point from, Point to, size_t portal) const;
    static double crossed_at(Point at, Point ahead, const Portal& p);
    double pulled_length(Point from, Point to) const;

    const Mesh& mesh_;
    const double* position_;
    double scale_;
    Call& call_;
    Array<double> edge_length_; // if they are kept; below 0: not known yet
    Array<Portal> portal_;
    Array<Bend> bend_, chain_[2]; // chain_: of the funnel
    struct Detour {
        size_t first, begin, end; // the crossing where it begins; in around_
        bool left;                // of the loop
    };
    Array<Detour> detour_;
    Array<uint32_t> detours_at_; // per crossing
    Array<uint32_t> next_, outside_, around_;
    Array<uint32_t> best_, pushed_, tried_;
    uint64_t work_ = 0;
};

} // namespace hmf
