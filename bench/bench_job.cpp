// The whole job through the public interface: build, loops, solve to a residual of 1e-8.
//
//     bench_job [options] MESH.obj
//
//     -r N              repetitions (1)
//     --threads N       of the library and of BLAS (1)
//     --cholmod         one linear solve by CHOLMOD in each repetition
//     --applications    parameterization, cylinders, leaves, atlas as well, once
//     --forms           a basis of the harmonic 1-forms as well, once
//     --design          the even design, instead of the job
//     --quads FILE      the even design and its quads as OBJ
//     --count N         target number of quads
//     --mollify X       option of the build (0)
//
// Rows: "job" for each repetition; "applications"; "forms"; "design"; "quads" (seconds with all calls before);
// "failure".  Times are processor times of the calling thread, with several threads wall times.
#include <functional>

#include "measure.hpp"

namespace {

using namespace measure;

struct Options {
    int repetitions = 1, threads = 1;
    bool cholmod = false, applications = false, forms = false, design = false;
    double mollify = 0;
    uint64_t quad_count = 0;
    std::string quads, path;
};

double clock_of(const Seconds& s, const Options& options) { return options.threads > 1 ? s.wall : s.processor; }

void fail(const Mesh& mesh, const char* stage, hmf_status status, const std::string& message) {
    Row("failure")
        .text("mesh", mesh.name)
        .text("stage", stage)
        .count("status", static_cast<uint64_t>(status))
        .text("what", message.empty() ? hmf_status_string(status) : message)
        .print();
}

struct Job {
    Owned<hmf_hierarchy> hierarchy;
    Owned<hmf_loop_set> loops;
    Solved solved;
};

uint64_t linear_solves(const hmf_report& report) {
    uint64_t sum = 0;
    for (uint64_t l = 0; l < report.level_count; ++l) sum += report.levels[l].linear_solve_count;
    return sum;
}

bool run(const Mesh& mesh, const Options& options, const hmf_control& control, int repetition, Counter& counter,
         Job& job) {
    const Seconds reference = reference_computation();
    hmf_hierarchy_options build_options;
    hmf_hierarchy_options_init(&build_options, sizeof build_options);
    build_options.allocate = Counter::allocate;
    build_options.release = Counter::release;
    build_options.allocator_user = &counter;
    build_options.mollify = options.mollify;
    hmf_error error = {};
    hmf_hierarchy* h = nullptr;
    const Watch build_watch;
    hmf_status status = hmf_hierarchy_create(mesh.position.data(), mesh.vertices(), mesh.triangle.data(),
                                             mesh.triangles(), &build_options, &control, &h, &error);
    const Seconds build = build_watch.elapsed();
    job.hierarchy.reset(h);
    if (status != HMF_OK) return fail(mesh, "build", status, error.message), false;
    const hmf_hierarchy_info& info = *hmf_hierarchy_describe(h);
    const size_t build_peak = counter.peak;

    hmf_loop_set* loops = nullptr;
    const Watch loops_watch;
    status = hmf_loops(h, info.boundary_count ? 0 : info.level_count - 1, HMF_LOOPS_CUT, &control, &loops, &error);
    const Seconds loops_time = loops_watch.elapsed();
    job.loops.reset(loops);
    if (status != HMF_OK) return fail(mesh, "loops", status, error.message), false;

    hmf_solve_options solve_options;
    hmf_solve_options_init(&solve_options, sizeof solve_options);
    counter.peak = counter.used;
    job.solved = solve(h, loops, solve_options, 0, &control);
    if (!job.solved.report) return fail(mesh, "solve", job.solved.status, job.solved.message), false;
    const hmf_report& report = *job.solved.report;
    const double edges = static_cast<double>(info.levels[0].edge_count);
    Row row("job");
    row.text("mesh", mesh.name)
        .count("repetition", static_cast<uint64_t>(repetition))
        .count("threads", static_cast<uint64_t>(options.threads))
        .count("vertices", info.levels[0].vertex_count)
        .count("edges", info.levels[0].edge_count)
        .count("genus", info.genus)
        .count("boundaries", info.boundary_count)
        .count("levels", info.level_count)
        .number("reference_wall", reference.wall)
        .number("reference_processor", reference.processor)
        .number("build", clock_of(build, options))
        .number("loops", clock_of(loops_time, options))
        .number("solve", clock_of(job.solved.seconds, options))
        .number("job", clock_of(build, options) + clock_of(loops_time, options) + clock_of(job.solved.seconds, options))
        .number("job_wall", build.wall + loops_time.wall + job.solved.seconds.wall)
        .number("held_bytes_per_edge", static_cast<double>(info.memory_bytes) / edges)
        .number("build_bytes_per_edge", static_cast<double>(build_peak) / edges)
        .number("solve_bytes_per_edge", static_cast<double>(counter.peak) / edges)
        .count("linear_solves", linear_solves(report))
        .count("status", static_cast<uint64_t>(job.solved.status))
        .number("residual", report.residual_max)
        .number("energy", report.energy)
        .count("poles", report.poles)
        .count("zeros", report.zeros)
        .text("class", class_name(report.class_state))
        .number("class_seconds", report.class_seconds);
#if HMF_HAVE_CHOLMOD
    hmf_level_mesh* level = nullptr;
    if (options.cholmod && hmf_level(h, 0, nullptr, &level, nullptr) == HMF_OK) {
        const Owned<hmf_level_mesh> owner(level);
        Seconds factor, solving;
        if (run_cholmod(*level, factor, solving)) {
            row.number("cholmod_factor", clock_of(factor, options)).number("cholmod_solve", clock_of(solving, options));
            row.number("cholmod", clock_of(factor, options) + clock_of(solving, options));
        }
    }
#endif
    row.print();
    return true;
}

template <class Result>
double timed(hmf_status& status, Owned<Result>& owner, const std::function<hmf_status(Result**)>& call) {
    Result* result = nullptr;
    const Watch watch;
    status = call(&result);
    const double seconds = watch.elapsed().processor;
    owner.reset(result);
    return seconds;
}

void run_applications(const Mesh& mesh, const Job& job, const hmf_control& control) {
    const hmf_foliation* f = job.solved.foliation.get();
    hmf_error error = {};
    hmf_status status = HMF_OK;
    Owned<hmf_parameterization> map, again;
    Owned<hmf_cylinder_set> cylinders;
    Owned<hmf_lines> lines;
    Owned<hmf_chart_set> atlas;
    Row row("applications");
    row.text("mesh", mesh.name).number("solve", job.solved.seconds.processor);
    const double first = timed<hmf_parameterization>(
        status, map, [&](auto** out) { return hmf_parameterize(f, nullptr, &control, out, &error); });
    if (status != HMF_OK) return fail(mesh, "parameterize", status, error.message);
    const double second = timed<hmf_parameterization>(
        status, again, [&](auto** out) { return hmf_parameterize(f, nullptr, &control, out, &error); });
    row.number("parameterize_first", first)
        .number("parameterize_again", second)
        .count("flipped", map->flipped_count)
        .count("degenerate", map->degenerate_count)
        .number("dilatation_mean", map->dilatation_mean)
        .number("dilatation_median", map->dilatation_median)
        .number("dilatation_p99", map->dilatation_p99)
        .number("energy_ratio", map->energy_ratio);
    row.number("trace", timed<hmf_lines>(status, lines,
                                         [&](auto** out) { return hmf_trace(f, nullptr, &control, out, &error); }));
    row.count("trace_status", static_cast<uint64_t>(status));
    row.number("cylinders", timed<hmf_cylinder_set>(status, cylinders, [&](auto** out) {
                   return hmf_cylinders(f, job.loops.get(), &control, out, &error);
               }));
    row.count("cylinders_status", static_cast<uint64_t>(status));
    row.number("atlas", timed<hmf_chart_set>(status, atlas,
                                             [&](auto** out) { return hmf_atlas(f, nullptr, &control, out, &error); }));
    row.count("atlas_status", static_cast<uint64_t>(status));
    if (atlas)
        row.count("charts", atlas->chart_count)
            .number("used_area", atlas->used_area)
            .number("unevenness", atlas->unevenness);
    row.print();
}

// A basis of the harmonic 1-forms, and what a factorization and a solve for each form take.
void run_forms(const Mesh& mesh, const Job& job, const hmf_control& control) {
    hmf_error error = {};
    hmf_status status = HMF_OK;
    Owned<hmf_form_set> forms;
    const double seconds = timed<hmf_form_set>(
        status, forms, [&](auto** out) { return hmf_harmonic_forms(job.hierarchy.get(), 0, &control, out, &error); });
    if (status != HMF_OK) return fail(mesh, "forms", status, error.message);
    Row row("forms");
    row.text("mesh", mesh.name)
        .count("edges", forms->edge_count)
        .count("genus", forms->genus)
        .count("forms", forms->form_count)
        .number("seconds", seconds)
        .number("residual", forms->residual)
        .number("conjugation_error", forms->conjugation_error);
#if HMF_HAVE_CHOLMOD
    hmf_level_mesh* level = nullptr;
    if (hmf_level(job.hierarchy.get(), 0, nullptr, &level, nullptr) == HMF_OK) {
        const Owned<hmf_level_mesh> owner(level);
        Seconds factor, solving;
        if (run_cholmod(*level, factor, solving))
            row.number("cholmod_factor", factor.processor).number("cholmod_solve", solving.processor);
    }
#endif
    row.print();
}

void run_quads(const Mesh& mesh, const Solved& solved, double before, const Options& options,
               const hmf_control& control) {
    hmf_quad_options quad_options;
    hmf_quad_options_init(&quad_options, sizeof quad_options);
    quad_options.count = options.quad_count;
    quad_options.relax = 40;
    quad_options.merge = 1;
    hmf_error error = {};
    hmf_status status = HMF_OK;
    Owned<hmf_quad_mesh> quads;
    const double seconds = timed<hmf_quad_mesh>(status, quads, [&](auto** out) {
        return hmf_quads(solved.foliation.get(), &quad_options, &control, out, &error);
    });
    if (status != HMF_OK) return fail(mesh, "quads", status, error.message);
    std::ofstream file(options.quads);
    file.precision(17);
    for (uint64_t v = 0; v < quads->vertex_count; ++v)
        file << "v " << quads->positions[3 * v] << ' ' << quads->positions[3 * v + 1] << ' '
             << quads->positions[3 * v + 2] << '\n';
    for (uint64_t q = 0; q < quads->quad_count; ++q) {
        file << 'f';
        for (uint64_t s = 0; s < 4; ++s) file << ' ' << quads->quads[4 * q + s] + 1;
        file << '\n';
    }
    Row("quads")
        .text("mesh", mesh.name)
        .number("seconds", before + seconds)
        .count("quads", quads->quad_count)
        .count("irregular", quads->irregular_count)
        .count("inverted", quads->inverted_count)
        .print();
}

// Marked vertices, loops and weights of the even design, solved; with --quads also its quads.
void run_design(const Mesh& mesh, const Options& options, const hmf_control& control) {
    hmf_error error = {};
    hmf_status status = HMF_OK;
    Owned<hmf_design> design;
    const double seconds = timed<hmf_design>(status, design, [&](auto** out) {
        return hmf_even_design(mesh.position.data(), mesh.vertices(), mesh.triangle.data(), mesh.triangles(), nullptr,
                               &control, out, &error);
    });
    if (status != HMF_OK) return fail(mesh, "design", status, error.message);
    hmf_hierarchy_options build_options;
    hmf_hierarchy_options_init(&build_options, sizeof build_options);
    build_options.marked_vertices = design->marked_vertices;
    build_options.marked_count = design->marked_count;
    hmf_hierarchy* built = nullptr;
    const Watch watch;
    status = hmf_hierarchy_create(mesh.position.data(), mesh.vertices(), mesh.triangle.data(), mesh.triangles(),
                                  &build_options, &control, &built, &error);
    const Owned<hmf_hierarchy> hierarchy(built);
    if (status != HMF_OK) return fail(mesh, "build", status, error.message);
    hmf_solve_options solve_options;
    hmf_solve_options_init(&solve_options, sizeof solve_options);
    const Solved solved = solve(built, design->loops, solve_options, 0, &control);
    const double job = watch.elapsed().processor;
    if (solved.status != HMF_OK) return fail(mesh, "solve", solved.status, solved.message);
    hmf_scale* out = nullptr;
    hmf_conformal_scale(solved.foliation.get(), &control, &out, &error);
    const Owned<hmf_scale> scale(out);
    Row row("design");
    row.text("mesh", mesh.name)
        .count("vertices", mesh.vertices())
        .number("distortion_of_cut_loops", design->unevenness_before)
        .number("distortion", scale ? scale->unevenness : NAN)
        .count("marked", design->marked_count)
        .count("loops", design->loops->count)
        .number("seconds", seconds)
        .number("solve", solved.seconds.processor);
    row.print();
    if (!options.quads.empty()) run_quads(mesh, solved, seconds + job, options, control);
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const auto is = [&](const char* name) { return !std::strcmp(argv[i], name) && i + 1 < argc; };
        if (is("-r")) options.repetitions = std::atoi(argv[++i]);
        else if (is("--threads")) options.threads = std::max(1, std::atoi(argv[++i]));
        else if (is("--quads")) {
            options.quads = argv[++i];
            options.design = true;
        } else if (is("--count")) options.quad_count = std::strtoull(argv[++i], nullptr, 10);
        else if (is("--mollify")) options.mollify = std::atof(argv[++i]);
        else if (!std::strcmp(argv[i], "--cholmod")) options.cholmod = true;
        else if (!std::strcmp(argv[i], "--forms")) options.forms = true;
        else if (!std::strcmp(argv[i], "--design")) options.design = true;
        else if (!std::strcmp(argv[i], "--applications")) options.applications = true;
        else options.path = argv[i];
    }
    run_with_threads(options.threads, argv);
    if (options.path.empty()) return std::fprintf(stderr, "bench_job [options] MESH.obj\n"), 2;
#if HMF_HAVE_CHOLMOD
    if (options.cholmod) Row("blas").text("path", blas()).print();
#endif
    const Mesh mesh = read_mesh(options.path);
    hmf_control control;
    hmf_control_init(&control, sizeof control);
    hmf_pool* pool = options.threads > 1 ? hmf_pool_create(static_cast<uint32_t>(options.threads)) : nullptr;
    if (pool) {
        control.parallel_for = hmf_pool_run;
        control.parallel_user = pool;
        control.workers = hmf_pool_threads(pool);
    }
    bool good = true;
    if (options.design) run_design(mesh, options, control);
    for (int r = 0; !options.design && r < options.repetitions && good; ++r) {
        Counter counter;
        Job job;
        good = run(mesh, options, control, r, counter, job);
        if (good && r == 0 && options.applications) run_applications(mesh, job, control);
        if (good && r == 0 && options.forms) run_forms(mesh, job, control);
        job = Job();
        if (counter.used != 0) fail(mesh, "memory", HMF_ERROR_INTERNAL, "memory was not returned");
    }
    hmf_pool_destroy(pool);
    return good ? 0 : 1;
}
