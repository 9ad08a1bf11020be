// The pieces that an atlas is made of, as they lie in their strips, and what is measured on them once.
#pragma once

#include "strips.hpp"

namespace hmf {

struct FlatPieces {
    const Mesh& mesh;
    const double* position;
    const SignBundle& bundle;
    const Strips& strips;
    double margin; // of charts, as a part of the side of the square

    Array<uint32_t> side;      // a half-edge of each face; with boundary also of those behind, which have no piece
    Array<double> area, image; // per piece, twice: in space, in the plane
    double whole = 0, whole_area = 0; // image of all; twice the surface
    double triangle = 0;              // length of a side in the plane
    int64_t mirror = 1;               // -1: the plane is turned over

    [[nodiscard]] hmf_status measure(Call& call);
    // Twice the area of the face of h, in space and in the plane.
    double twice_area(uint32_t h) const;
    double image_area(uint32_t h) const;
};

} // namespace hmf
