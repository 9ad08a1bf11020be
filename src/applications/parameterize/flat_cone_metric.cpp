// From the foliation to its holomorphic quadratic differential (du + i dv)^2:
//
//   F --tripods to vertices--> du --harmonic--> du --conjugate--> dv --harmonic--> dv
//
// F is harmonic already; moving the zeros to vertices disturbs it near them, so
// du is made harmonic again with the signs fixed: a linear problem, with the same matrix as for dv.
#include "flat_cone_metric.hpp"

#include "check_cylinders.hpp"
#include "harmonic_form.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

double energy_of(const int64_t* form, const Mesh& mesh, const double* weight, const Parallel& parallel) {
    return parallel.sum_blocks<double>(mesh.edge_count, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t e = begin; e < end; ++e) {
            const double value = static_cast<double>(form[e]);
            sum += weight[e] * value * value;
        }
        return sum;
    });
}

// Why a map is refused.
enum class MapDefect : uint8_t { none, energy, circumference, inaccurate, open };

// Carries the forms of level 0 from the intrinsic triangulation of the state to the caller's.
Done unflip_to_input(const State& state, FlatConeMetric& flat, Call& call) {
    const hmf_hierarchy& h = *state.hierarchy;
    const Mesh& mesh = state.foliation.mesh;
    Array<uint32_t> next; // of the mesh on the way: forms need no more of it
    if (!next.allocate(call.memory, size_t{2} * mesh.edge_count)) return false;
    call.parallel.copy(next.data(), mesh.next, next.size());
    for (size_t i = h.intrinsic_flip_count; i-- > 0;) {
        if (i % 4096 == 0 && !call.tick(0)) return false;
        unflip_forms(next.data(), h.intrinsic_flips[i], flat.bundle, flat.du, flat.dv);
    }
    return true;
}

// One choice of vertices for the zeros, and what is wrong with it.
class FlatAttempt {
public:
    FlatAttempt(State& state, double residual, FlatConeMetric& flat, Call& call) :
        state_(state), f_(state.foliation), weight_(state.hierarchy->levels[state.level].weight), residual_(residual),
        flat_(flat), call_(call), of_foliation_(energy_of(f_.value, f_.mesh, weight_, call.parallel)) {}

    MapDefect defect() const { return defect_; }

    hmf_status run(CornerChoice corners) {
        if (make_du(corners)) return call_.status();
        defect_ = defect_of_du();
        if (defect_ != MapDefect::none) return HMF_OK;
        if (make_dv()) return call_.status();
        flat_.iterations = laplacian_.iterations();
        const bool moves = state_.level == 0 && state_.triangulation == Triangulation::intrinsic;
        if (moves && !unflip_to_input(state_, flat_, call_)) return call_.stopped();
        image_ = sum_image(moves ? state_.hierarchy->input : f_.mesh, flat_.bundle, flat_.du, flat_.dv, call_.parallel);
        defect_ = defect_of_image();
        return HMF_OK;
    }

    hmf_status refuse() const {
        const FlatFigures& figures = flat_.figures;
        switch (defect_) {
        case MapDefect::none: return HMF_OK;
        case MapDefect::energy:
            return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                              "The mesh is too coarse: with the zeros at vertices the energy is %.3g times that of the "
                              "foliation. Subdivide it.",
                              figures.energy_ratio);
        case MapDefect::circumference:
            return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                              "The mesh is too coarse: with the zeros at vertices the circumferences of cylinders are "
                              "%.3g to %.3g times those of the foliation; the number of cylinders thinner than the "
                              "triangles is %llu. Subdivide it.",
                              figures.circumference_least, figures.circumference_most,
                              static_cast<unsigned long long>(cylinders_.crossed));
        case MapDefect::inaccurate:
            return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                              "The equations of (u, v) were solved too inaccurately: areas are off by %.3g. Improve "
                              "the worst triangles of the mesh.",
                              std::max(figures.area_error, std::fabs(cylinders_.area / energy_ - 1)));
        case MapDefect::open: break;
        }
        return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                          "(u, v) is not closed in %llu triangles and along %llu leaves. Please report it.",
                          static_cast<unsigned long long>(image_.open),
                          static_cast<unsigned long long>(cylinders_.open));
    }

private:
    // Four decades below what the triangles leave (dilatation 1.01 and more): gradients are off by 1e-7.
    static constexpr double TOLERANCE = 1e-7;
    static constexpr double LARGEST_AREA_ERROR = 1e-4; // measured: 5e-6

    hmf_status make_du(CornerChoice corners) {
        // A wrong sign leaves the flux of one side or more; a minimum 1e-8 of what is largest near by.
        constexpr double share = 1e-4;
        const Mesh& mesh = f_.mesh;
        MovedZeros moved;
        if (form_of_foliation(f_, weight_, of_foliation_, corners, flat_.bundle, flat_.du, moved, call_))
            return call_.status();
        if (!call_.tick(0.05)) return call_.was_cancelled();
        if (!charts_.build(mesh, flat_.bundle, call_)) return call_.stopped();
        if (laplacian_.build(mesh, flat_.bundle, charts_, weight_, call_))
            return call_.cancelled() ? call_.was_cancelled() : call_.status();
        if (!call_.tick(0.3)) return call_.was_cancelled();
        const TwistedLaplacian::Known known{moved.untouched.data(), std::max(residual_, share), of_foliation_,
                                            residual_ > 0};
        if (laplacian_.make_harmonic(flat_.du, TOLERANCE, call_, known)) return call_.status();
        if (!call_.tick(0.5)) return call_.was_cancelled();
        energy_ = energy_of(flat_.du.value.data(), mesh, weight_, call_.parallel);
        cylinders_ = {};
        return check_cylinders(state_, moved, flat_.bundle, flat_.du, cylinders_, call_);
    }

    // Moving the zeros changes little where the mesh is fine beside the distances of the zeros.  Cylinders that a zero
    // crosses are measured together: what the others leave of the energy of du is theirs, by Riemann's bilinear
    // relation.
    MapDefect defect_of_du() {
        constexpr double least_energy = 0.9, most_energy = 1.5, least = 0.5, most = 2; // circumferences
        FlatFigures& figures = flat_.figures;
        const double rest = energy_ - cylinders_.area,
                     together = cylinders_.crossed > 0 ? rest / cylinders_.crossed_area : 1;
        figures.energy_ratio = energy_ / of_foliation_;
        figures.circumference_least = std::min(cylinders_.least, together);
        figures.circumference_most = std::max(cylinders_.most, together);
        if (!(figures.energy_ratio > least_energy && figures.energy_ratio < most_energy)) return MapDefect::energy;
        if (cylinders_.open > 0) return MapDefect::open;
        if (!(figures.circumference_least > least && figures.circumference_most < most))
            return MapDefect::circumference;
        if (cylinders_.crossed > 0 || std::fabs(rest) < LARGEST_AREA_ERROR * energy_) return MapDefect::none;
        return MapDefect::inaccurate;
    }

    hmf_status make_dv() {
        if (conjugate_form(f_.mesh, flat_.bundle, charts_, weight_, flat_.du, flat_.dv, call_))
            return call_.cancelled() ? call_.was_cancelled() : call_.status();
        if (!call_.tick(0.6)) return call_.was_cancelled();
        if (laplacian_.make_harmonic(flat_.dv, TOLERANCE, call_, {})) return call_.status();
        return call_.tick(0.8) ? HMF_OK : call_.was_cancelled();
    }

    // By Riemann's bilinear relation the area of the image is the energy of du, whatever du is.
    MapDefect defect_of_image() {
        flat_.figures.area_error = std::fabs(image_.area / energy_ - 1);
        flat_.figures.covered = image_.absolute_area / of_foliation_;
        if (image_.open > 0) return MapDefect::open;
        return flat_.figures.area_error <= LARGEST_AREA_ERROR ? MapDefect::none : MapDefect::inaccurate;
    }

    State& state_;
    const Foliation& f_;
    const double* weight_;
    const double residual_;
    FlatConeMetric& flat_;
    Call& call_;
    const double of_foliation_; // energy
    double energy_ = 0;         // of du
    VertexCharts charts_;
    TwistedLaplacian laplacian_;
    CylinderCheck cylinders_;
    ImageSum image_;
    MapDefect defect_ = MapDefect::none;
};

} // namespace

hmf_status flat_cone_metric(State& state, double residual, FlatConeMetric& flat, Call& call) {
    FlatAttempt attempt(state, residual, flat, call);
    if (attempt.run(CornerChoice::nearest)) return call.status();
    if (attempt.defect() != MapDefect::none && attempt.run(CornerChoice::keeps_class)) return call.status();
    return attempt.refuse();
}

namespace {

// Vertices that lie at one place of the flat surface, joined by edges of length 0.  Only their total cone angle is
// known. It is distributed consistently with the turn around each vertex: regular ones get 2, odd ones 3, marked ones
// 1, in units of pi; the remaining even number goes to the vertex that has most.
Done share_cones(const Mesh& mesh, const FlatConeMetric& flat, const Array<uint8_t>& odd, int32_t* cone, Call& call) {
    const auto is_point = [&](uint32_t h) {
        return flat.du.value[edge_of(h)] == 0 && flat.dv.value[edge_of(h)] == 0 && mesh.origin[h] != mesh.target(h);
    };
    bool any = false;
    for (uint32_t e = 0; e < mesh.edge_count && !any; ++e) any = is_point(2 * e);
    if (!any) return true;
    Array<uint8_t> seen;
    Array<uint32_t> place;
    place.start(call.memory);
    if (!seen.allocate_filled(call.memory, mesh.vertex_count, uint8_t{0})) return false;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        if (v % 131072 == 0 && !call.tick(0.81)) return false;
        if (seen[v]) continue;
        seen[v] = 1;
        place.clear();
        if (!place.push(v)) return false;
        for (size_t i = 0; i < place.size(); ++i)
            for (const uint32_t h : mesh.around(place[i])) {
                if (!is_point(h) || seen[mesh.target(h)]) continue;
                seen[mesh.target(h)] = 1;
                if (!place.push(mesh.target(h))) return false;
            }
        if (place.size() == 1) continue;
        int32_t rest = 0;
        uint32_t most = v;
        for (const uint32_t u : place) {
            rest += cone[u];
            if (cone[u] > cone[most]) most = u;
        }
        for (const uint32_t u : place) {
            cone[u] = !odd[u] ? 2 : mesh.is_marked(u) ? 1 : 3;
            rest -= cone[u];
        }
        if (rest > 0) cone[most] += rest;
        for (const int32_t least : {3, 2}) // zeros that poles have met
            for (const uint32_t u : place)
                if (rest < 0 && cone[u] == least) {
                    cone[u] -= 2;
                    rest += 2;
                }
    }
    return true;
}

} // namespace

Done cone_angles(const Mesh& mesh, const FlatConeMetric& flat, const VertexCharts& charts, int32_t* cone, Call& call) {
    // Is the origin of h before its target, in the chart of the face of h?
    const auto rises = [&](uint32_t h) {
        const int64_t u = flat.du.at(flat.bundle, h), v = flat.dv.at(flat.bundle, h);
        return u != 0 ? u > 0 : v != 0 ? v > 0 : mesh.origin[h] < mesh.target(h);
    };
    const auto count = [&](size_t begin, size_t end) {
        for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) {
            if (end - v > Stars::AHEAD)
                for (const uint32_t h : charts.stars.of(v + Stars::AHEAD)) {
                    prefetch(&flat.du.value[edge_of(h)]);
                    prefetch(&flat.dv.value[edge_of(h)]);
                }
            int32_t middle = 0; // corners that are the middle ones of their faces
            const Stars::Star star = charts.stars.of(v);
            for (uint32_t t = 0; t < star.size(); ++t) middle += rises(star[t]) == rises(twin(star.after(t)));
            cone[v] = middle;
        }
    };
    return call.pass(mesh.vertex_count, 0.81, count) && share_cones(mesh, flat, charts.odd, cone, call);
}

Done find_cones(const Mesh& mesh, const FlatConeMetric& flat, const VertexCharts& charts, Array<int32_t>& cone,
                Array<uint8_t>& is_cone, Call& call) {
    if (!cone.allocate(call.memory, mesh.vertex_count) || !is_cone.allocate(call.memory, mesh.vertex_count)
        || !cone_angles(mesh, flat, charts, cone.data(), call))
        return false;
    return call.pass(mesh.vertex_count, 0.82, [&](size_t begin, size_t end) {
        for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v)
            is_cone[v] = charts.odd[v] || (cone[v] > 2 && is_visible(charts.stars.of(v), flat));
    });
}

bool is_visible(Stars::Star star, const FlatConeMetric& flat) {
    constexpr int64_t least = 1000; // units
    for (const uint32_t h : star) {
        const int64_t u = flat.du.value[edge_of(h)], w = flat.dv.value[edge_of(h)];
        if (u < least && u > -least && w < least && w > -least) return false;
    }
    return true;
}

} // namespace hmf
