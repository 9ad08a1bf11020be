// In turns: vertices that reach for tips and snap to sharp edges are held, and the
// others are relaxed round them.  Quads cut in four look outwards where the whole one did,
// but at creases, where to turn them out takes long and does not always work.
#include "fit_quads.hpp"

#include "reach_tips.hpp"
#include "relax_quads.hpp"
#include "snap_quads.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr int ROUNDS = 3;         // of reaching for tips; from the first on pegasus' greatest distance is 1.4, 1.1, 0.8
constexpr int STEPS_ON_FINER = 4; // of relaxation

template <class T>
Done copy(const Array<T>& from, Array<T>& to, Memory& memory) {
    if (!to.allocate(memory, from.size())) return false;
    for (size_t i = 0; i < from.size(); ++i) to[i] = from[i];
    return true;
}

// Quads that look inwards are turned out, if no other quad gets inverted by that.
hmf_status turn_outwards(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call) {
    Array<double> positions;
    Array<uint32_t> sides;
    Array<uint8_t> held;
    QuadFigures before, after;
    if (!copy(quads.positions, positions, call.memory) || !copy(quads.sides, sides, call.memory)
        || !copy(quads.held, held, call.memory))
        return call.out_of_memory();
    if (quad_figures(quads, before, call) || relax_quads(mesh, position, 0, true, quads, call)
        || quad_figures(quads, after, call))
        return call.status();
    if (after.inverted > before.inverted) {
        quads.positions.swap(positions);
        quads.sides.swap(sides);
        quads.held.swap(held);
    }
    return HMF_OK;
}

} // namespace

hmf_status fit_quads(const Mesh& mesh, const double* position, const Reflection* front, int steps, int halvings,
                     QuadMesh& quads, Call& call) {
    if (relax_quads(mesh, position, steps, false, quads, call)) return call.status();
    for (int round = 0; round < ROUNDS; ++round) {
        size_t reached = 0, snapped = 0;
        if (reach_tips(mesh, position, front, quads, reached, call)
            || (round == 0 && snap_to_sharp_edges(mesh, position, front, quads, snapped, call)))
            return call.status();
        if (reached + snapped == 0) break;
        if (relax_quads(mesh, position, steps, false, quads, call)) return call.status();
    }
    if (turn_outwards(mesh, position, quads, call)) return call.status();
    for (; halvings > 0; --halvings)
        if (refine_quads(mesh, position, quads, call)
            || relax_quads(mesh, position, std::min(steps, STEPS_ON_FINER), false, quads, call))
            return call.status();
    return HMF_OK;
}

} // namespace hmf
