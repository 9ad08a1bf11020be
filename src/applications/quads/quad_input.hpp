// What a quad mesh is made from, for all stages: an exact foliation with its cylinders, and
// of a double which part of them lies in front.
#pragma once

#include "../../core/leaves/cylinders.hpp"
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
};

} // namespace hmf
