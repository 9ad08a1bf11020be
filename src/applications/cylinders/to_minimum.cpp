#include "to_minimum.hpp"

#include "../../core/hierarchy/caller_numbers.hpp"

namespace hmf {

hmf_status to_minimum(State& state, double& unit, Call& call) {
    constexpr double largest_excess = 1e-2;
    if (const hmf_status status = refuse_hubs(*state.hierarchy, state.level, call)) return status;
    const double* weight = state.hierarchy->levels[state.level].weight;
    const double before = energy(state.foliation, weight) * unit * unit;
    SolveLog log(false, call, unit);
    SolveOptions options;
    options.tolerance = DEFAULT_TOLERANCE;
    options.stop_level = state.level;
    const hmf_status status = run_cascade(state, options, call, log);
    if (call.cancelled()) return call.was_cancelled();
    if (status >= HMF_ERROR_NULL) return status;
    unit = log.unit();
    const double excess = before / (energy(state.foliation, weight) * unit * unit) - 1;
    if (excess > largest_excess)
        return call.fail(HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ELEMENT_NONE, 0,
                         "The energy of the values is %.2g times that of the minimum. Improve them with hmf_relax.",
                         excess + 1);
    return HMF_OK;
}

} // namespace hmf
