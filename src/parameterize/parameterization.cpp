#include "parameterization.hpp"

#include "../base/sort_keys.hpp"
#include "../foliation/whitehead.hpp"

#include <cmath>

namespace hmf {

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

constexpr uint32_t STRIDE = 16384; // triangles between two reports

// Length of each edge for the seams; those that the caller prefers hardly count.
hmf_status seam_lengths(const Mesh& mesh, const double* position, const Array<uint32_t>& cheap, Array<double>& length,
                        Array<double>& cost, Call& call) {
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
    for (const uint32_t e : cheap) cost[e] = least;
    return HMF_OK;
}

AffineMap map_of(const Mesh& mesh, const double* position, const Layout& layout, uint32_t side, double unit) {
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
    Done allocate(size_t triangles, Memory& memory) {
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

Transition Parameterization::transition(const Mesh& mesh, const SignBundle& bundle, uint32_t h) const {
    const uint32_t t = twin(h), there = mesh.next[t];
    const int8_t sign =
        static_cast<int8_t>(layout.chart[mesh.face[h]] * layout.chart[mesh.face[t]] * bundle.turn[edge_of(h)]);
    return {sign, layout.u[there] - sign * layout.u[h], layout.v[there] - sign * layout.v[h]};
}

hmf_status Parameterization::build(const Mesh& mesh, const double* position, const FlatSurface& flat, double unit,
                                   const Array<uint32_t>& side, const Array<uint32_t>& seam_edges, Call& call) {
    Memory& memory = call.memory;
    Array<uint8_t> is_cone;
    Array<double> cost;
    if (!find_cones(mesh, flat, cone, is_cone, call)) return call.stopped();
    uint32_t start = side[0];
    for (uint32_t v = mesh.vertex_count; v-- > 0;)
        if (is_cone[v]) start = mesh.out[v];
    if (seam_lengths(mesh, position, seam_edges, length, cost, call)) return call.status();
    if (!call.tick(0.85)) return call.was_cancelled();
    if (!cut_through_cones(mesh, cost.data(), is_cone.data(), seams, call)
        || !layout.build(mesh, flat.bundle, flat.du, flat.dv, start, seams, call))
        return call.stopped();
    if (!call.tick(0.95)) return call.was_cancelled();
    if (!map.allocate(memory, mesh.face_count)) return call.out_of_memory();
    for (uint32_t t = 0; t < mesh.face_count; ++t) {
        if (t % STRIDE == 0 && !call.tick(0.95)) return call.was_cancelled();
        map[t] = map_of(mesh, position, layout, side[t], unit);
    }
    return HMF_OK;
}

hmf_status Parameterization::measure(size_t count, hmf_parameterization& out, Call& call) const {
    Measure measure;
    if (!call.tick(0.96)) return call.was_cancelled();
    if (!measure.allocate(count, call.memory)) return call.out_of_memory();
    for (uint32_t t = 0; t < count; ++t) {
        if (t % STRIDE == 0 && !call.tick(0.96)) return call.was_cancelled();
        measure.add(t, map[t]);
    }
    if (!call.tick(0.97)) return call.was_cancelled();
    measure.finish(out);
    return call.tick(0.98) ? HMF_OK : call.was_cancelled();
}

} // namespace hmf
