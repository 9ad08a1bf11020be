// The whole job through the public interface: build, loops, solve.
//
//     bench_pipeline [options] [MESH.obj ...]
//
//     -r N              repetitions (5)
//     --subdivide N     midpoint subdivisions of every mesh (0)
//     --tolerance T     of newton (1e-8)
//     --preview N       vertices of the level of the preview (10000)
//     --whitehead S     time limit of the method whitehead, 0 = leave out (60)
//     --single-level S  time limit of the method single_level, 0 = leave out (0)
//     --whitehead-tolerance T  of whitehead and single_level (1e-6)
//     --whitehead-excess X     relative energy over the minimum, for which whitehead is timed too, 0 = leave out (1e-6)
//     --no-cholesky     leave CHOLMOD out
//     --threads N       of the library and of BLAS (1); wall time, so not with --cpu
//     --cpu             processor time of the thread instead of wall time (the
//                       stages inside hmf_solve are always wall time)
//
// Without a mesh: tori.  The repetitions are the outer loop and the meshes the
// inner one, so that a busy minute of the machine falls on all of them.  Every
// cell is the median [smallest, largest] over the repetitions; a ratio is
// taken inside one repetition, never between medians.  A cell that could not
// be measured to its end says so; it never turns into a number.
#include <dlfcn.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#if HMF_HAVE_CHOLMOD
#include <cholmod.h>
#endif

#include "../include/hmf/applications.h"
#include "../include/hmf/pool.h"
#include "soup.hpp"

namespace {

double wall() {
    using namespace std::chrono;
    return duration<double>(steady_clock::now().time_since_epoch()).count();
}

// --threads.
hmf_pool* pool = nullptr;
hmf_control control_of_threads() {
    hmf_control control = {};
    control.struct_size = sizeof control;
    if (!pool) return control;
    control.parallel_for = hmf_pool_run;
    control.parallel_user = pool;
    control.workers = hmf_pool_threads(pool);
    return control;
}

// With --cpu all work is on one thread, so its processor time is the wall time of an idle
// machine; on a shared one the wall time mostly measures the neighbors.
bool processor_clock = false;
double now() {
    if (!processor_clock) return wall();
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// --- Meshes ------------------------------------------------------------------

// Each triangle into four at the midpoints of its sides.
void subdivide(Soup& soup) {
    std::unordered_map<uint64_t, uint32_t> midpoint;
    midpoint.reserve(soup.triangle.size());
    std::vector<uint32_t> fine;
    fine.reserve(4 * soup.triangle.size());
    for (size_t f = 0; f < soup.triangles(); ++f) {
        uint32_t v[3], m[3];
        for (size_t s = 0; s < 3; ++s) v[s] = soup.triangle[3 * f + s];
        for (size_t s = 0; s < 3; ++s) {
            const uint32_t i = std::min(v[s], v[(s + 1) % 3]), j = std::max(v[s], v[(s + 1) % 3]);
            const auto found =
                midpoint.try_emplace(static_cast<uint64_t>(i) << 32 | j, static_cast<uint32_t>(soup.vertices()));
            m[s] = found.first->second;
            if (found.second)
                for (size_t k = 0; k < 3; ++k)
                    soup.position.push_back(0.5
                                            * (soup.position[3 * size_t{i} + k] + soup.position[3 * size_t{j} + k]));
        }
        fine.insert(fine.end(), {v[0], m[0], m[2], v[1], m[1], m[0], v[2], m[2], m[1], m[0], m[1], m[2]});
    }
    soup.triangle.swap(fine);
    soup.name += " /4";
}

// --- Measuring ---------------------------------------------------------------

// Bytes in use and their peak, by the allocator hooks.
struct Counter {
    size_t used = 0, peak = 0;
};
void* counted_allocate(void* user, size_t size) {
    Counter& c = *static_cast<Counter*>(user);
    void* block = std::malloc(size);
    if (block) c.peak = std::max(c.peak, c.used += size);
    return block;
}
void counted_release(void* user, void* block, size_t size) {
    static_cast<Counter*>(user)->used -= size;
    std::free(block);
}

// Bytes per second of a copy far larger than the caches, reads and writes counted.
double copy_bandwidth() {
    static std::vector<char> from(size_t{128} << 20, 1), to(size_t{128} << 20, 2);
    double best = 1e30;
    for (int r = 0; r < 3; ++r) {
        const double begin = now();
        std::memcpy(to.data(), from.data(), from.size());
        best = std::min(best, now() - begin);
        from[static_cast<size_t>(r)] = to[from.size() / 2]; // keeps the copy alive
    }
    return 2 * static_cast<double>(from.size()) / best;
}

// The samples of one cell, one per repetition; a negative one is a failure.
struct Cell {
    std::vector<double> sample;
    bool sign = false;    // may be negative without being a failure
    bool bounded = false; // a time limit cut a sample short: the truth is larger
    void add(double x) { sample.push_back(x); }
    std::string text(const char* format) const {
        if (sample.empty()) return "-";
        std::vector<double> x = sample;
        std::sort(x.begin(), x.end());
        if (!sign && !(x[0] >= 0)) return "failed";
        const size_t h = x.size() / 2;
        const double middle = x.size() % 2 ? x[h] : 0.5 * (x[h - 1] + x[h]);
        char a[64], b[64], c[64];
        std::snprintf(a, sizeof a, format, middle);
        std::snprintf(b, sizeof b, format, x.front());
        std::snprintf(c, sizeof c, format, x.back());
        return std::string(bounded ? ">= " : "") + a + " [" + b + ", " + c + "]";
    }
};

struct LevelCost {
    double vertices = 0, edges = 0;
    Cell optimize, interpolate, optimize_bound, interpolate_bound;
    uint64_t sweeps = 0, linear_solve_count = 0;
};

struct Result {
    Cell build, edges_per_second, bytes_per_edge, build_peak, loops, solve, second, job, job_per_edge;
    Cell cholesky, job_against_cholesky, solve_against_cholesky;
    Cell preview, preview_vertices;
    Cell whitehead, newton_gain, single, hierarchy_gain, energy_excess, single_excess;
    Cell whitehead_reach, reach_gain; // until --whitehead-excess
    Cell build_bound, rest, solve_peak, bandwidth;
    std::vector<LevelCost> level;
    uint64_t poles = 0, zeros = 0;
    double residual = 0;
    int unconverged = 0, repetitions = 0, same_bits = 1;
    std::string trouble;
};

struct Options {
    int repetitions = 5, subdivisions = 0;
    double tolerance = 1e-8, whitehead_tolerance = 1e-6, whitehead_excess = 1e-6, whitehead = 60, single = 0,
           preview = 10000;
    bool cholesky = true;
};

#if HMF_HAVE_CHOLMOD
// The library that CHOLMOD's products of dense blocks come from: which one it is makes a factor of 1.5.
std::string blas() {
    Dl_info info = {};
    void* const product = dlsym(RTLD_DEFAULT, "dgemm_");
    if (!product || !dladdr(product, &info) || !info.dli_fname) return "unknown";
    char* const path = realpath(info.dli_fname, nullptr);
    const std::string name = path ? path : info.dli_fname;
    std::free(path);
    return name;
}

// Seconds to analyse, factorize and solve the cotangent Laplacian of the
// caller's mesh with one vertex pinned; negative: failed.  Filling the matrix
// is not counted.
double run_cholesky(const std::vector<uint32_t>& ends, const std::vector<double>& weight, size_t vertices) {
    cholmod_common common;
    cholmod_start(&common);
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.print = 0;
    const size_t n = vertices - 1; // the last vertex is pinned
    cholmod_triplet* t = cholmod_allocate_triplet(n, n, n + weight.size(), -1, CHOLMOD_REAL, &common);
    int* row = static_cast<int*>(t->i);
    int* column = static_cast<int*>(t->j);
    double* value = static_cast<double*>(t->x);
    std::vector<double> diagonal(vertices, 0.0);
    size_t at = 0;
    for (size_t e = 0; e < weight.size(); ++e) {
        const uint32_t i = std::min(ends[2 * e], ends[2 * e + 1]), j = std::max(ends[2 * e], ends[2 * e + 1]);
        diagonal[i] += weight[e];
        diagonal[j] += weight[e];
        if (j >= n) continue;
        row[at] = static_cast<int>(j);
        column[at] = static_cast<int>(i);
        value[at++] = -weight[e];
    }
    for (size_t i = 0; i < n; ++i) {
        row[at] = column[at] = static_cast<int>(i);
        value[at++] = diagonal[i];
    }
    t->nnz = at;
    cholmod_sparse* a = cholmod_triplet_to_sparse(t, at, &common);
    cholmod_free_triplet(&t, &common);
    cholmod_dense* b = cholmod_allocate_dense(n, 1, n, CHOLMOD_REAL, &common);
    for (size_t i = 0; i < n; ++i) static_cast<double*>(b->x)[i] = i % 2 ? 1.0 : -1.0;
    const double begin = now();
    cholmod_factor* factor = cholmod_analyze(a, &common);
    cholmod_factorize(a, factor, &common);
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor, b, &common);
    const double seconds = now() - begin;
    const bool good = common.status == CHOLMOD_OK && x;
    cholmod_free_dense(&x, &common);
    cholmod_free_dense(&b, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&a, &common);
    cholmod_finish(&common);
    return good ? seconds : -1;
}
#endif

struct Destroy {
    void operator()(hmf_hierarchy* h) const { hmf_hierarchy_destroy(h); }
    void operator()(hmf_foliation* f) const { hmf_foliation_destroy(f); }
    void operator()(hmf_loop_set* loops) const { hmf_free(loops); }
};
template <class T>
using Owned = std::unique_ptr<T, Destroy>;

struct Solved {
    hmf_status status = 0;
    double seconds = -1, wall_seconds = -1;
    Owned<hmf_foliation> foliation; // there even if it is not harmonic yet
    const hmf_report* report = nullptr;
    bool out_of_time = false;
    bool usable() const { return foliation != nullptr; }
    // Until the energy on level 0 was this low; negative: never.  The history
    // is in wall time, which is scaled to the clock of the measurement.
    double seconds_to(double energy) const {
        for (uint64_t i = 0; report && i < report->history_count; ++i) {
            const hmf_history_entry& entry = report->history[i];
            if (entry.level == 0 && entry.energy <= energy) return entry.seconds * seconds / wall_seconds;
        }
        return -1;
    }
};

// The limit must run on the clock of the measurement: the library's own limit
// is wall time, of which a busy machine may give us a tenth.
struct Deadline {
    double at = 0;
    bool passed = false;
};
int32_t watch(void* user, double) {
    Deadline& d = *static_cast<Deadline*>(user);
    if (now() > d.at) d.passed = true;
    return d.passed ? HMF_PROGRESS_FINISH : HMF_PROGRESS_CONTINUE;
}

Solved run_solve(const hmf_hierarchy* h, const hmf_loop_set* loops, int32_t method, double tolerance, double limit,
                 size_t stop_level, std::string& trouble) {
    Solved s;
    hmf_solve_options o = {};
    o.struct_size = sizeof o;
    o.method = method;
    (method == HMF_METHOD_NEWTON ? o.tolerance : o.energy_tolerance) = tolerance;
    o.stop_level = stop_level;
    Deadline deadline;
    deadline.at = now() + limit;
    hmf_control control = control_of_threads();
    if (limit > 0) {
        control.progress = watch;
        control.progress_user = &deadline;
    }
    hmf_error error = {};
    hmf_foliation* out = nullptr;
    const double begin = now(), wall_begin = wall();
    s.status = hmf_solve(h, loops, &o, &control, &out, &error);
    s.seconds = now() - begin;
    s.wall_seconds = wall() - wall_begin;
    s.foliation.reset(out);
    s.report = hmf_foliation_report(out);
    s.out_of_time = deadline.passed;
    if (!s.usable()) trouble = error.message;
    return s;
}

// One repetition on one mesh.
void run(const Soup& soup, const Options& options, Counter& counter, Result& out) {
    ++out.repetitions;
    hmf_hierarchy_options bo = {};
    bo.struct_size = sizeof bo;
    bo.allocate = counted_allocate;
    bo.release = counted_release;
    bo.allocator_user = &counter;
    hmf_hierarchy* h = nullptr;
    hmf_error error = {};
    const double bandwidth = copy_bandwidth();
    out.bandwidth.add(bandwidth * 1e-9);

    const hmf_control control = control_of_threads();
    const double t0 = now();
    hmf_hierarchy_create(soup.position.data(), soup.vertices(), soup.triangle.data(), soup.triangles(), &bo, &control,
                         &h, &error);
    const double t1 = now();
    const Owned<hmf_hierarchy> hierarchy(h);
    if (!h) {
        out.trouble = error.message;
        return;
    }
    const size_t coarsest = hmf_hierarchy_describe(h)->level_count - 1;
    const hmf_level_info& fine = hmf_hierarchy_describe(h)->levels[0];
    const size_t build_peak = counter.peak;
    const double t2 = now();
    hmf_loop_set* loops = nullptr;
    hmf_loops(h, coarsest, HMF_LOOPS_CUT, &control, &loops, &error);
    const double t3 = now();
    const Owned<hmf_loop_set> loops_owner(loops);
    if (!loops) {
        out.trouble = error.message;
        return;
    }

    const Solved first = run_solve(h, loops, HMF_METHOD_NEWTON, options.tolerance, 0, 0, out.trouble);
    if (!first.usable()) return;
    const hmf_report& report = *first.report;
    if (first.status != HMF_OK) ++out.unconverged;
    out.residual = std::max(out.residual, report.residual_max);
    out.poles = std::max(out.poles, report.poles);
    out.zeros = report.zeros;
    const double edges = static_cast<double>(fine.edge_count), build = t1 - t0;
    const double job = build + (t3 - t2) + first.seconds;
    const double held = static_cast<double>(hmf_hierarchy_describe(h)->memory_bytes);
    out.build.add(build);
    out.edges_per_second.add(edges / build * 1e-6);
    out.bytes_per_edge.add(held / edges);
    out.build_peak.add(static_cast<double>(build_peak) / edges);
    out.solve_peak.add(static_cast<double>(report.peak_memory_bytes) / edges);
    out.loops.add(t3 - t2);
    out.solve.add(first.seconds);
    out.job.add(job);
    out.job_per_edge.add(job / edges * 1e9);
    // What the build has to read and write at least once.
    out.build_bound.add(
        (8.0 * static_cast<double>(soup.position.size()) + 4.0 * static_cast<double>(soup.triangle.size()) + held)
        / bandwidth);

    const size_t levels = static_cast<size_t>(report.level_count);
    out.level.resize(std::max(out.level.size(), levels));
    double accounted = 0;
    for (size_t l = 0; l < levels; ++l) {
        const hmf_level_report& from = report.levels[l];
        LevelCost& to = out.level[l];
        const double e = static_cast<double>(from.edge_count),
                     c = l + 1 < levels ? static_cast<double>(report.levels[l + 1].edge_count) : 0;
        to.vertices = static_cast<double>(from.vertex_count);
        to.edges = e;
        to.sweeps = from.sweep_count;
        to.linear_solve_count = from.linear_solve_count;
        to.optimize.add(from.optimize_seconds);
        to.interpolate.add(from.interpolate_seconds);
        // Optimize: weight, two ends, value read and written.  Interpolate:
        // coarse values read, fine ones written, the sides of the triangles
        // read (12 bytes for 2/3 triangle an edge).
        to.optimize_bound.add(32 * e / bandwidth);
        to.interpolate_bound.add((8 * c + 8 * e + 8 * e) / bandwidth);
        accounted += from.optimize_seconds + from.interpolate_seconds;
    }
    out.rest.add(std::max(0.0, first.wall_seconds - accounted));

    {
        const Solved second = run_solve(h, loops, HMF_METHOD_NEWTON, options.tolerance, 0, 0, out.trouble);
        out.second.add(second.usable() ? second.seconds : -1);
        size_t count = 0, again = 0;
        const double* const values = hmf_foliation_values(first.foliation.get(), &count);
        const double* const others = hmf_foliation_values(second.foliation.get(), &again);
        if (again != count || std::memcmp(others, values, count * sizeof(double)) != 0) out.same_bits = 0;
    }

    size_t level = 0;
    double distance = 1e300, size = 0;
    for (size_t l = 0; l <= coarsest; ++l) {
        const hmf_level_info& info = hmf_hierarchy_describe(h)->levels[l];
        const double d = std::abs(std::log(static_cast<double>(info.vertex_count) / options.preview));
        if (d < distance) {
            distance = d;
            level = l;
            size = static_cast<double>(info.vertex_count);
        }
    }
    const Solved preview = run_solve(h, loops, HMF_METHOD_NEWTON, options.tolerance, 0, level, out.trouble);
    out.preview.add(preview.usable() ? 1e3 * preview.seconds : -1);
    out.preview_vertices.add(size);

#if HMF_HAVE_CHOLMOD
    if (options.cholesky) {
        hmf_level_mesh* level = nullptr;
        hmf_level(h, 0, nullptr, &level, nullptr);
        if (const Owned<hmf_level_mesh> owner(level); level) {
            const std::vector<uint32_t> ends(level->edge_vertices, level->edge_vertices + 2 * level->edge_count);
            const std::vector<double> weight(level->weights, level->weights + level->edge_count);
            const double seconds = run_cholesky(ends, weight, soup.vertices());
            out.cholesky.add(seconds);
            out.job_against_cholesky.add(seconds > 0 ? job / seconds : -1);
            out.solve_against_cholesky.add(seconds > 0 ? first.seconds / seconds : -1);
        }
    }
#endif
    const double energy = report.energy;
    if (options.whitehead > 0) {
        const Solved w =
            run_solve(h, loops, HMF_METHOD_WHITEHEAD, options.whitehead_tolerance, options.whitehead, 0, out.trouble);
        out.whitehead.add(w.usable() ? w.seconds : -1);
        out.newton_gain.add(w.usable() ? w.seconds / first.seconds : -1);
        if (w.out_of_time) out.whitehead.bounded = out.newton_gain.bounded = true;
        out.energy_excess.sign = out.single_excess.sign = true;
        if (w.usable()) out.energy_excess.add(w.report->energy / energy - 1);
        if (options.whitehead_excess > 0) {
            const Solved to_end = run_solve(h, loops, HMF_METHOD_WHITEHEAD, 1e-15, options.whitehead, 0, out.trouble);
            double seconds = to_end.seconds_to(energy * (1 + options.whitehead_excess));
            if (seconds < 0 && to_end.out_of_time) {
                seconds = to_end.seconds;
                out.whitehead_reach.bounded = out.reach_gain.bounded = true;
            }
            out.whitehead_reach.add(seconds);
            out.reach_gain.add(seconds < 0 ? -1 : seconds / first.seconds);
        }
        if (options.single > 0) {
            const Solved s = run_solve(h, loops, HMF_METHOD_SINGLE_LEVEL, options.whitehead_tolerance, options.single,
                                       0, out.trouble);
            out.single.add(s.usable() ? s.seconds : -1);
            // Against an unfinished whitehead a quotient would bound nothing.
            if (w.status == HMF_OK) out.hierarchy_gain.add(s.usable() ? s.seconds / w.seconds : -1);
            if (s.out_of_time) out.single.bounded = out.hierarchy_gain.bounded = true;
            if (s.usable()) out.single_excess.add(s.report->energy / energy - 1);
        }
    }
}

// --- Report ------------------------------------------------------------------

void print(const std::vector<Soup>& soups, const std::vector<Result>& results, const Options& options) {
    std::printf("hmf %u, %d repetitions, threads %u, %s time: median [smallest, largest]\n\n", hmf_version(),
                options.repetitions, hmf_pool_threads(pool), processor_clock ? "processor" : "wall");
#if HMF_HAVE_CHOLMOD
    if (options.cholesky) std::printf("BLAS of CHOLMOD: %s\n\n", blas().c_str());
#endif
    std::printf("| mesh | edges | build M edges/s | bytes/edge held | peak of build B/edge | peak of solve B/edge | "
                "build s | loops s | newton s | second solve s | job s | residual |\n");
    std::printf("|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < soups.size(); ++i) {
        const Result& r = results[i];
        std::printf("| %s | %.0f | %s | %s | %s | %s | %s | %s | %s | %s | %s | %.1e%s |\n", soups[i].name.c_str(),
                    soups[i].edges(), r.edges_per_second.text("%.2f").c_str(), r.bytes_per_edge.text("%.0f").c_str(),
                    r.build_peak.text("%.0f").c_str(), r.solve_peak.text("%.0f").c_str(), r.build.text("%.3f").c_str(),
                    r.loops.text("%.4f").c_str(), r.solve.text("%.3f").c_str(), r.second.text("%.3f").c_str(),
                    r.job.text("%.3f").c_str(), r.residual, r.unconverged ? " NOT CONVERGED" : "");
    }
    std::printf("\n| mesh | Cholesky s | job / Cholesky | newton / Cholesky | preview ms | preview vertices | "
                "whitehead s | whitehead / newton | whitehead energy excess | whitehead to excess %.0e s | that / "
                "newton | single_level s | single_level / whitehead | single_level energy excess |\n",
                options.whitehead_excess);
    std::printf("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (size_t i = 0; i < soups.size(); ++i) {
        const Result& r = results[i];
        std::printf("| %s | %s | %s | %s | %s | %.0f | %s | %s | %s | %s | %s | %s | %s | %s |\n",
                    soups[i].name.c_str(), r.cholesky.text("%.3f").c_str(), r.job_against_cholesky.text("%.2f").c_str(),
                    r.solve_against_cholesky.text("%.2f").c_str(), r.preview.text("%.0f").c_str(),
                    r.preview_vertices.sample.empty() ? 0.0 : r.preview_vertices.sample[0],
                    r.whitehead.text("%.2f").c_str(), r.newton_gain.text("%.1f").c_str(),
                    r.energy_excess.text("%.1e").c_str(), r.whitehead_reach.text("%.2f").c_str(),
                    r.reach_gain.text("%.0f").c_str(), r.single.text("%.2f").c_str(),
                    r.hierarchy_gain.text("%.1f").c_str(), r.single_excess.text("%.1e").c_str());
    }
    size_t small = 0;
    for (size_t i = 0; i < soups.size(); ++i)
        if (soups[i].edges() < soups[small].edges()) small = i;
    std::printf("\n| growth | edges | job ns/edge | against %s |\n|---|---|---|---|\n", soups[small].name.c_str());
    for (size_t i = 0; i < soups.size(); ++i) {
        Cell growth;
        const std::vector<double>&a = results[i].job_per_edge.sample, &b = results[small].job_per_edge.sample;
        if (a.size() == b.size())
            for (size_t k = 0; k < a.size(); ++k) growth.add(a[k] / b[k]);
        std::printf("| %s | %.0f | %s | %s |\n", soups[i].name.c_str(), soups[i].edges(),
                    results[i].job_per_edge.text("%.0f").c_str(), growth.text("%.2f").c_str());
    }
    for (size_t i = 0; i < soups.size(); ++i) {
        const Result& r = results[i];
        std::printf("\n%s: where the time goes (copy %s GB/s)\n\n", soups[i].name.c_str(),
                    r.bandwidth.text("%.1f").c_str());
        std::printf("| stage | vertices | seconds%s | bound by memory s | linear solves | sweeps "
                    "|\n|---|---|---|---|---|---|\n",
                    processor_clock ? " (of the solve: wall)" : "");
        std::printf("| build | %zu | %s | %s | | |\n", soups[i].vertices(), r.build.text("%.4f").c_str(),
                    r.build_bound.text("%.4f").c_str());
        std::printf("| loops, coarsest | | %s | | | |\n", r.loops.text("%.4f").c_str());
        for (size_t l = r.level.size(); l-- > 0;) {
            const LevelCost& c = r.level[l];
            if (l + 1 < r.level.size())
                std::printf("| interpolate to %zu | %.0f | %s | %s | | |\n", l, c.vertices,
                            c.interpolate.text("%.4f").c_str(), c.interpolate_bound.text("%.4f").c_str());
            std::printf("| optimize %zu%s | %.0f | %s | %s | %llu | %llu |\n", l,
                        l + 1 == r.level.size() ? " (coarsest)" : "", c.vertices, c.optimize.text("%.4f").c_str(),
                        c.optimize_bound.text("%.4f").c_str(), static_cast<unsigned long long>(c.linear_solve_count),
                        static_cast<unsigned long long>(c.sweeps));
        }
        std::printf("| rest of solve | | %s | | | |\n", r.rest.text("%.4f").c_str());
        std::printf("\nzeros %llu, poles %llu; second solve %s\n", static_cast<unsigned long long>(r.zeros),
                    static_cast<unsigned long long>(r.poles), r.same_bits ? "has the same bits" : "DIFFERS");
        if (r.unconverged)
            std::printf("newton did not reach the tolerance in %d of %d repetitions\n", r.unconverged, r.repetitions);
        if (!r.trouble.empty()) std::printf("TROUBLE: %s\n", r.trouble.c_str());
    }
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    std::printf("\npeak memory of the whole program, with meshes and CHOLMOD: %.2f GiB\n",
                static_cast<double>(usage.ru_maxrss) / 1048576);
}

} // namespace

int main(int argc, char** argv) {
    const char* threads = "1";
    for (int i = 1; i + 1 < argc; ++i)
        if (!std::strcmp(argv[i], "--threads")) threads = argv[i + 1];
    // BLAS and OpenMP read their number of threads before main.
    if (!std::getenv("HMF_BENCH_THREADS")) {
        setenv("HMF_BENCH_THREADS", threads, 1);
        setenv("OMP_NUM_THREADS", threads, 1);
        setenv("OPENBLAS_NUM_THREADS", threads, 1);
        execv("/proc/self/exe", argv);
    }
    for (int i = 1; i < argc; ++i)
        if (!std::strcmp(argv[i], "--cpu") && std::atoi(threads) > 1) {
            std::fprintf(stderr, "--cpu is the time of one thread; it goes with --threads 1 only\n");
            return 2;
        }
    if (std::atoi(threads) > 1) pool = hmf_pool_create(static_cast<uint32_t>(std::atoi(threads)));
    Options options;
    std::vector<Soup> soups;
    for (int i = 1; i < argc; ++i) {
        const auto is = [&](const char* name) { return !std::strcmp(argv[i], name) && i + 1 < argc; };
        if (is("-r")) options.repetitions = std::max(1, std::atoi(argv[++i]));
        else if (is("--subdivide")) options.subdivisions = std::max(0, std::atoi(argv[++i]));
        else if (is("--tolerance")) options.tolerance = std::atof(argv[++i]);
        else if (is("--preview")) options.preview = std::max(1.0, std::atof(argv[++i]));
        else if (is("--whitehead")) options.whitehead = std::atof(argv[++i]);
        else if (is("--whitehead-excess")) options.whitehead_excess = std::atof(argv[++i]);
        else if (is("--whitehead-tolerance")) options.whitehead_tolerance = std::atof(argv[++i]);
        else if (is("--threads")) ++i;
        else if (!std::strcmp(argv[i], "--cpu")) processor_clock = true;
        else if (is("--single-level")) options.single = std::atof(argv[++i]);
        else if (!std::strcmp(argv[i], "--no-cholesky")) options.cholesky = false;
        else if (argv[i][0] == '-') {
            std::fprintf(stderr, "unknown option %s, or its value is missing\n", argv[i]);
            return 2;
        } else {
            soups.emplace_back();
            if (!read_obj(argv[i], soups.back())) {
                std::fprintf(stderr, "cannot read %s\n", argv[i]);
                return 3;
            }
        }
    }
    if (soups.empty())
        for (uint32_t k : {100u, 240u}) soups.push_back(torus(3 * k, k));
    for (Soup& soup : soups)
        for (int k = 0; k < options.subdivisions; ++k) subdivide(soup);
    std::vector<Result> results(soups.size());
    for (int r = 0; r < options.repetitions; ++r)
        for (size_t i = 0; i < soups.size(); ++i) {
            Counter counter;
            run(soups[i], options, counter, results[i]);
            if (counter.used != 0) results[i].trouble = "memory was not returned";
            std::fprintf(stderr, "repetition %d, %s\n", r + 1, soups[i].name.c_str());
        }
    print(soups, results, options);
    for (const Result& r : results)
        if (!r.trouble.empty()) return 1;
    return 0;
}
