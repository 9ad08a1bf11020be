#include "trace.hpp"

#include "../parameterize/flat_surface.hpp"
#include "../solve/to_minimum.hpp"

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

hmf_status trace_conjugate(State& state, double unit, const hmf_trace_options& all, const Array<uint32_t>& side,
                           ConjugateLevels& levels, Lines& made, Call& call) {
    Foliation& f = state.foliation;
    FlatSurface flat;
    Array<int64_t> du;
    const double before = unit;
    if (to_minimum(state, unit, call)) return call.status();
    for (double& height : levels.height) height *= before / unit;
    if (flat_surface(state, flat, call)) return call.status();
    if (!flat_surface_to_input(state, flat, call) || !du.allocate(call.memory, f.mesh.edge_count))
        return call.stopped();
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) {
        du[e] = flat.du.value[e] < 0 ? -flat.du.value[e] : flat.du.value[e];
        f.value[e] = flat.dv.value[e] < 0 ? -flat.dv.value[e] : flat.dv.value[e];
    }
    const double* position = state.hierarchy->levels[state.level].position;
    if (all.spacing > 0 && add_conjugate_levels(made, f, du.data(), levels, all.spacing, unit, position, call))
        return call.status();
    if (all.critical && add_conjugate_prongs(made, f, position, call)) return call.status();
    for (uint64_t i = 0; i < all.point_count; ++i)
        if (made.add_point(nullptr, side[all.point_triangles[i]], all.point_barycentrics + 3 * i,
                           static_cast<uint32_t>(i)))
            return call.status();
    return HMF_OK;
}

} // namespace hmf
