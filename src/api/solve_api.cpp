// hmf.h: loops, initialize, solve, relax.
#include "../loops/library_loops.hpp"
#include "../solve/solve.hpp"
#include "values.hpp"

#include <cmath>

using namespace hmf;

namespace {

// Level of the caller's loops; of the library's own where set is NULL.
size_t loop_level(const hmf_loop_set* set, size_t own) { return set ? static_cast<size_t>(set->level) : own; }

// Loops of the caller (NULL: the cut system with weights 1) as checked
// crossings on `level`, with integer weights in `unit`.
hmf_status take_loops(const hmf_hierarchy& h, const hmf_loop_set* set, size_t level, Call& call, Loops& loops,
                      Array<int64_t>& weights, double& unit) {
    const double* given_weights = nullptr;
    GivenLoops given{};
    if (!set) {
        if (library_loops(h, level, HMF_LOOPS_CUT, call, loops)) return call.status();
    } else {
        hmf_loop_set all;
        if (!copy_options(set, all))
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                             "hmf_loop_set has an unusable struct_size. Set it to sizeof(hmf_loop_set).");
        if (all.element_kind != HMF_LOOP_TRIANGLES && all.element_kind != HMF_LOOP_VERTICES)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                             "element_kind is %d. Use HMF_LOOP_TRIANGLES or HMF_LOOP_VERTICES.",
                             static_cast<int>(all.element_kind));
        if (all.count == 0 || !all.offsets || !all.elements)
            return call.fail(all.count == 0 ? HMF_ERROR_LOOP_COUNT : HMF_ERROR_NULL, HMF_ELEMENT_LOOP, 0,
                             "There are no loops. Give at least one, or NULL for the loops that the library makes.");
        for (uint64_t c = 0; c < all.count; ++c)
            if (all.offsets[c + 1] < all.offsets[c] || all.offsets[0] != 0)
                return call.fail(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_LOOP, c,
                                 "The offsets of loop %llu decrease, or do not start at 0.",
                                 static_cast<unsigned long long>(c));
        const uint64_t elements = all.offsets[all.count];
        const Mesh& mesh = loop_mesh(h, level);
        Array<uint32_t> internal;
        const uint32_t* used = all.elements;
        if (level == 0) {
            if (!internal.allocate(call.memory, elements)) return call.out_of_memory();
            const bool triangles = all.element_kind == HMF_LOOP_TRIANGLES;
            const uint32_t limit = triangles ? mesh.face_count : mesh.vertex_count;
            for (uint64_t i = 0; i < elements; ++i)
                internal[i] = all.elements[i] >= limit ? NONE
                            : triangles                ? internal_face(h, all.elements[i])
                                                       : h.vertex_internal[all.elements[i]];
            used = internal.data();
        }
        if (read_loops(mesh, all.element_kind, all.count, all.offsets, used, call, loops)) return call.status();
        given_weights = all.weights;
        given = {all.element_kind, all.offsets, all.elements};
    }
    const size_t count = loops.count();
    double largest = given_weights ? 0 : 1;
    double smallest = given_weights ? HUGE_VAL : 1;
    for (size_t c = 0; given_weights && c < count; ++c) {
        const double w = given_weights[c];
        if (!(w > 0) || !(w < 1e100) || w < 1e-100)
            return call.fail(HMF_ERROR_LOOP_WEIGHT, HMF_ELEMENT_LOOP, c,
                             "The weight of loop %llu is %g. Weights are positive and finite.",
                             static_cast<unsigned long long>(c), w);
        if (w > largest) largest = w;
        if (w < smallest) smallest = w;
    }
    if (largest / smallest > 1048576.0)
        return call.fail(HMF_ERROR_LOOP_WEIGHT, HMF_ELEMENT_LOOP, 0,
                         "The weights span a factor of %g. Keep them within 2^20.", largest / smallest);
    unit = unit_of_weights(largest);
    if (!weights.allocate(call.memory, count)) return call.out_of_memory();
    for (size_t c = 0; c < count; ++c)
        weights[c] = static_cast<int64_t>((given_weights ? given_weights[c] : 1.0) / unit);
    if (!set) return HMF_OK;
    const hmf_status status = check_loops(loop_mesh(h, level), loops, call, &given);
    return status ? status : pull_tight(loop_mesh(h, level), call, loops);
}

// The solve options with all defaults in place.
hmf_status read_solve_options(const hmf_solve_options* from, const hmf_hierarchy& h, hmf_solve_options& all,
                              SolveOptions& options, Call& call) {
    if (!copy_options(from, all))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "hmf_solve_options has an unusable struct_size. Start from hmf_solve_options_init.");
    options.method = all.method ? all.method : HMF_METHOD_NEWTON;
    if (options.method < HMF_METHOD_NEWTON || options.method > HMF_METHOD_SINGLE_LEVEL)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "There is no method %d. Use HMF_METHOD_*.",
                         static_cast<int>(all.method));
    if (!(all.tolerance >= 0) || !(all.tolerance < 1) || !(all.time_limit >= 0))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "tolerance must lie in (0, 1) and time_limit must not be negative; 0 means the default.");
    options.tolerance = all.tolerance > 0 ? all.tolerance : options.method == HMF_METHOD_NEWTON ? 1e-8 : 1e-6;
    if (all.iteration_limit) options.iteration_limit = all.iteration_limit;
    if (all.stop_level >= h.level_count)
        return call.fail(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, all.stop_level,
                         "stop_level is %llu; the hierarchy has %llu levels, counted from 0.",
                         static_cast<unsigned long long>(all.stop_level),
                         static_cast<unsigned long long>(h.level_count));
    options.stop_level = all.stop_level;
    if (options.method == HMF_METHOD_SINGLE_LEVEL && options.stop_level != 0)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "The single-level method works on level 0 only. Set stop_level to 0.");
    call.set_time_limit(all.time_limit);
    return HMF_OK;
}

// A report of the caller with its arrays, and what is known of its layout.
hmf_status check_report(const hmf_report* report, Call& call) {
    if (report && report->struct_size != sizeof(hmf_report))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "hmf_report has struct_size %u instead of %u. Set it to sizeof(hmf_report).",
                         static_cast<unsigned>(report->struct_size), static_cast<unsigned>(sizeof(hmf_report)));
    return HMF_OK;
}

// Result of the state on its level into values and report.
hmf_status finish(State& state, hmf_status status, const SolveOptions& options, Call& call, Recorder& recorder,
                  double* values, const ClassWatch* watch) {
    hmf_report* report = recorder.report();
    if (report) {
        const Level& level = state.hierarchy->levels[state.level];
        report->method = options.method;
        report->converged = status == HMF_OK;
        const double unit = recorder.unit();
        Certificate certificate = recorder.certificate;
        if (!certificate.known) {
            Rings rings;
            Star star;
            if (!rings.build(state.foliation.mesh, level.weight, call.memory)
                || !star.allocate(call.memory, rings.max_degree))
                return call.out_of_memory();
            const ResidualResult residual = residuals(state.foliation, rings, level.weight, star, nullptr, call);
            certificate = {true, energy(state.foliation, level.weight), residual.max, residual.mean};
            if (call.cancelled()) certificate.residual_max = certificate.residual_mean = -1; // it is unfinished
        }
        report->energy = certificate.energy * unit * unit;
        report->residual_max = certificate.residual_max;
        report->residual_mean = certificate.residual_mean;
        if (watch) {
            report->class_state = static_cast<int32_t>(watch->result.state);
            report->class_repeats = watch->repeats;
            report->class_seconds = watch->seconds;
        }
    }
    if (state.level == 0 && !state.to_input(call))
        return call.cancelled() ? call.fail(HMF_CANCELLED, HMF_ELEMENT_NONE, 0, "Cancelled by the progress callback.")
                                : call.out_of_memory();
    if (report) {
        const SingularityCount count = count_singularities(state.foliation, nullptr, nullptr, nullptr, nullptr);
        if (state.foliation.out_of_memory) return call.out_of_memory();
        report->poles = count.poles;
        report->zeros = count.zeros;
        report->index_sum = count.index_sum;
        report->bad_flips = state.statistics.bad_flips;
        report->bad_flips_left = state.statistics.bad_flips_left;
        report->peak_memory_bytes = call.memory.peak() - state.hierarchy->memory.used();
    }
    if (export_values(state, recorder.unit(), values, call)) return call.status();
    if (report) {
        report->values_written = 1;
        report->solve_seconds = call.seconds();
    }
    switch (status) {
    case HMF_OK:
        call.range(1, 1);
        call.tick(1, true);
        return HMF_OK;
    case HMF_LIMIT_TIME:
        return call.fail(
            status, HMF_ELEMENT_LEVEL, state.level,
            "The time limit ended the optimisation; the values are closed and without poles. Raise time_limit.");
    case HMF_LIMIT_ITERATIONS:
        return call.fail(status, HMF_ELEMENT_LEVEL, state.level,
                         "The iteration limit ended the optimisation; the values are closed and without poles. Raise "
                         "iteration_limit.");
    case HMF_LIMIT_STALLED:
        return call.fail(
            status, HMF_ELEMENT_LEVEL, state.level,
            "No progress above the tolerance is possible; the values are closed and without poles. Loosen tolerance.");
    case HMF_LIMIT_CLASS:
        if (!watch || watch->lost.loop == NONE)
            return call.fail(status, HMF_ELEMENT_NONE, 0,
                             "Steps to the minimum leave the class of the loops; report->class_state tells whether the "
                             "values are in it. Try another ratio, or improve the triangles.");
        return call.fail(status, HMF_ELEMENT_LOOP, watch->lost.loop,
                         "Steps to the minimum leave the class: the cylinder of loop %u would be %g high instead of "
                         "%g. The values are in the class. Try another ratio, or improve the triangles.",
                         static_cast<unsigned>(watch->lost.loop), watch->lost.found * watch->unit,
                         watch->lost.wanted * watch->unit);
    case HMF_CANCELLED:
        return call.fail(status, HMF_ELEMENT_LEVEL, state.level,
                         "Cancelled by the progress callback; the values are closed and without poles.");
    default:
        return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0, "Unexpected status %d. Please report it.",
                         static_cast<int>(status));
    }
}

void clear_report(hmf_report* report) {
    if (!report) return;
    hmf_report empty;
    std::memset(&empty, 0, sizeof empty);
    empty.struct_size = report->struct_size;
    empty.levels = report->levels;
    empty.level_capacity = report->level_capacity;
    empty.history = report->history;
    empty.history_capacity = report->history_capacity;
    *report = empty;
}

} // namespace

extern "C" {

hmf_status hmf_loops(const hmf_hierarchy* hierarchy, size_t level, int32_t kind, uint64_t* offsets,
                     size_t offset_capacity, uint32_t* elements, size_t element_capacity, size_t* loop_count,
                     size_t* element_count, hmf_error* error) {
    Query query(hierarchy, error);
    Call& call = query.call;
    if (check_level(hierarchy, level, call)) return call.status();
    if (!loop_count || !element_count)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "loop_count and element_count must not be NULL.");
    Loops loops;
    Array<uint32_t> faces;
    if (library_loops(*hierarchy, level, kind, call, loops) || name_by_triangles(*hierarchy, level, call, loops, faces))
        return call.status();
    const size_t count = loops.count(), size = loops.crossings.size();
    if (offsets && check_capacity(offset_capacity, count + 1, "offsets", call)) return call.status();
    if (elements && check_capacity(element_capacity, size, "elements", call)) return call.status();
    if (elements) {
        const Mesh& mesh = loop_mesh(*hierarchy, level);
        if (level > 0) {
            for (size_t i = 0; i < size; ++i) elements[i] = faces[i];
        } else {
            Array<uint32_t> triangle; // of the caller, per internal face
            if (!triangle.allocate(call.memory, mesh.face_count)) return call.out_of_memory();
            for (uint32_t t = 0; t < mesh.face_count; ++t) triangle[internal_face(*hierarchy, t)] = t;
            for (size_t i = 0; i < size; ++i) elements[i] = triangle[faces[i]];
        }
    }
    if (offsets) std::memcpy(offsets, loops.offsets.data(), (count + 1) * sizeof(uint64_t));
    *loop_count = count;
    *element_count = size;
    return HMF_OK;
}

hmf_status hmf_initialize(const hmf_hierarchy* hierarchy, const hmf_loop_set* loops, double* values, size_t capacity,
                          hmf_error* error) {
    Query query(hierarchy, error);
    Call& call = query.call;
    if (check_level(hierarchy, 0, call)) return call.status();
    if (!values)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0,
                         "values is NULL. Give an array of one value per edge of the level of the loops.");
    const size_t level = loop_level(loops, hierarchy->level_count - 1);
    if (check_level(hierarchy, level, call)) return call.status();
    const Mesh& mesh = loop_mesh(*hierarchy, level);
    if (check_capacity(capacity, mesh.edge_count, "values", call)) return call.status();
    Loops crossings;
    Array<int64_t> weights, value;
    double unit = 1;
    if (take_loops(*hierarchy, loops, level, call, crossings, weights, unit)) return call.status();
    if (!value.allocate(call.memory, mesh.edge_count)) return call.out_of_memory();
    initial_foliation(mesh, crossings, weights.data(), value.data());
    for (uint32_t e = 0; e < mesh.edge_count; ++e)
        values[e] = static_cast<double>(value[level == 0 ? hierarchy->edge_internal[e] : e]) * unit;
    return HMF_OK;
}

void hmf_solve_options_init(hmf_solve_options* options) {
    if (!options) return;
    std::memset(options, 0, sizeof *options);
    options->struct_size = sizeof *options;
}

hmf_status hmf_solve(const hmf_hierarchy* hierarchy, const hmf_loop_set* loops, const hmf_solve_options* options,
                     double* values, size_t capacity, hmf_report* report, hmf_error* error) {
    Query query(hierarchy, error);
    if (check_level(hierarchy, 0, query.call)) return query.call.status();
    hmf_solve_options all;
    SolveOptions solve;
    if (read_solve_options(options, *hierarchy, all, solve, query.call)) return query.call.status();
    Call call(query.memory, error, all.progress, all.progress_user);
    call.set_time_limit(all.time_limit);
    if (!values)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "values is NULL. Give an array of one value per edge.");
    if (check_capacity(capacity, hierarchy->levels[solve.stop_level].mesh.edge_count, "values", call)
        || check_report(report, call))
        return call.status();
    // The cascade starts on the coarsest level, to which loops and values of finer levels are restricted.
    const size_t start = solve.method == HMF_METHOD_SINGLE_LEVEL ? 0 : hierarchy->level_count - 1;
    if (all.initial_values && loops)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "There are loops and initial_values. Give one of them, the other NULL.");
    const size_t given = all.initial_values ? static_cast<size_t>(all.initial_level) : loop_level(loops, start);
    if (check_level(hierarchy, given, call)) return call.status();
    State state;
    Loops crossings;
    Array<int64_t> weights;
    double unit = 1;
    call.range(0, 0); // the levels share the whole range
    if (!state.allocate(*hierarchy, given < solve.stop_level ? given : solve.stop_level, call.memory))
        return call.out_of_memory();
    state.load(given, Side::input);
    if (all.initial_values) {
        if (import_values(state, all.initial_values, all.initial_count, unit, false, call)) return call.status();
    } else {
        if (take_loops(*hierarchy, loops, given, call, crossings, weights, unit)) return call.status();
        initial_foliation(state.foliation.mesh, crossings, weights.data(), state.foliation.value);
    }
    clear_report(report);
    Recorder recorder(report, call, unit);
    if (!state.go_to(start, call) || (start == 0 && !state.to_intrinsic(call)))
        return call.cancelled() ? call.fail(HMF_CANCELLED, HMF_ELEMENT_NONE, 0,
                                            "Cancelled by the progress callback; no values are written.")
                                : call.out_of_memory();
    ClassWatch watch;
    const bool same_mesh = given == start && start > 0 && !all.initial_values; // of the loops and the state
    if (watch.start(state, unit, same_mesh ? &crossings : nullptr, weights, call)) return call.status();
    const hmf_status status = solve_in_class(state, solve, call, recorder, watch);
    if (status >= HMF_ERROR_NULL) return status;
    if (call.cancelled() && state.level != solve.stop_level)
        return call.fail(HMF_CANCELLED, HMF_ELEMENT_LEVEL, state.level,
                         "Cancelled by the progress callback on level %llu; no values are written.",
                         static_cast<unsigned long long>(state.level));
    return finish(state, status, solve, call, recorder, values, &watch);
}

hmf_status hmf_relax(const hmf_hierarchy* hierarchy, size_t level, const hmf_solve_options* options, double* values,
                     size_t count, hmf_report* report, hmf_error* error) {
    Query query(hierarchy, error);
    if (check_level(hierarchy, level, query.call)) return query.call.status();
    hmf_solve_options all;
    SolveOptions solve;
    if (read_solve_options(options, *hierarchy, all, solve, query.call)) return query.call.status();
    Call call(query.memory, error, all.progress, all.progress_user);
    call.set_time_limit(all.time_limit);
    if (check_report(report, call)) return call.status();
    State state;
    if (!state.allocate(*hierarchy, level, call.memory)) return call.out_of_memory();
    state.load(level, Side::input);
    double unit = 1;
    if (import_values(state, values, count, unit, false, call)) return call.status();
    clear_report(report);
    Recorder recorder(report, call, unit);
    solve.stop_level = level;
    if (level == 0 && !state.to_intrinsic(call))
        return call.cancelled() ? call.fail(HMF_CANCELLED, HMF_ELEMENT_NONE, 0, "Cancelled by the progress callback.")
                                : call.out_of_memory();
    const hmf_status status = run_cascade(state, solve, call, recorder);
    if (status >= HMF_ERROR_NULL) return status;
    return finish(state, status, solve, call, recorder, values, nullptr);
}

} // extern "C"
