// hmf.h: parameterisation.
#include "../base/sort_keys.hpp"
#include "../foliation/whitehead.hpp"
#include "../parameterize/dilatation.hpp"
#include "../parameterize/flat_surface.hpp"
#include "../parameterize/seams.hpp"
#include "values.hpp"

#include <cmath>

using namespace hmf;

namespace {

hmf_status cancelled(Call& call) {
    return call.fail(HMF_CANCELLED, HMF_ELEMENT_NONE, 0, "Cancelled by the progress callback.");
}

// Refuses values whose residual of [W] Eq. 4 is above the tolerance, but for a
// few vertices: the way between the two triangulations of level 0 may have to
// move some.  They are relaxed.
hmf_status check_harmonic(State& state, double tolerance, Call& call) {
    Foliation& f = state.foliation;
    const double* weight = state.hierarchy->levels[state.level].weight;
    const uint32_t n = f.mesh.vertex_count;
    Rings rings;
    Star star;
    Array<double> residual;
    if (!rings.build(f.mesh, weight, call.memory) || !star.allocate(call.memory, rings.max_degree)
        || !residual.allocate(call.memory, n))
        return call.out_of_memory();
    ResidualResult found;
    for (uint32_t round = 0; round < 100; ++round) {
        found = residuals(f, rings, weight, star, residual.data(), call);
        if (f.out_of_memory) return call.out_of_memory();
        if (call.cancelled()) return cancelled(call);
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

// Length of each edge for the seams; those that the caller prefers hardly count.
hmf_status seam_lengths(const State& state, const hmf_parameterize_options& all, Array<double>& length,
                        Array<double>& cost, Call& call) {
    const Mesh& mesh = state.foliation.mesh;
    const double* position = state.hierarchy->levels[state.level].position;
    if (!length.allocate(call.memory, mesh.edge_count) || !cost.allocate(call.memory, mesh.edge_count))
        return call.out_of_memory();
    double least = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        double square = 0;
        for (uint32_t a = 0; a < 3; ++a) {
            const double d =
                position[3 * size_t{mesh.origin[2 * e]} + a] - position[3 * size_t{mesh.origin[2 * e + 1]} + a];
            square += d * d;
        }
        length[e] = cost[e] = std::sqrt(square);
        least += length[e];
    }
    least *= 1e-6 / mesh.edge_count;
    for (uint64_t i = 0; i < all.seam_edge_count; ++i) {
        const uint32_t e = all.seam_edges[i];
        if (e >= mesh.edge_count)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_EDGE, e,
                             "seam_edges names edge %u; the level has %u edges.", e, mesh.edge_count);
        cost[state.level == 0 ? state.hierarchy->edge_internal[e] : e] = least;
    }
    return HMF_OK;
}

struct Transition {
    int8_t sign;
    int64_t u, v;
};

// From face(h) to face(twin h).
Transition transition(const Mesh& mesh, const SignBundle& bundle, const Layout& layout, uint32_t h) {
    const uint32_t t = twin(h), there = mesh.next[t];
    const int8_t sign =
        static_cast<int8_t>(layout.chart[mesh.face[h]] * layout.chart[mesh.face[t]] * bundle.turn[edge_of(h)]);
    return {sign, layout.u[there] - sign * layout.u[h], layout.v[there] - sign * layout.v[h]};
}

AffineMap map_of(const State& state, const Layout& layout, uint32_t side, double unit) {
    const Mesh& mesh = state.foliation.mesh;
    const double* position = state.hierarchy->levels[state.level].position;
    const uint32_t h[3] = {side, mesh.next[side], mesh.prev(side)};
    double u[3], v[3];
    for (int c = 0; c < 3; ++c) {
        u[c] = static_cast<double>(layout.u[h[c]] - layout.u[side]) * unit;
        v[c] = static_cast<double>(layout.v[h[c]] - layout.v[side]) * unit;
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

// Dilatations of all triangles, and their statistics.
class Measure {
public:
    bool allocate(size_t triangles, Memory& memory) {
        return by_dilatation_.allocate(memory, triangles) && area_.allocate(memory, triangles);
    }

    void add(size_t t, const AffineMap& map) {
        by_dilatation_.item[t] = static_cast<uint32_t>(t);
        by_dilatation_.key[t] = key_of(map.dilatation);
        area_[t] = map.area;
        sum_ += map.area;
        image_ += map.determinant * map.area;
        if (map.dilatation == HUGE_VAL) {
            ++degenerate_;
            return;
        }
        flipped_ += map.determinant < 0;
        weighted_ += map.area * map.dilatation;
        visible_ += map.area;
    }

    void finish(hmf_parameterization& out) {
        out.flipped_triangles = flipped_;
        out.degenerate_triangles = degenerate_;
        out.area = image_;
        out.dilatation_mean = visible_ > 0 ? weighted_ / visible_ : HUGE_VAL;
        by_dilatation_.sort_falling();
        out.dilatation_median = quantile(0.5);
        out.dilatation_p99 = quantile(0.99);
    }

private:
    double quantile(double part) const {
        double above = 0;
        size_t i = 0;
        while (i + 1 < area_.size() && above + area_[by_dilatation_.item[i]] < (1 - part) * sum_)
            above += area_[by_dilatation_.item[i++]];
        float x;
        std::memcpy(&x, &by_dilatation_.key[i], sizeof x);
        return static_cast<double>(x);
    }

    KeyedItems by_dilatation_;
    Array<double> area_;
    double sum_ = 0, weighted_ = 0, visible_ = 0, image_ = 0;
    uint64_t flipped_ = 0, degenerate_ = 0;
};

} // namespace

extern "C" {

void hmf_parameterize_options_init(hmf_parameterize_options* options) {
    if (!options) return;
    std::memset(options, 0, sizeof *options);
    options->struct_size = sizeof *options;
}

hmf_status hmf_parameterize(const hmf_hierarchy* hierarchy, size_t level, const double* values, size_t count,
                            const hmf_parameterize_options* options, hmf_parameterization* out, hmf_error* error) {
    Query query(hierarchy, error);
    if (query.check(hierarchy, level, out)) return query.call.status();
    hmf_parameterize_options all;
    if (!copy_options(options, all) || !(all.tolerance >= 0) || (all.seam_edge_count && !all.seam_edges))
        return query.call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                               "hmf_parameterize_options is unusable. Start from hmf_parameterize_options_init.");
    if (out->struct_size != sizeof *out)
        return query.call.fail(
            HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
            "hmf_parameterization has struct_size %u instead of %u. Set it to sizeof(hmf_parameterization).",
            static_cast<unsigned>(out->struct_size), static_cast<unsigned>(sizeof *out));
    Call call(query.memory, error, all.progress, all.progress_user);
    Memory& memory = call.memory;
    const Mesh& counts = hierarchy->levels[level].mesh;
    if ((out->cone && check_capacity(out->vertex_capacity, counts.vertex_count, "cone", call))
        || ((out->transition || out->seam)
            && check_capacity(out->edge_capacity, counts.edge_count, "An array of edges", call))
        || ((out->corner_uv || out->dilatation || out->differential)
            && check_capacity(out->triangle_capacity, counts.face_count, "An array of triangles", call)))
        return call.status();

    State state;
    double unit = 1;
    if (!state.allocate(*hierarchy, level, memory)) return call.out_of_memory();
    state.load(level, Side::input);
    if (import_values(state, values, count, unit, false, call)) return call.status();
    if (level == 0 && !state.to_intrinsic(call)) return call.cancelled() ? cancelled(call) : call.out_of_memory();
    if (check_harmonic(state, all.tolerance > 0 ? all.tolerance : 1e-2, call)) return call.status();
    FlatSurface flat;
    if (flat_surface(state, flat, call)) return call.status();
    if (!flat_surface_to_input(state, flat, call)) return call.cancelled() ? cancelled(call) : call.out_of_memory();

    const Mesh& mesh = state.foliation.mesh;
    VertexCharts charts;
    Array<int32_t> cone;
    Array<uint8_t> is_cone;
    Array<uint32_t> side;
    Array<double> length, cost;
    Seams seams;
    Layout layout;
    if (!charts.build(mesh, flat.bundle, memory) || !cone.allocate(memory, mesh.vertex_count)
        || !is_cone.allocate(memory, mesh.vertex_count) || !first_sides(state, side, memory))
        return call.out_of_memory();
    cone_angles(mesh, flat, cone.data());
    uint32_t start = side[0];
    for (uint32_t v = mesh.vertex_count; v-- > 0;) {
        is_cone[v] = charts.odd[v] || (cone[v] > 2 && is_visible(mesh, flat, v));
        if (is_cone[v]) start = mesh.out[v];
    }
    if (seam_lengths(state, all, length, cost, call)) return call.status();
    if (!call.tick(0.85)) return cancelled(call);
    if (!cut_through_cones(mesh, cost.data(), is_cone.data(), seams, call)
        || !layout.build(mesh, flat.bundle, flat.du, flat.dv, start, seams, call))
        return call.cancelled() ? cancelled(call) : call.out_of_memory();
    if (!call.tick(0.95)) return cancelled(call);

    Measure measure;
    Array<uint8_t> met;
    Array<AffineMap> map;
    if (!measure.allocate(mesh.face_count, memory) || !met.allocate_filled(memory, mesh.edge_count, 0)
        || !map.allocate(memory, mesh.face_count))
        return call.out_of_memory();
    for (uint32_t t = 0; t < mesh.face_count; ++t) {
        if (t % 65536 == 0 && !call.tick(0.95)) return cancelled(call);
        map[t] = map_of(state, layout, side[t], unit);
        measure.add(t, map[t]);
    }
    hmf_parameterization result = *out;
    measure.finish(result);
    if (!call.tick(0.98)) return cancelled(call);
    result.seam_edge_count = 0;
    result.seam_length = 0;
    // From here on nothing fails, and the outputs are written.
    for (uint32_t t = 0; t < mesh.face_count; ++t) {
        uint32_t h = side[t];
        const bool flipped = map[t].dilatation != HUGE_VAL && map[t].determinant < 0;
        if (out->dilatation) out->dilatation[t] = flipped ? -map[t].dilatation : map[t].dilatation;
        if (out->differential) {
            out->differential[2 * size_t{t}] = map[t].differential[0];
            out->differential[2 * size_t{t} + 1] = map[t].differential[1];
        }
        for (size_t s = 0; s < 3; ++s, h = mesh.next[h]) {
            if (out->corner_uv) {
                out->corner_uv[6 * size_t{t} + 2 * s] = static_cast<double>(layout.u[h]) * unit;
                out->corner_uv[6 * size_t{t} + 2 * s + 1] = static_cast<double>(layout.v[h]) * unit;
            }
            const uint32_t internal = edge_of(h);
            if (met[internal]) continue;
            met[internal] = 1;
            const size_t e = level == 0 ? hierarchy->triangle_edges[3 * size_t{t} + s] : internal;
            const Transition to = transition(mesh, flat.bundle, layout, h);
            const bool seam = seams.on[internal] || to.sign < 0 || to.u != 0 || to.v != 0;
            result.seam_edge_count += seam;
            if (seam) result.seam_length += length[internal];
            if (out->seam) out->seam[e] = seam;
            if (out->transition) {
                out->transition[3 * e] = to.sign;
                out->transition[3 * e + 1] = static_cast<double>(to.u) * unit;
                out->transition[3 * e + 2] = static_cast<double>(to.v) * unit;
            }
        }
    }
    if (out->cone)
        for (uint32_t v = 0; v < mesh.vertex_count; ++v)
            out->cone[v] = cone[level == 0 ? hierarchy->vertex_internal[v] : v];
    result.linear_iterations = flat.iterations;
    result.seconds = call.seconds();
    *out = result;
    call.tick(1);
    return HMF_OK;
}

} // extern "C"
