// In turns: vertices reach for tips, where they are held, or snap to sharp edges, along which they
// slide from then on, and the others are relaxed round them.  A vertex leaves its sharp edge again where
// that costs a corner too much.  Quads cut in four look outwards where the whole one did,
// but at creases, where to turn them out takes long and does not always work.  Where a quad stays
// inverted all is done again without sharp edges, and the better of both kept.
#include "fit_quads.hpp"

#include "boundary_corners.hpp"
#include "quad_shape.hpp"
#include "reach_tips.hpp"
#include "relax_quads.hpp"
#include "snap_quads.hpp"

#include <algorithm>
#include <utility>

namespace hmf {

namespace {

constexpr int ROUNDS = 3; // of reaching and snapping; from the first on pegasus' greatest distance is 1.4, 1.1, 0.8
constexpr double TOO_FLAT = 0.5;  // sine of a corner of a quad on a sharp edge
constexpr int STEPS_ON_FINER = 4; // of relaxation

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

// Quads that look inwards are turned out, if no other quad gets inverted by that.
hmf_status turn_outwards(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call) {
    QuadPlaces places;
    QuadFigures before, after;
    if (!places.keep(quads, call.memory)) return call.out_of_memory();
    if (quad_figures(quads, before, call) || relax_quads(mesh, position, 0, Untangle::all, true, quads, call)
        || quad_figures(quads, after, call))
        return call.status();
    if (after.inverted > before.inverted) places.give_back(quads);
    return HMF_OK;
}

// With sharp edges: is given up before the finest quads where some stay inverted.
hmf_status fit(const Mesh& mesh, const double* position, const Reflection* front, int steps, int halvings,
               bool to_sharp_edges, QuadMesh& quads, QuadFigures& figures, Call& call) {
    if (relax_quads(mesh, position, steps, Untangle::some, false, quads, call)) return call.status();
    for (int round = 0; round < ROUNDS; ++round) {
        size_t reached = 0, snapped = 0;
        if (reach_tips(mesh, position, front, quads, reached, call)
            || (to_sharp_edges && snap_to_sharp_edges(mesh, position, front, quads, snapped, call)))
            return call.status();
        if (reached + snapped == 0) break;
        if (relax_quads(mesh, position, steps, Untangle::some, false, quads, call)) return call.status();
    }
    const int again = leave_sharp_edges(quads) ? steps : 0;
    if (relax_quads(mesh, position, again, Untangle::all, false, quads, call)
        || turn_outwards(mesh, position, quads, call))
        return call.status();
    if (quad_figures(quads, figures, call)) return call.status();
    for (; halvings > 0; --halvings) {
        if (refine_quads(mesh, position, quads, call)
            || relax_quads(mesh, position, std::min(steps, STEPS_ON_FINER), Untangle::all, false, quads, call)
            || quad_figures(quads, figures, call))
            return call.status();
        if (to_sharp_edges && figures.inverted > 0) return HMF_OK;
    }
    return HMF_OK;
}

// The surface of a double without its back, where points would be seen from behind.
struct Front {
    Array<uint32_t> face;
    Mesh mesh;

    // The vertices of the quads that were found behind are in front then.
    Done build(const Mesh& whole, const Reflection& reflection, QuadMesh& quads, Memory& memory) {
        const size_t sides = size_t{2} * whole.edge_count;
        if (!face.allocate(memory, sides)) return false;
        for (size_t h = 0; h < sides; ++h) face[h] = reflection.is_front[h] ? whole.face[h] : NONE;
        mesh = whole;
        mesh.face = face.data();
        for (uint32_t& side : quads.sides)
            if (face[side] == NONE) side = twin(reflection.half_edge[side]);
        return true;
    }
};

// With sharp edges, or without where that leaves fewer inverted.
hmf_status fit_better(const Mesh& mesh, const double* position, const Reflection* front, int steps, int halvings,
                      QuadMesh& quads, Call& call) {
    QuadMesh free; // of sharp edges
    QuadFigures figures, without;
    if (!copy(quads.positions, free.positions, call.memory) || !copy(quads.quads, free.quads, call.memory)
        || !copy(quads.sides, free.sides, call.memory) || !copy(quads.held, free.held, call.memory))
        return call.out_of_memory();
    const size_t wished = quads.quad_count() << 2 * halvings;
    if (fit(mesh, position, front, steps, halvings, true, quads, figures, call)) return call.status();
    if (figures.inverted == 0) return HMF_OK;
    if (fit(mesh, position, front, steps, halvings, false, free, without, call)) return call.status();
    if (without.inverted < figures.inverted || quads.quad_count() < wished) std::swap(quads, free);
    return HMF_OK;
}

} // namespace

hmf_status fit_quads(const Mesh& mesh, const double* position, const Reflection* front, int steps, int halvings,
                     QuadMesh& quads, Call& call) {
    if (!front) return fit_better(mesh, position, front, steps, halvings, quads, call);
    Front shown;
    if (!shown.build(mesh, *front, quads, call.memory)) return call.out_of_memory();
    size_t corners = 0;
    if (steps > 0 && take_boundary_corners(shown.mesh, position, *front, quads, corners, call)) return call.status();
    return fit_better(shown.mesh, position, front, steps, halvings, quads, call);
}

} // namespace hmf
