/*
 * hmf.hpp - the C interface hmf.h as C++17 classes, header only
 *
 *     const hmf::Hierarchy hierarchy(positions, triangles);
 *     hmf::Loops loops;
 *     loops.add({0, 1, 2, 3});               // vertices along the loop
 *     const hmf::Solution solution = hierarchy.solve(loops);
 *     solution.foliation.values();           // one value per edge
 *     solution.foliation.singularities();
 *
 * applications.hpp has what applications.h has: loops chosen by the library, and what follows
 * from a foliation.  hmf.h is the manual; these comments only say what differs.
 *
 *   errors    A call that fails throws hmf::Error with the status, the element
 *             and the message of hmf_error.  Limits do not throw: see
 *             Solution::status.  Only the vectors throw std::bad_alloc.
 *   arrays    In: Span, a pointer with a size, made from vectors, arrays and similar
 *             containers, also of std::array<T, N>.  Out: a Span that is valid as
 *             long as the object that returned it, or a std::vector.
 *   objects   Hierarchy, Foliation and Results can be moved, not copied, and
 *             destroyed in any order.  A moved-from object can be destroyed or
 *             assigned to; its calls throw HMF_ERROR_NULL.
 *   threads   As in C: any number of threads may use a const Hierarchy or
 *             Foliation.
 *   cores     While a Threads object lives, calls of the thread that created it use
 *             threads of the host.  Pool of hmf/pool.hpp is a ready thread pool.
 *   progress  The last argument of every call that can take long.  An exception of
 *             the function cancels the call and is rethrown after it has ended.
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

/* Thrown by a call that fails; what() says what is wrong and what to do. */
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
    explicit Span(const T* data, uint64_t size) : data_(data), size_(static_cast<std::size_t>(size)) {}
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

/* Called on the calling thread with a fraction that rises from 0 to 1; returns HMF_PROGRESS_*. */
using ProgressFunction = std::function<hmf_progress(double)>;

/* A structure of options with its defaults; zero means the default. */
template <class T, void (*init)(T*, uint32_t)>
struct Options : T {
    Options() { init(this, sizeof(T)); }
};

/* Positions are packed; marked vertices are borrowed until the call ends. */
struct BuildOptions : Options<hmf_hierarchy_options, hmf_hierarchy_options_init> {
    Span<uint32_t> marked_vertices;
};
using SolveOptions = Options<hmf_solve_options, hmf_solve_options_init>;

/* Closed curves on a level, with weights: hmf_loop_set with its own arrays. */
struct Loops {
    std::size_t level = 0;
    hmf_path kind = HMF_PATH_VERTICES;
    std::vector<uint64_t> offsets = {0}; /* size() + 1; loop c is elements[offsets[c]] .. elements[offsets[c+1]-1] */
    std::vector<uint32_t> elements;
    std::vector<double> weights; /* size() */
    std::vector<uint8_t> arcs;   /* size(), not 0 = from boundary to boundary; or empty: all are closed */
    std::vector<uint32_t> arc_sides; /* 2 size(): where arcs of triangles begin and end, see hmf_loop_set; or empty */

    std::size_t size() const noexcept { return offsets.empty() ? 0 : offsets.size() - 1; }
    Span<uint32_t> operator[](std::size_t loop) const {
        return Span<uint32_t>(elements.data() + offsets[loop], offsets[loop + 1] - offsets[loop]);
    }
    void add(Span<uint32_t> loop, double weight = 1, bool is_arc = false) {
        elements.insert(elements.end(), loop.begin(), loop.end());
        if (is_arc) arcs.resize(size(), 0);
        offsets.push_back(elements.size());
        weights.push_back(weight);
        if (is_arc || !arcs.empty()) arcs.push_back(is_arc);
        if (!arc_sides.empty()) arc_sides.resize(2 * size(), HMF_NONE);
    }
    void add(std::initializer_list<uint32_t> loop, double weight = 1) {
        add(Span<uint32_t>(loop.begin(), loop.size()), weight);
    }
    void add_arc(Span<uint32_t> arc, double weight = 1) { add(arc, weight, true); }
    void add_arc(std::initializer_list<uint32_t> arc, double weight = 1) {
        add(Span<uint32_t>(arc.begin(), arc.size()), weight, true);
    }
};

using LevelInfo = hmf_level_info;
using LevelReport = hmf_level_report;
using HistoryEntry = hmf_history_entry;
using Singularity = hmf_singularity;

/* hmf_report with its own arrays. */
struct Report : hmf_report {
    std::vector<LevelReport> levels;   /* finest first */
    std::vector<HistoryEntry> history; /* in order of time */

    explicit Report(const hmf_report& report) :
        hmf_report(report), levels(report.levels, report.levels + report.level_count),
        history(report.history, report.history + report.history_count) {
        hmf_report::levels = nullptr;
        hmf_report::history = nullptr;
    }
};

namespace detail {

struct Delete {
    void operator()(const hmf_hierarchy* h) const noexcept { hmf_hierarchy_destroy(const_cast<hmf_hierarchy*>(h)); }
    void operator()(const hmf_foliation* f) const noexcept { hmf_foliation_destroy(const_cast<hmf_foliation*>(f)); }
    void operator()(const void* result) const noexcept { hmf_free(result); }
};

template <class T>
using Handle = std::unique_ptr<const T, Delete>;

/* Threads of the innermost Threads object of this thread; zero: none. */
inline hmf_control& lent() noexcept {
    static thread_local Options<hmf_control, hmf_control_init> control;
    return control;
}

/* The callback of a call; stores an exception, which must not pass through C. */
class Reporter {
public:
    explicit Reporter(const ProgressFunction& function) : function_(function), control_(lent()) {
        if (!function_) return;
        control_.progress = report;
        control_.progress_user = this;
    }
    Reporter(const Reporter&) = delete;
    Reporter& operator=(const Reporter&) = delete;

    const hmf_control* control() const noexcept { return &control_; }
    void rethrow() const {
        if (exception_) std::rethrow_exception(exception_);
    }

private:
    static int32_t report(void* user, double fraction) noexcept {
        Reporter& self = *static_cast<Reporter*>(user);
        if (self.exception_) return HMF_PROGRESS_CANCEL;
        try {
            return self.function_(fraction);
        } catch (...) {
            self.exception_ = std::current_exception();
            return HMF_PROGRESS_CANCEL;
        }
    }

    const ProgressFunction& function_;
    std::exception_ptr exception_;
    hmf_control control_;
};

/* function(arguments..., control, &object, &error).  A call that stops early may still return an object;
   the error then says why. */
template <class T, class Function, class... Arguments>
Handle<T> make_or_stop(hmf_error& error, const ProgressFunction& progress, Function* function,
                       const Arguments&... arguments) {
    Reporter reporter(progress);
    T* out = nullptr;
    const hmf_status status = function(arguments..., reporter.control(), &out, &error);
    Handle<T> handle(out);
    reporter.rethrow();
    if (status != HMF_OK && !handle) throw Error(error);
    return handle;
}

template <class T, class Function, class... Arguments>
Handle<T> make(const ProgressFunction& progress, Function* function, const Arguments&... arguments) {
    hmf_error error = {};
    return make_or_stop<T>(error, progress, function, arguments...);
}

/* Throws unless an array has three numbers for each of its elements. */
inline void check_triples(std::size_t size, const char* what, const char* element) {
    if (size % 3 == 0) return;
    throw Error(HMF_ERROR_COUNT, HMF_ELEMENT_NONE, 0,
                std::string(what) + " has " + std::to_string(size) + " numbers. Give three for each " + element + ".");
}

/* function(mesh, options, control, &object, &error) */
template <class T, class Function, class Options>
Handle<T> make_of_mesh(const ProgressFunction& progress, Function* function, Span<double> positions,
                       Span<uint32_t> triangles, const Options& options) {
    check_triples(positions.size(), "positions", "vertex");
    check_triples(triangles.size(), "triangles", "triangle");
    return make<T>(progress, function, positions.data(), positions.size() / 3, triangles.data(), triangles.size() / 3,
                   &options);
}

inline hmf_hierarchy_options raw(const BuildOptions& options) {
    hmf_hierarchy_options all = options;
    all.position_stride = 0; /* packed */
    all.marked_vertices = options.marked_vertices.data();
    all.marked_count = options.marked_vertices.size();
    return all;
}

/* For calls during which the loops live.  Throws on errors that C cannot detect. */
inline hmf_loop_set raw(const Loops& loops) {
    const auto check = [&](uint64_t size, uint64_t expected, const char* what) {
        if (size == expected) return;
        throw Error(HMF_ERROR_COUNT, HMF_ELEMENT_NONE, 0,
                    "There are " + std::to_string(size) + " " + what + " instead of " + std::to_string(expected)
                        + ". Use Loops::add and Loops::add_arc.");
    };
    check(loops.weights.size(), loops.size(), "weights of loops");
    if (!loops.arcs.empty()) check(loops.arcs.size(), loops.size(), "entries of arcs");
    if (!loops.arc_sides.empty()) check(loops.arc_sides.size(), 2 * loops.size(), "sides of arcs");
    if (!loops.offsets.empty()) check(loops.elements.size(), loops.offsets.back(), "elements of loops");
    hmf_loop_set set = {};
    set.struct_size = sizeof set;
    set.element_kind = loops.kind;
    set.level = loops.level;
    set.count = loops.size();
    set.offsets = loops.offsets.data();
    set.elements = loops.elements.data();
    set.weights = loops.weights.data();
    if (!loops.arcs.empty()) set.arcs = loops.arcs.data();
    if (!loops.arc_sides.empty()) set.arc_sides = loops.arc_sides.data();
    return set;
}

/* A copy with its own arrays, and all weights. */
inline Loops own(const hmf_loop_set& set) {
    Loops loops;
    loops.level = static_cast<std::size_t>(set.level);
    loops.kind = static_cast<hmf_path>(set.element_kind);
    loops.offsets.assign(set.offsets, set.offsets + set.count + 1);
    loops.elements.assign(set.elements, set.elements + set.offsets[set.count]);
    loops.weights.assign(static_cast<std::size_t>(set.count), 1.0);
    if (set.weights) loops.weights.assign(set.weights, set.weights + set.count);
    if (set.arcs) loops.arcs.assign(set.arcs, set.arcs + set.count);
    if (set.arc_sides) loops.arc_sides.assign(set.arc_sides, set.arc_sides + 2 * set.count);
    return loops;
}

} // namespace detail

/* While the object lives, calls of the thread that created it run on parallel_for, see
   hmf_parallel_for_fn.  The innermost object applies.  Results are bit-identical. */
class Threads {
public:
    explicit Threads(hmf_parallel_for_fn parallel_for, void* user, uint32_t workers = 0) : before_(detail::lent()) {
        hmf_control& lent = detail::lent();
        lent.workers = workers;
        lent.parallel_for = parallel_for;
        lent.parallel_user = user;
    }
    ~Threads() { detail::lent() = before_; }
    Threads(const Threads&) = delete;
    Threads& operator=(const Threads&) = delete;

private:
    hmf_control before_;
};

/* A result structure of the library with its arrays, used as result->count. */
template <class T>
class Result {
public:
    explicit Result(detail::Handle<T> handle) noexcept : handle_(std::move(handle)) {}
    const T* get() const noexcept { return handle_.get(); }
    const T* operator->() const noexcept { return handle_.get(); }

protected:
    template <class E>
    static Span<E> span(const E* data, uint64_t size) noexcept {
        return Span<E>(data, size);
    }

private:
    detail::Handle<T> handle_;
};

/* hmf_singularities */
class Singularities : public Result<hmf_singularity_set> {
public:
    using Result::Result;
    Span<Singularity> list() const noexcept { return span(get()->list, get()->count); }
    Span<int32_t> vertex_index() const noexcept { return span(get()->vertex_index, get()->vertex_count); }
    Span<uint32_t> vertex_cluster() const noexcept { return span(get()->vertex_cluster, get()->vertex_count); }
    Span<int32_t> triangle_index() const noexcept { return span(get()->triangle_index, get()->triangle_count); }
};

/* hmf_level */
class LevelMesh : public Result<hmf_level_mesh> {
public:
    using Result::Result;
    Span<double> positions() const noexcept { return span(get()->positions, 3 * get()->vertex_count); }
    Span<uint32_t> edge_vertices() const noexcept { return span(get()->edge_vertices, 2 * get()->edge_count); }
    Span<uint32_t> triangle_edges() const noexcept { return span(get()->triangle_edges, 3 * get()->triangle_count); }
    Span<uint32_t> triangle_vertices() const noexcept {
        return span(get()->triangle_vertices, 3 * get()->triangle_count);
    }
    Span<double> weights() const noexcept { return span(get()->weights, get()->edge_count); }
};

struct Solution;

/* An immutable measured foliation; it may outlive its hierarchy. */
class Foliation {
public:
    explicit Foliation(detail::Handle<hmf_foliation> handle) noexcept : handle_(std::move(handle)) {}

    /* The object, for calls of hmf.h; it stays ours. */
    const hmf_foliation* get() const noexcept { return handle_.get(); }

    std::size_t level() const noexcept { return hmf_foliation_level(get()); }
    double unit() const noexcept { return hmf_foliation_unit(get()); }
    uint64_t memory() const noexcept { return hmf_foliation_memory(get()); }
    /* One for each edge of the level. */
    Span<double> values() const noexcept {
        std::size_t count = 0;
        const double* data = hmf_foliation_values(get(), &count);
        return Span<double>(data, data ? count : 0);
    }

    double energy(const ProgressFunction& progress = nullptr) const {
        detail::Reporter reporter(progress);
        hmf_error error = {};
        double energy = 0;
        const hmf_status status = hmf_energy(get(), reporter.control(), &energy, &error);
        reporter.rethrow();
        if (status != HMF_OK) throw Error(error);
        return energy;
    }
    /* One for each vertex. */
    std::vector<double> residuals(const ProgressFunction& progress = nullptr) const {
        const auto made = detail::make<hmf_residual_set>(progress, hmf_residuals, get());
        return {made->values, made->values + made->vertex_count};
    }
    Singularities singularities(const ProgressFunction& progress = nullptr) const {
        return Singularities(detail::make<hmf_singularity_set>(progress, hmf_singularities, get()));
    }
    /* hmf_interpolate: the same foliation on another level. */
    Foliation to_level(std::size_t level, const ProgressFunction& progress = nullptr) const {
        return Foliation(detail::make<hmf_foliation>(progress, hmf_interpolate, get(), level));
    }
    Solution relax(const SolveOptions& options = {}, const ProgressFunction& progress = nullptr) const;

private:
    detail::Handle<hmf_foliation> handle_;
};

/* Result of hmf_solve and hmf_relax. */
struct Solution {
    Foliation foliation; /* closed and without poles, even if the solve stopped early */
    hmf_status status;   /* HMF_OK, HMF_LIMIT_* or HMF_CANCELLED */
    std::string message; /* why it stopped early; empty with HMF_OK */
    Report report;
};

namespace detail {

/* function(arguments..., options, control, &foliation, &error) */
template <class Function, class... Arguments>
Solution solve(const SolveOptions& options, const ProgressFunction& progress, Function* function,
               const Arguments&... arguments) {
    const hmf_solve_options* const given = &options;
    hmf_error error = {};
    Handle<hmf_foliation> handle = make_or_stop<hmf_foliation>(error, progress, function, arguments..., given);
    Report report(*hmf_foliation_report(handle.get()));
    return Solution{Foliation(std::move(handle)), error.status, error.message, std::move(report)};
}

} // namespace detail

inline Solution Foliation::relax(const SolveOptions& options, const ProgressFunction& progress) const {
    return detail::solve(options, progress, hmf_relax, get());
}

/* An immutable hierarchy of triangle meshes. */
class Hierarchy {
public:
    /* positions: vertex_count x 3; triangles: triangle_count x 3 */
    Hierarchy(Span<double> positions, Span<uint32_t> triangles, const BuildOptions& options = {},
              const ProgressFunction& progress = nullptr) :
        handle_(detail::make_of_mesh<hmf_hierarchy>(progress, hmf_hierarchy_create, positions, triangles,
                                                    detail::raw(options))) {}

    static uint64_t memory_estimate(std::size_t vertex_count, std::size_t triangle_count,
                                    const BuildOptions& options = {}) {
        const hmf_hierarchy_options all = detail::raw(options);
        return hmf_hierarchy_memory_estimate(vertex_count, triangle_count, &all);
    }

    /* The object, for calls of hmf.h; it stays ours. */
    const hmf_hierarchy* get() const noexcept { return handle_.get(); }

    uint64_t memory() const { return info().memory_bytes; }
    std::size_t level_count() const { return static_cast<std::size_t>(info().level_count); }
    std::size_t coarsest_level() const { return level_count() - 1; }
    std::size_t genus() const { return static_cast<std::size_t>(info().genus); }
    std::size_t boundary_count() const { return static_cast<std::size_t>(info().boundary_count); }
    /* Counts of a level. */
    const LevelInfo& level(std::size_t level) const {
        if (level < level_count()) return info().levels[level];
        throw Error(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, level,
                    "There is no level " + std::to_string(level) + "; the hierarchy has "
                        + std::to_string(level_count()) + ".");
    }
    LevelMesh mesh(std::size_t level, const ProgressFunction& progress = nullptr) const {
        return LevelMesh(detail::make<hmf_level_mesh>(progress, hmf_level, get(), level));
    }

    /* hmf_foliation_from_loops */
    Foliation initialize(const Loops& loops, const ProgressFunction& progress = nullptr) const {
        const hmf_loop_set set = detail::raw(loops);
        return Foliation(detail::make<hmf_foliation>(progress, hmf_foliation_from_loops, get(), &set));
    }
    /* hmf_foliation_from_values: edge_count of the level. */
    Foliation foliation(std::size_t level, Span<double> values, const ProgressFunction& progress = nullptr) const {
        return Foliation(detail::make<hmf_foliation>(progress, hmf_foliation_from_values, get(), level, values.data(),
                                                     values.size()));
    }

    /* hmf_solve from options.start. */
    Solution solve(const SolveOptions& options, const ProgressFunction& progress = nullptr) const {
        const hmf_loop_set* const none = nullptr;
        return detail::solve(options, progress, hmf_solve, get(), none);
    }
    Solution solve(const Loops& loops, const SolveOptions& options = {},
                   const ProgressFunction& progress = nullptr) const {
        const hmf_loop_set set = detail::raw(loops);
        return detail::solve(options, progress, hmf_solve, get(), &set);
    }

private:
    const hmf_hierarchy_info& info() const {
        static constexpr hmf_hierarchy_info none = {}; // of moved-from objects
        return get() ? *hmf_hierarchy_describe(get()) : none;
    }

    detail::Handle<hmf_hierarchy> handle_;
};

} // namespace cpp
} // namespace hmf

#endif /* HMF_HMF_HPP */
