// hmf.h: loops, initialize, solve, relax.
#include "../design/conformal_scale.hpp"
#include "../hierarchy/caller_numbers.hpp"
#include "../leaves/double_reflection.hpp"
#include "../loops/surface_loops.hpp"
#include "canonical_loops.hpp"
#include "read_loop_set.hpp"

#include <algorithm>
#include <cmath>

using namespace hmf;

namespace {

// The solve options with all defaults in place.
hmf_status read_solve_options(const hmf_solve_options* from, const hmf_hierarchy& h, SolveOptions& options,
                              Call& call) {
    hmf_solve_options& given = options;
    const SolveOptions defaults;
    if (read_options(from, given, "hmf_solve_options", call)) return call.status();
    if (options.method == HMF_METHOD_DEFAULT) options.method = defaults.method;
    if (options.method < HMF_METHOD_NEWTON || options.method > HMF_METHOD_PAPER)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There is no method %d. Use HMF_METHOD_*.",
                         static_cast<int>(options.method));
    if (!(options.tolerance >= 0) || !(options.tolerance < 1) || !(options.time_limit >= 0))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "tolerance must lie in (0, 1) and time_limit must not be negative; 0 means the default.");
    if (!(options.residual_tolerance >= 0) || !(options.residual_tolerance < 1))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "residual_tolerance must lie in (0, 1); 0 means the default.");
    const bool newton = options.method == HMF_METHOD_NEWTON;
    if (newton && options.residual_tolerance > 0) options.tolerance = options.residual_tolerance;
    if (!(options.tolerance > 0)) options.tolerance = newton ? 1e-8 : 1e-6;
    if (options.iteration_limit == 0) options.iteration_limit = defaults.iteration_limit;
    if (options.stop_level >= h.level_count)
        return call.fail(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, options.stop_level,
                         "stop_level is %llu; the hierarchy has %llu levels, counted from 0.",
                         static_cast<unsigned long long>(options.stop_level),
                         static_cast<unsigned long long>(h.level_count));
    options.largest_value = largest_inner_value;
    if (options.method == HMF_METHOD_SINGLE_LEVEL && options.stop_level != 0)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "The single-level method works on level 0 only. Set stop_level to 0.");
    call.set_time_limit(options.time_limit);
    return HMF_OK;
}

// The sentence of a solve that ended with a foliation.
hmf_status describe(hmf_status status, size_t level, const hmf_report& report, const ClassWatch& watch, Call& call) {
    switch (status) {
    case HMF_OK: call.finished(); return HMF_OK;
    case HMF_LIMIT_TIME:
        return call.fail(
            status, HMF_ELEMENT_LEVEL, level,
            "The time limit ended the optimisation; the values are closed and without poles. Raise time_limit.");
    case HMF_LIMIT_ITERATIONS:
        return call.fail(status, HMF_ELEMENT_LEVEL, level,
                         "The limit of %s ended the optimisation; the values are closed and without poles. Raise %s.",
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
        if (watch.lost.loop == NONE)
            return call.fail(status, HMF_ELEMENT_NONE, 0,
                             "Steps to the minimum leave the class of the loops; report->class_state tells whether the "
                             "values are in it. Try another ratio, or improve the triangles.");
        return call.fail(status, HMF_ELEMENT_LOOP, watch.lost.loop,
                         "Steps to the minimum leave the class: the cylinder of loop %u would be %g high instead of "
                         "%g. The values are in the class. Try another ratio, or improve the triangles.",
                         static_cast<unsigned>(watch.lost.loop), watch.lost.found * watch.unit,
                         watch.lost.wanted * watch.unit);
    case HMF_CANCELLED:
        return call.fail(status, HMF_ELEMENT_LEVEL, level,
                         "Cancelled by the progress callback; the values are closed and without poles.");
    default:
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0, "Unexpected status %d. Please report it.",
                         static_cast<int>(status));
    }
}

// Energy and residuals of the report, where the method has not left them.
hmf_status measure(State& state, Recorder& recorder, Call& call) {
    const Level& level = state.hierarchy->levels[state.level];
    Certificate certificate = recorder.certificate;
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
    recorder.report.energy = certificate.energy * recorder.unit() * recorder.unit() * share;
    for (hmf_history_entry& entry : recorder.history) entry.energy *= share;
    recorder.report.residual_max = certificate.residual_max;
    recorder.report.residual_mean = certificate.residual_mean;
    return HMF_OK;
}

// Bits that the unit has to lose so that doubles hold the values: none or, beyond
// 2^53, with room for sums of two, but not more than `most`.
uint32_t bits_too_many(const Foliation& f, uint32_t most) {
    int64_t largest = 0;
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e)
        if (f.value[e] > largest) largest = f.value[e];
    uint32_t bits = 0;
    if (largest > int64_t{1} << 53)
        while (bits < most && largest >> bits > int64_t{1} << 51) ++bits;
    return bits;
}

// From a state that a cascade has left to the foliation of the caller.
// unit_of_heights: a unit that all heights are multiples of.
hmf_status finish(State& state, hmf_status status, const SolveOptions& options, double unit_of_heights,
                  Recorder& recorder, Call& call, const ClassWatch& watch, hmf_foliation** out) {
    hmf_report& report = recorder.report;
    report.struct_size = sizeof report;
    report.method = options.method;
    if (measure(state, recorder, call)) return call.status();
    const double enough = options.method == HMF_METHOD_NEWTON ? options.tolerance
                        : options.residual_tolerance > 0      ? options.residual_tolerance
                                                              : 1e-8;
    report.converged = report.residual_max >= 0 && report.residual_max <= enough;
    report.class_state = static_cast<int32_t>(watch.result.state);
    report.class_repeats = watch.repeats;
    report.class_seconds = watch.seconds;
    Making making;
    Array<int64_t> solved;
    const uint32_t n = state.foliation.mesh.edge_count;
    const bool two_sides = state.level == 0 && state.hierarchy->intrinsic_flip_count > 0;
    int spare = 0; // bits that the unit has become finer by, and one
    std::frexp(unit_of_heights / recorder.unit(), &spare);
    if (two_sides || spare > 1) {
        if (!solved.allocate(call.memory, n)) return call.out_of_memory();
        std::memcpy(solved.data(), state.foliation.value, n * sizeof(int64_t));
    }
    if (state.level == 0 && !state.to_input(call)) return call.stopped();
    // A call that was cancelled before gives what it has.
    Call* const watched = call.cancelled() ? nullptr : &call;
    if (watched && !call.tick(0, true)) return call.was_cancelled();
    making.solved_bits = bits_too_many(state.foliation, static_cast<uint32_t>(spare - 1));
    if (two_sides || making.solved_bits > 0) making.solved = solved.data();
    if (making.solved_bits > 0 && coarsen_unit(state, making.solved_bits, call)) return call.status();
    if (options.method != HMF_METHOD_PAPER && make_symmetric(state, call)) return call.status();
    if (watched && !call.tick(0, true)) return call.was_cancelled();
    const SingularityCount count = count_singularities(state.foliation, {}, watched);
    if (watched && call.cancelled()) return call.was_cancelled();
    if (count.broken_triangles > 0)
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                         "%llu triangles of the result are not closed. Please report it.",
                         static_cast<unsigned long long>(count.broken_triangles));
    making.unit = std::ldexp(recorder.unit(), static_cast<int>(making.solved_bits));
    if (watched && !call.tick(0, true)) return call.was_cancelled();
    ConformalScale scale;
    if (!scale.measure(state.foliation.mesh, state.hierarchy->levels[state.level].position, state.foliation.value,
                       making.unit, call.memory, watched))
        return call.stopped();
    report.unevenness = scale.unevenness();
    report.poles = making.poles = count.poles;
    report.zeros = count.zeros;
    report.index_sum = count.index_sum;
    report.bad_flips = state.statistics.bad_flips;
    report.bad_flips_left = state.statistics.bad_flips_left;
    report.peak_memory_bytes = call.memory.peak() - state.hierarchy->memory.used();
    report.solve_seconds = call.seconds();
    making.recorder = &recorder;
    if (recorder.certificate.known && recorder.certificate.fractional) making.fraction = recorder.fraction.data();
    if (make_foliation(state, making, call, out)) return call.status();
    if (report.poles > 0 && status == HMF_OK) status = HMF_LIMIT_CLASS;
    return describe(status, state.level, report, watch, call);
}

// Runs the cascade and hands the result over; the state lies on level `given`,
// on the caller's side of level 0.  loops: those of the foliation, NULL if it was given.
hmf_status solve_from(State& state, size_t start, const WeightedLoops* loops, double unit, const SolveOptions& options,
                      Call& call, hmf_foliation** out) {
    Recorder recorder(true, call, unit);
    if (!state.go_to(start, call) || (start == 0 && !state.to_intrinsic(call)))
        return call.cancelled() ? call.fail(HMF_CANCELLED, HMF_ELEMENT_NONE, 0,
                                            "Cancelled by the progress callback before there was a foliation.")
                                : call.out_of_memory();
    ClassWatch watch;
    const Array<int64_t> unknown;
    const bool same_mesh = loops && loops->level == start && start > 0; // of the loops and the state
    if (watch.start(state, unit, same_mesh ? &loops->loops : nullptr, loops ? loops->weights : unknown, call))
        return call.status();
    if (options.method == HMF_METHOD_PAPER) state.bad_flip = BadFlip::as_printed;
    const hmf_status status = solve_in_class(state, options, call, recorder, watch);
    if (status >= HMF_ERROR_NULL) return status;
    if (call.cancelled() && state.level != options.stop_level)
        return call.fail(HMF_CANCELLED, HMF_ELEMENT_LEVEL, state.level,
                         "Cancelled by the progress callback on level %llu, before the asked one was reached.",
                         static_cast<unsigned long long>(state.level));
    return finish(state, status, options, unit, recorder, call, watch, out);
}

// Optimises the state of a foliation on its level, within its class.  Where that
// has a report, watch.result says no more than the report did.
hmf_status relax_in_class(State& state, const hmf_foliation& from, const SolveOptions& options, Recorder& recorder,
                          ClassWatch& watch, Call& call) {
    const int32_t known = from.has_report ? from.report.class_state : HMF_CLASS_UNKNOWN;
    hmf_status status = HMF_OK;
    if (options.method == HMF_METHOD_NEWTON) {
        const Array<int64_t> unknown;
        if (watch.start(state, recorder.unit(), nullptr, unknown, call)) return call.status();
        status = solve_in_class(state, options, call, recorder, watch);
        if (!from.has_report || !watch.holds()) return status;
        if (known == HMF_CLASS_UNKNOWN || known == HMF_CLASS_LOST) watch.result.state = ClassState::unknown;
        else if (known == HMF_CLASS_CHECKED && watch.result.state == ClassState::proven)
            watch.result.state = ClassState::checked;
    } else { // moves of single vertices do not leave the class
        status = run_cascade(state, options, call, recorder);
        if (known != HMF_CLASS_LOST) watch.result.state = static_cast<ClassState>(known);
    }
    return status;
}

// The start of the caller: of this hierarchy, or of another one of the same triangles.
hmf_status load_start(const hmf_hierarchy& h, const hmf_foliation& start, size_t finest, State& state, double& unit,
                      Call& call) {
    if (check_foliation(&start, call)) return call.status();
    unit = start.unit;
    if (start.hierarchy == &h) return load_values(start, finest, state, call);
    if (start.level > 0)
        return call.fail(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, start.level,
                         "start lies on level %llu of another hierarchy. Carry it to level 0 there with "
                         "hmf_interpolate.",
                         static_cast<unsigned long long>(start.level));
    if (!state.allocate(h, 0, call.memory)) return call.out_of_memory();
    state.load(0, Triangulation::input);
    uint64_t poles = 0;
    if (read_values(state, start.values, static_cast<size_t>(start.count), unit, poles, call)) return call.status();
    return refuse_poles(poles, call);
}

// hmf_loops on a surface with boundary.
hmf_status loops_of_surface(const hmf_hierarchy& h, size_t level, int32_t kind, Call& call, hmf_loop_set** out) {
    if (level > 0)
        return call.fail(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, level,
                         "Level %llu is one of the closed double of the surface. Ask for loops of a surface with "
                         "boundary on level 0.",
                         static_cast<unsigned long long>(level));
    FoundLoops found;
    if (surface_loops(h, kind, call, found)) return call.status();
    hmf_loop_set made{sizeof(hmf_loop_set), HMF_LOOP_TRIANGLES, 0, found.count(), nullptr, nullptr, nullptr, nullptr};
    ResultBlock block;
    block.array(made, made.offsets, found.offsets.size(), found.offsets.data());
    block.array(made, made.elements, found.triangles.size(), found.triangles.data());
    block.array(made, made.arcs, found.arcs.size(), found.arcs.data());
    *out = block.make(made, h, call);
    return call.status();
}

} // namespace

extern "C" {

hmf_status hmf_loops(const hmf_hierarchy* hierarchy, size_t level, int32_t kind, const hmf_control* control,
                     hmf_loop_set** out, hmf_error* error) {
    Entry entry(hierarchy, control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, out) || check_level(*hierarchy, level, call)) return call.status();
    if (hierarchy->is_double())
        return loops_of_surface(*hierarchy, level, kind, call, out) ? call.status() : entry.end();
    Loops loops;
    Array<uint32_t> faces;
    if (canonical_loops(*hierarchy, level, kind, call, loops)
        || name_by_triangles(*hierarchy, level, call, loops, faces))
        return call.status();
    if (level == 0 && caller_triangles(*hierarchy, loops.crossings, faces, call)) return call.status();
    hmf_loop_set made{
        sizeof(hmf_loop_set), HMF_LOOP_TRIANGLES, level, loops.count(), nullptr, nullptr, nullptr, nullptr};
    ResultBlock block;
    block.array(made, made.offsets, loops.offsets.size(), loops.offsets.data());
    block.array(made, made.elements, faces.size(), faces.data());
    *out = block.make(made, *hierarchy, call);
    return entry.end();
}

hmf_status hmf_initialize(const hmf_hierarchy* hierarchy, const hmf_loop_set* loops, const hmf_control* control,
                          hmf_foliation** out, hmf_error* error) {
    Entry entry(hierarchy, control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, out)) return call.status();
    WeightedLoops given;
    if (read_loop_set(*hierarchy, loops, hierarchy->level_count - 1, given, call)) return call.status();
    State state;
    if (!state.allocate(*hierarchy, given.level, call.memory)) return call.out_of_memory();
    state.load(given.level, Triangulation::input);
    initial_foliation(state.foliation.mesh, given.loops, given.weights.data(), state.foliation.value);
    if (make_symmetric(state, call)) return call.status();
    Making making;
    making.unit = given.unit;
    return make_foliation(state, making, call, out) ? call.status() : entry.end();
}

hmf_status hmf_solve(const hmf_hierarchy* hierarchy, const hmf_loop_set* loops, const hmf_solve_options* options,
                     const hmf_control* control, hmf_foliation** out, hmf_error* error) {
    Entry entry(hierarchy, control, error, true);
    Call& call = entry.call;
    SolveOptions solve;
    if (entry.check(hierarchy, out) || read_solve_options(options, *hierarchy, solve, call)) return call.status();
    if (solve.start && loops)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "There are loops and a start. Give one of them, the other NULL.");
    // The cascade starts on the coarsest level, to which loops and foliations of finer levels are restricted.
    const size_t start = solve.method == HMF_METHOD_SINGLE_LEVEL ? 0 : hierarchy->level_count - 1;
    State state;
    call.range(0, 0); // the levels share the whole range
    if (solve.start) {
        double unit = 1;
        if (load_start(*hierarchy, *solve.start, solve.stop(), state, unit, call)) return call.status();
        return solve_from(state, start, nullptr, unit, solve, call, out);
    }
    WeightedLoops given;
    if (read_loop_set(*hierarchy, loops, start, given, call)) return call.status();
    if (!state.allocate(*hierarchy, std::min(solve.stop(), given.level), call.memory)) return call.out_of_memory();
    state.load(given.level, Triangulation::input);
    initial_foliation(state.foliation.mesh, given.loops, given.weights.data(), state.foliation.value);
    return solve_from(state, start, &given, given.unit, solve, call, out);
}

hmf_status hmf_relax(const hmf_foliation* foliation, const hmf_solve_options* options, const hmf_control* control,
                     hmf_foliation** out, hmf_error* error) {
    const hmf_hierarchy* const hierarchy = foliation ? foliation->hierarchy : nullptr;
    Entry entry(hierarchy, control, error, true);
    Call& call = entry.call;
    SolveOptions solve;
    if (entry.check(hierarchy, out) || check_foliation(foliation, call)) return call.status();
    if (read_solve_options(options, *hierarchy, solve, call)) return call.status(); // NOLINT: check refuses NULL
    State state;
    double unit = 1;
    if (load_solved(*foliation, state, unit, call)) return call.status();
    Recorder recorder(true, call, unit);
    solve.stop_level = foliation->level;
    ClassWatch watch;
    const hmf_status status = relax_in_class(state, *foliation, solve, recorder, watch, call);
    if (status >= HMF_ERROR_NULL) return status;
    return finish(state, status, solve, foliation->unit, recorder, call, watch, out);
}

} // extern "C"
