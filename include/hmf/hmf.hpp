/*
 * hmf.hpp - the C interface hmf.h as C++17 classes, header only
 *
 *     const hmf::Hierarchy hierarchy(positions, triangles);
 *     const hmf::Solution solution = hierarchy.solve();
 *     solution.foliation.values();           // one value per edge
 *     solution.foliation.zeros_and_poles();
 *
 * hmf.h is the manual; here is only what differs.
 *
 *   errors    A failing call throws hmf::Error with the status, the element
 *             and the sentence of hmf_error.  Limits are no failure: see
 *             Solution::status.  std::bad_alloc comes from the vectors only.
 *   arrays    In: Span, a pointer with a size, made from vectors, arrays and
 *             the like, also of std::array<T, N>.  Out: flat std::vector.
 *   handles   Hierarchy and Foliation can be moved, not copied.  A foliation
 *             keeps its hierarchy alive.  What has been moved from can be
 *             destroyed or assigned to; its calls throw HMF_ERROR_NULL.
 *   threads   As in C: any number of threads may use a const Hierarchy or
 *             Foliation.
 *   progress  An exception of the progress function cancels the call, and is
 *             thrown again once the call has ended.
 */
#ifndef HMF_HMF_HPP
#define HMF_HMF_HPP

#include <hmf/hmf.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace hmf {
// Keeps these names apart from those inside a static library.
inline namespace cpp {

/* ------------------------------------------------------------------------
 * Errors
 * --------------------------------------------------------------------- */

/* What a failing call says; what() is what is wrong and what to do. */
class Error : public std::runtime_error {
public:
    Error(hmf_status status, int32_t element, uint64_t index, const std::string& message) :
        std::runtime_error(message), index_(index), status_(status), element_(element) {}
    explicit Error(const hmf_error& error) : Error(error.status, error.element, error.index, error.message) {}

    hmf_status status() const noexcept { return status_; }
    int32_t element() const noexcept { return element_; } /* HMF_ELEMENT_* */
    uint64_t index() const noexcept { return index_; }    /* of the element */

private:
    uint64_t index_;
    hmf_status status_;
    int32_t element_;
};

/* ------------------------------------------------------------------------
 * Arrays and options
 * --------------------------------------------------------------------- */

/* A borrowed array of T: a pointer and a number of elements. */
template <class T>
class Span {
    template <class E>
    struct Flat : std::false_type {};
    template <std::size_t N>
    struct Flat<std::array<T, N>> : std::bool_constant<sizeof(std::array<T, N>) == N * sizeof(T)> {};
    template <class Container>
    using Element = std::remove_cv_t<std::remove_pointer_t<decltype(std::declval<const Container&>().data())>>;

public:
    Span() = default;
    explicit Span(const T* data, std::size_t size) : data_(data), size_(size) {}
    template <std::size_t N>
    Span(const T (&array)[N]) : data_(array), size_(N) {}
    /* Containers with data() and size(), of T or of std::array<T, N>. */
    template <class Container, class E = Element<Container>,
              std::enable_if_t<std::is_same_v<E, T> || Flat<E>::value, int> = 0>
    Span(const Container& container) :
        data_(reinterpret_cast<const T*>(container.data())), size_(container.size() * (sizeof(E) / sizeof(T))) {}

    const T* data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }
    const T* begin() const noexcept { return data_; }
    const T* end() const noexcept { return data_ + size_; }
    const T& operator[](std::size_t i) const { return data_[i]; }

private:
    const T* data_ = nullptr;
    std::size_t size_ = 0;
};

/* Answer of a progress function. */
enum class Progress : int32_t {
    proceed = HMF_PROGRESS_CONTINUE,
    cancel = HMF_PROGRESS_CANCEL,
    finish = HMF_PROGRESS_FINISH, /* give the foliation that there is */
};

/* Called on the calling thread with a fraction that rises from 0 to 1. */
using ProgressFunction = std::function<Progress(double)>;

enum class Collapse : int32_t {
    automatic = HMF_COLLAPSE_DEFAULT,
    midpoint = HMF_COLLAPSE_MIDPOINT,
    endpoint = HMF_COLLAPSE_ENDPOINT,
    qslim = HMF_COLLAPSE_QSLIM,
};

enum class Method : int32_t {
    automatic = HMF_METHOD_DEFAULT,
    newton = HMF_METHOD_NEWTON,
    whitehead = HMF_METHOD_WHITEHEAD,
    single_level = HMF_METHOD_SINGLE_LEVEL,
};

enum class LoopElements : int32_t { triangles = HMF_LOOP_TRIANGLES, vertices = HMF_LOOP_VERTICES };

enum class LoopsKind : int32_t {
    cut = HMF_LOOPS_CUT,
    handle = HMF_LOOPS_HANDLE,
    tunnel = HMF_LOOPS_TUNNEL,
    pants = HMF_LOOPS_PANTS
};

/* hmf_build_options; zero means the default. */
struct BuildOptions {
    Collapse collapse = Collapse::automatic;
    double ratio = 0;
    uint64_t coarsest = 0;
    uint64_t memory_limit = 0;
    hmf_allocate_fn allocate = nullptr; /* must outlive the hierarchy and its foliations */
    hmf_release_fn release = nullptr;
    void* allocator_user = nullptr;
    ProgressFunction progress;
    double mollify = 0;
    Span<uint32_t> marked_vertices; /* borrowed until the call ends */
};

/* hmf_solve_options; zero means the default. */
struct SolveOptions {
    Method method = Method::automatic;
    double tolerance = 0;
    double time_limit = 0; /* seconds */
    uint64_t iteration_limit = 0;
    std::size_t stop_level = 0;
    std::size_t history_capacity = 4096; /* most entries of Report::history */
    Span<double> initial_values;         /* borrowed until the call ends */
    std::size_t initial_level = 0;
    ProgressFunction progress;
};

enum class LeavesKind : int32_t {
    automatic = HMF_LEAVES_DEFAULT,
    foliation = HMF_LEAVES_FOLIATION,
    conjugate = HMF_LEAVES_CONJUGATE,
};

/* hmf_trace_options; zero means the default. */
struct TraceOptions {
    bool critical = false;
    double spacing = 0;
    double length_limit = 0;
    std::vector<uint32_t> point_triangles;  /* point_count */
    std::vector<double> point_barycentrics; /* point_count x 3 */
    LeavesKind leaves = LeavesKind::automatic;
};

/* hmf_parameterize_options; zero means the default. */
struct ParameterizeOptions {
    double tolerance = 0;
    std::vector<uint32_t> seam_edges; /* where seams cost nothing */
    ProgressFunction progress;
};

/* Closed curves on a level, with weights: hmf_loop_set with its own arrays. */
struct Loops {
    std::size_t level = 0;
    LoopElements kind = LoopElements::vertices;
    std::vector<uint64_t> offsets = {0}; /* size() + 1; loop c is elements[offsets[c]] .. elements[offsets[c+1]-1] */
    std::vector<uint32_t> elements;
    std::vector<double> weights; /* size() */

    std::size_t size() const noexcept { return offsets.empty() ? 0 : offsets.size() - 1; }
    Span<uint32_t> operator[](std::size_t loop) const {
        return Span<uint32_t>(elements.data() + offsets[loop],
                              static_cast<std::size_t>(offsets[loop + 1] - offsets[loop]));
    }
    void add(Span<uint32_t> loop, double weight = 1) {
        elements.insert(elements.end(), loop.begin(), loop.end());
        offsets.push_back(elements.size());
        weights.push_back(weight);
    }
    void add(std::initializer_list<uint32_t> loop, double weight = 1) {
        add(Span<uint32_t>(loop.begin(), loop.size()), weight);
    }
};

/* ------------------------------------------------------------------------
 * Results
 * --------------------------------------------------------------------- */

using LevelInfo = hmf_level_info;
using LevelReport = hmf_level_report;
using HistoryEntry = hmf_history_entry;
using Singularity = hmf_singularity;
using Line = hmf_line;
using Cylinder = hmf_cylinder;

/* hmf_report with its own arrays. */
struct Report {
    Method method = Method::automatic;
    bool converged = false;
    double energy = 0;
    double residual_max = 0;
    double residual_mean = 0;
    uint64_t poles = 0;
    uint64_t zeros = 0;
    int64_t index_sum = 0;
    uint64_t bad_flips = 0;
    uint64_t bad_flips_left = 0;
    double solve_seconds = 0;
    uint64_t peak_memory_bytes = 0;
    std::vector<LevelReport> levels;   /* finest first */
    std::vector<HistoryEntry> history; /* in order of time, at most SolveOptions::history_capacity */
    uint64_t history_count = 0;        /* also of those that history has no room for */
};

/* Outputs of hmf_singularities. */
struct Singularities {
    std::vector<int32_t> vertex_index;    /* vertex_count */
    std::vector<int32_t> triangle_index;  /* triangle_count */
    std::vector<uint32_t> vertex_cluster; /* vertex_count */
    std::vector<Singularity> list;
};

/* Outputs of hmf_trace. */
struct Leaves {
    std::vector<Line> lines;           /* line_count */
    std::vector<uint64_t> offsets;     /* line_count + 1; line k has the points offsets[k] .. offsets[k+1]-1 */
    std::vector<double> points;        /* point_count x 3 */
    std::vector<uint32_t> point_edges; /* point_count, or HMF_NONE */
};

/* Outputs of hmf_cylinders. */
struct Cylinders {
    std::vector<Cylinder> list;
    Loops leaves; /* the leaf in the middle of each as a triangle loop, weights: the heights */
};

/* Outputs of hmf_quads. */
struct QuadMesh {
    std::vector<double> positions; /* vertex_count x 3 */
    std::vector<uint32_t> quads;   /* quad_count x 4 */
};

/* hmf_parameterization with its own arrays, all of which are filled. */
struct Parameterization {
    std::vector<double> corner_uv;    /* triangle_count x 3 x 2 */
    std::vector<double> transition;   /* edge_count x 3: sign, du, dv */
    std::vector<uint8_t> seam;        /* edge_count */
    std::vector<int32_t> cone;        /* vertex_count */
    std::vector<double> dilatation;   /* triangle_count */
    std::vector<double> differential; /* triangle_count x 2 */
    double dilatation_mean = 0;
    double dilatation_median = 0;
    double dilatation_p99 = 0;
    uint64_t flipped_triangles = 0;
    uint64_t degenerate_triangles = 0;
    uint64_t seam_edge_count = 0;
    double seam_length = 0;
    double area = 0;
    uint64_t linear_iterations = 0;
    double seconds = 0;
};

namespace detail {

/* Makes a call with an hmf_error; throws unless it succeeds. */
template <class Call>
void check(Call&& call) {
    hmf_error error = {};
    if (call(&error) != HMF_OK) throw Error(error);
}

/* The callback of a call, and the exception that it must not let through. */
class Reporter {
public:
    explicit Reporter(const ProgressFunction& function) : function_(function) {}

    hmf_progress_fn callback() const { return function_ ? report : nullptr; }
    void rethrow() const {
        if (exception_) std::rethrow_exception(exception_);
    }

private:
    static int32_t report(void* user, double fraction) noexcept {
        Reporter& self = *static_cast<Reporter*>(user);
        if (self.exception_) return HMF_PROGRESS_CANCEL;
        try {
            return static_cast<int32_t>(self.function_(fraction));
        } catch (...) {
            self.exception_ = std::current_exception();
            return HMF_PROGRESS_CANCEL;
        }
    }

    const ProgressFunction& function_;
    std::exception_ptr exception_;
};

inline hmf_build_options raw(const BuildOptions& options) {
    hmf_build_options all = {};
    all.struct_size = sizeof all;
    all.collapse = static_cast<int32_t>(options.collapse);
    all.ratio = options.ratio;
    all.coarsest = options.coarsest;
    all.memory_limit = options.memory_limit;
    all.allocate = options.allocate;
    all.release = options.release;
    all.allocator_user = options.allocator_user;
    all.mollify = options.mollify;
    all.marked_vertices = options.marked_vertices.data();
    all.marked_count = options.marked_vertices.size();
    return all;
}

inline hmf_solve_options raw(const SolveOptions& options) {
    hmf_solve_options all = {};
    all.struct_size = sizeof all;
    all.method = static_cast<int32_t>(options.method);
    all.tolerance = options.tolerance;
    all.time_limit = options.time_limit;
    all.iteration_limit = options.iteration_limit;
    all.stop_level = options.stop_level;
    all.initial_values = options.initial_values.data();
    all.initial_count = options.initial_values.size();
    all.initial_level = options.initial_level;
    return all;
}

/* For calls during which the loops live.  Throws what C cannot see. */
inline hmf_loop_set raw(const Loops& loops) {
    if (loops.weights.size() != loops.size())
        throw Error(HMF_ERROR_CAPACITY, HMF_ELEMENT_NONE, 0,
                    "There are " + std::to_string(loops.weights.size()) + " weights for " + std::to_string(loops.size())
                        + " loops. Give one for each.");
    if (!loops.offsets.empty() && loops.offsets.back() != loops.elements.size())
        throw Error(HMF_ERROR_LOOP_COUNT, HMF_ELEMENT_NONE, 0,
                    "The last offset of the loops is " + std::to_string(loops.offsets.back()) + ", but there are "
                        + std::to_string(loops.elements.size()) + " elements. Use Loops::add.");
    hmf_loop_set set = {};
    set.struct_size = sizeof set;
    set.element_kind = static_cast<int32_t>(loops.kind);
    set.level = loops.level;
    set.count = loops.size();
    set.offsets = loops.offsets.data();
    set.elements = loops.elements.data();
    set.weights = loops.weights.data();
    return set;
}

using Handle = std::shared_ptr<const hmf_hierarchy>;

inline LevelInfo level_info(const Handle& handle, std::size_t level) {
    LevelInfo info = {};
    check([&](hmf_error* error) { return hmf_level_counts(handle.get(), level, &info, error); });
    return info;
}

inline std::size_t edge_count(const Handle& handle, std::size_t level) {
    return static_cast<std::size_t>(level_info(handle, level).edge_count);
}

} // namespace detail

/* ------------------------------------------------------------------------
 * Foliation
 * --------------------------------------------------------------------- */

struct Solution;

/* One value for each edge of a level. */
class Foliation {
public:
    Foliation(Foliation&&) = default;
    Foliation& operator=(Foliation&&) = default;

    std::size_t level() const noexcept { return level_; }
    const std::vector<double>& values() const& noexcept { return values_; }
    std::vector<double> values() && noexcept { return std::move(values_); }

    /* hmf_energy */
    double energy() const {
        double energy = 0;
        detail::check([&](hmf_error* error) {
            return hmf_energy(handle_.get(), level_, values_.data(), values_.size(), &energy, error);
        });
        return energy;
    }

    /* hmf_residuals: vertex_count */
    std::vector<double> residuals() const {
        std::vector<double> residuals(static_cast<std::size_t>(detail::level_info(handle_, level_).vertex_count));
        detail::check([&](hmf_error* error) {
            return hmf_residuals(handle_.get(), level_, values_.data(), values_.size(), residuals.data(),
                                 residuals.size(), error);
        });
        return residuals;
    }

    /* hmf_interpolate: the same foliation on another level. */
    Foliation to_level(std::size_t level) const {
        std::vector<double> values(detail::edge_count(handle_, level));
        detail::check([&](hmf_error* error) {
            return hmf_interpolate(handle_.get(), level_, values_.data(), values_.size(), level, values.data(),
                                   values.size(), error);
        });
        return Foliation(handle_, level, std::move(values));
    }

    /* hmf_singularities, all of it. */
    Singularities singularities() const {
        const LevelInfo info = detail::level_info(handle_, level_);
        Singularities all;
        all.vertex_index.resize(static_cast<std::size_t>(info.vertex_count));
        all.triangle_index.resize(static_cast<std::size_t>(info.triangle_count));
        all.vertex_cluster.resize(static_cast<std::size_t>(info.vertex_count));
        all.list = list(&all);
        return all;
    }

    /* hmf_singularities, the list alone. */
    std::vector<Singularity> zeros_and_poles() const { return list(nullptr); }

    /* hmf_trace */
    Leaves trace(const TraceOptions& options = {}) const {
        if (options.point_barycentrics.size() != 3 * options.point_triangles.size())
            throw Error(HMF_ERROR_CAPACITY, HMF_ELEMENT_NONE, 0,
                        "There are " + std::to_string(options.point_barycentrics.size())
                            + " barycentric coordinates for " + std::to_string(options.point_triangles.size())
                            + " points. Give three for each.");
        hmf_trace_options all = {};
        all.struct_size = sizeof all;
        all.critical = options.critical;
        all.spacing = options.spacing;
        all.length_limit = options.length_limit;
        all.point_count = options.point_triangles.size();
        all.point_triangles = options.point_triangles.data();
        all.point_barycentrics = options.point_barycentrics.data();
        all.leaves = static_cast<int32_t>(options.leaves);
        Leaves leaves;
        std::size_t lines = 0, points = 0;
        const auto call = [&](bool fill) {
            detail::check([&](hmf_error* error) {
                return hmf_trace(handle_.get(), level_, values_.data(), values_.size(), &all,
                                 fill ? leaves.lines.data() : nullptr, leaves.lines.size(),
                                 fill ? leaves.offsets.data() : nullptr, leaves.offsets.size(),
                                 fill ? leaves.points.data() : nullptr, fill ? leaves.point_edges.data() : nullptr,
                                 leaves.point_edges.size(), &lines, &points, error);
            });
        };
        call(false);
        leaves.lines.resize(lines);
        leaves.offsets.resize(lines + 1);
        leaves.points.resize(3 * points);
        leaves.point_edges.resize(points);
        call(true);
        return leaves;
    }

    /* hmf_cylinders; loops: those that the values belong to, or NULL. */
    Cylinders cylinders(const Loops* loops = nullptr) const {
        hmf_loop_set set = {};
        if (loops) set = detail::raw(*loops);
        Cylinders own;
        std::size_t count = 0, size = 0;
        // Without the list and the loops it is quick.
        const auto call = [&](bool fill) {
            detail::check([&](hmf_error* error) {
                return hmf_cylinders(handle_.get(), level_, values_.data(), values_.size(),
                                     fill && loops ? &set : nullptr, fill ? own.list.data() : nullptr, own.list.size(),
                                     fill ? own.leaves.offsets.data() : nullptr, own.leaves.offsets.size(),
                                     fill ? own.leaves.elements.data() : nullptr, own.leaves.elements.size(), &count,
                                     &size, error);
            });
        };
        call(false);
        own.list.resize(count);
        own.leaves.level = level_;
        own.leaves.kind = LoopElements::triangles;
        own.leaves.offsets.resize(count + 1);
        own.leaves.elements.resize(size);
        call(true);
        for (const Cylinder& cylinder : own.list) own.leaves.weights.push_back(cylinder.height);
        return own;
    }

    /* hmf_quads; edge_length 0: about as many quads as triangles / 2 */
    QuadMesh quads(double edge_length = 0) const {
        hmf_quad_options options = {};
        options.struct_size = sizeof options;
        options.edge_length = edge_length;
        QuadMesh mesh;
        std::size_t vertices = 0, quads = 0;
        const auto call = [&](bool fill) {
            detail::check([&](hmf_error* error) {
                return hmf_quads(handle_.get(), level_, values_.data(), values_.size(), &options,
                                 fill ? mesh.positions.data() : nullptr, vertices, fill ? mesh.quads.data() : nullptr,
                                 quads, &vertices, &quads, error);
            });
        };
        call(false);
        mesh.positions.resize(3 * vertices);
        mesh.quads.resize(4 * quads);
        call(true);
        return mesh;
    }

    /* hmf_parameterize */
    Parameterization parameterize(const ParameterizeOptions& options = {}) const {
        const LevelInfo info = detail::level_info(handle_, level_);
        const auto triangles = static_cast<std::size_t>(info.triangle_count);
        const auto edges = static_cast<std::size_t>(info.edge_count);
        Parameterization own;
        own.corner_uv.resize(6 * triangles);
        own.transition.resize(3 * edges);
        own.seam.resize(edges);
        own.cone.resize(static_cast<std::size_t>(info.vertex_count));
        own.dilatation.resize(triangles);
        own.differential.resize(2 * triangles);

        hmf_parameterization out = {};
        out.struct_size = sizeof out;
        out.vertex_capacity = info.vertex_count;
        out.edge_capacity = info.edge_count;
        out.triangle_capacity = info.triangle_count;
        out.corner_uv = own.corner_uv.data();
        out.transition = own.transition.data();
        out.seam = own.seam.data();
        out.cone = own.cone.data();
        out.dilatation = own.dilatation.data();
        out.differential = own.differential.data();
        detail::Reporter reporter(options.progress);
        hmf_parameterize_options all = {};
        all.struct_size = sizeof all;
        all.tolerance = options.tolerance;
        all.seam_edges = options.seam_edges.data();
        all.seam_edge_count = options.seam_edges.size();
        all.progress = reporter.callback();
        all.progress_user = &reporter;
        hmf_error error = {};
        const hmf_status status =
            hmf_parameterize(handle_.get(), level_, values_.data(), values_.size(), &all, &out, &error);
        reporter.rethrow();
        if (status != HMF_OK) throw Error(error);

        own.dilatation_mean = out.dilatation_mean;
        own.dilatation_median = out.dilatation_median;
        own.dilatation_p99 = out.dilatation_p99;
        own.flipped_triangles = out.flipped_triangles;
        own.degenerate_triangles = out.degenerate_triangles;
        own.seam_edge_count = out.seam_edge_count;
        own.seam_length = out.seam_length;
        own.area = out.area;
        own.linear_iterations = out.linear_iterations;
        own.seconds = out.seconds;
        return own;
    }

    /* hmf_relax: optimises a copy on its level. */
    Solution relax(const SolveOptions& options = {}) const;

private:
    friend class Hierarchy;

    Foliation(detail::Handle handle, std::size_t level, std::vector<double> values) :
        handle_(std::move(handle)), level_(level), values_(std::move(values)) {}

    std::vector<Singularity> list(Singularities* arrays) const {
        // Without a pole there are at most 4 genus - 4 zeros, so that one call is enough.
        const std::size_t genus = hmf_genus(handle_.get());
        std::vector<Singularity> list(genus > 1 ? 4 * genus - 4 : 1);
        std::size_t count = 0;
        const auto call = [&](Singularities* to, std::vector<Singularity>* out, hmf_error* error) {
            return hmf_singularities(handle_.get(), level_, values_.data(), values_.size(),
                                     to ? to->vertex_index.data() : nullptr, to ? to->vertex_index.size() : 0,
                                     to ? to->triangle_index.data() : nullptr, to ? to->triangle_index.size() : 0,
                                     to ? to->vertex_cluster.data() : nullptr, to ? to->vertex_cluster.size() : 0,
                                     out ? out->data() : nullptr, out ? out->size() : 0, &count, error);
        };
        hmf_error error = {};
        const hmf_status status = call(arrays, &list, &error);
        if (status == HMF_ERROR_CAPACITY) {
            detail::check([&](hmf_error* e) { return call(nullptr, nullptr, e); });
            list.resize(count);
            detail::check([&](hmf_error* e) { return call(arrays, &list, e); });
        } else if (status != HMF_OK) {
            throw Error(error);
        }
        list.resize(count);
        return list;
    }

    detail::Handle handle_;
    std::size_t level_;
    std::vector<double> values_;
};

/* What hmf_solve and hmf_relax give. */
struct Solution {
    Foliation foliation; /* closed and without poles, even if the optimisation was stopped */
    hmf_status status;   /* HMF_OK, HMF_LIMIT_*, or HMF_CANCELLED */
    std::string message; /* why it was stopped; empty with HMF_OK */
    Report report;
};

namespace detail {

/* Runs call(options, report, error), which writes `values`. */
template <class Call, class Make>
Solution run(const Handle& handle, const SolveOptions& options, Make&& make, Call&& call) {
    std::vector<LevelReport> levels(hmf_level_count(handle.get()));
    std::vector<HistoryEntry> history(options.history_capacity);
    hmf_report report = {};
    report.struct_size = sizeof report;
    report.levels = levels.data();
    report.level_capacity = levels.size();
    report.history = history.data();
    report.history_capacity = history.size();

    Reporter reporter(options.progress);
    hmf_solve_options all = raw(options);
    all.progress = reporter.callback();
    all.progress_user = &reporter;
    hmf_error error = {};
    const hmf_status status = call(all, &report, &error);
    reporter.rethrow();
    if (status != HMF_OK && !report.values_written) throw Error(error);
    if (status != HMF_OK && !(status >= HMF_LIMIT_ITERATIONS && status <= HMF_CANCELLED)) throw Error(error);

    Report own;
    own.method = static_cast<Method>(report.method);
    own.converged = report.converged != 0;
    own.energy = report.energy;
    own.residual_max = report.residual_max;
    own.residual_mean = report.residual_mean;
    own.poles = report.poles;
    own.zeros = report.zeros;
    own.index_sum = report.index_sum;
    own.bad_flips = report.bad_flips;
    own.bad_flips_left = report.bad_flips_left;
    own.solve_seconds = report.solve_seconds;
    own.peak_memory_bytes = report.peak_memory_bytes;
    own.history_count = report.history_count;
    if (report.level_count < levels.size()) levels.resize(static_cast<std::size_t>(report.level_count));
    if (report.history_count < history.size()) history.resize(static_cast<std::size_t>(report.history_count));
    own.levels = std::move(levels);
    own.history = std::move(history);
    return Solution{make(), status, status == HMF_OK ? std::string() : std::string(error.message), std::move(own)};
}

} // namespace detail

inline Solution Foliation::relax(const SolveOptions& options) const {
    std::vector<double> values = values_;
    return detail::run(
        handle_, options, [&] { return Foliation(handle_, level_, std::move(values)); },
        [&](const hmf_solve_options& all, hmf_report* report, hmf_error* error) {
            return hmf_relax(handle_.get(), level_, &all, values.data(), values.size(), report, error);
        });
}

/* ------------------------------------------------------------------------
 * Hierarchy
 * --------------------------------------------------------------------- */

/* An immutable hierarchy of triangle meshes. */
class Hierarchy {
public:
    /* hmf_build.  positions: vertex_count x 3; triangles: triangle_count x 3. */
    Hierarchy(Span<double> positions, Span<uint32_t> triangles, const BuildOptions& options = {}) {
        check_triples(positions.size(), "positions", "vertex");
        check_triples(triangles.size(), "triangles", "triangle");
        detail::Reporter reporter(options.progress);
        hmf_build_options all = detail::raw(options);
        all.progress = reporter.callback();
        all.progress_user = &reporter;
        hmf_hierarchy* out = nullptr;
        hmf_error error = {};
        const hmf_status status = hmf_build(positions.data(), positions.size() / 3, 0, triangles.data(),
                                            triangles.size() / 3, &all, &out, &error);
        handle_ = detail::Handle(out, Destroy());
        reporter.rethrow();
        if (status != HMF_OK) throw Error(error);
    }

    Hierarchy(Hierarchy&&) = default;
    Hierarchy& operator=(Hierarchy&&) = default;

    /* hmf_suggest_marks */
    static std::vector<uint32_t> suggest_marks(Span<double> positions, Span<uint32_t> triangles,
                                               const BuildOptions& options = {}) {
        check_triples(positions.size(), "positions", "vertex");
        check_triples(triangles.size(), "triangles", "triangle");
        detail::Reporter reporter(options.progress);
        hmf_build_options all = detail::raw(options);
        all.progress = reporter.callback();
        all.progress_user = &reporter;
        std::vector<uint32_t> marks(24);
        std::size_t count = 0;
        hmf_error error = {};
        const hmf_status status =
            hmf_suggest_marks(positions.data(), positions.size() / 3, 0, triangles.data(), triangles.size() / 3, &all,
                              marks.data(), marks.size(), &count, &error);
        reporter.rethrow();
        if (status != HMF_OK) throw Error(error);
        marks.resize(count);
        return marks;
    }

    /* hmf_memory_estimate */
    static uint64_t memory_estimate(std::size_t vertex_count, std::size_t triangle_count,
                                    const BuildOptions& options = {}) {
        const hmf_build_options all = detail::raw(options);
        return hmf_memory_estimate(vertex_count, triangle_count, &all);
    }

    /* The handle, for calls of hmf.h; it stays ours. */
    const hmf_hierarchy* get() const noexcept { return handle_.get(); }

    uint64_t memory() const noexcept { return hmf_hierarchy_memory(get()); }
    std::size_t level_count() const noexcept { return hmf_level_count(get()); }
    std::size_t coarsest_level() const noexcept { return level_count() - 1; }
    std::size_t genus() const noexcept { return hmf_genus(get()); }
    LevelInfo level(std::size_t level) const { return detail::level_info(handle_, level); }

    /* edge_count x 2 */
    std::vector<uint32_t> edge_vertices(std::size_t level) const {
        return fill<uint32_t>(level, &LevelInfo::edge_count, 2, hmf_level_edge_vertices);
    }
    /* triangle_count x 3 */
    std::vector<uint32_t> triangle_edges(std::size_t level) const {
        return fill<uint32_t>(level, &LevelInfo::triangle_count, 3, hmf_level_triangle_edges);
    }
    /* triangle_count x 3 */
    std::vector<uint32_t> triangle_vertices(std::size_t level) const {
        return fill<uint32_t>(level, &LevelInfo::triangle_count, 3, hmf_level_triangle_vertices);
    }
    /* edge_count */
    std::vector<double> weights(std::size_t level) const {
        return fill<double>(level, &LevelInfo::edge_count, 1, hmf_level_weights);
    }
    /* vertex_count x 3 */
    std::vector<double> positions(std::size_t level) const {
        return fill<double>(level, &LevelInfo::vertex_count, 3, hmf_level_positions);
    }

    /* hmf_loops, with weights 1 */
    Loops loops(std::size_t level, LoopsKind kind = LoopsKind::cut) const {
        std::size_t count = 0, size = 0;
        Loops loops;
        const auto call = [&](uint64_t* offsets, uint32_t* elements) {
            detail::check([&](hmf_error* error) {
                return hmf_loops(get(), level, static_cast<int32_t>(kind), offsets, offsets ? loops.offsets.size() : 0,
                                 elements, elements ? loops.elements.size() : 0, &count, &size, error);
            });
        };
        call(nullptr, nullptr);
        loops.level = level;
        loops.kind = LoopElements::triangles;
        loops.offsets.resize(count + 1);
        loops.elements.resize(size);
        loops.weights.assign(count, 1.0);
        call(loops.offsets.data(), loops.elements.data());
        return loops;
    }

    /* hmf_initialize */
    Foliation initialize(const Loops& loops) const {
        const hmf_loop_set set = detail::raw(loops);
        std::vector<double> values(detail::edge_count(handle_, loops.level));
        detail::check(
            [&](hmf_error* error) { return hmf_initialize(get(), &set, values.data(), values.size(), error); });
        return Foliation(handle_, loops.level, std::move(values));
    }

    /* A foliation of the caller's values, edge_count of the level.  Here only
       their number is checked; each use checks that they are closed. */
    Foliation foliation(std::size_t level, std::vector<double> values) const {
        const std::size_t edges = detail::edge_count(handle_, level);
        if (values.size() != edges)
            throw Error(HMF_ERROR_CAPACITY, HMF_ELEMENT_NONE, 0,
                        "There are " + std::to_string(values.size()) + " values, but level " + std::to_string(level)
                            + " has " + std::to_string(edges) + " edges. Give one for each.");
        return Foliation(handle_, level, std::move(values));
    }

    /* hmf_solve with the loops of the library. */
    Solution solve(const SolveOptions& options = {}) const { return solve_set(nullptr, options); }

    /* hmf_solve */
    Solution solve(const Loops& loops, const SolveOptions& options = {}) const {
        const hmf_loop_set set = detail::raw(loops);
        return solve_set(&set, options);
    }

private:
    struct Destroy {
        void operator()(const hmf_hierarchy* handle) const noexcept { hmf_destroy(const_cast<hmf_hierarchy*>(handle)); }
    };

    static void check_triples(std::size_t size, const char* what, const char* element) {
        if (size % 3 != 0)
            throw Error(HMF_ERROR_CAPACITY, HMF_ELEMENT_NONE, 0,
                        std::string(what) + " has " + std::to_string(size) + " numbers. Give three for each " + element
                            + ".");
    }

    template <class T>
    std::vector<T> fill(std::size_t level, uint64_t LevelInfo::*count, std::size_t width,
                        hmf_status (*call)(const hmf_hierarchy*, std::size_t, T*, std::size_t, hmf_error*)) const {
        std::vector<T> array(width * static_cast<std::size_t>(this->level(level).*count));
        detail::check([&](hmf_error* error) { return call(handle_.get(), level, array.data(), array.size(), error); });
        return array;
    }

    Solution solve_set(const hmf_loop_set* loops, const SolveOptions& options) const {
        std::vector<double> values(detail::edge_count(handle_, options.stop_level));
        return detail::run(
            handle_, options, [&] { return Foliation(handle_, options.stop_level, std::move(values)); },
            [&](const hmf_solve_options& all, hmf_report* report, hmf_error* error) {
                return hmf_solve(get(), loops, &all, values.data(), values.size(), report, error);
            });
    }

    detail::Handle handle_;
};

} // namespace cpp
} // namespace hmf

#endif /* HMF_HMF_HPP */
