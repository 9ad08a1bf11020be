// Checks finished polylines against the foliation, from their points and edges alone.
//
//              k          Two consecutive points lie on sides of one triangle. Their corner is at the same
//             / \         distance from both in F, and no further than the branch point:
//            p---q
//           /     \           F_ij t_p = F_ik t_q <= a_i        t: fraction of the side from corner i
//          i-------j
#pragma once

#include "../parameterize/flat_cone_metric.hpp"
#include "polyline.hpp"

namespace hmf {

struct LineCheck {
    double deviation = 0; // largest difference of those distances, units
    uint64_t pairs = 0;   // of points that were compared
    uint64_t wrong = 0;   // pairs in no triangle, or further apart than rounding explains
};

// Compares the ends of every closed line and, of consecutive points, about `most_pairs`, evenly spread; all if there
// are fewer. Points without edge and arcs from vertex to vertex are left out.
[[nodiscard]] hmf_status check_lines(const Lines& lines, const Foliation& f, const double* position,
                                     uint64_t most_pairs, LineCheck& out, Call& call);

// Conjugate lines across cylinders: how much u changes along each, without the triangles at its ends, against the
// height of its cylinder.  Looks at some of them, of about `most_points` points in all.
[[nodiscard]] hmf_status check_crossings(const Lines& lines, const Mesh& mesh, const FlatConeMetric& flat,
                                         const double* position, const Array<double>& height, uint64_t most_points,
                                         uint64_t& wrong, Call& call);

} // namespace hmf
