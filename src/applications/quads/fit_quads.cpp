#include "fit_quads.hpp"

#include "optimize_quads.hpp"
#include "quad_figures.hpp"
#include "quad_numbers.hpp"
#include "surface_search.hpp"

namespace hmf {

namespace {

// Vertices of quads with worse corners leave what holds them.
void give_up(QuadMesh& quads) {
    for (size_t q = 0; q < quads.quad_count(); ++q) {
        const double worst = worst_corner(quads, q);
        for (size_t k = 0; k < 4; ++k) {
            uint8_t& held = quads.held[quads.quads[4 * q + k]];
            const bool slides = held == ON_CREASE || held == ON_WAY_TO_TIP;
            if (!is_at_boundary(held) && worst < (slides ? LEAST_SLIDING : LEAST_TAKEN)) held = 0;
        }
    }
}

} // namespace

hmf_status fit_quads(const Mesh& mesh, const double* position, int sweeps, QuadMesh& quads, QuadMesh& fitted,
                     Call& call) {
    if (place_on_boundary(mesh, position, quads, call)) return call.status();
    SurfaceSearch surface;
    if (!fitted.copy(quads, call.memory) || !surface.build(mesh, position, call.memory)) return call.out_of_memory();
    QuadOptimizer optimizer(mesh, position, surface, fitted, call);
    if (optimizer.start() || optimizer.untangle() || optimizer.shape(sweeps)) return call.status();
    for (int round = 0; round < ROUNDS; ++round) {
        size_t reached = 0, snapped = 0;
        if (reach_tips(mesh, position, surface, fitted, reached, call)
            || snap_to_sharp_edges(mesh, position, surface, fitted, snapped, call))
            return call.status();
        if (reached + snapped == 0) break;
        optimizer.look_again();
        if (optimizer.shape(sweeps)) return call.status();
    }
    give_up(fitted);
    optimizer.look_again();
    uint64_t left = 0;
    if (optimizer.shape(sweeps)) return call.status();
    if (!count_inverted(surface, fitted, left, call)) return call.stopped();
    return left == 0 ? HMF_OK : optimizer.untangle(1) ? call.status() : optimizer.shape(sweeps);
}

} // namespace hmf
