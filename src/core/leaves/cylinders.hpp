// The cylinders of a foliation: the components of the surface without its critical graph. There is one for each loop of
// the class, and its height is the weight of the loop.
#pragma once

#include "critical_graph.hpp"

namespace hmf {

// Part of a path across a cylinder: along half_edge from place `from` to place `to`.
struct PathPiece {
    uint32_t half_edge;
    int64_t from, to;
    int64_t height; // of its start above the lower boundary, half units
};

struct Cylinder {
    uint32_t lower, upper;         // boundaries
    int64_t height;                // units: the distance of the critical leaves
    uint64_t path_begin, path_end; // a path across, from the lower boundary leaf to the upper one
};

class Cylinders {
public:
    CriticalGraph graph;
    Array<Cylinder> list;        // in the order of their lower boundaries
    Array<uint32_t> of_boundary; // cylinder
    Array<PathPiece> pieces;

    [[nodiscard]] hmf_status build(Foliation& f, const uint32_t* vertex_order, const uint32_t* face_order, Call& call);
    // The same, where the zeros are known.
    [[nodiscard]] hmf_status build(Foliation& f, const ZeroList& known, Call& call);

    // Across the leaves from place `at` ahead on half-edge h to the first
    // boundary leaf; appends the way to `path` unless that is NULL.
    [[nodiscard]] hmf_status walk_across(Foliation& f, uint32_t h, int64_t at, Array<PathPiece>* path, LeafMark& found,
                                         int64_t& distance, Call& call);

private:
    [[nodiscard]] hmf_status find_cylinders(Foliation& f, Call& call);
    Done half_edge_ahead(Foliation& f, uint32_t back, uint32_t& best);
    Array<uint32_t> circle_;
};

} // namespace hmf
