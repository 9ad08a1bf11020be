#include "trace.hpp"

namespace hmf {

hmf_status trace_leaves(const hmf_trace_options& all, const Array<uint32_t>& side, Cylinders& cylinders, Lines& made,
                        Call& call) {
    if (all.spacing > 0 && made.add_levels(cylinders, all.spacing)) return call.status();
    if (all.critical && made.add_arcs(cylinders.graph)) return call.status();
    for (uint64_t i = 0; i < all.point_count; ++i)
        if (made.add_point(&cylinders, side[all.point_triangles[i]], all.point_barycentrics + 3 * i,
                           static_cast<uint32_t>(i)))
            return call.status();
    return HMF_OK;
}

hmf_status trace_conjugate(Foliation& g, const double* position, const FlatConeMetric& flat, double unit,
                           const hmf_trace_options& all, const Array<uint32_t>& side, const ConjugateLevels& levels,
                           Lines& made, Call& call) {
    Array<int64_t> du;
    if (!du.allocate(call.memory, g.mesh.edge_count)) return call.out_of_memory();
    for (uint32_t e = 0; e < g.mesh.edge_count; ++e) {
        du[e] = flat.du.value[e] < 0 ? -flat.du.value[e] : flat.du.value[e];
        g.value[e] = flat.dv.value[e] < 0 ? -flat.dv.value[e] : flat.dv.value[e];
    }
    if (all.spacing > 0 && add_conjugate_levels(made, g, du.data(), levels, all.spacing, unit, position, call))
        return call.status();
    if (all.critical && add_conjugate_prongs(made, g, position, call)) return call.status();
    for (uint64_t i = 0; i < all.point_count; ++i)
        if (made.add_point(nullptr, side[all.point_triangles[i]], all.point_barycentrics + 3 * i,
                           static_cast<uint32_t>(i)))
            return call.status();
    return HMF_OK;
}

} // namespace hmf
