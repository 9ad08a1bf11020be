#include "fit_quads.hpp"

#include "optimize_quads.hpp"
#include "quad_figures.hpp"
#include "quad_numbers.hpp"
#include "surface_search.hpp"

namespace hmf {

hmf_status fit_quads(const Mesh& mesh, const double* position, int sweeps, QuadMesh& quads, QuadMesh& fitted,
                     Call& call) {
    if (place_on_boundary(mesh, position, quads, call)) return call.status();
    SurfaceSearch surface;
    if (!fitted.copy(quads, call.memory) || !surface.build(mesh, position, call.memory)) return call.out_of_memory();
    QuadOptimizer optimizer(mesh, position, surface, fitted, call);
    if (optimizer.start() || optimizer.untangle() || optimizer.shape(sweeps)) return call.status();
    uint64_t inverted = 0;
    if (!count_inverted(surface, fitted, inverted, call)) return call.was_cancelled();
    // Where too many are folded, tips and sharp edges can wait: more quads are made, or none.
    const bool waits = static_cast<double>(inverted) > MOST_INVERTED * static_cast<double>(fitted.quad_count());
    for (int round = 0; round < ROUNDS && !waits; ++round) {
        size_t reached = 0, snapped = 0;
        if (reach_tips(mesh, position, surface, fitted, reached, call)
            || snap_to_sharp_edges(mesh, position, surface, fitted, snapped, call))
            return call.status();
        if (reached + snapped == 0) break;
        optimizer.look_again();
        if (optimizer.shape(sweeps)) return call.status();
    }
    return optimizer.untangle(1) ? call.status() : optimizer.shape(sweeps);
}

} // namespace hmf
