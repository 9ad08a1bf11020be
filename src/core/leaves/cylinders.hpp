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

    // The leaf at a height (half units above the lower critical leaves, odd),
    // where it crosses the path; it has the direction of the lower boundary leaf.
    Crossing leaf_at(const Foliation& f, uint32_t cylinder, int64_t height, uint64_t* piece = nullptr) const;

    // Which cylinder a leaf lies in, and how high (half units).
    [[nodiscard]] hmf_status locate(Foliation& f, const Crossing& c, uint32_t& cylinder, int64_t& height, Call& call);

    // The cylinder of each vertex, NONE on critical leaves; for visit_parts.
    Done find_vertices(const Foliation& f, Call& call);

    // visit(cylinder, from, to) for the parts of edge e between critical
    // leaves, along half-edge 2e in half units.
    template <class Visit>
    void visit_parts(const Mesh& mesh, const int64_t* value, uint32_t e, Visit visit) const {
        uint32_t begin = 0, end = 0;
        graph.marks_on(e, begin, end);
        uint32_t inside = of_vertex_[mesh.origin[2 * e]];
        if (inside == NONE && begin == end) inside = of_vertex_[mesh.target(2 * e)];
        int64_t from = 0;
        for (uint32_t i = begin; i < end; ++i) {
            const LeafMark& m = graph.marks[i];
            if (m.forward) {
                inside = of_boundary[m.boundary];
                from = m.at - 1; // critical leaves lie half a unit beyond marks
            } else {
                visit(of_boundary[m.boundary], from, m.at + 1);
                inside = NONE;
            }
        }
        if (inside != NONE && from < 2 * value[e]) visit(inside, from, 2 * value[e]);
    }

private:
    [[nodiscard]] hmf_status find_cylinders(Foliation& f, Call& call);
    // Across the leaves from place `at` ahead on half-edge h to the first
    // boundary leaf; appends the way to `path` unless that is NULL.
    [[nodiscard]] hmf_status walk_across(Foliation& f, uint32_t h, int64_t at, Array<PathPiece>* path, LeafMark& found,
                                         int64_t& distance, Call& call);
    Done half_edge_ahead(Foliation& f, uint32_t back, uint32_t& best);
    Array<uint32_t> circle_, of_vertex_;
};

// A whole closed leaf, from c on, without repeating it.  False: out of memory,
// or more than limit crossings (then found is empty).
bool closed_leaf(const Foliation& f, const Crossing& c, uint64_t limit, Array<Crossing>& found);

// Closed curves of a level, one after the other.
struct Curves {
    Array<uint64_t> offsets; // count + 1
    Array<Crossing> crossings;
};

// The middle leaves of the cylinders; found reorders them (NULL: as they are).
[[nodiscard]] hmf_status middle_leaves(const Foliation& f, const Cylinders& cylinders, const Array<uint32_t>* found,
                                       Curves& out, Call& call);

// Areas of the cylinders in the flat metric, the sum of weight * F * (part of F
// in the cylinder): together the energy.  Squared units; after find_vertices.
[[nodiscard]] hmf_status cylinder_areas(const Foliation& f, const Cylinders& cylinders, const double* weight,
                                        double* area, Call& call);

} // namespace hmf
