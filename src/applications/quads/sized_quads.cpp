#include "sized_quads.hpp"

#include "fit_quads.hpp"
#include "front_surface.hpp"

#include <cmath>
#include <utility>

namespace hmf {

namespace {

constexpr double FEWEST_TO_REFINE = 8000; // quads
constexpr int MOST_HALVINGS = 12;         // of the edges
constexpr double MOST_INVERTED = 0.05;    // of the quads
constexpr size_t FEW = 100;               // quads, which are larger than what they should follow as a rule
constexpr double LEAST_AREA = 0.75;       // of the quads in that of the surface, or the other way around

// How many quads the wish makes of that area.
hmf_status wished_number(const SizedQuads& wish, double area, double by_default, double& number, Call& call) {
    number = wish.count > 0       ? static_cast<double>(wish.count)
           : wish.edge_length > 0 ? area / (wish.edge_length * wish.edge_length)
                                  : by_default;
    if (number <= static_cast<double>(MOST_QUADS)) return HMF_OK;
    return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                     "There would be about %.3g quads of this size, and at most %.3g fit. Choose a larger edge_length.",
                     number, static_cast<double>(MOST_QUADS));
}

// That number, then each cut in four so many times.
hmf_status make_and_fit(Foliation& f, const double* position, const Cylinders& cylinders, const SizedQuads& wish,
                        const FlatMetric& metric, const FrontSurface* front, double number, int halvings, QuadMesh& out,
                        uint64_t& inverted, Call& call) {
    QuadWish first;
    first.step = std::sqrt(metric.flat_area * wish.share / number);
    first.count = wish.count > 0 ? static_cast<int64_t>(std::floor(number + 0.5)) : 0;
    first.merge = wish.merge;
    first.keep_poles = wish.keep_poles;
    if (!(first.step > 0) || !std::isfinite(first.step))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "edge_length is out of proportion to the surface.");
    if (make_quads(f, position, cylinders, wish.front, first, out, call)) return call.status();
    if (front) front->bring_forward(position, out);
    if (!(wish.relax > 0)) return HMF_OK;
    return fit_quads(front ? front->mesh() : f.mesh, position, front ? wish.reflection : nullptr, wish.relax, halvings,
                     out, inverted, call);
}

// Where quads are larger than what they should follow, or the leaves do not reach a part of the surface.
hmf_status refuse_unfit(const QuadFigures& figures, double area, size_t count, Call& call) {
    if (count < FEW) return HMF_OK;
    if (static_cast<double>(figures.inverted) > MOST_INVERTED * static_cast<double>(count))
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                         "%llu of %llu quads are folded over on the surface. Ask for more, smaller quads, or give "
                         "other loops.",
                         static_cast<unsigned long long>(figures.inverted), static_cast<unsigned long long>(count));
    const double ratio = figures.area / area;
    if (ratio > LEAST_AREA && ratio * LEAST_AREA < 1) return HMF_OK;
    return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                     "The quads have %.2f times the area of the surface. Ask for more, smaller quads, or give other "
                     "loops.",
                     ratio);
}

} // namespace

hmf_status make_sized_quads(Foliation& f, const double* position, const Cylinders& cylinders, const SizedQuads& wish,
                            QuadMesh& out, double& area, QuadFigures& figures, Call& call) {
    FlatMetric metric;
    FrontSurface surface;
    const FrontSurface* const front = wish.front ? &surface : nullptr;
    if (front && !surface.build(f.mesh, *wish.reflection, call.memory)) return call.out_of_memory();
    if (flat_metric(f, position, cylinders, metric, call)) return call.status();
    area = metric.area * wish.share;
    const double by_default = 0.5 * wish.share * static_cast<double>(f.mesh.face_count);
    double number = 0;
    if (wished_number(wish, area, by_default, number, call)) return call.status();
    // Quads smaller than the triangles would show how these bend the leaves: they are made of larger ones.
    int halvings = 0;
    const bool refines = wish.relax > 0 && !wish.front;
    double fewer = number;
    for (; refines && fewer > by_default && fewer > FEWEST_TO_REFINE && halvings < MOST_HALVINGS; ++halvings)
        fewer /= 4;
    // Quads that are inverted stay so when they are cut: then there are more and smaller ones to begin with.
    uint64_t inverted = 0;
    if (make_and_fit(f, position, cylinders, wish, metric, front, fewer, halvings, out, inverted, call))
        return call.status();
    for (; halvings > 0 && inverted > 0; fewer *= 4) {
        QuadMesh other;
        uint64_t left = 0;
        --halvings;
        other.start(call.memory);
        if (make_and_fit(f, position, cylinders, wish, metric, front, 4 * fewer, halvings, other, left, call))
            return call.status();
        if (left >= inverted) continue;
        inverted = left;
        std::swap(out, other);
    }
    if (quad_figures(front ? surface.mesh() : f.mesh, position, front ? wish.reflection : nullptr, out, figures, call))
        return call.status();
    return wish.relax > 0 ? refuse_unfit(figures, area, out.quad_count(), call) : HMF_OK;
}

} // namespace hmf
