// A quad mesh along the leaves.
#pragma once

#include "cylinder_classes.hpp"

namespace hmf {

struct QuadMesh {
    Array<double> positions; // 3 per vertex; the zeros first, in their order
    Array<uint32_t> quads;   // 4 per quad, in the orientation of the triangles
};

// position: of the vertices of f.mesh; step: wished edge length in the flat
// metric, in units of f.  Cylinders of the same f.
[[nodiscard]] hmf_status make_quads(Foliation& f, const double* position, const Cylinders& cylinders, double step,
                                    QuadMesh& out, Call& call);

// Areas of the surface, in space and in the flat metric (squared units of f).
struct FlatMetric {
    double area = 0, flat_area = 0;
};
[[nodiscard]] hmf_status flat_metric(const Foliation& f, const double* position, const Cylinders& cylinders,
                                     FlatMetric& out, Call& call);

} // namespace hmf
