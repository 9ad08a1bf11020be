// The cylinders of the flat surface, rolled out in the (u, v) plane.
//
//      v    cut           cut      cut            cut again, a period further
//      |     |             |        |              |
//      high -Z-------------+--------Z--------------Z-     upper zeros
//            |  piece 0    | 1      |  piece 2     |
//      low  -+-------------Z--------+--------------+-     lower zeros
//
// A triangle belongs to the strip in which its barycenter lies, as a whole.
//
// With boundary the cylinders are those of the double, and the part in front is kept: of one round a boundary curve
// what lies on one side of its middle leaf, of one across the surface half of the period.
#pragma once

#include "../../core/leaves/cylinders.hpp"
#include "../../core/leaves/mirror_symmetry.hpp"
#include "../parameterize/flat_cone_metric.hpp"

namespace hmf {

struct Strip {
    int64_t low = 0, high = 0; // u of its two sides
    int64_t period = 0;        // of v
    int64_t length = 0;        // of its pieces together: the period, or half of it from boundary to boundary
    uint32_t first_piece = 0;  // its pieces lie between its cuts, one after the other
};

struct Strips {
    Array<Strip> list;     // one for each cylinder, and an end
    Array<int64_t> cuts;   // per piece: v of its first side
    Array<int64_t> u, v;   // per half-edge: of the corner origin(h) of face(h) in its strip
    Array<int8_t> sign;    // per face: of its chart in the strip
    Array<uint32_t> piece; // per face; NONE behind

    uint32_t piece_count() const { return static_cast<uint32_t>(cuts.size()); }

    // mesh, foliation, cylinders and flat surface: of the caller's side of one level.
    // reflection: of a double, else NULL.  to_flat: units of the flat surface in one of the foliation.
    [[nodiscard]] hmf_status build(const Foliation& f, const Cylinders& cylinders, const FlatConeMetric& flat,
                                   const Reflection* reflection, double to_flat, Call& call);
};

} // namespace hmf
