// The cascadic multigrid method ([W] section 4): solve on the coarsest level,
// interpolate, optimize, up to the input.
#include "parameters.hpp"
#include "solve.hpp"

#include <cstring>

namespace hmf {

hmf_status SolveLog::count_levels(size_t n) {
    if (!wanted_) return HMF_OK;
    report.level_count = n;
    return levels.allocate_filled(call_.memory, n, hmf_level_report{}) ? HMF_OK : call_.out_of_memory();
}

hmf_level_report* SolveLog::level(size_t index) { return index < levels.size() ? &levels[index] : nullptr; }

Done SolveLog::event(size_t level, uint32_t kind, double energy_units, double residual_max) {
    if (!wanted_) return true;
    const hmf_history_entry entry{call_.seconds(), energy_units * unit_ * unit_, residual_max,
                                  static_cast<uint32_t>(level), kind};
    if (!history.push(entry)) return false;
    ++report.history_count;
    return true;
}

Done LevelWork::prepare() {
    if (!rings.build(state.foliation.mesh, level.weight, call.memory, call.parallel)
        || !star.allocate(call.memory, rings.max_degree))
        return false;
    const hmf_hierarchy& h = *state.hierarchy;
    const uint32_t coarser = state.level + 1 < h.level_count ? h.levels[state.level + 1].mesh.vertex_count : 0;
    if (!sweeps.prepare(state.foliation, rings, coarser, call)) return false;
    star.budget = parameters::SEARCH_BUDGET;
    return true;
}

namespace {

hmf_status optimize(State& state, const SolveOptions& options, Call& call, SolveLog& log, ClassGuard* guard,
                    hmf_level_report& statistics) {
    const double start = call.seconds();
    LevelWork work{state, state.hierarchy->levels[state.level], options, call, log, guard, {}, {}, {}, {}};
    if (guard) guard->zeros.known = false;
    if (!work.prepare()) return call.out_of_memory();
    // Coarse levels of the direct method only provide a start.
    const hmf_status status =
        options.method == HMF_METHOD_NEWTON ? newton_level(work, options.tolerance) : whitehead_level(work);
    statistics.sweep_count += work.statistics.sweep_count;
    statistics.linear_solve_count += work.statistics.linear_solve_count;
    statistics.optimize_seconds += call.seconds() - start;
    return status;
}

// The level as it was entered, and again with a check of each step if it loses the class.
hmf_status optimize_in_class(State& state, const SolveOptions& options, Call& call, SolveLog& log, ClassGuard& guard,
                             hmf_level_report& statistics) {
    Foliation& f = state.foliation;
    const double unit = log.unit();
    const int64_t largest = state.largest_input_value;
    Array<int64_t> values;
    if (!values.allocate(call.memory, f.mesh.edge_count)) return call.out_of_memory();
    std::memcpy(values.data(), f.value, values.size() * sizeof(int64_t));
    hmf_status status = HMF_OK;
    const auto go_back = [&] {
        std::memcpy(f.value, values.data(), values.size() * sizeof(int64_t));
        log.set_unit(unit);
        state.largest_input_value = largest;
        log.certificate.known = false;
        guard.zeros.known = false;
    };
    for (uint32_t attempt = 0; attempt < 2; ++attempt) {
        guard.checks = attempt == 0 ? ClassGuard::Checks::levels : ClassGuard::Checks::steps;
        if (attempt > 0) {
            go_back();
            ++guard.repeats;
        }
        status = optimize(state, options, call, log, &guard, statistics);
        if (status >= HMF_ERROR_NULL || call.cancelled() || call.finishing()) return status;
        if (const hmf_status looked = guard.certify(state, log.unit(), call)) return looked;
        if (guard.holds()) return status;
    }
    go_back();
    if (const hmf_status looked = guard.certify(state, log.unit(), call)) return looked;
    return HMF_LIMIT_CLASS;
}

} // namespace

hmf_status run_cascade(State& state, const SolveOptions& options, Call& call, SolveLog& log, ClassGuard* guard) {
    const hmf_hierarchy& h = *state.hierarchy;
    if (log.count_levels(state.level - options.stop() + 1)) return call.status();
    // Progress: each level its share of the edges.
    double total = 0, done = 0;
    for (size_t k = options.stop(); k <= state.level; ++k) total += static_cast<double>(h.levels[k].mesh.edge_count);
    hmf_status status = HMF_OK;
    for (;;) {
        const size_t k = state.level;
        const Level& level = h.levels[k];
        const double share = static_cast<double>(level.mesh.edge_count) / total;
        hmf_level_report statistics{};
        statistics.vertex_count = level.mesh.vertex_count;
        statistics.edge_count = level.mesh.edge_count;
        statistics.raised_count = level.raised_count;
        hmf_level_report* entry = log.level(k - options.stop());
        if (entry) statistics.interpolate_seconds = entry->interpolate_seconds;
        call.range(done, done + 0.9 * share);
        const bool stop_improving = status == HMF_LIMIT_TIME || call.finishing();
        if (!stop_improving) {
            const bool is_guarded = guard && guard->checks != ClassGuard::Checks::result;
            const hmf_status here = is_guarded ? optimize_in_class(state, options, call, log, *guard, statistics)
                                               : optimize(state, options, call, log, guard, statistics);
            if (here >= HMF_ERROR_NULL) return here;
            // Only the last level decides, unless the whole call ran out of something.
            status = here;
        } else if (call.finishing()) {
            status = HMF_CANCELLED; // whatever an earlier level reached
        }
        done += share;
        if (entry) *entry = statistics;
        if (call.cancelled()) return HMF_CANCELLED;
        if (k == options.stop_level) return status;

        const double start = call.seconds();
        call.range(done, done);
        if (!state.refine(call) || (state.level == 0 && !state.to_intrinsic(call))) return interrupted(call);
        if (hmf_level_report* finer = log.level(state.level - options.stop()))
            finer->interpolate_seconds = call.seconds() - start;
        log.certificate.known = false;
        if (!log.event(state.level, 0, energy(state.foliation, h.levels[state.level].weight, call.parallel), -1))
            return call.out_of_memory();
    }
}

} // namespace hmf
