#include "fit_quads.hpp"

#include "boundary_places.hpp"
#include "optimize_quads.hpp"
#include "quad_figures.hpp"
#include "quad_shape.hpp"
#include "reach_tips.hpp"
#include "refine_quads.hpp"
#include "snap_quads.hpp"
#include "surface_search.hpp"

#include <algorithm>
#include <utility>

namespace hmf {

namespace {

constexpr int ROUNDS = 5; // of reaching for tips and snapping to sharp edges
constexpr int SWEEPS_AFTER = 8, SWEEPS_ON_FINER = 4;
// While one corner in this many differs from 90 degrees by more than 18, vertices held on sharp edges are released at
// quads with a corner of a sine below these values, and vertices held at tips if the sine is lower by TIPS.
constexpr size_t SHARE = 20;
constexpr double ENOUGH = 0.309, FIRST = 0.4, LAST = 0.61, TIPS = 0.1;

// Whether too many corners differ from 90 degrees by too much.
bool is_off(const QuadMesh& quads) {
    size_t off = 0;
    for (size_t i = 0; i < quads.quads.size(); ++i) {
        const uint32_t* const c = &quads.quads[i / 4 * 4];
        const Point p = at(quads, c[i % 4]), e = at(quads, c[(i + 1) % 4]) - p, b = at(quads, c[(i + 3) % 4]) - p;
        const double cosine = dot(e, b);
        off += cosine * cosine > ENOUGH * ENOUGH * dot(e, e) * dot(b, b);
    }
    return off * SHARE > quads.quads.size();
}

// Vertices of quads with a smaller sine than this leave what holds them.
void give_up(QuadMesh& quads, double sine) {
    for (size_t q = 0; q < quads.quad_count(); ++q) {
        const double worst = worst_corner(quads, q);
        for (size_t k = 0; k < 4 && worst < sine; ++k) {
            uint8_t& held = quads.held[quads.quads[4 * q + k]];
            if (held == ON_CREASE || ((is_for_tip(held) || held == AT_SHARP_CORNER) && worst < sine - TIPS)) held = 0;
        }
    }
}

struct Attempt {
    bool reaches, lets_go; // for tips and sharp edges; what is held around inverted quads at the end
};
constexpr Attempt ATTEMPTS[] = {{true, false}, {false, false}, {true, true}};

hmf_status fit(const Mesh& mesh, const double* position, const SurfaceSearch& surface, const Reflection* front,
               int sweeps, int halvings, const Attempt& as, QuadMesh& quads, uint64_t& inverted, Call& call) {
    {
        QuadOptimizer optimizer(mesh, position, surface, quads, call);
        if (optimizer.start() || optimizer.untangle() || optimizer.shape(sweeps)) return call.status();
        for (int round = 0; round < ROUNDS && as.reaches; ++round) {
            size_t reached = 0, snapped = 0;
            if (reach_tips(mesh, position, surface, front, quads, reached, call)
                || snap_to_sharp_edges(mesh, position, surface, front, quads, snapped, call))
                return call.status();
            if (reached + snapped == 0) break;
            optimizer.look_again();
            if (optimizer.shape(sweeps)) return call.status();
        }
        for (double sine = FIRST; sine < LAST && is_off(quads); sine += 0.1) {
            give_up(quads, sine);
            optimizer.look_again();
            if (optimizer.shape(std::min(sweeps, SWEEPS_AFTER))) return call.status();
        }
        if (as.lets_go && optimizer.untangle()) return call.status();
    }
    for (; halvings > 0; --halvings) {
        if (refine_quads(mesh, position, quads, call)) return call.status();
        QuadOptimizer optimizer(mesh, position, surface, quads, call);
        if (optimizer.start() || optimizer.untangle() || optimizer.shape(std::min(sweeps, SWEEPS_ON_FINER))
            || (as.lets_go && optimizer.untangle()))
            return call.status();
    }
    return count_inverted(surface, quads, inverted, call) ? HMF_OK : call.stopped();
}

} // namespace

// One attempt after the other, until no quad is inverted, and the best of them and of what it began with.
hmf_status fit_quads(const Mesh& mesh, const double* position, const Reflection* front, int sweeps, int halvings,
                     QuadMesh& quads, uint64_t& inverted, Call& call) {
    if (front && place_on_boundary(mesh, position, quads, call)) return call.status();
    QuadMesh start, now;
    SurfaceSearch surface;
    if (!start.copy(quads, call.memory) || !surface.build(mesh, position, call.memory)) return call.out_of_memory();
    if (!count_inverted(surface, quads, inverted, call)) return call.stopped();
    bool is_first = true;
    for (const Attempt& as : ATTEMPTS) {
        uint64_t left = 0;
        if (!now.copy(start, call.memory)) return call.out_of_memory();
        if (fit(mesh, position, surface, front, sweeps, halvings, as, now, left, call)) return call.status();
        if (left < inverted || (is_first && left <= inverted)) {
            inverted = left;
            std::swap(quads, now);
        }
        is_first = false;
        if (inverted == 0) break;
    }
    return HMF_OK;
}

} // namespace hmf
