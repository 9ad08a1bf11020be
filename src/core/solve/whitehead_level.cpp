// The method of the paper on a level: sweeps of Whitehead moves ([W] section 4).
#include "parameters.hpp"
#include "solve.hpp"

#include <algorithm>

namespace hmf {

hmf_status whitehead_level(LevelWork& work) {
    Foliation& f = work.state.foliation;
    double D = energy(f, work.level.weight);
    const double wanted = work.state.level == work.options.stop_level ? work.options.tolerance : 0;
    const uint32_t n = f.mesh.vertex_count;
    uint32_t without_move = 0; // sweeps without a move, one after the other; two: in both orders
    for (uint64_t iteration = 0; iteration < work.options.iteration_limit; ++iteration) {
        SweepResult result;
        work.star.credit = parameters::SEARCH_BUDGET + parameters::CREDIT_PER_VERTEX * uint64_t{n};
        // The number of sweeps is not known; the fraction tends to 1.
        constexpr double sweeps_of_half_progress = 50;
        const double fraction = 1 - 1 / (1 + static_cast<double>(iteration) / sweeps_of_half_progress);
        work.sweeps.sweep(f, work.rings, work.level.weight, iteration % 2 == 1, work.star, result, work.call, fraction);
        ++work.statistics.sweep_count;
        D += result.energy_change;
        double residual = -1;
        if (wanted > 0 && !work.call.cancelled()) {
            residual = residuals(f, work.rings, work.level.weight, work.star, nullptr, work.call).max;
            if (work.call.cancelled()) residual = -1; // it is unfinished
        }
        if (!work.record(1, D, residual)) return work.call.out_of_memory();
        if (work.call.cancelled() || work.call.finishing()) return HMF_CANCELLED;
        if (wanted > 0) {
            if (residual <= wanted) return HMF_OK;
            without_move = result.moves == 0 ? without_move + 1 : 0;
            if (without_move == 2) {
                // The remaining steps are smaller than a unit: a finer one, as far as doubles distinguish pulls.
                if (!work.refine_unit(std::max(wanted, parameters::TIGHTEST))) return HMF_LIMIT_STALLED;
                D = energy(f, work.level.weight);
                without_move = 0;
            }
        } else if (-result.energy_change <= work.options.energy_tolerance * D) {
            return HMF_OK;
        }
        if (work.call.out_of_time()) return HMF_LIMIT_TIME;
    }
    return HMF_LIMIT_ITERATIONS;
}

} // namespace hmf
