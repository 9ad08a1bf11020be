// From the foliation to its holomorphic quadratic differential (du + i dv)^2:
//
//   F --tripods to vertices--> du --harmonic--> du --conjugate--> dv --harmonic--> dv
//
// F is harmonic already; moving the zeros to vertices disturbs it near them, so
// du is made harmonic again with the signs fixed: a linear problem, whose
// matrix serves for dv as well.
#include "flat_surface.hpp"

#include "harmonic_form.hpp"

namespace hmf {

hmf_status flat_surface(State& state, FlatSurface& flat, Call& call) {
    constexpr double tolerance = 1e-9;
    Foliation& f = state.foliation;
    const double* weight = state.hierarchy->levels[state.level].weight;
    if (form_of_foliation(f, weight, flat.bundle, flat.du, call)) return call.status();
    if (!call.tick(0.05)) return call.was_cancelled();
    VertexCharts charts;
    if (!charts.build(f.mesh, flat.bundle, call.memory)) return call.out_of_memory();
    TwistedLaplacian laplacian;
    if (laplacian.build(f.mesh, flat.bundle, charts, weight, call))
        return call.cancelled() ? call.was_cancelled() : call.status();
    if (!call.tick(0.3)) return call.was_cancelled();
    if (laplacian.make_harmonic(flat.du, tolerance, call) || !call.tick(0.5)) return call.was_cancelled();
    if (conjugate_form(f.mesh, flat.bundle, charts, weight, flat.du, flat.dv, call))
        return call.cancelled() ? call.was_cancelled() : call.status();
    if (!call.tick(0.6) || laplacian.make_harmonic(flat.dv, tolerance, call) || !call.tick(0.8))
        return call.was_cancelled();
    flat.iterations = laplacian.iterations();
    return HMF_OK;
}

Done flat_surface_to_input(State& state, FlatSurface& flat, Call& call) {
    Foliation& f = state.foliation;
    if (state.level == 0 && state.side == Side::intrinsic) {
        const hmf_hierarchy& h = *state.hierarchy;
        for (size_t i = h.intrinsic_flip_count; i-- > 0;) {
            if (i % 4096 == 0 && !call.tick(0)) return false;
            unflip_forms(f.mesh, h.intrinsic_flips[i], flat.bundle, flat.du, flat.dv);
        }
        state.side = Side::input;
    }
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e)
        f.value[e] = flat.du.value[e] < 0 ? -flat.du.value[e] : flat.du.value[e];
    return true;
}

void cone_angles(const Mesh& mesh, const FlatSurface& flat, int32_t* cone) {
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) cone[v] = 0;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        const uint32_t n = mesh.next[h], p = mesh.next[n];
        if (h > n || h > p) continue;
        // Places of the three corners by (u, v), in the chart of the face.
        const uint32_t corner[3] = {mesh.origin[h], mesh.origin[n], mesh.origin[p]};
        const int64_t u[3] = {0, flat.du.at(flat.bundle, h), -flat.du.at(flat.bundle, p)};
        const int64_t v[3] = {0, flat.dv.at(flat.bundle, h), -flat.dv.at(flat.bundle, p)};
        const auto before = [&](int a, int b) {
            return u[a] != u[b] ? u[a] < u[b] : v[a] != v[b] ? v[a] < v[b] : corner[a] < corner[b];
        };
        for (int c = 0; c < 3; ++c)
            if (before((c + 1) % 3, c) != before((c + 2) % 3, c)) ++cone[corner[c]];
    }
}

Done find_cones(const Mesh& mesh, const FlatSurface& flat, Array<int32_t>& cone, Array<uint8_t>& is_cone, Call& call) {
    VertexCharts charts;
    if (!charts.build(mesh, flat.bundle, call.memory) || !cone.allocate(call.memory, mesh.vertex_count)
        || !is_cone.allocate(call.memory, mesh.vertex_count) || !call.tick(0.81))
        return false;
    cone_angles(mesh, flat, cone.data());
    if (!call.tick(0.81)) return false;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v)
        is_cone[v] = charts.odd[v] || (cone[v] > 2 && is_visible(mesh, flat, v));
    return call.tick(0.82);
}

bool is_visible(const Mesh& mesh, const FlatSurface& flat, uint32_t v) {
    constexpr int64_t least = 1000; // units
    for (const uint32_t h : mesh.around(v)) {
        const int64_t u = flat.du.value[edge_of(h)], w = flat.dv.value[edge_of(h)];
        if (u < least && u > -least && w < least && w > -least) return false;
    }
    return true;
}

} // namespace hmf
