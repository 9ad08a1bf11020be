#include "parameterization.hpp"

#include "../../core/foliation/whitehead.hpp"

#include <cmath>

namespace hmf {

// Refuses values whose residual of [W] Eq. 4 is above the tolerance, except at a few vertices that may have moved
// between the two triangulations of level 0. Those are relaxed.
hmf_status check_harmonic(State& state, double tolerance, Call& call) {
    Foliation& f = state.foliation;
    const double* weight = state.hierarchy->levels[state.level].weight;
    const uint32_t n = f.mesh.vertex_count;
    Rings rings;
    Star star;
    Array<double> residual;
    if (!rings.build(f.mesh, weight, call.memory, call.parallel) || !star.allocate(call.memory, rings.max_degree)
        || !residual.allocate(call.memory, n))
        return call.out_of_memory();
    ResidualResult found;
    for (uint32_t round = 0; round < 100; ++round) {
        found = residuals(f, rings, weight, star, residual.data(), call);
        if (call.cancelled()) return call.was_cancelled();
        if (found.max <= tolerance) return HMF_OK;
        uint32_t above = 0;
        for (uint32_t v = 0; v < n; ++v) above += residual[v] > tolerance;
        if (above > 16 + n / 20) break;
        SweepResult moved;
        for (uint32_t v = 0; v < n; ++v) {
            if (!(residual[v] > tolerance)) continue;
            relax_vertex(f, rings, weight, v, star, moved);
            for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t)
                relax_vertex(f, rings, weight, f.mesh.target(rings.side[t].half_edge), star, moved);
        }
    }
    uint64_t vertex = found.worst;
    for (uint64_t v = 0; state.level == 0 && v < state.foliation.mesh.vertex_count; ++v)
        if (state.hierarchy->vertex_internal[v] == found.worst) {
            vertex = v;
            break;
        }
    return call.fail(HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ELEMENT_VERTEX, vertex,
                     "The residual at vertex %llu is %g, above the tolerance %g. Improve the values with hmf_relax.",
                     static_cast<unsigned long long>(vertex), found.max, tolerance);
}

namespace {

// Length of each edge for the seams; edges that the caller prefers have a length close to 0.
hmf_status seam_lengths(const Mesh& mesh, const double* position, const Array<uint32_t>& cheap, Array<double>& length,
                        Array<double>& cost, Call& call) {
    if (!length.allocate(call.memory, mesh.edge_count) || !cost.allocate(call.memory, mesh.edge_count))
        return call.out_of_memory();
    const double sum = call.parallel.sum_blocks<double>(mesh.edge_count, [&](size_t begin, size_t end) {
        double part = 0;
        for (size_t e = begin; e < end; ++e) {
            double square = 0;
            for (uint32_t a = 0; a < 3; ++a) {
                const double d =
                    position[3 * size_t{mesh.origin[2 * e]} + a] - position[3 * size_t{mesh.origin[2 * e + 1]} + a];
                square += d * d;
            }
            length[e] = cost[e] = std::sqrt(square);
            part += length[e];
        }
        return part;
    });
    const double least = 1e-6 * sum / mesh.edge_count;
    for (const uint32_t e : cheap) cost[e] = least;
    return HMF_OK;
}

} // namespace

Transition Parameterization::transition(const Mesh& mesh, const SignBundle& bundle, uint32_t h) const {
    const uint32_t t = twin(h), there = mesh.next[t];
    const int8_t sign =
        static_cast<int8_t>(layout.chart[mesh.face[h]] * layout.chart[mesh.face[t]] * bundle.turn[edge_of(h)]);
    const Layout::Point &from = layout.at[h], &to = layout.at[there];
    return {sign, to.u - sign * from.u, to.v - sign * from.v};
}

hmf_status Parameterization::build(const Mesh& mesh, const double* position, const FlatConeMetric& flat, uint32_t start,
                                   const Array<uint32_t>& seam_edges, Call& call) {
    Array<uint8_t> is_cone;
    Array<double> cost;
    VertexCharts charts;
    if (!charts.build(mesh, flat.bundle, call) || !find_cones(mesh, flat, charts, cone, is_cone, call))
        return call.stopped();
    for (uint32_t v = mesh.vertex_count; v-- > 0;)
        if (is_cone[v]) start = mesh.out[v];
    if (seam_lengths(mesh, position, seam_edges, length, cost, call)) return call.status();
    if (!call.tick(0.85)) return call.was_cancelled();
    if (!cut_through_cones(mesh, charts.stars, cost.data(), is_cone.data(), start, seams, call)
        || !layout.build(mesh, flat.bundle, flat.du, flat.dv, seams, call))
        return call.stopped();
    return call.tick(0.95) ? HMF_OK : call.was_cancelled();
}

AffineMap Parameterization::map_of(const Mesh& mesh, const double* position, uint32_t side, double unit) const {
    const uint32_t h[3] = {side, mesh.next[side], mesh.prev(side)};
    double u[3], v[3];
    for (int c = 0; c < 3; ++c) {
        const Layout::Point &p = layout.at[h[c]], &first = layout.at[side];
        u[c] = static_cast<double>(p.u - first.u) * unit;
        v[c] = static_cast<double>(p.v - first.v) * unit;
    }
    AffineMap map = affine_map(position + size_t{3} * mesh.origin[h[0]], position + size_t{3} * mesh.origin[h[1]],
                               position + size_t{3} * mesh.origin[h[2]], u, v);
    // Where the image is no larger than what rounding and the linear solver leave, it says nothing.
    constexpr double least = 1 << 16; // units
    double size = 0;
    for (int c = 0; c < 3; ++c) {
        if (size < std::fabs(u[c])) size = std::fabs(u[c]);
        if (size < std::fabs(v[c])) size = std::fabs(v[c]);
    }
    if (size < least * unit) map.dilatation = HUGE_VAL;
    return map;
}

} // namespace hmf
