// An atlas: charts without overlap in the unit square.
//
//   flat surface --Strips--> rectangles --Charts::join--> charts --cut, if they fit better so--> charts
//        --GridLayout, find_overlaps--> without overlap --Packer--> unit square
#pragma once

#include "strips.hpp"

namespace hmf {

struct Atlas {
    Array<double> uv;      // per half-edge 2: of the corner origin(h) of face(h)
    Array<uint32_t> chart; // per face; NONE behind
    uint32_t chart_count = 0;
    double side = 0;        // of the square, in units of which all coordinates are whole multiples
    double used_area = 0;   // of the square
    uint64_t collapsed = 0; // triangles

    // Both triangles of the edge meet along it in the square.
    bool is_joined(const Mesh& mesh, uint32_t edge) const;

    // mesh and position: of the side that the strips are on.
    // margin: distance of charts, as a part of the side of the square.
    [[nodiscard]] hmf_status build(const Mesh& mesh, const double* position, const SignBundle& bundle,
                                   const Strips& strips, double margin, Call& call);
};

} // namespace hmf
