#include "sized_quads.hpp"

#include "../lines/polyline.hpp"
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

// Figures with the number of quads and the area of the surface.
struct Judged {
    QuadFigures figures;
    double count = 0, area = 0;

    // 1 at the limits of what is returned: quads that are larger than what they should follow, or do not reach a part
    // of the surface.
    double badness() const {
        const double ratio = figures.area / area, inverted = static_cast<double>(figures.inverted);
        return std::max(inverted / (MOST_INVERTED * count), LEAST_AREA * std::max(ratio, 1 / ratio));
    }
    bool is_better_than(const Judged& other) const {
        const double mine = std::max(badness(), 1.0), its = std::max(other.badness(), 1.0);
        return mine != its ? mine < its : figures.inverted < other.figures.inverted;
    }
};

class SizedQuadMaker {
public:
    SizedQuadMaker(Foliation& f, const double* position, const Cylinders& cylinders, const SizedQuads& wish,
                   Call& call) :
        f_(f),
        position_(position), cylinders_(cylinders), wish_(wish), call_(call) {}

    hmf_status run(QuadMesh& out, double& area, QuadFigures& figures) {
        if (wish_.front && !front_.build(f_.mesh, *wish_.reflection, call_.memory)) return call_.out_of_memory();
        area = area_ = surface_area(f_.mesh, position_, call_.parallel) * wish_.share;
        const double by_default = 0.5 * wish_.share * static_cast<double>(f_.mesh.face_count);
        double number = 0, most = -1;
        if (wished_number(wish_, area, by_default, number, call_)) return call_.status();
        Judged best;
        if (make(number, out, best)) return call_.status();
        while (wish_.relax > 0 && (best.figures.inverted > 0 || best.badness() >= 1)) {
            QuadMesh more;
            if (most < 0) { // rounding stretches quads of a number near the least possible one
                if (make_unfitted(1, more)) return call_.status();
                most = std::min(MOST_TIMES * static_cast<double>(more.quad_count()), static_cast<double>(MOST_QUADS));
            }
            number = 2 * best.count;
            if (number > most) break;
            Judged judged;
            if (make(number, more, judged)) return call_.status();
            if (!judged.is_better_than(best)) break;
            std::swap(out, more);
            best = judged;
        }
        figures = best.figures;
        return wish_.relax > 0 && best.badness() >= 1 ? refuse(best) : HMF_OK;
    }

private:
    const Mesh& mesh() const { return wish_.front ? front_.mesh() : f_.mesh; }

    hmf_status make_unfitted(double number, QuadMesh& out) {
        QuadWish first;
        first.number = number;
        first.exact = wish_.count > 0;
        first.merge = wish_.merge;
        first.keep_poles = wish_.keep_poles;
        if (make_quads(f_, *wish_.conjugate, position_, cylinders_, wish_.front, first, out, call_))
            return call_.status();
        if (wish_.front) front_.bring_forward(position_, out);
        return HMF_OK;
    }

    // Fitted quads, unless they are worse than the quads that they were made of.
    hmf_status make(double number, QuadMesh& out, Judged& judged) {
        if (make_unfitted(number, out)) return call_.status();
        QuadMesh fitted;
        Judged after;
        judged.area = after.area = area_;
        judged.count = after.count = static_cast<double>(out.quad_count());
        if (!(wish_.relax > 0)) return quad_figures(mesh(), position_, out, judged.figures, call_);
        if (fit_quads(mesh(), position_, wish_.relax, out, fitted, call_)
            || quad_figures(mesh(), position_, fitted, after.figures, call_))
            return call_.status();
        if (after.figures.inverted > 0 || after.badness() >= 1) {
            if (quad_figures(mesh(), position_, out, judged.figures, call_)) return call_.status();
            if (judged.is_better_than(after)) return HMF_OK;
        }
        std::swap(out, fitted);
        judged = after;
        return HMF_OK;
    }

    hmf_status refuse(const Judged& judged) {
        return call_.fail(HMF_ERROR_QUADS, HMF_ELEMENT_NONE, 0,
                          "%llu of %.0f quads are folded over on the surface, and they have %.2f times its area. Ask "
                          "for more, smaller quads, or give other loops.",
                          static_cast<unsigned long long>(judged.figures.inverted), judged.count,
                          judged.figures.area / judged.area);
    }

    Foliation& f_;
    const double* position_;
    const Cylinders& cylinders_;
    const SizedQuads& wish_;
    Call& call_;
    FrontSurface front_; // of a double
    double area_ = 0;    // of what the caller sees
};

} // namespace

hmf_status make_sized_quads(Foliation& f, const double* position, const Cylinders& cylinders, const SizedQuads& wish,
                            QuadMesh& out, double& area, QuadFigures& figures, Call& call) {
    return SizedQuadMaker(f, position, cylinders, wish, call).run(out, area, figures);
}

} // namespace hmf
