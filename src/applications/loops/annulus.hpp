// The shortest loop homotopic to a given one on a cut surface, searched in a
// strip of its annular cover, where a class is a number of turns.
//
// The strip begins with the regions that the loop runs through and grows at
// its nearest border.  A region of the surface may come in several copies; two
// sides that meet in a vertex and are the same segment close up there:
//
//      \ new /  |                     \     /
//       \   /   | same segment   ->    \ | /       the vertex is inside now
//    ----\-/----+                  -----\|/
//         v                              v
//
// so that turns around a vertex do not count, and turns around the strip do.  They
// stay apart at a marked vertex, since loops must not be pulled over it.
// A loop with a bigon around some vertices comes back into the region where
// the bigon began: two copies of the strip are the same region of the cover,
// and a link without length joins them.
//
// Links carry 0 or 1 turn; a shortest path from a copy to itself one turn on,
// least over the copies where turns are counted, is the shortest loop.
#pragma once

#include "../../core/base/nearest_first.hpp"
#include "dual_length.hpp"
#include "../../core/curves/multicurve.hpp"

namespace hmf {

class Annulus {
public:
    Annulus(const Mesh& mesh, const DualLength& length, Call& call) : mesh_(mesh), length_(length), call_(call) {
        copies_.start(call.memory);
        border_.start(call.memory);
        heap_.start(call.memory);
        fan_.start(call.memory);
    }

    // A place on an edge: between two of the curves, from the origin of the half-edge.
    struct Place {
        uint32_t half_edge, position;
    };

    // The surface is cut along the curves with `count` crossings per edge; the
    // loop leaves regions at the given places.  Copies are at most `capacity`
    // (at least those of the loop).  On success `out` is a shortest loop within
    // the strip, in the same direction, if it is shorter than limit; else it is
    // empty.  It may go back and forth.
    Done shortest(const Array<uint32_t>& count, const Array<Place>& loop, size_t capacity, double limit,
                  Array<uint32_t>& out);

private:
    struct Copy {
        Place side[3];    // counter-clockwise
        double length[3]; // to the region beyond
        uint32_t to[3];   // 4 * copy + side, or NONE at the border
        int32_t turns[4];
        uint32_t sides;
        uint32_t same;   // a copy that is the same region, or NONE; its turns are turns[3]
        double distance; // from the loop
    };
    struct Border {
        uint32_t link, before, after;
    }; // link: 4 * copy + side
    struct Wedge {
        uint32_t copy;
        int32_t turns;
    };                   // of a fan, turns since its first
    struct SearchState { // of the search, a copy with a turn
        double distance;
        uint32_t from, stamp; // from: 4 * copy + side
    };

    // The sides of the strip that begin at the end of this one may be the same segments again.
    bool ends_at_plain_vertex(Place p) const {
        return p.position == count(p.half_edge) && !mesh_.is_marked(mesh_.target(p.half_edge));
    }
    uint32_t count(uint32_t h) const { return (*count_)[edge_of(h)]; }
    Place other(Place p) const { return {twin(p.half_edge), count(p.half_edge) - p.position}; }
    Done add_copy(Place entry, double distance);
    Done push_border(uint32_t link, uint32_t before, uint32_t after);
    Done build_strip(const Array<Place>& loop);
    Done grow(size_t capacity);
    void close_up(uint32_t a);
    Done find_same(uint32_t a);
    double way_left(uint32_t state, uint32_t goal) const;
    Done search_from(uint32_t root, bool is_landmark, double& best, Array<uint32_t>& out);
    Done read_way(uint32_t start, uint32_t goal, Array<uint32_t>& out) const;
    Done search(double limit, Array<uint32_t>& out);

    const Mesh& mesh_;
    const DualLength& length_;
    Call& call_;
    const Array<uint32_t>* count_ = nullptr;
    Array<Copy> copies_;
    Array<Border> border_;
    NearestFirst heap_;
    Array<Wedge> fan_;
    Array<SearchState> state_; // per copy and turn
    Array<double> landmark_;   // likewise, the distance from the landmark
    uint32_t stamp_ = 0;
    uint64_t settled_ = 0; // states, by all searches of one loop
};

} // namespace hmf
