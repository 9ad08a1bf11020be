// In turns: vertices reach for tips, where they are held, or snap to sharp edges, along which they
// slide from then on, and the others are relaxed round them.  A vertex leaves its sharp edge again where
// that costs a corner too much.  Where a quad stays inverted all is done again without sharp edges, then
// also without a look at the side that quads look to, and the best kept; in the end vertices may leave the surface.
#include "fit_quads.hpp"

#include "boundary_corners.hpp"
#include "quad_figures.hpp"
#include "quad_shape.hpp"
#include "reach_tips.hpp"
#include "relax_quads.hpp"
#include "snap_quads.hpp"
#include "square_corners.hpp"
#include "unfold_quads.hpp"

#include <algorithm>
#include <utility>

namespace hmf {

namespace {

constexpr int ROUNDS = 5;                                 // of reaching and snapping
constexpr double TOO_FLAT = 0.3;                          // sine of a corner of a quad on a sharp edge
constexpr int STEPS_ON_FINER = 4, STEPS_AFTER_TURNS = 20; // of relaxation
constexpr int SWEEPS = 8, SWEEPS_ON_FINER = 4;            // to make corners square
constexpr double SQUARE_ON_FINER = 0.25;                  // cosine: quads so good stay as they are when they are cut

template <class T>
Done copy(const Array<T>& from, Array<T>& to, Memory& memory) {
    if (!to.allocate(memory, from.size())) return false;
    for (size_t i = 0; i < from.size(); ++i) to[i] = from[i];
    return true;
}

// Where a corner on one is too flat or too sharp; whether there was one.
bool leave_sharp_edges(QuadMesh& quads) {
    bool any = false;
    for (size_t q = 0; q < quads.quad_count(); ++q) {
        if (!(worst_corner(quads, q) < TOO_FLAT)) continue;
        for (size_t k = 0; k < 4; ++k) {
            uint8_t& held = quads.held[quads.quads[4 * q + k]];
            any |= held == ON_CREASE;
            if (held == ON_CREASE) held = 0;
        }
    }
    return any;
}

struct Attempt {
    bool to_sharp_edges, outwards; // outwards: quads that look inwards are to turn, not only those that are inverted
};
// Where the surface is finer than the quads, which side they should look to is not always known.
constexpr Attempt ATTEMPTS[] = {{true, false}, {true, true}, {false, true}, {false, false}};

// What stays inverted is turned as it lies, to whatever side it looks.
hmf_status untangle(const Mesh& mesh, const double* position, int steps, int after, bool outwards, QuadMesh& quads,
                    uint64_t& inverted, Call& call) {
    Unfolded unfolded;
    const auto unfold = [&] { return unfold_quads(mesh, position, Unfold::on_surface, quads, unfolded, call); };
    if (relax_quads(mesh, position, steps, Untangle::all, outwards, quads, call) || unfold()) return call.status();
    // What was turned is even in size, and angles are not the best yet.  after: steps, none on finer quads.
    if (unfolded.better && after > 0
        && (relax_quads(mesh, position, after, Untangle::some, outwards, quads, call) || unfold()))
        return call.status();
    inverted = unfolded.inverted;
    if (inverted == 0 || !outwards) return HMF_OK;
    if (relax_quads(mesh, position, 0, Untangle::all, false, quads, call)) return call.status();
    return count_inverted(mesh, position, quads, inverted, call) ? HMF_OK : call.stopped();
}

// Is given up before the finest quads where some stay inverted.
hmf_status fit(const Mesh& mesh, const double* position, const Reflection* front, int steps, int halvings,
               const Attempt& as, QuadMesh& quads, uint64_t& inverted, Call& call) {
    if (relax_quads(mesh, position, steps, Untangle::some, as.outwards, quads, call)) return call.status();
    for (int round = 0; round < ROUNDS; ++round) {
        size_t reached = 0, snapped = 0, corners = 0;
        if ((front && take_boundary_corners(mesh, position, quads, corners, call))
            || reach_tips(mesh, position, front, quads, reached, call)
            || (as.to_sharp_edges && snap_to_sharp_edges(mesh, position, front, quads, snapped, call)))
            return call.status();
        if (reached + snapped + corners == 0) break;
        if (relax_quads(mesh, position, steps, Untangle::some, as.outwards, quads, call)) return call.status();
    }
    const int again = leave_sharp_edges(quads) ? steps : 0;
    if (untangle(mesh, position, again, std::min(steps, STEPS_AFTER_TURNS), as.outwards, quads, inverted, call))
        return call.status();
    // What was turned out may have left its sharp edge without need.
    size_t snapped = 0;
    if ((as.to_sharp_edges && steps > 0 && snap_to_sharp_edges(mesh, position, front, quads, snapped, call))
        || square_corners(mesh, position, std::min(steps, SWEEPS), 0, quads, call))
        return call.status();
    for (; halvings > 0; --halvings) {
        if (refine_quads(mesh, position, quads, call)
            || untangle(mesh, position, std::min(steps, STEPS_ON_FINER), 0, as.outwards, quads, inverted, call)
            || square_corners(mesh, position, std::min(steps, SWEEPS_ON_FINER), SQUARE_ON_FINER, quads, call))
            return call.status();
        if (as.to_sharp_edges && inverted > 0) return HMF_OK;
    }
    return HMF_OK;
}

Done copy(const QuadMesh& from, QuadMesh& to, Memory& memory) {
    return copy(from.positions, to.positions, memory) && copy(from.quads, to.quads, memory)
        && copy(from.sides, to.sides, memory) && copy(from.held, to.held, memory);
}

// One attempt after the other, until no quad is inverted: the first one with all quads and the fewest inverted.
// Where some stay so on the surface, vertices round them leave it.
hmf_status fit_better(const Mesh& mesh, const double* position, const Reflection* front, int steps, int halvings,
                      QuadMesh& quads, uint64_t& inverted, Call& call) {
    QuadMesh start, now;
    inverted = UINT64_MAX;
    if (!copy(quads, start, call.memory)) return call.out_of_memory();
    for (const Attempt& as : ATTEMPTS) {
        uint64_t left = 0;
        if (!copy(start, now, call.memory)) return call.out_of_memory();
        if (fit(mesh, position, front, steps, halvings, as, now, left, call)) return call.status();
        const bool more = now.quad_count() > quads.quad_count() || inverted == UINT64_MAX;
        if (now.quad_count() >= quads.quad_count() && (more || left < inverted)) {
            inverted = left;
            std::swap(quads, now);
        }
        if (inverted == 0 && quads.quad_count() == start.quad_count() << 2 * halvings) break;
    }
    if (inverted == 0 || steps == 0) return HMF_OK;
    Unfolded unfolded;
    if (unfold_quads(mesh, position, Unfold::off_surface, quads, unfolded, call)) return call.status();
    return count_inverted(mesh, position, quads, inverted, call) ? HMF_OK : call.stopped();
}

} // namespace

hmf_status fit_quads(const Mesh& mesh, const double* position, const Reflection* front, int steps, int halvings,
                     QuadMesh& quads, uint64_t& inverted, Call& call) {
    size_t corners = 0;
    if (front && steps > 0 && take_boundary_corners(mesh, position, quads, corners, call)) return call.status();
    return fit_better(mesh, position, front, steps, halvings, quads, inverted, call);
}

} // namespace hmf
