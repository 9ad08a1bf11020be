#include "solve.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <nlohmann/json.hpp>

#include "failure.hpp"
#include "leaves.hpp"
#include "library.hpp"
#include "loop_lines.hpp"
#include "output.hpp"
#include "potential.hpp"
#include "read_loops.hpp"
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

Owned<hmf_hierarchy> build(const TriangleMesh& mesh, const hmf_build_options& options, const hmf_control& control,
                           const std::string& name) {
    return make<hmf_hierarchy>(name, [&](hmf_hierarchy** out, hmf_error* error) {
        return hmf_build(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                         &options, &control, out, error);
    });
}

// HMF_LOOPS_* of a name, 0 for the name of a file.
int32_t loop_kind(const std::string& name) {
    if (name == "cut") return HMF_LOOPS_CUT;
    if (name == "handle") return HMF_LOOPS_HANDLE;
    if (name == "tunnel") return HMF_LOOPS_TUNNEL;
    if (name == "pants") return HMF_LOOPS_PANTS;
    return 0;
}

Owned<hmf_loop_set> library_loops(const hmf_hierarchy* hierarchy, size_t level, int32_t kind,
                                  const hmf_control* control, const std::string& name) {
    return make<hmf_loop_set>(name, [&](hmf_loop_set** out, hmf_error* error) {
        return hmf_loops(hierarchy, level, kind, control, out, error);
    });
}

const char* method_name(int32_t method) {
    switch (method) {
    case HMF_METHOD_NEWTON: return "newton";
    case HMF_METHOD_WHITEHEAD: return "whitehead";
    case HMF_METHOD_SINGLE_LEVEL: return "single-level";
    default: return "default";
    }
}

// Everything that the pictures need, in the numbering of level 0.
Foliation collect(const hmf_hierarchy* hierarchy, const TriangleMesh& mesh, const hmf_foliation* result,
                  std::vector<double> loop_weights, const std::string& name) {
    Foliation f;
    hmf_error error{};
    size_t count = 0;
    const double* values = hmf_foliation_values(result, &count);
    f.values.assign(values, values + count);
    f.positions = mesh.positions;
    f.triangles.resize(mesh.triangles.size());
    f.triangle_edges.resize(mesh.triangles.size());
    f.edge_vertices.resize(2 * count);
    check(hmf_level_triangle_vertices(hierarchy, 0, f.triangles.data(), f.triangles.size(), &error), error, name);
    check(hmf_level_triangle_edges(hierarchy, 0, f.triangle_edges.data(), f.triangle_edges.size(), &error), error,
          name);
    check(hmf_level_edge_vertices(hierarchy, 0, f.edge_vertices.data(), f.edge_vertices.size(), &error), error, name);
    f.loop_weights = std::move(loop_weights);
    const auto singular = make<hmf_singularity_set>(
        name, [&](hmf_singularity_set** out, hmf_error* e) { return hmf_singularities(result, nullptr, out, e); });
    f.singular.assign(singular->list, singular->list + singular->count);
    return f;
}

} // namespace

int solve(const TriangleMesh& mesh, double read_seconds, const SolveRequest& request) {
    const std::string& name = request.mesh_name;
    const Clock::time_point start = Clock::now();
    const int32_t kind = loop_kind(request.loops);
    const bool own_loops = kind == 0, has_start = !request.start.empty();
    LoopList read;
    if (own_loops) read = read_loops(request.loops, mesh.vertex_count(), mesh.triangle_count());
    for (const std::string& path : request.values) check_writable(path);
    for (const std::string& path :
         {request.report, request.history, request.image, request.leaves, request.quads, request.obj})
        if (!path.empty()) check_writable(path);

    InterruptGuard guard;
    Progress progress("build");
    Meter meter;
    Summary summary;

    hmf_control control = {};
    control.struct_size = sizeof control;
    control.progress = Progress::callback;
    control.progress_user = &progress;
    hmf_build_options build_options = {};
    build_options.struct_size = sizeof build_options;
    build_options.ratio = request.ratio;
    build_options.mollify = request.mollify;
    build_options.coarsest = request.coarsest;
    build_options.collapse = request.collapse;
    build_options.allocate = Meter::allocate;
    build_options.release = Meter::release;
    build_options.allocator_user = &meter;
    progress.part("build", 0, 0.35);
    const Clock::time_point build_start = Clock::now();
    const Owned<hmf_hierarchy> hierarchy = build(mesh, build_options, control, name);
    summary.build_seconds = seconds_since(build_start);

    const size_t level_count = hmf_level_count(hierarchy.get());
    // Loops of the caller are drawn on the input mesh, and the single-level
    // method knows no other; the library's own are cheapest where it is coarse.
    const size_t loop_level = own_loops || request.method == HMF_METHOD_SINGLE_LEVEL ? 0 : level_count - 1;
    const Clock::time_point loops_start = Clock::now();
    Owned<hmf_loop_set> made;
    if (!own_loops && !has_start) made = library_loops(hierarchy.get(), loop_level, kind, &control, name);
    hmf_loop_set loops = made ? *made : read.view();
    summary.loops_seconds = seconds_since(loops_start);

    std::vector<double> weights = request.loop_weights;
    // Without loops the weights are for the pictures only.
    if (weights.empty()) weights.assign(has_start ? 1 : loops.count, 1.0);
    if (weights.size() != loops.count && !has_start)
        throw Failure(EXIT_USAGE, "--weights: " + std::to_string(weights.size()) + " weights for "
                                      + std::to_string(loops.count) + " loops; give one weight per loop");
    loops.weights = weights.data();

    hmf_level_info finest{};
    hmf_error error{};
    check(hmf_level_counts(hierarchy.get(), 0, &finest, &error), error, name);
    hmf_solve_options options = {};
    options.struct_size = sizeof options;
    options.method = request.method;
    options.tolerance = request.tolerance;
    options.time_limit = request.time_limit;
    Owned<hmf_foliation> begin;
    if (has_start) {
        std::vector<uint32_t> edge_vertices(2 * finest.edge_count);
        check(hmf_level_edge_vertices(hierarchy.get(), 0, edge_vertices.data(), edge_vertices.size(), &error), error,
              name);
        const std::vector<double> values = read_values(request.start, edge_vertices);
        begin = make<hmf_foliation>(request.start, [&](hmf_foliation** out, hmf_error* e) {
            return hmf_foliation_create(hierarchy.get(), 0, values.data(), values.size(), &control, out, e);
        });
        options.start = begin.get();
    }
    progress.part("solve", 0.35, 1);
    hmf_foliation* raw = nullptr;
    const hmf_status status =
        hmf_solve(hierarchy.get(), has_start ? nullptr : &loops, &options, &control, &raw, &error);
    const Owned<hmf_foliation> result(raw);
    progress.clear();
    if (status >= HMF_ERROR_NULL) {
        if (own_loops && error.status == status && error.element == HMF_ELEMENT_LOOP && error.index < read.lines.size())
            fail_with(status, error, request.loops + ":" + std::to_string(read.lines[error.index]));
        fail_with(status, error,
                  has_start && status >= HMF_ERROR_VALUE_NOT_FINITE && status < 600 ? request.start : name);
    }
    const hmf_report* const told = hmf_foliation_report(result.get());
    if (!told) throw Failure(EXIT_LIMIT, name + ": cancelled before there was a result");
    const hmf_report& report = *told;
    const Foliation foliation = collect(hierarchy.get(), mesh, result.get(), weights, name);
    summary.report = told;
    summary.vertices = finest.vertex_count;
    summary.edges = finest.edge_count;
    summary.triangles = finest.triangle_count;
    summary.genus = hmf_genus(hierarchy.get());
    summary.loops = loops.count;
    summary.method = method_name(report.method);
    summary.peak_memory_bytes = meter.peak;
    summary.total_seconds = read_seconds + seconds_since(start);

    for (const std::string& path : request.values)
        if (extension_of(path) == ".npy") write_values_npy(path, foliation.values);
        else write_values_csv(path, foliation);
    if (!request.history.empty()) write_history(request.history, report);
    Owned<hmf_cylinder_set> cylinders;
    if (!request.leaves.empty() && status == HMF_OK)
        cylinders = make<hmf_cylinder_set>(name, [&](hmf_cylinder_set** out, hmf_error* e) {
            return hmf_cylinders(result.get(), has_start ? nullptr : &loops, nullptr, out, e);
        });
    summary.cylinders = cylinders.get();
    if (!request.quads.empty())
        summary.quads = write_quads(request.quads, result.get(), request.quad_size, nullptr, name);
    const double spacing =
        request.leaf_spacing > 0 ? request.leaf_spacing : 0.1 * *std::min_element(weights.begin(), weights.end());
    if (!request.leaves.empty())
        summary.leaves = write_leaves(request.leaves, result.get(), spacing, request.conjugate, nullptr, name);
    const Potential potential = request.image.empty() && request.obj.empty() ? Potential{} : local_potential(foliation);
    // Asked for, or for the report, which tells how conformal the result is.
    const bool asked = request.checkerboard || !request.obj.empty();
    Owned<hmf_parameterization> parameterization;
    std::exception_ptr no_parameterization;
    if (asked
        || (!request.report.empty() && status == HMF_OK && request.method != HMF_METHOD_WHITEHEAD
            && request.method != HMF_METHOD_SINGLE_LEVEL)) {
        progress.part("unfold", 0, 1);
        try {
            parameterization = make<hmf_parameterization>(name, [&](hmf_parameterization** out, hmf_error* e) {
                return hmf_parameterize(result.get(), nullptr, &control, out, e);
            });
            summary.parameterization = parameterization.get();
        } catch (const Failure&) {
            // The other results come first.
            if (asked) no_parameterization = std::current_exception();
        }
        progress.clear();
    }
    if (!request.obj.empty() && parameterization)
        write_textured_obj(request.obj, foliation, *parameterization, pattern_period(foliation, potential));
    if (!request.image.empty()) {
        const Owned<hmf_loop_set> fine =
            loop_level == 0 ? nullptr : library_loops(hierarchy.get(), 0, kind, nullptr, name);
        write_png(request.image, render(foliation, potential, request.checkerboard ? parameterization.get() : nullptr,
                                        loop_lines(foliation, fine ? *fine : loops)));
    }
    if (!request.report.empty()) write_report(request.report, summary);

    std::printf("%s: genus %zu, %zu edges, %zu loops, energy %.10g, residual %.2g, %llu zeros, %llu poles, %.2f s\n",
                name.c_str(), summary.genus, summary.edges, summary.loops, report.energy, report.residual_max,
                static_cast<unsigned long long>(report.zeros), static_cast<unsigned long long>(report.poles),
                summary.total_seconds);
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
    hmf_build_options options = {};
    options.struct_size = sizeof options;
    // Validation only: one level.
    options.coarsest = mesh.vertex_count();
    hmf_control control = {};
    control.struct_size = sizeof control;
    control.progress = Progress::callback;
    control.progress_user = &progress;
    hmf_hierarchy* raw = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_build(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                        mesh.triangle_count(), &options, &control, &raw, &error);
    const Owned<hmf_hierarchy> hierarchy(raw);
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
