#include "fit_quads.hpp"

#include "optimize_quads.hpp"
#include "quad_figures.hpp"
#include "quad_numbers.hpp"
#include "surface_search.hpp"

#include <utility>

namespace hmf {

hmf_status fit_quads(const Mesh& mesh, const double* position, int sweeps, QuadMesh& quads, QuadMesh& fitted,
                     Call& call) {
    if (place_on_boundary(mesh, position, quads, call)) return call.status();
    SurfaceSearch surface;
    if (!fitted.copy(quads, call.memory) || !surface.build(mesh, position, call.memory)) return call.out_of_memory();
    QuadOptimizer optimizer(mesh, position, surface, fitted, call);
    if (optimizer.start() || optimizer.untangle() || optimizer.shape(sweeps)) return call.status();
    QuadMesh plain; // without tips and sharp edges
    uint64_t before = 0, after = 0;
    if (!plain.copy(fitted, call.memory)) return call.out_of_memory();
    if (!count_inverted(surface, plain, before, call)) return call.was_cancelled();
    for (int round = 0; round < ROUNDS; ++round) {
        size_t reached = 0, snapped = 0;
        if (reach_tips(mesh, position, surface, fitted, reached, call)
            || snap_to_sharp_edges(mesh, position, surface, fitted, snapped, call))
            return call.status();
        if (reached + snapped == 0) break;
        optimizer.look_again();
        if (optimizer.shape(sweeps)) return call.status();
    }
    if (optimizer.untangle(1) || optimizer.shape(sweeps)) return call.status();
    if (!count_inverted(surface, fitted, after, call)) return call.was_cancelled();
    if (after > before) std::swap(fitted, plain);
    return HMF_OK;
}

} // namespace hmf
