// Leaves at any height of a cylinder, and the parts of edges in each cylinder.
#pragma once

#include "../../core/leaves/cylinders.hpp"

namespace hmf {

// Does the leaf, where it comes over c, turn around the corner on its left?
inline bool turns_left(const Foliation& f, const Crossing& c) {
    return width(f, c.half_edge) - c.at < branch(f, twin(c.half_edge));
}

// The leaf at a height (half units above the lower critical leaves, odd), where it crosses the path; it has the
// direction of the lower boundary leaf.
Crossing leaf_at(const Foliation& f, const Cylinders& cylinders, uint32_t cylinder, int64_t height);

// Which cylinder a leaf lies in, and how high (half units).
[[nodiscard]] hmf_status locate(Foliation& f, Cylinders& cylinders, const Crossing& c, uint32_t& cylinder,
                                int64_t& height, Call& call);

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

class CylinderParts {
public:
    Done find(const Foliation& f, const Cylinders& cylinders, Call& call);

    // visit(cylinder, from, to) for the parts of edge e between critical
    // leaves, along half-edge 2e in half units.
    template <class Visit>
    void visit(const Foliation& f, uint32_t e, Visit visit) const {
        const CriticalGraph& graph = cylinders_->graph;
        const Array<uint32_t>& of_boundary = cylinders_->of_boundary;
        uint32_t begin = 0, end = 0;
        graph.marks_on(e, begin, end);
        uint32_t inside = of_vertex_[f.mesh.origin[2 * e]];
        if (inside == NONE && begin == end) inside = of_vertex_[f.mesh.target(2 * e)];
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
        if (inside != NONE && from < 2 * f.value[e]) visit(inside, from, 2 * f.value[e]);
    }

private:
    const Cylinders* cylinders_ = nullptr;
    Array<uint32_t> of_vertex_; // the cylinder of each vertex, NONE on critical leaves
};

// Areas of the cylinders in the flat metric, the sum of weight * F * (part of F in the cylinder): together the energy.
// Squared units.
[[nodiscard]] hmf_status cylinder_areas(const Foliation& f, const Cylinders& cylinders, const double* weight,
                                        double* area, Call& call);

} // namespace hmf
