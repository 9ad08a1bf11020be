// hmf.h: initialize, solve, relax.
#include "../hierarchy/caller_numbers.hpp"
#include "../leaves/double_reflection.hpp"
#include "read_values.hpp"
#include "solve_call.hpp"
#include "solve_result.hpp"

#include <algorithm>

namespace hmf {

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
    if (!(options.energy_tolerance >= 0) || !(options.energy_tolerance < 1))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "energy_tolerance must lie in (0, 1); 0 means the default.");
    if (options.method == HMF_METHOD_NEWTON && options.tolerance == 0) options.tolerance = DEFAULT_TOLERANCE;
    if (options.energy_tolerance == 0) options.energy_tolerance = defaults.energy_tolerance;
    if (options.iteration_limit == 0) options.iteration_limit = defaults.iteration_limit;
    if (options.stop_level >= h.level_count)
        return call.fail(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, options.stop_level,
                         "stop_level is %llu; the hierarchy has %llu, counted from 0.",
                         static_cast<unsigned long long>(options.stop_level),
                         static_cast<unsigned long long>(h.level_count));
    options.largest_value = LARGEST_INNER_VALUE;
    if (options.method == HMF_METHOD_SINGLE_LEVEL && options.stop_level != 0)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "The single-level method works on level 0 only. Set stop_level to 0.");
    call.set_time_limit(options.time_limit);
    return HMF_OK;
}

size_t first_level(const hmf_hierarchy& h, const SolveOptions& options) {
    return options.method == HMF_METHOD_SINGLE_LEVEL ? 0 : h.level_count - 1;
}

namespace {

// Runs the cascade and hands the result over; the state lies on level `given`,
// on the caller's side of level 0.  loops: those of the foliation, NULL if it was given.
hmf_status solve_from(State& state, size_t start, const WeightedLoops* loops, double unit, const SolveOptions& options,
                      Call& call, hmf_foliation** out) {
    if (const hmf_status status = refuse_hubs(*state.hierarchy, options.stop(), call)) return status;
    SolveLog log(true, call, unit);
    if (!state.go_to(start, call) || (start == 0 && !state.to_intrinsic(call)))
        return call.cancelled() ? call.fail(HMF_CANCELLED, HMF_ELEMENT_NONE, 0,
                                            "Cancelled by the progress callback before there was a foliation.")
                                : call.out_of_memory();
    ClassGuard guard;
    const Array<int64_t> unknown;
    const bool same_mesh = loops && loops->level == start && start > 0; // of the loops and the state
    if (guard.start(state, unit, same_mesh ? &loops->loops : nullptr, loops ? loops->weights : unknown, call))
        return call.status();
    if (options.method == HMF_METHOD_PAPER) state.bad_flip = BadFlip::as_printed;
    const hmf_status status = solve_in_class(state, options, call, log, guard);
    if (status >= HMF_ERROR_NULL) return status;
    if (call.cancelled() && state.level != options.stop_level)
        return call.fail(HMF_CANCELLED, HMF_ELEMENT_LEVEL, state.level,
                         "Cancelled by the progress callback on level %llu, before the asked one was reached.",
                         static_cast<unsigned long long>(state.level));
    return finish_solve(state, status, options, unit, log, call, guard, out);
}

// Optimizes the state of a foliation on its level, within its class. If the foliation has a report, guard.result claims
// no more than that report.
hmf_status relax_in_class(State& state, const hmf_foliation& from, const SolveOptions& options, SolveLog& log,
                          ClassGuard& guard, Call& call) {
    const int32_t known = from.has_report ? from.report.class_state : HMF_CLASS_UNKNOWN;
    hmf_status status = HMF_OK;
    if (options.method == HMF_METHOD_NEWTON) {
        const Array<int64_t> unknown;
        if (guard.start(state, log.unit(), nullptr, unknown, call)) return call.status();
        status = solve_in_class(state, options, call, log, guard);
        if (!from.has_report || !guard.holds()) return status;
        if (known == HMF_CLASS_UNKNOWN || known == HMF_CLASS_LOST) guard.result.state = ClassState::unknown;
    } else { // moves of single vertices do not leave the class
        status = run_cascade(state, options, call, log);
        if (known != HMF_CLASS_LOST) guard.result.state = static_cast<ClassState>(known);
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
    if (start.count != state.foliation.mesh.edge_count)
        return call.fail(HMF_ERROR_COUNT, HMF_ELEMENT_NONE, state.foliation.mesh.edge_count,
                         "start belongs to a mesh with other edges. Give a foliation of the same triangles.");
    uint64_t poles = 0;
    if (read_values(state, start.values, static_cast<size_t>(start.count), unit, poles, call)) return call.status();
    return refuse_poles(poles, call);
}

} // namespace

hmf_status solve_loops(const hmf_hierarchy& h, const WeightedLoops& loops, const SolveOptions& options, Call& call,
                       hmf_foliation** out) {
    State state;
    if (!state.allocate(h, std::min(options.stop(), loops.level), call.memory)) return call.out_of_memory();
    state.load(loops.level, Triangulation::input);
    initial_foliation(state.foliation.mesh, loops.loops, loops.weights.data(), state.foliation.value);
    return solve_from(state, first_level(h, options), &loops, loops.unit, options, call, out);
}

} // namespace hmf

using namespace hmf;

extern "C" {

hmf_status hmf_foliation_from_loops(const hmf_hierarchy* hierarchy, const hmf_loop_set* loops,
                                    const hmf_control* control, hmf_foliation** out, hmf_error* error) {
    Entry entry(hierarchy, control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, out)) return call.status();
    WeightedLoops given;
    if (read_loop_set(*hierarchy, loops, nullptr, given, call)) return call.status();
    State state;
    if (!state.allocate(*hierarchy, given.level, call.memory)) return call.out_of_memory();
    state.load(given.level, Triangulation::input);
    initial_foliation(state.foliation.mesh, given.loops, given.weights.data(), state.foliation.value);
    Symmetrized made;
    if (make_symmetric(*state.hierarchy, state.level, state.foliation, call, made)) return call.status();
    FoliationData data;
    data.unit = given.unit;
    return make_foliation(state, data, call, out) ? call.status() : entry.end();
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
    call.range(0, 0); // the levels share the whole range
    if (solve.start) {
        State state;
        double unit = 1;
        if (load_start(*hierarchy, *solve.start, solve.stop(), state, unit, call)) return call.status();
        return solve_from(state, first_level(*hierarchy, solve), nullptr, unit, solve, call, out);
    }
    WeightedLoops given;
    if (read_loop_set(*hierarchy, loops, nullptr, given, call)) return call.status();
    return solve_loops(*hierarchy, given, solve, call, out);
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
    if (refuse_hubs(*hierarchy, foliation->level, call) || load_solved(*foliation, state, unit, call))
        return call.status();
    SolveLog log(true, call, unit);
    solve.stop_level = foliation->level;
    ClassGuard guard;
    const hmf_status status = relax_in_class(state, *foliation, solve, log, guard, call);
    if (status >= HMF_ERROR_NULL) return status;
    return finish_solve(state, status, solve, foliation->unit, log, call, guard, out);
}

} // extern "C"
