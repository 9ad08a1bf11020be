// The cascadic multigrid method ([W] section 4): solve on the coarsest level,
// interpolate, optimize, up to the input.
#include "fraction.hpp"
#include "steering.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

hmf_status Recorder::count_levels(size_t n) {
    if (!wanted_) return HMF_OK;
    report.level_count = n;
    return levels.allocate_filled(call_.memory, n, hmf_level_report{}) ? HMF_OK : call_.out_of_memory();
}

hmf_level_report* Recorder::level(size_t index) { return index < levels.size() ? &levels[index] : nullptr; }

Done Recorder::event(size_t level, uint32_t kind, double energy_units, double residual_max) {
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
    star.budget = steering::SEARCH_BUDGET;
    return true;
}

// No step helps. Tests whether quantization is the reason.
hmf_status end_beyond_rounding(LevelWork& work, double goal) {
    ResidualResult found;
    Recorder& recorder = work.recorder;
    if (const hmf_status status = find_fractions(work, goal, recorder.fraction, found)) return status;
    if (!(found.max <= goal)) return HMF_LIMIT_STALLED;
    const double D = energy(work.state.foliation, work.level.weight, work.call.parallel);
    if (!work.record(work.options.method == HMF_METHOD_NEWTON ? 2 : 1, D, found.max)) return work.call.out_of_memory();
    recorder.certificate = {true, D, found.max, found.mean, true};
    return HMF_OK;
}

hmf_status whitehead_level(LevelWork& work) {
    Foliation& f = work.state.foliation;
    double D = energy(f, work.level.weight);
    const double wanted = work.state.level == work.options.stop_level ? work.options.tolerance : 0;
    const uint32_t n = f.mesh.vertex_count;
    uint32_t without_move = 0; // sweeps without a move, one after the other
    for (uint64_t iteration = 0; iteration < work.options.iteration_limit; ++iteration) {
        SweepResult result;
        if (n >= steering::SMALL_LEVEL) work.star.credit = steering::CREDIT_PER_VERTEX * uint64_t{n};
        // The number of sweeps is not known; the fraction tends to 1.
        const double fraction = 1 - 1 / (1 + static_cast<double>(iteration) / steering::SWEEPS_OF_HALF_PROGRESS);
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
            if (without_move == steering::SWEEPS_WITHOUT_MOVE) {
                // The remaining steps are smaller than a unit: a finer unit, as far as doubles distinguish pulls, then
                // fractions.
                const double told_apart = std::max(wanted, steering::END_OF_DOUBLES);
                if (!work.refine_unit(told_apart).changed) return end_beyond_rounding(work, wanted);
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

namespace {

// Bits by which the unit must be finer for this residual: rounding to a unit
// changes the pull of an edge by its weight.
uint32_t bits_for_residual(const LevelWork& work, double residual) {
    const Foliation& f = work.state.foliation;
    const Rings& rings = work.rings;
    double total = 0;
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) total += work.level.weight[e] * static_cast<double>(f.value[e]);
    const double floor = pull_floor(total, f.mesh.vertex_count);
    double worst = 0;
    for (uint32_t v = 0; v < f.mesh.vertex_count; ++v) {
        double pull = 0, rounding = 0;
        for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t) {
            const uint32_t e = edge_of(rings.side[t].half_edge);
            pull += work.level.weight[e] * static_cast<double>(f.value[e]);
            rounding += work.level.weight[e];
        }
        if (pull < floor) pull = floor;
        if (rounding > worst * pull) worst = rounding / pull;
    }
    uint32_t bits = 0;
    for (double error = 2 * worst; error > residual && bits < 52; error *= 0.5) ++bits;
    return bits;
}

} // namespace

UnitChange LevelWork::refine_unit(double residual) {
    Foliation& f = state.foliation;
    const uint32_t wanted = bits_for_residual(*this, residual);
    int64_t largest = state.largest_input_value;
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e)
        if (f.value[e] > largest) largest = f.value[e];
    uint32_t bits = wanted;
    while (bits > 0 && largest > options.largest_value >> bits) --bits;
    // Heights are no values of an edge: on a fine mesh they can be much larger.
    int64_t highest = 0;
    if (guard) highest = guard->reference.largest_height() * static_cast<int64_t>(guard->unit / recorder.unit());
    while (bits > 0 && highest > LARGEST_HEIGHT >> bits) --bits;
    // Exact, as the factor is a power of two.
    const int64_t factor = int64_t{1} << bits;
    for (uint32_t e = 0; e < f.mesh.edge_count && bits > 0; ++e) f.value[e] *= factor;
    state.largest_input_value *= factor;
    recorder.set_unit(recorder.unit() / static_cast<double>(factor));
    return {bits > 0, bits == wanted};
}

namespace {

hmf_status optimize(State& state, const SolveOptions& options, Call& call, Recorder& recorder, ClassGuard* guard,
                    bool gated, hmf_level_report& statistics) {
    const double start = call.seconds();
    LevelWork work{state, state.hierarchy->levels[state.level], options, call, recorder, guard, gated, {}, {}, {}, {}};
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
hmf_status optimize_in_class(State& state, const SolveOptions& options, Call& call, Recorder& recorder,
                             ClassGuard& guard, hmf_level_report& statistics) {
    Foliation& f = state.foliation;
    const double unit = recorder.unit();
    const int64_t largest = state.largest_input_value;
    Array<int64_t> values;
    if (!values.allocate(call.memory, f.mesh.edge_count)) return call.out_of_memory();
    std::memcpy(values.data(), f.value, values.size() * sizeof(int64_t));
    hmf_status status = HMF_OK;
    const auto go_back = [&] {
        std::memcpy(f.value, values.data(), values.size() * sizeof(int64_t));
        recorder.set_unit(unit);
        state.largest_input_value = largest;
        recorder.certificate.known = false;
        guard.zeros.known = false;
    };
    for (uint32_t attempt = 0; attempt < 2; ++attempt) {
        const bool gated = attempt > 0;
        if (gated) {
            go_back();
            ++guard.repeats;
        }
        status = optimize(state, options, call, recorder, &guard, gated, statistics);
        if (status >= HMF_ERROR_NULL || call.cancelled() || call.finishing()) return status;
        if (const hmf_status looked = guard.certify(state, recorder.unit(), call)) return looked;
        if (guard.holds()) return gated && status == HMF_LIMIT_STALLED ? HMF_LIMIT_CLASS : status;
    }
    go_back();
    if (const hmf_status looked = guard.certify(state, recorder.unit(), call)) return looked;
    return HMF_LIMIT_CLASS;
}

} // namespace

hmf_status run_cascade(State& state, const SolveOptions& options, Call& call, Recorder& recorder, ClassGuard* guard) {
    const hmf_hierarchy& h = *state.hierarchy;
    if (recorder.count_levels(state.level - options.stop() + 1)) return call.status();
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
        hmf_level_report* entry = recorder.level(k - options.stop());
        if (entry) statistics.interpolate_seconds = entry->interpolate_seconds;
        call.range(done, done + 0.9 * share);
        const bool stop_improving = status == HMF_LIMIT_TIME || call.finishing();
        if (!stop_improving) {
            const hmf_status here = options.guarded
                                      ? optimize_in_class(state, options, call, recorder, *guard, statistics)
                                      : optimize(state, options, call, recorder, guard, false, statistics);
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
        if (hmf_level_report* finer = recorder.level(state.level - options.stop()))
            finer->interpolate_seconds = call.seconds() - start;
        recorder.certificate.known = false;
        if (!recorder.event(state.level, 0, energy(state.foliation, h.levels[state.level].weight, call.parallel), -1))
            return call.out_of_memory();
    }
}

} // namespace hmf
