// From the foliation to its holomorphic quadratic differential (du + i dv)^2:
//
//   F --tripods to vertices--> du --harmonic--> du --conjugate--> dv --harmonic--> dv
//
// F is harmonic already; moving the zeros to vertices disturbs it near them, so
// du is made harmonic again with the signs fixed: a linear problem, with the same matrix as for dv.
#include "flat_surface.hpp"

#include "check_cylinders.hpp"
#include "harmonic_form.hpp"

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

// What moving the zeros costs is little where the mesh is fine beside the distances of the zeros.
hmf_status check_energy(double energy, double of_foliation, Call& call) {
    constexpr double least = 0.9, most = 1.5;
    const double ratio = energy / of_foliation;
    if (ratio > least && ratio < most) return HMF_OK;
    return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                     "The mesh is too coarse: with the zeros at vertices the energy is %.3g times that of the "
                     "foliation. Subdivide it.",
                     ratio);
}

// Each cylinder is about as wide as that of F, and has its height.
hmf_status check_each_cylinder(State& state, const ZeroList& zeros, FlatSurface& flat, double energy, Call& call) {
    constexpr double least = 0.5, most = 2, largest = 1e-4; // measured: 1e-6
    CylinderCheck found;
    if (check_cylinders(state, zeros, flat.bundle, flat.du, found, call)) return call.status();
    flat.figures.circumference_least = found.least;
    flat.figures.circumference_most = found.most;
    const double off = std::fabs(found.area / energy - 1);
    if (found.crossed == 0 && found.least > least && found.most < most && off < largest) return HMF_OK;
    return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                     "The mesh is too coarse: with the zeros at vertices the circumferences of cylinders are %.3g to "
                     "%.3g times those of the foliation, their areas are %.3g times the energy, and %llu are crossed "
                     "by a zero. Subdivide it.",
                     found.least, found.most, found.area / energy, static_cast<unsigned long long>(found.crossed));
}

// By Riemann's bilinear relation the area of the image is the energy of du, whatever du is.
hmf_status check_image(const ImageSum& image, double energy, double& error, Call& call) {
    constexpr double largest = 1e-4; // measured: 5e-6
    error = std::fabs(image.area / energy - 1);
    if (image.open == 0 && error <= largest) return HMF_OK;
    return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                     "(u, v) is not closed in %llu triangles, or its area is not the energy but %.9g times that. "
                     "Please report it.",
                     static_cast<unsigned long long>(image.open), image.area / energy);
}

} // namespace

hmf_status flat_surface(State& state, double residual, FlatSurface& flat, Call& call) {
    // Four decades below what the triangles leave (dilatation 1.01 and more): gradients are off by 1e-7.
    constexpr double tolerance = 1e-7;
    // A wrong sign leaves the flux of one side or more; a minimum 1e-8 of what is largest near by.
    constexpr double share = 1e-4;
    const Foliation& f = state.foliation;
    const double* weight = state.hierarchy->levels[state.level].weight;
    const double of_foliation = energy_of(f.value, f.mesh, weight, call.parallel);
    Array<uint8_t> untouched;
    ZeroList zeros;
    VertexCharts charts;
    TwistedLaplacian laplacian;
    if (form_of_foliation(f, weight, of_foliation, flat.bundle, flat.du, untouched, zeros, call)) return call.status();
    if (!call.tick(0.05)) return call.was_cancelled();
    if (!charts.build(f.mesh, flat.bundle, call)) return call.stopped();
    if (laplacian.build(f.mesh, flat.bundle, charts, weight, call))
        return call.cancelled() ? call.was_cancelled() : call.status();
    if (!call.tick(0.3)) return call.was_cancelled();
    const TwistedLaplacian::Known known{untouched.data(), residual > share ? residual : share, of_foliation,
                                        residual > 0};
    if (const hmf_status status = laplacian.make_harmonic(flat.du, tolerance, call, known)) return status;
    if (!call.tick(0.5)) return call.was_cancelled();
    const double energy = energy_of(flat.du.value.data(), f.mesh, weight, call.parallel);
    if (const hmf_status status = check_energy(energy, of_foliation, call)) return status;
    if (const hmf_status status = check_each_cylinder(state, zeros, flat, energy, call)) return status;
    flat.figures.energy_ratio = energy / of_foliation;
    if (conjugate_form(f.mesh, flat.bundle, charts, weight, flat.du, flat.dv, call))
        return call.cancelled() ? call.was_cancelled() : call.status();
    if (!call.tick(0.6)) return call.was_cancelled();
    if (const hmf_status status = laplacian.make_harmonic(flat.dv, tolerance, call, {})) return status;
    if (!call.tick(0.8)) return call.was_cancelled();
    flat.iterations = laplacian.iterations();
    return check_image(sum_image(f.mesh, flat.bundle, flat.du, flat.dv, call.parallel), energy, flat.figures.area_error,
                       call);
}

Done flat_surface_to_input(const State& state, FlatSurface& flat, Call& call) {
    const hmf_hierarchy& h = *state.hierarchy;
    if (state.level > 0 || state.triangulation == Triangulation::input || h.intrinsic_flip_count == 0) return true;
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

namespace {

// Vertices that lie at one place of the flat surface, joined by edges of length 0.  Only their total cone angle is
// known. It is distributed consistently with the turn around each vertex: regular ones get 2, odd ones 3, marked ones
// 1, in units of pi; the remaining even number goes to the vertex that has most.
Done share_cones(const Mesh& mesh, const FlatSurface& flat, const Array<uint8_t>& odd, int32_t* cone, Call& call) {
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

Done cone_angles(const Mesh& mesh, const FlatSurface& flat, const VertexCharts& charts, int32_t* cone, Call& call) {
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

Done find_cones(const Mesh& mesh, const FlatSurface& flat, const VertexCharts& charts, Array<int32_t>& cone,
                Array<uint8_t>& is_cone, Call& call) {
    if (!cone.allocate(call.memory, mesh.vertex_count) || !is_cone.allocate(call.memory, mesh.vertex_count)
        || !cone_angles(mesh, flat, charts, cone.data(), call))
        return false;
    return call.pass(mesh.vertex_count, 0.82, [&](size_t begin, size_t end) {
        for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v)
            is_cone[v] = charts.odd[v] || (cone[v] > 2 && is_visible(charts.stars.of(v), flat));
    });
}

bool is_visible(Stars::Star star, const FlatSurface& flat) {
    constexpr int64_t least = 1000; // units
    for (const uint32_t h : star) {
        const int64_t u = flat.du.value[edge_of(h)], w = flat.dv.value[edge_of(h)];
        if (u < least && u > -least && w < least && w > -least) return false;
    }
    return true;
}

} // namespace hmf
