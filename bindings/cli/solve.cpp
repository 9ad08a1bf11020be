#include "solve.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>

#include "failure.hpp"
#include "leaves.hpp"
#include "output.hpp"
#include "potential.hpp"
#include "read_loops.hpp"
#include "read_mesh.hpp"
#include "read_values.hpp"
#include "render.hpp"
#include "write_results.hpp"

namespace cli {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

volatile std::sig_atomic_t interrupted = 0;
extern "C" void on_interrupt(int) {
    // The second time the caller does not want to wait.
    if (interrupted) std::_Exit(130);
    interrupted = 1;
}

struct InterruptGuard {
    void (*previous)(int) = std::signal(SIGINT, on_interrupt);
    InterruptGuard() = default;
    ~InterruptGuard() { std::signal(SIGINT, previous == SIG_ERR ? SIG_DFL : previous); }
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

// One bar for several calls; each fills its part.
class Progress {
public:
    explicit Progress(const char* label) : label_(label), visible_(isatty(STDERR_FILENO) != 0) {}
    ~Progress() { clear(); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void part(const char* label, double from, double to) {
        label_ = label;
        from_ = from;
        to_ = to;
        draw(0);
    }
    void clear() {
        if (visible_ && drawn_) std::fprintf(stderr, "\r\033[K");
        drawn_ = false;
    }
    static int32_t callback(void* user, double fraction) {
        static_cast<Progress*>(user)->draw(fraction);
        return interrupted ? HMF_PROGRESS_FINISH : HMF_PROGRESS_CONTINUE;
    }

private:
    void draw(double fraction) {
        if (!visible_ || (drawn_ && fraction < 1 && seconds_since(last_) < 0.05)) return;
        constexpr int WIDTH = 40;
        const double all = from_ + (to_ - from_) * std::clamp(fraction, 0.0, 1.0);
        const int filled = static_cast<int>(std::lround(all * WIDTH));
        std::fprintf(stderr, "\r\033[K%-8s [", label_);
        for (int i = 0; i < WIDTH; ++i) std::fputc(i < filled ? '#' : '.', stderr);
        std::fprintf(stderr, "] %3d%%", static_cast<int>(all * 100));
        std::fflush(stderr);
        last_ = Clock::now();
        drawn_ = true;
    }

    const char* label_;
    bool visible_, drawn_ = false;
    double from_ = 0, to_ = 1;
    Clock::time_point last_;
};

// Counts the bytes that the library holds.
struct Meter {
    uint64_t held = 0, peak = 0;
    static void* allocate(void* user, size_t size) {
        Meter& meter = *static_cast<Meter*>(user);
        void* block = std::malloc(size);
        if (block) {
            meter.held += size;
            meter.peak = std::max(meter.peak, meter.held);
        }
        return block;
    }
    static void release(void* user, void* block, size_t size) {
        static_cast<Meter*>(user)->held -= size;
        std::free(block);
    }
};

struct DestroyHierarchy {
    void operator()(hmf_hierarchy* hierarchy) const { hmf_destroy(hierarchy); }
};
using Hierarchy = std::unique_ptr<hmf_hierarchy, DestroyHierarchy>;

Hierarchy build(const TriangleMesh& mesh, const std::string& name, const hmf_build_options& options) {
    hmf_hierarchy* raw = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_build(mesh.positions.data(), mesh.vertex_count(), 0, mesh.triangles.data(),
                                        mesh.triangle_count(), &options, &raw, &error);
    if (status == HMF_CANCELLED) throw Failure(EXIT_LIMIT, name + ": cancelled before there was a result");
    if (status != HMF_OK) fail_with(status, error, name);
    return Hierarchy(raw);
}

// The marked vertices that --marks asks for.
std::vector<uint32_t> find_marks(const TriangleMesh& mesh, const SolveRequest& request,
                                 const hmf_build_options& options) {
    std::vector<uint32_t> marks;
    if (request.marks == "none") return marks;
    if (request.marks != "auto") {
        const std::string text = read_file(request.marks);
        const char *at = text.data(), *const stop = at + text.size();
        for (;;) {
            while (at != stop && (*at == ' ' || *at == '\t' || *at == '\r' || *at == '\n')) ++at;
            if (at == stop) return marks;
            uint32_t vertex = 0;
            const std::from_chars_result parsed = std::from_chars(at, stop, vertex);
            if (parsed.ec != std::errc() || vertex >= mesh.vertex_count())
                throw Failure(EXIT_BAD_INPUT, request.marks + ": number " + std::to_string(marks.size() + 1)
                                                  + " is no vertex; give indices below "
                                                  + std::to_string(mesh.vertex_count()) + ", white space between them");
            if (std::find(marks.begin(), marks.end(), vertex) != marks.end())
                throw Failure(EXIT_BAD_INPUT, request.marks + ": vertex " + std::to_string(vertex)
                                                  + " is marked twice; name each marked vertex once");
            marks.push_back(vertex);
            at = parsed.ptr;
        }
    }
    // Edges of a sphere; what else is wrong with the mesh, the build tells.
    if (mesh.triangle_count() + 4 != 2 * mesh.vertex_count()) return marks;
    marks.resize(24);
    size_t count = 0;
    hmf_error error{};
    const hmf_status status =
        hmf_suggest_marks(mesh.positions.data(), mesh.vertex_count(), 0, mesh.triangles.data(), mesh.triangle_count(),
                          &options, marks.data(), marks.size(), &count, &error);
    if (status == HMF_CANCELLED) throw Failure(EXIT_LIMIT, request.mesh_name + ": cancelled before there was a result");
    if (status != HMF_OK) fail_with(status, error, request.mesh_name);
    marks.resize(count);
    return marks;
}

// HMF_LOOPS_* of a name, 0 for the name of a file.
int32_t loop_kind(const std::string& name) {
    if (name == "cut") return HMF_LOOPS_CUT;
    if (name == "handle") return HMF_LOOPS_HANDLE;
    if (name == "tunnel") return HMF_LOOPS_TUNNEL;
    if (name == "pants") return HMF_LOOPS_PANTS;
    return 0;
}

LoopList library_loops(const hmf_hierarchy* hierarchy, size_t level, int32_t kind, const std::string& name) {
    LoopList loops;
    hmf_error error{};
    hmf_level_info counts{};
    hmf_status status = hmf_level_counts(hierarchy, level, &counts, &error);
    if (status != HMF_OK) fail_with(status, error, name);
    // Room that nearly always suffices saves computing the loops twice.
    size_t count = 3 * hmf_genus(hierarchy) + 24, element_count = counts.triangle_count;
    for (int round = 0; round < 2; ++round) {
        loops.offsets.resize(count + 1);
        loops.elements.resize(element_count);
        status = hmf_loops(hierarchy, level, kind, loops.offsets.data(), loops.offsets.size(), loops.elements.data(),
                           loops.elements.size(), &count, &element_count, &error);
        if (status != HMF_ERROR_CAPACITY) break;
        status = hmf_loops(hierarchy, level, kind, nullptr, 0, nullptr, 0, &count, &element_count, &error);
        if (status != HMF_OK) break;
    }
    if (status != HMF_OK) fail_with(status, error, name);
    loops.offsets.resize(count + 1);
    loops.elements.resize(element_count);
    return loops;
}

const char* method_name(int32_t method) {
    switch (method) {
    case HMF_METHOD_NEWTON: return "newton";
    case HMF_METHOD_WHITEHEAD: return "whitehead";
    case HMF_METHOD_SINGLE_LEVEL: return "single-level";
    default: return "default";
    }
}

void check(hmf_status status, const hmf_error& error, const std::string& name) {
    if (status != HMF_OK) fail_with(status, error, name);
}

// Everything that the pictures need, in the numbering of level 0.
Foliation collect(const hmf_hierarchy* hierarchy, const TriangleMesh& mesh, std::vector<double> values,
                  std::vector<double> loop_weights, const std::string& name) {
    Foliation f;
    hmf_error error{};
    f.positions = mesh.positions;
    f.triangles.resize(mesh.triangles.size());
    f.triangle_edges.resize(mesh.triangles.size());
    f.edge_vertices.resize(2 * values.size());
    check(hmf_level_triangle_vertices(hierarchy, 0, f.triangles.data(), f.triangles.size(), &error), error, name);
    check(hmf_level_triangle_edges(hierarchy, 0, f.triangle_edges.data(), f.triangle_edges.size(), &error), error,
          name);
    check(hmf_level_edge_vertices(hierarchy, 0, f.edge_vertices.data(), f.edge_vertices.size(), &error), error, name);
    f.values = std::move(values);
    f.loop_weights = std::move(loop_weights);
    size_t count = 0;
    check(hmf_singularities(hierarchy, 0, f.values.data(), f.values.size(), nullptr, 0, nullptr, 0, nullptr, 0, nullptr,
                            0, &count, &error),
          error, name);
    f.singular.resize(count);
    check(hmf_singularities(hierarchy, 0, f.values.data(), f.values.size(), nullptr, 0, nullptr, 0, nullptr, 0,
                            f.singular.data(), count, &count, &error),
          error, name);
    return f;
}

} // namespace

int solve(const TriangleMesh& mesh, double read_seconds, const SolveRequest& request) {
    const std::string& name = request.mesh_name;
    const Clock::time_point start = Clock::now();
    const int32_t kind = loop_kind(request.loops);
    const bool own_loops = kind == 0, has_start = !request.start.empty();
    LoopList loops;
    if (own_loops) loops = read_loops(request.loops, mesh.vertex_count(), mesh.triangle_count());
    for (const std::string& path : request.values) check_writable(path);
    for (const std::string& path :
         {request.report, request.history, request.image, request.leaves, request.quads, request.obj})
        if (!path.empty()) check_writable(path);

    InterruptGuard guard;
    Progress progress("build");
    Meter meter;
    Summary summary;

    hmf_build_options build_options;
    hmf_build_options_init(&build_options);
    build_options.ratio = request.ratio;
    build_options.mollify = request.mollify;
    build_options.coarsest = request.coarsest;
    build_options.collapse = request.collapse;
    build_options.allocate = Meter::allocate;
    build_options.release = Meter::release;
    build_options.allocator_user = &meter;
    build_options.progress = Progress::callback;
    build_options.progress_user = &progress;
    const Clock::time_point build_start = Clock::now();
    progress.part("marks", 0, 0.05);
    const std::vector<uint32_t> marks = find_marks(mesh, request, build_options);
    build_options.marked_vertices = marks.data();
    build_options.marked_count = marks.size();
    progress.part("build", 0.05, 0.35);
    const Hierarchy hierarchy = build(mesh, name, build_options);
    summary.build_seconds = seconds_since(build_start);

    const size_t level_count = hmf_level_count(hierarchy.get());
    // Loops of the caller are drawn on the input mesh, and the single-level
    // method knows no other; the library's own are cheapest where it is coarse.
    const size_t loop_level = own_loops || request.method == HMF_METHOD_SINGLE_LEVEL ? 0 : level_count - 1;
    const Clock::time_point loops_start = Clock::now();
    if (!own_loops && !has_start) loops = library_loops(hierarchy.get(), loop_level, kind, name);
    summary.loops_seconds = seconds_since(loops_start);

    std::vector<double> weights = request.loop_weights;
    // Without loops the weights are for the pictures only.
    if (weights.empty()) weights.assign(has_start ? 1 : loops.count(), 1.0);
    if (weights.size() != loops.count() && !has_start)
        throw Failure(EXIT_USAGE, "--weights: " + std::to_string(weights.size()) + " weights for "
                                      + std::to_string(loops.count()) + " loops; give one weight per loop");
    hmf_loop_set loop_set{};
    loop_set.struct_size = sizeof loop_set;
    loop_set.element_kind = loops.element_kind;
    loop_set.level = loop_level;
    loop_set.count = loops.count();
    loop_set.offsets = loops.offsets.data();
    loop_set.elements = loops.elements.data();
    loop_set.weights = weights.data();

    hmf_level_info finest{};
    hmf_error error{};
    check(hmf_level_counts(hierarchy.get(), 0, &finest, &error), error, name);
    hmf_solve_options options;
    hmf_solve_options_init(&options);
    options.method = request.method;
    options.tolerance = request.tolerance;
    options.time_limit = request.time_limit;
    options.progress = Progress::callback;
    options.progress_user = &progress;
    summary.levels.resize(level_count);
    // Room for every sweep of a long run, only where it is wanted.
    std::vector<hmf_history_entry> history(request.history.empty() ? 0 : size_t(1) << 20);
    hmf_report& report = summary.report;
    report.struct_size = sizeof report;
    report.levels = summary.levels.data();
    report.level_capacity = summary.levels.size();
    report.history = history.empty() ? nullptr : history.data();
    report.history_capacity = history.size();

    std::vector<double> values(finest.edge_count);
    if (has_start) {
        std::vector<uint32_t> edge_vertices(2 * finest.edge_count);
        check(hmf_level_edge_vertices(hierarchy.get(), 0, edge_vertices.data(), edge_vertices.size(), &error), error,
              name);
        values = read_values(request.start, edge_vertices);
        options.initial_values = values.data();
        options.initial_count = values.size();
    }
    progress.part("solve", 0.35, 1);
    const hmf_status status = hmf_solve(hierarchy.get(), has_start ? nullptr : &loop_set, &options, values.data(),
                                        values.size(), &report, &error);
    progress.clear();
    if (status >= HMF_ERROR_NULL) {
        if (own_loops && error.status == status && error.element == HMF_ELEMENT_LOOP
            && error.index < loops.lines.size())
            fail_with(status, error, request.loops + ":" + std::to_string(loops.lines[error.index]));
        fail_with(status, error,
                  has_start && status >= HMF_ERROR_VALUE_NOT_FINITE && status < 600 ? request.start : name);
    }
    if (!report.values_written) throw Failure(EXIT_LIMIT, name + ": cancelled before there was a result");
    summary.levels.resize(std::min<uint64_t>(report.level_count, summary.levels.size()));
    history.resize(std::min<uint64_t>(report.history_count, history.size()));

    const Foliation foliation = collect(hierarchy.get(), mesh, std::move(values), weights, name);
    summary.vertices = finest.vertex_count;
    summary.edges = finest.edge_count;
    summary.triangles = finest.triangle_count;
    summary.genus = hmf_genus(hierarchy.get());
    summary.marked = marks.size();
    summary.loops = loops.count();
    summary.method = method_name(report.method);
    summary.peak_memory_bytes = meter.peak;
    summary.total_seconds = read_seconds + seconds_since(start);

    for (const std::string& path : request.values)
        if (extension_of(path) == ".npy") write_values_npy(path, foliation.values);
        else write_values_csv(path, foliation);
    if (!request.history.empty()) write_history(request.history, history);
    if (!request.leaves.empty() && status == HMF_OK)
        summary.cylinders = find_cylinders(hierarchy.get(), foliation, loop_set, name);
    if (!request.quads.empty())
        summary.quads = write_quads(request.quads, hierarchy.get(), foliation, request.quad_size, name);
    if (!request.leaves.empty())
        summary.leaves =
            write_leaves(request.leaves, hierarchy.get(), foliation, request.leaf_spacing, request.conjugate, name);
    const Potential potential = request.image.empty() && request.obj.empty() ? Potential{} : local_potential(foliation);
    // Asked for, or for the report, which tells how conformal the result is.
    const bool asked = request.checkerboard || !request.obj.empty();
    Parameterization parameterization;
    std::exception_ptr no_parameterization;
    if (asked
        || (!request.report.empty() && status == HMF_OK && request.method != HMF_METHOD_WHITEHEAD
            && request.method != HMF_METHOD_SINGLE_LEVEL)) {
        progress.part("unfold", 0, 1);
        try {
            parameterization = parameterize(hierarchy.get(), foliation, Progress::callback, &progress, name);
            summary.parameterized = true;
            summary.parameterization = parameterization.numbers;
        } catch (const Failure&) {
            // The other results come first.
            if (asked) no_parameterization = std::current_exception();
        }
        progress.clear();
    }
    if (!request.obj.empty() && summary.parameterized)
        write_textured_obj(request.obj, foliation, parameterization, pattern_period(foliation, potential));
    if (!request.image.empty()) {
        const LoopList drawn = loop_level == 0 ? loops : library_loops(hierarchy.get(), 0, kind, name);
        write_png(request.image, render(foliation, potential,
                                        request.checkerboard && summary.parameterized ? &parameterization : nullptr,
                                        loop_lines(foliation, drawn)));
    }
    if (!request.report.empty()) write_report(request.report, summary);

    std::printf("%s: genus %zu, %zu edges, %zu loops, energy %.10g, residual %.2g, %llu zeros, %llu poles, %.2f s\n",
                name.c_str(), summary.genus, summary.edges, summary.loops, report.energy, report.residual_max,
                static_cast<unsigned long long>(report.zeros), static_cast<unsigned long long>(report.poles),
                summary.total_seconds);
    if (request.marks == "auto" && !marks.empty()) {
        std::printf("marked %zu vertices, two at each of %zu tips:", marks.size(), marks.size() / 2);
        for (const uint32_t v : marks) std::printf(" %u", v);
        std::printf(" (--marks FILE for others)\n");
    }
    if (status != HMF_OK) {
        std::fflush(stdout);
        std::fprintf(stderr, "hmf: %s: %s; the best foliation so far was written\n", name.c_str(),
                     status == HMF_CANCELLED ? "interrupted" : hmf_status_string(status));
        if (!no_parameterization) return EXIT_LIMIT;
    }
    if (no_parameterization) std::rethrow_exception(no_parameterization);
    return EXIT_SOLVED;
}

int info(const TriangleMesh& mesh, const std::string& mesh_name, bool json) {
    InterruptGuard guard;
    Progress progress("check");
    hmf_build_options options;
    hmf_build_options_init(&options);
    // Validation only: one level.
    options.coarsest = mesh.vertex_count();
    options.progress = Progress::callback;
    options.progress_user = &progress;
    hmf_hierarchy* raw = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_build(mesh.positions.data(), mesh.vertex_count(), 0, mesh.triangles.data(),
                                        mesh.triangle_count(), &options, &raw, &error);
    const Hierarchy hierarchy(raw);
    progress.clear();
    if (status != HMF_OK) {
        if (json && status >= 300 && status < 400) {
            const nlohmann::ordered_json refused = {{"mesh", mesh_name},        {"valid", false},
                                                    {"status", status},         {"text", hmf_status_string(status)},
                                                    {"message", error.message}, {"index", error.index}};
            std::printf("%s\n", refused.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
        }
        fail_with(status, error, mesh_name);
    }

    hmf_level_info counts{};
    check(hmf_level_counts(hierarchy.get(), 0, &counts, &error), error, mesh_name);
    std::vector<double> weights(counts.edge_count);
    check(hmf_level_weights(hierarchy.get(), 0, weights.data(), weights.size(), &error), error, mesh_name);
    const auto negative = std::count_if(weights.begin(), weights.end(), [](double w) { return w < 0; });
    double low[3] = {}, high[3] = {}, area = 0, least_angle = 180, largest_angle = 0, edge_sum = 0;
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        for (size_t a = 0; a < 3; ++a) {
            const double x = mesh.positions[3 * v + a];
            low[a] = v ? std::min(low[a], x) : x;
            high[a] = v ? std::max(high[a], x) : x;
        }
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        double square[3];
        for (size_t s = 0; s < 3; ++s) {
            square[s] = 0;
            for (size_t a = 0; a < 3; ++a) {
                const double d = mesh.positions[3 * size_t(mesh.triangles[3 * t + s]) + a]
                               - mesh.positions[3 * size_t(mesh.triangles[3 * t + (s + 1) % 3]) + a];
                square[s] += d * d;
            }
            edge_sum += std::sqrt(square[s]);
        }
        const double p = square[0], q = square[1], r = square[2];
        const double twice = 0.5 * std::sqrt(std::max(0.0, 4 * p * q - (p + q - r) * (p + q - r)));
        area += twice / 2;
        for (size_t s = 0; s < 3; ++s) {
            const double cosine_side = (square[s] + square[(s + 1) % 3] - square[(s + 2) % 3]) / 2;
            const double angle = std::atan2(twice, cosine_side) * 57.29577951308232;
            least_angle = std::min(least_angle, angle);
            largest_angle = std::max(largest_angle, angle);
        }
    }
    const double mean_edge = edge_sum / double(3 * mesh.triangle_count());
    const size_t genus = hmf_genus(hierarchy.get());
    const uint64_t memory = hmf_memory_estimate(mesh.vertex_count(), mesh.triangle_count(), nullptr);
    if (json) {
        const nlohmann::ordered_json report = {{"mesh", mesh_name},
                                               {"valid", true},
                                               {"vertices", counts.vertex_count},
                                               {"edges", counts.edge_count},
                                               {"triangles", counts.triangle_count},
                                               {"genus", genus},
                                               {"non_delaunay_edges", negative},
                                               {"min_angle", least_angle},
                                               {"max_angle", largest_angle},
                                               {"mean_edge_length", mean_edge},
                                               {"area", area},
                                               {"box_low", {low[0], low[1], low[2]}},
                                               {"box_high", {high[0], high[1], high[2]}},
                                               {"memory_estimate_bytes", memory}};
        std::printf("%s\n", report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
        return EXIT_SOLVED;
    }
    std::printf("%s: closed oriented manifold, genus %zu\n", mesh_name.c_str(), genus);
    std::printf("  vertices       %llu\n", static_cast<unsigned long long>(counts.vertex_count));
    std::printf("  edges          %llu\n", static_cast<unsigned long long>(counts.edge_count));
    std::printf("  triangles      %llu\n", static_cast<unsigned long long>(counts.triangle_count));
    std::printf("  not Delaunay   %lld edges (%.2f %%)\n", static_cast<long long>(negative),
                100.0 * double(negative) / double(counts.edge_count));
    std::printf("  angles         %.3f to %.3f degrees\n", least_angle, largest_angle);
    std::printf("  mean edge      %.6g\n", mean_edge);
    std::printf("  area           %.6g\n", area);
    std::printf("  box            %.6g %.6g %.6g  to  %.6g %.6g %.6g\n", low[0], low[1], low[2], high[0], high[1],
                high[2]);
    std::printf("  memory to build, at most %.1f MB\n", double(memory) / 1e6);
    return EXIT_SOLVED;
}

} // namespace cli
