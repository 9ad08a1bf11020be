#include "sized_quads.hpp"

#include "fit_quads.hpp"
#include "front_surface.hpp"
#include "quad_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hmf {

namespace {

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

// 1 at the limits.  Features smaller than a quad are followed by smaller ones; what is bad for another reason stays so.
double badness(const QuadFigures& figures, double area, size_t count) {
    const double ratio = figures.area / area;
    return std::max(static_cast<double>(figures.inverted) / (MOST_INVERTED * static_cast<double>(count)),
                    LEAST_AREA * std::max(ratio, 1 / ratio));
}

// Quads that are larger than what they should follow, or do not reach a part of the surface, are refused.
bool is_fit(const QuadFigures& figures, double area, size_t count) {
    return count < FEW || badness(figures, area, count) < 1;
}

// Takes `fitted` unless it is worse than the quads that it was made of: more of it is inverted, or it covers the
// surface so badly that it would be refused.
hmf_status take_better(const Mesh& mesh, const double* position, double area, QuadMesh& fitted, QuadMesh& out,
                       QuadFigures& figures, Call& call) {
    if (quad_figures(mesh, position, fitted, figures, call)) return call.status();
    const double bad = badness(figures, area, out.quad_count());
    QuadFigures before;
    before.inverted = UINT64_MAX;
    if ((figures.inverted > 0 || bad >= 1) && quad_figures(mesh, position, out, before, call)) return call.status();
    if (figures.inverted > before.inverted || (bad >= 1 && bad > badness(before, area, out.quad_count())))
        figures = before;
    else std::swap(out, fitted);
    return HMF_OK;
}

hmf_status make_number(Foliation& f, const double* position, const Cylinders& cylinders, const SizedQuads& wish,
                       const FlatMetric& metric, const FrontSurface* front, double number, QuadMesh& out,
                       QuadFigures& figures, Call& call) {
    QuadWish first;
    first.step = std::sqrt(metric.flat_area * wish.share / number);
    first.count = wish.count > 0 ? static_cast<int64_t>(std::floor(number + 0.5)) : 0;
    first.merge = wish.merge;
    first.keep_poles = wish.keep_poles;
    if (!(first.step > 0) || !std::isfinite(first.step))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "edge_length is out of proportion to the surface.");
    if (make_quads(f, position, cylinders, wish.front, first, out, call)) return call.status();
    if (front) front->bring_forward(position, out);
    const Mesh& mesh = front ? front->mesh() : f.mesh;
    if (!(wish.relax > 0)) return quad_figures(mesh, position, out, figures, call);
    QuadMesh fitted;
    if (fit_quads(mesh, position, wish.relax, out, fitted, call)) return call.status();
    return take_better(mesh, position, metric.area * wish.share, fitted, out, figures, call);
}

hmf_status refuse(const QuadFigures& figures, double area, size_t count, Call& call) {
    return call.fail(HMF_ERROR_QUADS, HMF_ELEMENT_NONE, 0,
                     "%llu of %llu quads are folded over on the surface, and they have %.2f times its area. Ask for "
                     "more, smaller quads, or give other loops.",
                     static_cast<unsigned long long>(figures.inverted), static_cast<unsigned long long>(count),
                     figures.area / area);
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
    double before = HUGE_VAL; // how bad the last quads were
    for (int doublings = 0;; ++doublings, number *= 2) {
        if (make_number(f, position, cylinders, wish, metric, front, number, out, figures, call)) return call.status();
        if (!(wish.relax > 0) || is_fit(figures, area, out.quad_count())) return HMF_OK;
        const double bad = badness(figures, area, out.quad_count());
        if (doublings == MOST_DOUBLINGS || 2 * number > static_cast<double>(MOST_QUADS) || !(bad < before))
            return refuse(figures, area, out.quad_count(), call);
        before = bad;
    }
}

} // namespace hmf
