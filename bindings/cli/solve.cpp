#include "solve.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <new>

#include "leaves.hpp"
#include "library.hpp"
#include "loop_lines.hpp"
#include "marks.hpp"
#include "output.hpp"
#include "potential.hpp"
#include "progress.hpp"
#include "read_loops.hpp"
#include "read_mesh.hpp"
#include "read_values.hpp"
#include "render.hpp"
#include "write_results.hpp"

namespace cli {

namespace {

using readers::Json;

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

// HMF_LOOPS_* of a name, 0 for the name of a file.
int32_t loop_kind(const std::string& name) {
    if (name == "cut") return HMF_LOOPS_CUT;
    if (name == "handle") return HMF_LOOPS_HANDLE;
    if (name == "tunnel") return HMF_LOOPS_TUNNEL;
    if (name == "pants") return HMF_LOOPS_PANTS;
    return 0;
}

const char* method_name(int32_t method) {
    switch (method) {
    case HMF_METHOD_NEWTON: return "newton";
    case HMF_METHOD_WHITEHEAD: return "whitehead";
    case HMF_METHOD_SINGLE_LEVEL: return "single-level";
    default: return "default";
    }
}

const char* class_name(int32_t state) {
    switch (state) {
    case HMF_CLASS_PROVEN: return "proven";
    case HMF_CLASS_CHECKED: return "checked";
    case HMF_CLASS_LOST: return "lost";
    default: return "unknown";
    }
}

// Whether the result is as close to the minimum as it says, whatever the method measures on the way.
bool is_converged(const hmf_report& report, double tolerance) {
    const double residual = report.method == HMF_METHOD_NEWTON ? tolerance : 1e-8;
    return report.converged != 0 && report.residual_max >= 0 && report.residual_max <= residual;
}

// One run, from the files it reads to the files it writes.
class Run {
public:
    Run(SolveRequest& request, const Options& options) : r_(request), options_(options) {}

    Outcome go() {
        read();
        build();
        choose_loops();
        solve();
        describe();
        write();
        report();
        return std::move(outcome_);
    }

private:
    void read() {
        mesh_ = read_mesh(r_.mesh);
        if (r_.marks != "auto" && r_.marks != "none") marks_ = read_marks(r_.marks, mesh_.vertex_count());
        if (kind_ != 0 || has_start_) return;
        try {
            read_ = read_loops(r_.loops, mesh_.vertex_count(), mesh_.triangle_count());
        } catch (const Failure& failure) {
            if (failure.exit_status != EXIT_RESOURCES) throw;
            throw Failure(EXIT_RESOURCES, "--loops: neither a kind of loops nor a file that can be read has the name \""
                                              + r_.loops + "\"; the kinds are cut, handle, tunnel and pants");
        }
    }

    void build() {
        for (const std::string& path : outputs_of(options_)) {
            check_writable(path);
            outcome_.uses_stdout = outcome_.uses_stdout || path == "-";
        }
        hmf_build_options options = {};
        options.struct_size = sizeof options;
        options.ratio = r_.ratio;
        options.mollify = r_.mollify;
        options.coarsest = r_.coarsest;
        options.collapse = r_.collapse;
        options.allocate = Meter::allocate;
        options.release = Meter::release;
        options.allocator_user = &meter_;
        const Clock::time_point start = Clock::now();
        if (r_.marks == "auto") marks_ = suggested_marks(mesh_, options, progress_.part("marks", 0, 0.05), name_);
        options.marked_vertices = marks_.data();
        options.marked_count = marks_.size();
        const hmf_control* const control = progress_.part("build", 0.05, 0.35);
        hierarchy_ = make<hmf_hierarchy>(name_, [&](hmf_hierarchy** out, hmf_error* error) {
            return hmf_build(mesh_.positions.data(), mesh_.vertex_count(), mesh_.triangles.data(),
                             mesh_.triangle_count(), &options, control, out, error);
        });
        build_seconds_ = seconds_since(start);
        hmf_error error{};
        check(hmf_level_counts(hierarchy_.get(), 0, &finest_, &error), error, name_);
        r_.coarsest = std::max<uint64_t>(r_.coarsest, 40 * hmf_genus(hierarchy_.get()) + 10 * marks_.size());
    }

    void choose_loops() {
        // Loops of the caller are drawn on the input mesh, and the single-level method knows no other; the library's
        // own are cheapest where it is coarse.
        const bool fine = kind_ == 0 || r_.method == HMF_METHOD_SINGLE_LEVEL;
        const Clock::time_point start = Clock::now();
        if (!has_start_ && kind_ == 0) loops_ = read_.view();
        else if (!has_start_) {
            made_ = library_loops(fine ? 0 : hmf_level_count(hierarchy_.get()) - 1);
            loops_ = *made_;
        }
        loops_seconds_ = seconds_since(start);
        weights_given_ = !r_.weights.empty();
        // Without loops the weights are for the pictures only.
        if (!weights_given_) r_.weights.assign(has_start_ ? 1 : loops_.count, 1.0);
        if (r_.weights.size() != loops_.count && !has_start_)
            throw Failure(EXIT_USAGE, "--weights: " + std::to_string(r_.weights.size()) + " weights for "
                                          + std::to_string(loops_.count) + " loops; give one weight per loop");
        loops_.weights = r_.weights.data();
    }

    Owned<hmf_loop_set> library_loops(size_t level) {
        return make<hmf_loop_set>(name_, [&](hmf_loop_set** out, hmf_error* error) {
            return hmf_loops(hierarchy_.get(), level, kind_, control_, out, error);
        });
    }

    // The loops on the input mesh.
    const hmf_loop_set& fine_loops() {
        if (loops_.level == 0) return loops_;
        if (!fine_loops_) fine_loops_ = library_loops(0);
        return *fine_loops_;
    }

    Owned<hmf_foliation> start_values() {
        std::vector<uint32_t> ends(2 * finest_.edge_count);
        hmf_error error{};
        check(hmf_level_edge_vertices(hierarchy_.get(), 0, ends.data(), ends.size(), &error), error, name_);
        const std::vector<double> values = read_values(r_.start, ends);
        return make<hmf_foliation>(shown(r_.start), [&](hmf_foliation** out, hmf_error* e) {
            return hmf_foliation_create(hierarchy_.get(), 0, values.data(), values.size(), control_, out, e);
        });
    }

    void solve() {
        hmf_solve_options options = {};
        options.struct_size = sizeof options;
        options.method = r_.method;
        options.tolerance = r_.tolerance;
        options.time_limit = r_.time_limit;
        Owned<hmf_foliation> start;
        if (has_start_) start = start_values();
        options.start = start.get();
        const hmf_control* const control = progress_.part("solve", 0.35, 1);
        hmf_foliation* raw = nullptr;
        hmf_error error{};
        status_ = hmf_solve(hierarchy_.get(), has_start_ ? nullptr : &loops_, &options, control, &raw, &error);
        foliation_.reset(raw);
        progress_.clear();
        const bool of_loop =
            error.status == status_ && error.element == HMF_ELEMENT_LOOP && error.index < read_.lines.size();
        if (status_ >= HMF_ERROR_NULL) {
            if (of_loop) fail_with(status_, error, loop_name(error.index));
            fail_with(status_, error, has_start_ && status_ >= 500 && status_ < 600 ? shown(r_.start) : name_);
        }
        report_ = hmf_foliation_report(foliation_.get());
        if (!report_) fail_with(HMF_CANCELLED, error, name_);
        r_.method = report_->method;
        if (r_.tolerance == 0) r_.tolerance = r_.method == HMF_METHOD_NEWTON ? 1e-8 : 1e-6;
        if (status_ == HMF_OK) return;
        progress_.finish_quietly();
        outcome_.exit_status = EXIT_LIMIT;
        const bool written = !outputs_of(options_).empty();
        outcome_.errors.push_back(
            (of_loop ? loop_name(error.index) : name_) + ": " + limit_sentence(status_, error)
            + (report_->class_state == HMF_CLASS_LOST ? "; it is not in the class of the loops" : "")
            + (written ? "; the best foliation so far was written"
                       : "; the numbers are those of the best foliation so far"));
    }

    std::string loop_name(uint64_t loop) const { return shown(r_.loops) + ":" + std::to_string(read_.lines[loop]); }

    // Everything that the files need, in the numbering of level 0.
    void describe() {
        hmf_error error{};
        size_t count = 0;
        const double* const values = hmf_foliation_values(foliation_.get(), &count);
        f_.values.assign(values, values + count);
        f_.triangles.resize(3 * finest_.triangle_count);
        f_.triangle_edges.resize(3 * finest_.triangle_count);
        f_.edge_vertices.resize(2 * count);
        const hmf_hierarchy* const h = hierarchy_.get();
        check(hmf_level_triangle_vertices(h, 0, f_.triangles.data(), f_.triangles.size(), &error), error, name_);
        check(hmf_level_triangle_edges(h, 0, f_.triangle_edges.data(), f_.triangle_edges.size(), &error), error, name_);
        check(hmf_level_edge_vertices(h, 0, f_.edge_vertices.data(), f_.edge_vertices.size(), &error), error, name_);
        const auto singular = make<hmf_singularity_set>(name_, [&](hmf_singularity_set** out, hmf_error* e) {
            return hmf_singularities(foliation_.get(), nullptr, out, e);
        });
        f_.singular.assign(singular->list, singular->list + singular->count);
        f_.positions = std::move(mesh_.positions);
    }

    // An output that fails does not take the others with it.
    template <class Work>
    void attempt(const char* option, bool wanted, const Work& work) {
        if (!wanted) return;
        ExitStatus status = EXIT_RESOURCES;
        try {
            work();
            return;
        } catch (const Failure& failure) {
            // The command was right: only this mesh shows that it cannot be.
            status = failure.exit_status == EXIT_USAGE ? EXIT_BAD_INPUT : failure.exit_status;
            outcome_.errors.push_back(std::string(option) + ": " + failure.what());
            if (was_interrupted()) progress_.finish_quietly(); // only the output that was being made is given up
        } catch (const std::bad_alloc&) { outcome_.errors.push_back(std::string(option) + ": out of memory"); }
        if (outcome_.exit_status == EXIT_SOLVED || outcome_.exit_status == EXIT_LIMIT) outcome_.exit_status = status;
    }

    void find_cylinders() {
        cylinders_ = make<hmf_cylinder_set>(name_, [&](hmf_cylinder_set** out, hmf_error* error) {
            return hmf_cylinders(foliation_.get(), has_start_ ? nullptr : &loops_, control_, out, error);
        });
    }

    void write() {
        for (const std::string& path : r_.values)
            attempt("--values", true, [&] {
                if (extension_of(path) == ".npy") write_values_npy(path, f_.values);
                else write_values_csv(path, f_);
            });
        attempt("--history", !r_.history.empty(), [&] { write_history(r_.history, *report_); });
        attempt("--save-marks", !r_.save_marks.empty(), [&] { write_marks(r_.save_marks, marks_); });
        attempt("--save-loops", !r_.save_loops.empty(), [&] { write_loops(r_.save_loops, fine_loops(), r_.weights); });
        control_ = progress_.part("leaves", 0, 1);
        const bool pictured = !r_.image.empty() || !r_.obj.empty();
        attempt("--leaves", !r_.leaves.empty() && status_ == HMF_OK, [&] { find_cylinders(); });
        if (has_start_ && !weights_given_ && (pictured || !r_.leaves.empty()) && status_ == HMF_OK) {
            // The class of the values has its own weights.  Where they cannot be found stripes may not match.
            try {
                if (!cylinders_) find_cylinders();
                for (uint64_t k = 0; k < cylinders_->count; ++k) {
                    if (k == 0) r_.weights.clear();
                    r_.weights.push_back(cylinders_->list[k].height);
                }
            } catch (const Failure&) {}
        }
        f_.loop_weights = r_.weights;
        if (r_.spacing == 0 && !r_.leaves.empty())
            r_.spacing = 0.1 * *std::min_element(r_.weights.begin(), r_.weights.end());
        attempt("--quads", !r_.quads.empty(),
                [&] { quads_ = write_quads(r_.quads, foliation_.get(), r_.size, control_, name_); });
        attempt("--leaves", !r_.leaves.empty(), [&] {
            leaves_ = write_leaves(r_.leaves, foliation_.get(), r_.spacing, r_.conjugate, control_, name_);
        });
        const Potential potential = pictured ? local_potential(f_) : Potential{};
        const char* const asking = !r_.obj.empty() ? "--obj" : r_.checkerboard ? "--pattern" : "--conformality";
        attempt(asking, r_.checkerboard || !r_.obj.empty() || r_.conformality, [&] {
            control_ = progress_.part("unfold", 0, 1);
            parameterization_ = make<hmf_parameterization>(name_, [&](hmf_parameterization** out, hmf_error* error) {
                return hmf_parameterize(foliation_.get(), nullptr, control_, out, error);
            });
        });
        attempt("--obj", !r_.obj.empty() && parameterization_,
                [&] { write_textured_obj(r_.obj, f_, *parameterization_, pattern_period(f_, potential)); });
        attempt("--image", !r_.image.empty(), [&] {
            std::vector<Line> lines;
            if (!has_start_) lines = loop_lines(f_, fine_loops());
            write_png(r_.image, render(f_, potential, r_.checkerboard ? parameterization_.get() : nullptr, lines));
        });
        progress_.clear();
    }

    void report() {
        const double seconds = seconds_since(begin_);
        const hmf_report& r = *report_;
        if (!r_.report.empty()) {
            const Json json = report_json(seconds);
            attempt("--report", true, [&] { write_report(r_.report, json); });
        }
        char line[300];
        std::snprintf(line, sizeof line,
                      ": genus %zu, %llu edges, %llu loops, energy %.10g, residual %.2g, class %s, %llu zeros, "
                      "%llu poles, %.2f s",
                      hmf_genus(hierarchy_.get()), static_cast<unsigned long long>(finest_.edge_count),
                      static_cast<unsigned long long>(loops_.count), r.energy, r.residual_max,
                      class_name(r.class_state), static_cast<unsigned long long>(r.zeros),
                      static_cast<unsigned long long>(r.poles), seconds);
        outcome_.summary = name_ + line;
        if (r_.marks == "auto" && !marks_.empty()) outcome_.summary += "\n" + sentence_of(marks_);
    }

    Json report_json(double seconds) const {
        const hmf_report& r = *report_;
        Json::Array levels, singular;
        for (uint64_t k = 0; k < r.level_count; ++k) {
            const hmf_level_report& level = r.levels[k];
            levels.push_back(Json{{"vertices", level.vertices},
                                  {"edges", level.edges},
                                  {"nld", level.raised_count},
                                  {"raised_count", level.raised_count},
                                  {"iterations", level.iterations},
                                  {"linear_solves", level.linear_solves},
                                  {"optimize_seconds", level.optimize_seconds},
                                  {"interpolate_seconds", level.interpolate_seconds}});
        }
        static const char* const kinds[] = {"", "vertex", "triangle", "cluster"};
        for (const hmf_singularity& s : f_.singular)
            singular.push_back(Json{{"kind", kinds[s.kind & 3]},
                                    {"index", s.index},
                                    {"element", s.element},
                                    {"size", s.size},
                                    {"position", std::vector<double>(s.position, s.position + 3)}});
        Json report = {{"version", version_text()},
                       {"input", r_.mesh},
                       {"options", values_of(options_)},
                       {"exit_status", static_cast<int>(outcome_.exit_status)},
                       {"errors", outcome_.errors},
                       {"mesh", Json{{"vertices", finest_.vertex_count},
                                     {"edges", finest_.edge_count},
                                     {"triangles", finest_.triangle_count},
                                     {"genus", hmf_genus(hierarchy_.get())},
                                     {"marked", marks_.size()}}},
                       {"method", method_name(r.method)},
                       {"levels", levels},
                       {"loops", loops_.count},
                       {"build_seconds", build_seconds_},
                       {"loops_seconds", loops_seconds_},
                       {"solve_seconds", r.solve_seconds},
                       {"total_seconds", seconds},
                       {"cpu_seconds", double(std::clock()) / CLOCKS_PER_SEC},
                       {"energy", r.energy},
                       {"residual_max", r.residual_max},
                       {"residual_mean", r.residual_mean},
                       {"poles", r.poles},
                       {"zeros", r.zeros},
                       {"index_sum", r.index_sum},
                       {"singularities", singular},
                       {"bad_flips", r.bad_flips},
                       {"bad_flips_left", r.bad_flips_left},
                       {"converged", is_converged(r, r_.tolerance)},
                       {"class", class_name(r.class_state)},
                       {"class_repeats", r.class_repeats},
                       {"class_seconds", r.class_seconds},
                       {"peak_memory_bytes", meter_.peak}};
        if (parameterization_) {
            const hmf_parameterization& p = *parameterization_;
            report.set("dilatation_mean", p.dilatation_mean);
            report.set("dilatation_median", p.dilatation_median);
            // Not finite where more than a hundredth of the area is degenerate.
            report.set("dilatation_p99", std::isfinite(p.dilatation_p99) ? Json(p.dilatation_p99) : Json());
            report.set("flipped_triangles", p.flipped_triangles);
            report.set("degenerate_triangles", p.degenerate_triangles);
            report.set("seam_edges", p.seam_edge_count);
            report.set("seam_length", p.seam_length);
            report.set("parameterize_seconds", p.seconds);
        }
        if (leaves_ > 0) {
            Json::Array cylinders;
            for (uint64_t k = 0; cylinders_ && k < cylinders_->count; ++k) {
                const hmf_cylinder& c = cylinders_->list[k];
                cylinders.push_back(Json{{"loop", c.loop == HMF_NONE ? Json() : Json(c.loop)},
                                         {"height", c.height},
                                         {"circumference", c.circumference},
                                         {"modulus", c.modulus},
                                         {"area", c.area}});
            }
            report.set("leaves", leaves_);
            report.set("cylinders", cylinders);
        }
        if (quads_ > 0) report.set("quads", quads_);
        return report;
    }

    SolveRequest& r_;
    const Options& options_;
    const Clock::time_point begin_ = Clock::now();
    const std::string name_ = shown(r_.mesh);
    const bool has_start_ = !r_.start.empty();
    const int32_t kind_ = loop_kind(r_.loops);
    Outcome outcome_;
    Progress progress_;
    const hmf_control* control_ = nullptr;
    Meter meter_; // lives longer than all that the library made
    TriangleMesh mesh_;
    LoopList read_; // loops of the caller
    std::vector<uint32_t> marks_;
    Owned<hmf_hierarchy> hierarchy_;
    hmf_level_info finest_{};
    Owned<hmf_loop_set> made_, fine_loops_;
    hmf_loop_set loops_{}; // those that were used
    bool weights_given_ = false;
    double build_seconds_ = 0, loops_seconds_ = 0;
    hmf_status status_ = HMF_OK;
    Owned<hmf_foliation> foliation_;
    const hmf_report* report_ = nullptr;
    Foliation f_;
    Owned<hmf_cylinder_set> cylinders_;
    Owned<hmf_parameterization> parameterization_;
    size_t leaves_ = 0, quads_ = 0; // written
};

} // namespace

std::string version_text() {
    const uint32_t version = hmf_version();
    return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "."
         + std::to_string(version % 100);
}

Outcome solve(const std::vector<std::string>& words) {
    SolveRequest request;
    Options options = solve_options(request);
    parse(options, words, "solve");
    if (!request.start.empty()) request.loops.clear();
    if (!request.start.empty() && !request.weights.empty() && request.image.empty() && request.obj.empty()
        && request.leaves.empty())
        throw Failure(EXIT_USAGE, "--weights: has no effect with --start, whose values have their own; leave it out");
    return Run(request, options).go();
}

} // namespace cli
