// What lies in front of the critical graph and the cylinders of an exactly symmetric
// double, and what is the mirror image of what.
#pragma once

#include "../../core/leaves/cylinders.hpp"
#include "../../core/leaves/mirror_symmetry.hpp"

namespace hmf {

enum class Part : uint8_t {
    front,
    back,
    on_boundary, // a zero there
    first_half,  // an arc across the boundary: the half at its beginning lies in front
    second_half,
    strip, // a cylinder that the boundary crosses twice: one half of its circumference lies in front
    ring   // a cylinder around a boundary curve, which is its middle: the lower half lies in front
};

struct FrontParts {
    const Reflection* reflection = nullptr;
    Array<Part> zero, arc, cylinder; // arc: per side; along the boundary the side towards the front is in front
    Array<uint32_t> arc_mirror;      // per side
    Array<uint64_t> arc_middle;      // per side: the crossing of the boundary, of the halves
    Array<uint32_t> cylinder_mirror;

    // Turns rings whose upper half lies in front upside down.
    [[nodiscard]] hmf_status build(Foliation& f, const Reflection& mirror, Cylinders& cylinders, Call& call);

    bool crosses_to_front(const Crossing& c) const {
        return reflection->on_boundary(c.half_edge) && !reflection->is_front[c.half_edge];
    }
    bool crosses_to_back(const Crossing& c) const {
        return reflection->on_boundary(c.half_edge) && reflection->is_front[c.half_edge];
    }
    // Of the part of a leaf behind a crossing.
    bool goes_on_in_front(const Crossing& c) const { return reflection->is_front[twin(c.half_edge)]; }
};

} // namespace hmf
