// What a quad mesh is made from, for all stages: an exact foliation with its cylinders, and
// of a double which part of them lies in front.
#pragma once

#include "../common/cylinder_leaves.hpp"
#include "../lines/front_parts.hpp"
#include "quad_rulers.hpp"

namespace hmf {

struct QuadInput {
    Foliation& f;
    const double* position; // 3 per vertex
    const Cylinders& cylinders;
    const CriticalGraph& graph; // of the cylinders
    const FrontParts* front;    // NULL: the surface is closed
    Conjugate conjugate;

    bool tripod(uint32_t sector) const { return graph.zeros[graph.sectors[sector].zero].tripod; }
    Part part_of_arc(uint32_t a) const { return front ? front->arc[a] : Part::front; }
    Part part_of(uint32_t cylinder) const { return front ? front->cylinder[cylinder] : Part::front; }
    bool is_half(uint32_t a) const { return part_of_arc(a) == Part::first_half || part_of_arc(a) == Part::second_half; }
    bool is_annulus() const { return front && graph.zeros.empty(); } // then with one cylinder
    Point place_of(const Crossing& c) const;
};

// Of all cylinders in the flat metric, each as long as the leaf in its middle; squared units of f.
[[nodiscard]] hmf_status flat_area(const QuadInput& in, double& area, Call& call);

// A line along leaves of a double that may run on the boundary of the surface.
class BoundaryRuler : public Ruler {
public:
    // A vertex of the boundary, with those that lie between the one before and it: past parts that no leaf
    // crosses.  ahead: the line runs with the front on its left; round: once round, if it is the same vertex.
    // Other vertices are left out.
    Done push_on_boundary(const QuadInput& in, double value, uint32_t vertex, bool ahead, bool round = false);

private:
    uint32_t last_ = NONE; // vertex of the boundary
};

} // namespace hmf
