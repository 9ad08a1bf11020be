#include "solve_result.hpp"

#include "../extreme/fraction.hpp"
#include "../leaves/double_reflection.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// The sentence of a solve that ended with a foliation.
hmf_status describe(hmf_status status, size_t level, const hmf_report& report, const ClassGuard& guard, Call& call) {
    switch (status) {
    case HMF_OK: call.finished(); return HMF_OK;
    case HMF_LIMIT_TIME:
        return call.fail(
            status, HMF_ELEMENT_LEVEL, level,
            "The time limit ended the optimization; the values are closed and without poles. Raise time_limit.");
    case HMF_LIMIT_ITERATIONS:
        return call.fail(status, HMF_ELEMENT_LEVEL, level,
                         "The limit of %s ended the optimization; the values are closed and without poles. Raise %s.",
                         report.method == HMF_METHOD_NEWTON ? "steps" : "sweeps",
                         report.method == HMF_METHOD_NEWTON ? "step_limit" : "iteration_limit");
    case HMF_LIMIT_STALLED:
        return call.fail(
            status, HMF_ELEMENT_LEVEL, level,
            "No progress above the tolerance is possible; the values are closed and without poles. Loosen tolerance.");
    case HMF_LIMIT_CLASS:
        if (report.method == HMF_METHOD_PAPER)
            return call.fail(status, HMF_ELEMENT_NONE, 0,
                             "%llu flips of case 4 were taken as printed: the result has %llu poles and is not in the "
                             "class of the loops. HMF_METHOD_WHITEHEAD has none.",
                             static_cast<unsigned long long>(report.bad_flips_left),
                             static_cast<unsigned long long>(report.poles));
        if (guard.lost.loop == NONE)
            return call.fail(status, HMF_ELEMENT_NONE, 0,
                             "Steps to the minimum leave the class of the loops; report->class_state tells whether the "
                             "values are in it. Try another ratio, or improve the triangles.");
        return call.fail(status, HMF_ELEMENT_LOOP, guard.lost.loop,
                         "Steps to the minimum leave the class: the cylinder of loop %u would be %g high instead of "
                         "%g. The values are in the class. Try another ratio, or improve the triangles.",
                         static_cast<unsigned>(guard.lost.loop), guard.lost.found * guard.unit,
                         guard.lost.wanted * guard.unit);
    case HMF_CANCELLED:
        return call.fail(status, HMF_ELEMENT_LEVEL, level,
                         "Cancelled by the progress callback; the values are closed and without poles.");
    default:
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0, "Unexpected status %d. Please report it.",
                         static_cast<int>(status));
    }
}

// Energy and residuals of the report, where the method has not left them.
hmf_status measure_energy(State& state, SolveLog& log, Call& call) {
    const Level& level = state.hierarchy->levels[state.level];
    Certificate certificate = log.certificate;
    if (!certificate.known) {
        Rings rings;
        Star star;
        if (!rings.build(state.foliation.mesh, level.weight, call.memory, call.parallel)
            || !star.allocate(call.memory, rings.max_degree))
            return call.out_of_memory();
        const ResidualResult residual = residuals(state.foliation, rings, level.weight, star, nullptr, call);
        certificate = {true, energy(state.foliation, level.weight, call.parallel), residual.max, residual.mean};
        if (call.cancelled()) certificate.residual_max = certificate.residual_mean = -1; // it is unfinished
    }
    const double share = state.hierarchy->share();
    log.report.energy = certificate.energy * log.unit() * log.unit() * share;
    for (hmf_history_entry& entry : log.history) entry.energy *= share;
    log.report.residual_max = certificate.residual_max;
    log.report.residual_mean = certificate.residual_mean;
    return HMF_OK;
}

// Bits that the unit has to lose so that doubles hold the values: none or, beyond
// 2^53, with room for sums of two, but not more than `most`.
uint32_t bits_too_many(int64_t largest, uint32_t most) {
    uint32_t bits = 0;
    if (largest > int64_t{1} << 53)
        while (bits < most && largest >> bits > int64_t{1} << 51) ++bits;
    return bits;
}

} // namespace

hmf_status finish_solve(State& state, hmf_status status, const SolveOptions& options, double unit_of_heights,
                        SolveLog& log, Call& call, const ClassGuard& guard, hmf_foliation** out) {
    if (status == HMF_LIMIT_STALLED) status = correct_below_unit(state, options, guard, call, log);
    if (status >= HMF_ERROR_NULL) return status;
    hmf_report& report = log.report;
    report.struct_size = sizeof report;
    report.method = options.method;
    if (measure_energy(state, log, call)) return call.status();
    const double enough = options.tolerance > 0 ? options.tolerance : DEFAULT_TOLERANCE;
    report.converged = report.residual_max >= 0 && report.residual_max <= enough;
    report.class_state = static_cast<int32_t>(guard.result.state);
    report.class_repeats = guard.repeats;
    report.class_seconds = guard.seconds;
    FoliationData data;
    Array<int64_t> solved;
    const uint32_t n = state.foliation.mesh.edge_count;
    const bool two_sides = state.level == 0 && state.hierarchy->intrinsic_flip_count > 0;
    int spare = 0; // bits that the unit has become finer by, and one
    std::frexp(unit_of_heights / log.unit(), &spare);
    if (two_sides || spare > 1) {
        if (!solved.allocate(call.memory, n)) return call.out_of_memory();
        call.parallel.copy(solved.data(), state.foliation.value, n);
    }
    if (state.level == 0 && !state.to_input(call)) return call.stopped();
    // A call that was cancelled before gives what it has.
    Call* const watched = call.cancelled() ? nullptr : &call;
    if (watched && !call.tick(0, true)) return call.was_cancelled();
    data.solved_bits = bits_too_many(largest_value(state.foliation, call.parallel), static_cast<uint32_t>(spare - 1));
    if (two_sides || data.solved_bits > 0) data.solved = solved.data();
    if (data.solved_bits > 0 && coarsen_unit(state, data.solved_bits, call)) return call.status();
    Symmetrized made;
    if (options.method != HMF_METHOD_PAPER
        && make_symmetric(*state.hierarchy, state.level, state.foliation, call, made))
        return call.status();
    if (watched && !call.tick(0, true)) return call.was_cancelled();
    const SingularityCount count = made.exact ? made.count : count_singularities(state.foliation, {}, watched);
    if (watched && call.cancelled()) return call.was_cancelled();
    if (count.broken_triangles > 0)
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                         "%llu triangles of the result are not closed. Please report it.",
                         static_cast<unsigned long long>(count.broken_triangles));
    data.unit = std::ldexp(log.unit(), static_cast<int>(data.solved_bits));
    report.poles = data.poles = count.poles;
    report.zeros = count.zeros;
    report.index_sum = count.index_sum;
    report.bad_flips = state.statistics.bad_flips;
    report.bad_flips_left = state.statistics.bad_flips_left;
    report.peak_memory_bytes = call.memory.peak() - state.hierarchy->memory.used();
    report.solve_seconds = call.seconds();
    data.log = &log;
    if (log.certificate.known && log.certificate.fractional) data.fraction = log.fraction.data();
    if (make_foliation(state, data, call, out)) return call.status();
    if (report.poles > 0 && status == HMF_OK) status = HMF_LIMIT_CLASS;
    return describe(status, state.level, report, guard, call);
}

} // namespace hmf
