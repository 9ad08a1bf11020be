// The critical graph: the zeros of a foliation, its marked vertices, and the
// leaves between them.
//
// A zero of order m has m + 2 prongs and as many sectors between them, a marked
// vertex that is no zero has one of both (foliation.hpp).  In each
// sector a leaf passes half a unit away.  Such a boundary leaf goes on along a
// prong, past the next zero, and so on, until it closes: it runs around one side
// of the critical graph, which lies on its left, and bounds a cylinder on its right.
//
//            prong of s
//               |                 s' = next of s (counter-clockwise)
//       sector  |  sector         the prong of s is the one between s and s'
//         s'    |    s            a boundary leaf comes to s along the prong of
//        -------Z-------          the sector before, and leaves along its own
//
// So the order of the sectors along boundary leaves determines how prongs are joined to arcs (saddle connections),
// without following a leaf that hits a vertex.  The arc itself lies half a unit left of the boundary leaf.
//
// Two marked vertices may have the same image.  Their cluster is then the arc between them, which a closed leaf
// surrounds (if both lie on its boundary; otherwise it has one sector and no prong):
//
//        .------------------.          its sectors are those half-edges of the
//       (  p ------------ q  )         circle that start at p and at q
//        '------------------'
//
// On an exactly symmetric double a leaf can run along the boundary.  All its vertices
// there have one image, a cluster.  It can be divided (ClusterDivision):
// a zero at each vertex where prongs leave and at each marked one, and between
// them arcs along the boundary, again the parts of the circle between their sectors:
//
//           |           |
//     ======x1---------x2=====p     x1, x2: three prongs each, p: marked, one prong
//           |           |
#pragma once

#include "../base/sparse_map.hpp"
#include "leaf.hpp"

namespace hmf {

struct Zero {
    bool tripod;
    uint32_t element; // vertex (of a cluster the first in the given order); tripod: a half-edge of it
    int32_t index;    // 0: a marked vertex, which is the element
    int64_t euler;    // of its cluster; 1 is a disk
};

struct Sector {
    uint32_t zero;
    uint32_t next, previous; // counter-clockwise around the zero; itself if there is no prong
    uint32_t last;           // half-edge out of the zero, last of the sector; tripod: out of the corner
    uint32_t arc;            // the side of an arc that leaves here, NONE without prong
    uint32_t boundary;
};

// One side of a saddle connection: part of a boundary leaf.
struct ArcSide {
    uint32_t from, to;    // sectors
    uint64_t first, last; // crossings; of a tripod's sector, `last` is the one after its middle
    uint32_t twin;        // the other side
};

struct Boundary {
    uint64_t begin, end;           // its crossings; the last repeats the first
    uint32_t arcs_begin, arcs_end; // in the order of the leaf
};

// Where a boundary leaf crosses an edge, seen along half-edge 2e.
struct LeafMark {
    int64_t at;
    uint32_t boundary;
    bool forward; // its cylinder lies ahead (larger places)
};

// Where the zeros are: vertices of their clusters, in any order, and a
// half-edge of each tripod.
struct ZeroList {
    bool known = false;
    Array<uint32_t> vertices, tripods;
};

// Divides the cluster in f.members into several zeros, which it adds to the graph with their sectors, if done.
class CriticalGraph;
struct ClusterDivision {
    const void* user = nullptr;
    Done (*divide)(const void* user, CriticalGraph& graph, const Foliation& f, int32_t index, int64_t euler,
                   bool& done) = nullptr;
};

// Only edges that a boundary leaf crosses have an entry anywhere, so that the
// graph costs the length of these leaves (and a pass over the mesh to find
// the zeros, unless they are known).
class CriticalGraph {
public:
    Array<Zero> zeros;
    Array<Sector> sectors;
    Array<ArcSide> arcs;
    Array<Boundary> boundaries;
    Array<Crossing> crossings;
    Array<LeafMark> marks; // ascending on each edge
    static constexpr uint32_t BETWEEN = NONE - 1;
    SparseMap at_vertex; // half-edge out of a cluster to its sector; BETWEEN two marked vertices or zeros

    // Wishes, before build().
    ClusterDivision division;    // of a double: clusters on the boundary; by default they stay whole
    uint32_t closed_leaf = NONE; // where there is no zero: an edge that the leaf crosses in its middle

    // vertex_order, face_order: internal numbers in the order in which zeros
    // are listed, and behind them the marked vertices that are none; NULL: as
    // they are.  Without any of these (genus 1) one closed leaf
    // of the torus counts as critical, with a boundary leaf on either side.
    [[nodiscard]] hmf_status build(Foliation& f, const uint32_t* vertex_order, const uint32_t* face_order, Call& call);
    // The same, where the zeros are known.
    [[nodiscard]] hmf_status build(Foliation& f, const ZeroList& known, Call& call);
    // The marks of an edge.
    void marks_on(uint32_t edge, uint32_t& begin, uint32_t& end) const {
        begin = end = 0;
        const uint32_t k = marked_.find(edge);
        if (k == SparseMap::ABSENT) return;
        begin = mark_offset_[k];
        end = mark_offset_[k + 1];
    }

    // Zeros and sectors alone, for foliations whose leaves do not close.
    [[nodiscard]] hmf_status build_sectors(Foliation& f, const uint32_t* vertex_order, const uint32_t* face_order,
                                           Call& call);

    // The sector that a leaf passes at a crossing, or NONE.
    uint32_t sector_at(const Foliation& f, const Crossing& c) const;

    // More crossings than any leaf of a harmonic foliation has.
    uint64_t crossing_limit() const { return crossing_limit_; }

    // The mark nearest ahead of place `at` on half-edge h: true if there is one.
    bool mark_ahead(const Foliation& f, uint32_t h, int64_t at, LeafMark& found) const;

private:
    Done start(const Foliation& f, Memory& memory);
    [[nodiscard]] hmf_status trace(const Foliation& f, Call& call);
    Done add_zero_at(Foliation& f, uint32_t vertex, int32_t index, int64_t euler);
    Done add_tripod(const Foliation& f, uint32_t half_edge, int32_t index);
    [[nodiscard]] hmf_status find_zeros(Foliation& f, const uint32_t* vertex_order, const uint32_t* face_order,
                                        Call& call);
    [[nodiscard]] hmf_status find_marked(Foliation& f, const uint32_t* vertex_order, const int32_t* at_vertex,
                                         const uint32_t* cluster, Call& call);
    Done add_sectors_of_vertex(const Foliation& f, uint32_t zero, uint32_t vertex);
    Done add_sectors_of_circle(const Foliation& f, uint32_t zero, uint32_t h);
    Done add_sectors_of_pair(const Foliation& f, uint32_t zero, uint32_t other_zero, bool& done);
    Done add_sectors_of_tripod(const Foliation& f, uint32_t zero, uint32_t h);
    [[nodiscard]] hmf_status trace_boundary(const Foliation& f, Crossing start, Call& call);
    [[nodiscard]] hmf_status pair_arcs(Call& call);
    Done sort_marks(const Foliation& f, Memory& memory);

    SparseMap at_tripod_;         // half-edge to sector
    SparseMap marked_;            // edge to its number among those with marks
    Array<uint32_t> mark_offset_; // of these, and the end
    Array<uint32_t> circle_;
    Memory* memory_ = nullptr;
    uint64_t crossing_limit_ = 0;
};

// Once around the boundary of a cluster, from h on: visit(half-edge, the next one, a closed corner lies between).
template <class Visit>
Done for_circle(const Foliation& f, uint32_t h, Visit visit) {
    uint32_t g = h;
    do {
        bool closed = false;
        const uint32_t ahead = next_round(f, g, closed);
        if (!visit(g, ahead, closed)) return false;
        g = ahead;
    } while (g != h);
    return true;
}

} // namespace hmf
