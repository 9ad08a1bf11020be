// The tables of the paper (hmf.h names it): the same loops and the same mesh for every method.
//
//     bench_methods [options] MESH.obj
//
//     --times             table 1: Whitehead moves at three ratios, Newton's method, the mesh without a hierarchy
//     --cases             table 2: non-Delaunay edges, bad flips, poles
//     --collapses N       kinds of collapses in --cases (3)
//     --whitehead S       processor seconds for each solve by Whitehead moves (20)
//     --single-level S    the same without a hierarchy (60)
//     --levels            number of levels: coarsest meshes of 8000 to 60 vertices
//     --loops             handle loops, cut system, pants decomposition
//
// Rows: "method", "curve", "cases", "failure".  Each solve by moves runs until its largest residual is 1e-8 or its time
// is over; all columns are read from its history: when a sweep lowers the energy by less than 1e-6 (the paper's stop
// rule), and when the energy is within 1e-3, 1e-4 and 1e-6 of the minimum.
#include "measure.hpp"

namespace {

using namespace measure;

constexpr double STOP = 1e-6;

struct Options {
    bool times = false, cases = false, levels = false, loops = false;
    int collapses = 3;
    double whitehead = 20, single_level = 60;
    std::string path;
};

struct Built {
    Owned<hmf_hierarchy> hierarchy;
    Seconds seconds;
    const hmf_hierarchy_info& info() const { return *hmf_hierarchy_describe(hierarchy.get()); }
};

Built build(const Mesh& mesh, double ratio, int32_t collapse, uint64_t coarsest = 0) {
    hmf_hierarchy_options options;
    hmf_hierarchy_options_init(&options, sizeof options);
    options.ratio = ratio;
    options.collapse = collapse;
    options.coarsest = coarsest;
    hmf_error error = {};
    hmf_hierarchy* h = nullptr;
    Built built;
    const Watch watch;
    const hmf_status status = hmf_hierarchy_create(mesh.position.data(), mesh.vertices(), mesh.triangle.data(),
                                                   mesh.triangles(), &options, nullptr, &h, &error);
    built.seconds = watch.elapsed();
    built.hierarchy.reset(h);
    if (status != HMF_OK) {
        Row("failure").text("mesh", mesh.name).text("stage", "build").text("what", error.message).print();
        std::exit(1);
    }
    return built;
}

hmf_solve_options options_of(int32_t method) {
    hmf_solve_options options;
    hmf_solve_options_init(&options, sizeof options);
    options.method = method;
    options.tolerance = 1e-8;
    options.energy_tolerance = STOP;
    return options;
}

// When an event of the history came, on the clock of the measurement; negative: never.
struct History {
    const hmf_report& report;
    double scale; // processor seconds per second of the history
    explicit History(const Solved& s) :
        report(*s.report), scale(s.seconds.wall > 0 ? s.seconds.processor / s.seconds.wall : 1) {}
    const hmf_history_entry* energy_below(double energy) const {
        for (uint64_t i = 0; i < report.history_count; ++i)
            if (report.history[i].level == 0 && report.history[i].energy <= energy) return &report.history[i];
        return nullptr;
    }
    // The first sweep on the given mesh that lowers the energy by less than STOP.
    const hmf_history_entry* stop_rule() const {
        for (uint64_t i = 1; i < report.history_count; ++i) {
            const hmf_history_entry &before = report.history[i - 1], &after = report.history[i];
            if (after.level != 0 || before.level != 0 || after.kind != HMF_HISTORY_SWEEP) continue;
            if (before.energy - after.energy <= STOP * before.energy) return &after;
        }
        return nullptr;
    }
    void time(Row& row, const char* key, const hmf_history_entry* entry) const {
        row.number(key, entry ? entry->seconds * scale : NAN);
    }
};

void print_times(const Mesh& mesh, const char* experiment, const char* method, double ratio, const std::string& loops,
                 const Built& built, const Solved& s, double least_energy, double limit) {
    if (!s.report) {
        Row("failure").text("mesh", mesh.name).text("stage", method).text("what", s.message).print();
        return;
    }
    const History history(s);
    const hmf_report& report = *s.report;
    double optimize = 0, interpolate = 0;
    std::string level_optimize, level_interpolate, level_solves;
    for (uint64_t l = report.level_count; l-- > 0;) {
        const hmf_level_report& level = report.levels[l];
        optimize += level.optimize_seconds * history.scale;
        interpolate += level.interpolate_seconds * history.scale;
        level_solves += (level_solves.empty() ? "" : " ") + std::to_string(level.linear_solve_count);
        level_optimize += (level_optimize.empty() ? "" : " ") + std::to_string(level.optimize_seconds);
        level_interpolate += (level_interpolate.empty() ? "" : " ") + std::to_string(level.interpolate_seconds);
    }
    Row row("method");
    row.text("mesh", mesh.name)
        .text("experiment", experiment)
        .text("method", method)
        .number("ratio", ratio)
        .text("loops", loops)
        .count("vertices", built.info().levels[0].vertex_count)
        .count("edges", built.info().levels[0].edge_count)
        .count("genus", built.info().genus)
        .count("levels", report.level_count)
        .count("coarsest_vertices", report.levels[report.level_count - 1].vertex_count)
        .number("build", built.seconds.processor)
        .number("processor", s.seconds.processor)
        .number("wall", s.seconds.wall)
        .number("limit", limit)
        .count("out_of_time", s.out_of_time)
        .count("status", static_cast<uint64_t>(s.status))
        .number("residual", report.residual_max)
        .number("energy", report.energy)
        .number("excess", report.energy / least_energy - 1)
        .count("poles", report.poles)
        .text("class", class_name(report.class_state))
        .number("optimize", optimize)
        .number("interpolate", interpolate)
        .text("level_optimize", level_optimize)
        .text("level_interpolate", level_interpolate)
        .text("level_solves", level_solves);
    const hmf_history_entry* stop = report.method == HMF_METHOD_NEWTON ? nullptr : history.stop_rule();
    history.time(row, "to_stop_rule", stop);
    row.number("excess_at_stop", stop ? stop->energy / least_energy - 1 : NAN);
    history.time(row, "to_1e-3", history.energy_below(least_energy * (1 + 1e-3)));
    history.time(row, "to_1e-4", history.energy_below(least_energy * (1 + 1e-4)));
    history.time(row, "to_1e-6", history.energy_below(least_energy * (1 + 1e-6)));
    row.number("to_residual", report.converged ? s.seconds.processor : NAN).print();

    // The curve, at most 300 points: a point more where time has grown by 2 % or the level changes.
    std::string points;
    double last = -1;
    uint32_t level = 0xffffffffu;
    for (uint64_t i = 0; i < report.history_count; ++i) {
        const hmf_history_entry& entry = report.history[i];
        const double t = entry.seconds * history.scale;
        if (entry.level == level && i + 1 < report.history_count && t < last * 1.02 + 1e-5) continue;
        last = t;
        level = entry.level;
        char text[120];
        std::snprintf(text, sizeof text, "%s[%.6g, %.9g, %u]", points.empty() ? "" : ", ", t, entry.energy,
                      entry.level);
        points += text;
    }
    Row("curve")
        .text("mesh", mesh.name)
        .text("experiment", experiment)
        .text("method", method)
        .number("ratio", ratio)
        .text("loops", loops)
        .number("least_energy", least_energy)
        .raw("points", "[" + points + "]")
        .print();
}

// NULL after a row that says so.
Owned<hmf_loop_set> handle_loops(const Mesh& mesh, const Built& built, std::string& kind) {
    Owned<hmf_loop_set> loops = choose_loops(built.hierarchy.get(), HMF_LOOPS_HANDLE, kind);
    if (!loops) Row("failure").text("mesh", mesh.name).text("stage", "loops").text("what", "no loops").print();
    return loops;
}

void run_times(const Mesh& mesh, const Options& options) {
    const Built half = build(mesh, 0.5, HMF_COLLAPSE_MIDPOINT);
    std::string kind;
    const Owned<hmf_loop_set> loops = handle_loops(mesh, half, kind);
    if (!loops) return;
    const Solved newton = solve(half.hierarchy.get(), loops.get(), options_of(HMF_METHOD_NEWTON));
    const double least = newton.report ? newton.report->energy : NAN;
    print_times(mesh, "table1", "newton", 0.5, kind, half, newton, least, 0);
    for (const double ratio : {0.5, 0.25, 0.75}) {
        const Built built = build(mesh, ratio, HMF_COLLAPSE_MIDPOINT);
        print_times(mesh, "table1", "whitehead", ratio, kind, built,
                    solve(built.hierarchy.get(), loops.get(), options_of(HMF_METHOD_WHITEHEAD), options.whitehead),
                    least, options.whitehead);
    }
    if (options.single_level > 0)
        print_times(mesh, "table1", "single_level", 0.5, kind, half,
                    solve(half.hierarchy.get(), loops.get(), options_of(HMF_METHOD_SINGLE_LEVEL), options.single_level),
                    least, options.single_level);
}

// Figure 7: the coarsest level from 8000 vertices to 60.
void run_levels(const Mesh& mesh, const Options& options) {
    for (const uint64_t coarsest : {8000u, 4000u, 2000u, 1000u, 500u, 250u, 125u, 60u}) {
        if (2 * coarsest > mesh.vertices()) continue;
        const Built built = build(mesh, 0.5, HMF_COLLAPSE_MIDPOINT, coarsest);
        std::string kind;
        const Owned<hmf_loop_set> loops = choose_loops(built.hierarchy.get(), HMF_LOOPS_HANDLE, kind);
        if (!loops) continue;
        const Solved newton = solve(built.hierarchy.get(), loops.get(), options_of(HMF_METHOD_NEWTON));
        const double least = newton.report ? newton.report->energy : NAN;
        print_times(mesh, "levels", "newton", 0.5, kind, built, newton, least, 0);
        hmf_solve_options moves = options_of(HMF_METHOD_WHITEHEAD);
        moves.tolerance = 0; // the paper's stop rule
        print_times(mesh, "levels", "whitehead", 0.5, kind, built,
                    solve(built.hierarchy.get(), loops.get(), moves, options.whitehead), least, options.whitehead);
    }
}

// Figure 14: other loops.
void run_loops(const Mesh& mesh, const Options& options) {
    const Built built = build(mesh, 0.5, HMF_COLLAPSE_MIDPOINT);
    for (const int32_t wanted : {HMF_LOOPS_HANDLE, HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
        std::string kind;
        const Owned<hmf_loop_set> loops = choose_loops(built.hierarchy.get(), wanted, kind);
        if (!loops) continue;
        const Solved newton = solve(built.hierarchy.get(), loops.get(), options_of(HMF_METHOD_NEWTON));
        const double least = newton.report ? newton.report->energy : NAN;
        print_times(mesh, "loops", "newton", 0.5, kind, built, newton, least, 0);
        for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL})
            print_times(mesh, "loops", method == HMF_METHOD_WHITEHEAD ? "whitehead" : "single_level", 0.5, kind, built,
                        solve(built.hierarchy.get(), loops.get(), options_of(method), options.whitehead), least,
                        options.whitehead);
    }
}

void run_cases(const Mesh& mesh, const Options& options) {
    const char* names[] = {"midpoint", "endpoint", "quadric"};
    const int32_t kinds[] = {HMF_COLLAPSE_MIDPOINT, HMF_COLLAPSE_ENDPOINT, HMF_COLLAPSE_QSLIM};
    const Built reference = build(mesh, 0.5, HMF_COLLAPSE_MIDPOINT);
    std::string kind;
    const Owned<hmf_loop_set> loops = handle_loops(mesh, reference, kind);
    if (!loops) return;
    for (int k = 0; k < options.collapses; ++k)
        for (const double ratio : {0.25, 0.5, 0.75}) {
            const Built built = build(mesh, ratio, kinds[k]);
            uint64_t raised = 0;
            for (uint64_t l = 0; l < built.info().level_count; ++l) raised += built.info().levels[l].raised_count;
            for (const int32_t method : {HMF_METHOD_PAPER, HMF_METHOD_NEWTON}) {
                hmf_solve_options solve_options = options_of(method);
                if (method == HMF_METHOD_PAPER) solve_options.tolerance = 0;
                const Solved s = solve(built.hierarchy.get(), loops.get(), solve_options, options.whitehead);
                Row row("cases");
                row.text("mesh", mesh.name)
                    .text("collapse", names[k])
                    .number("ratio", ratio)
                    .text("method", method == HMF_METHOD_PAPER ? "paper" : "newton")
                    .text("loops", kind)
                    .count("edges", built.info().levels[0].edge_count)
                    .count("levels", built.info().level_count)
                    .count("non_delaunay", raised)
                    .count("status", static_cast<uint64_t>(s.status))
                    .text("what", s.message)
                    .number("processor", s.seconds.processor)
                    .count("out_of_time", s.out_of_time);
                if (s.report)
                    row.count("bad_flips", s.report->bad_flips)
                        .count("bad_flips_left", s.report->bad_flips_left)
                        .count("poles", s.report->poles)
                        .count("zeros", s.report->zeros)
                        .number("residual", s.report->residual_max)
                        .text("class", class_name(s.report->class_state));
                row.print();
            }
        }
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const auto is = [&](const char* name) { return !std::strcmp(argv[i], name) && i + 1 < argc; };
        if (is("--whitehead")) options.whitehead = std::atof(argv[++i]);
        else if (is("--single-level")) options.single_level = std::atof(argv[++i]);
        else if (is("--collapses")) options.collapses = std::min(3, std::atoi(argv[++i]));
        else if (!std::strcmp(argv[i], "--times")) options.times = true;
        else if (!std::strcmp(argv[i], "--cases")) options.cases = true;
        else if (!std::strcmp(argv[i], "--levels")) options.levels = true;
        else if (!std::strcmp(argv[i], "--loops")) options.loops = true;
        else options.path = argv[i];
    }
    if (options.path.empty()) return std::fprintf(stderr, "bench_methods [options] MESH.obj\n"), 2;
    const Mesh mesh = read_mesh(options.path);
    const Seconds reference = reference_computation();
    Row("reference")
        .text("mesh", mesh.name)
        .number("reference_wall", reference.wall)
        .number("reference_processor", reference.processor)
        .print();
    if (options.times) run_times(mesh, options);
    if (options.cases) run_cases(mesh, options);
    if (options.levels) run_levels(mesh, options);
    if (options.loops) run_loops(mesh, options);
    return 0;
}
