/*
 * hmf.hpp - the C interface hmf.h as C++17 classes, header only
 *
 *     const hmf::Hierarchy hierarchy(positions, triangles);
 *     const hmf::Solution solution = hierarchy.solve();
 *     solution.foliation.values();           // one value per edge
 *     solution.foliation.singularities();
 *
 * What one does with a foliation is in applications.hpp.  hmf.h is the manual; here is
 * only what differs.
 *
 *   errors    A failing call throws hmf::Error with the status, the element
 *             and the sentence of hmf_error.  Limits are no failure: see
 *             Solution::status.  std::bad_alloc comes from the vectors only.
 *   arrays    In: Span, a pointer with a size, made from vectors, arrays and
 *             the like, also of std::array<T, N>.  Out: a flat std::vector
 *             where the caller allocates in C, else a Span that lives as long
 *             as the object it was asked of.
 *   objects   Hierarchy, Foliation and Results can be moved, not copied, and
 *             destroyed in any order.  What has been moved from can be
 *             destroyed or assigned to; its calls throw HMF_ERROR_NULL.
 *   threads   As in C: any number of threads may use a const Hierarchy or
 *             Foliation.
 *   cores     A Threads object lends threads of the host to all calls that its
 *             own thread makes while it lives; Pool of hmf/pool.hpp has some.
 *   progress  The last argument of every call that can be long.  An exception
 *             of the function cancels the call, and is thrown again once the
 *             call has ended.
 */
#ifndef HMF_HMF_HPP
#define HMF_HMF_HPP

#include <hmf/applications.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
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
    paper = HMF_METHOD_PAPER,
};

enum class LoopElements : int32_t { triangles = HMF_PATH_TRIANGLES, vertices = HMF_PATH_VERTICES };

enum class LoopsKind : int32_t {
    cut = HMF_LOOPS_CUT,
    handle = HMF_LOOPS_HANDLE,
    tunnel = HMF_LOOPS_TUNNEL,
    pants = HMF_LOOPS_PANTS
};

/* The fields of hmf_hierarchy_options; zero means the default.  Two have a type of C++; positions are packed. */
struct BuildOptions : hmf_hierarchy_options {
    BuildOptions() : hmf_hierarchy_options{} {}
    Collapse collapse = Collapse::automatic;
    Span<uint32_t> marked_vertices; /* borrowed until the call ends */
};

/* hmf_design_options; zero means the default. */
struct DesignOptions {
    BuildOptions build; /* its marked vertices are part of every design */
    bool no_poles = false;
    uint64_t solve_limit = 0;
};

class Foliation;

/* The fields of hmf_solve_options; zero means the default.  Two have a type of C++. */
struct SolveOptions : hmf_solve_options {
    SolveOptions() : hmf_solve_options{} {}
    Method method = Method::automatic;
    const Foliation* start = nullptr; /* instead of loops; borrowed until the call ends */
};

/* Closed curves on a level, with weights: hmf_loop_set with its own arrays. */
struct Loops {
    std::size_t level = 0;
    LoopElements kind = LoopElements::vertices;
    std::vector<uint64_t> offsets = {0}; /* size() + 1; loop c is elements[offsets[c]] .. elements[offsets[c+1]-1] */
    std::vector<uint32_t> elements;
    std::vector<double> weights; /* size() */
    std::vector<uint8_t> arcs;   /* size(), not 0 = from boundary to boundary; or empty: all are closed */

    std::size_t size() const noexcept { return offsets.empty() ? 0 : offsets.size() - 1; }
    Span<uint32_t> operator[](std::size_t loop) const {
        return Span<uint32_t>(elements.data() + offsets[loop],
                              static_cast<std::size_t>(offsets[loop + 1] - offsets[loop]));
    }
    void add(Span<uint32_t> loop, double weight = 1) {
        elements.insert(elements.end(), loop.begin(), loop.end());
        offsets.push_back(elements.size());
        weights.push_back(weight);
        if (!arcs.empty()) arcs.push_back(0);
    }
    void add_arc(std::initializer_list<uint32_t> arc, double weight = 1) {
        add_arc(Span<uint32_t>(arc.begin(), arc.size()), weight);
    }
    void add_arc(Span<uint32_t> arc, double weight = 1) {
        arcs.resize(size(), 0);
        add(arc, weight);
        arcs.resize(size(), 1);
        arcs.back() = 1;
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
    void operator()(const hmf_hierarchy* hierarchy) const noexcept {
        hmf_hierarchy_destroy(const_cast<hmf_hierarchy*>(hierarchy));
    }
    void operator()(const hmf_foliation* foliation) const noexcept {
        hmf_foliation_destroy(const_cast<hmf_foliation*>(foliation));
    }
    void operator()(const void* result) const noexcept { hmf_free(result); }
};

template <class T>
using Handle = std::unique_ptr<const T, Delete>;

/* Makes a call with an hmf_error; throws unless it succeeds. */
template <class Call>
void check(Call&& call) {
    hmf_error error = {};
    if (call(&error) != HMF_OK) throw Error(error);
}

/* What the innermost Threads object of this thread lends; zero: nothing. */
inline hmf_control& lent() noexcept {
    static thread_local hmf_control control = {};
    return control;
}

/* The callback of a call, and the exception that it must not let through. */
class Reporter {
public:
    explicit Reporter(const ProgressFunction& function) : function_(function), control_(lent()) {
        control_.struct_size = sizeof control_;
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
            return static_cast<int32_t>(self.function_(fraction));
        } catch (...) {
            self.exception_ = std::current_exception();
            return HMF_PROGRESS_CANCEL;
        }
    }

    const ProgressFunction& function_;
    std::exception_ptr exception_;
    hmf_control control_;
};

/* Makes call(control, error), which fills an array. */
template <class Call>
void fill(const ProgressFunction& progress, Call&& call) {
    Reporter reporter(progress);
    hmf_error error = {};
    const hmf_status status = call(reporter.control(), &error);
    reporter.rethrow();
    if (status != HMF_OK) throw Error(error);
}

/* Makes call(control, &object, error).  A call may be stopped and give an object
   all the same: then the error says why. */
template <class T, class Call>
Handle<T> make(const ProgressFunction& progress, Call&& call, hmf_error& error) {
    Reporter reporter(progress);
    T* out = nullptr;
    const hmf_status status = call(reporter.control(), &out, &error);
    Handle<T> handle(out);
    reporter.rethrow();
    if (status != HMF_OK && !handle) throw Error(error);
    return handle;
}

template <class T, class Call>
Handle<T> make(const ProgressFunction& progress, Call&& call) {
    hmf_error error = {};
    return make<T>(progress, std::forward<Call>(call), error);
}

/* Throws unless an array holds three numbers for each element. */
inline void check_triples(std::size_t size, const char* what, const char* element) {
    if (size % 3 != 0)
        throw Error(HMF_ERROR_COUNT, HMF_ELEMENT_NONE, 0,
                    std::string(what) + " has " + std::to_string(size) + " numbers. Give three for each " + element
                        + ".");
}

inline hmf_hierarchy_options raw(const BuildOptions& options) {
    hmf_hierarchy_options all = options;
    all.struct_size = sizeof all;
    all.collapse = static_cast<int32_t>(options.collapse);
    all.position_stride = 0; /* packed */
    all.marked_vertices = options.marked_vertices.data();
    all.marked_count = options.marked_vertices.size();
    return all;
}

/* For calls during which the loops live.  Throws what C cannot see. */
inline hmf_loop_set raw(const Loops& loops) {
    if (loops.weights.size() != loops.size())
        throw Error(HMF_ERROR_COUNT, HMF_ELEMENT_NONE, 0,
                    "There are " + std::to_string(loops.weights.size()) + " weights for " + std::to_string(loops.size())
                        + " loops. Give one for each.");
    if (!loops.arcs.empty() && loops.arcs.size() != loops.size())
        throw Error(HMF_ERROR_COUNT, HMF_ELEMENT_NONE, 0,
                    "There are " + std::to_string(loops.arcs.size()) + " entries of arcs for "
                        + std::to_string(loops.size()) + " loops. Use Loops::add_arc.");
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
    if (!loops.arcs.empty()) set.arcs = loops.arcs.data();
    return set;
}

/* A copy with its own arrays, and all weights. */
inline Loops own(const hmf_loop_set& set) {
    Loops loops;
    loops.level = static_cast<std::size_t>(set.level);
    loops.kind = static_cast<LoopElements>(set.element_kind);
    loops.offsets.assign(set.offsets, set.offsets + set.count + 1);
    loops.elements.assign(set.elements, set.elements + set.offsets[set.count]);
    loops.weights.assign(static_cast<std::size_t>(set.count), 1.0);
    if (set.weights) loops.weights.assign(set.weights, set.weights + set.count);
    if (set.arcs) loops.arcs.assign(set.arcs, set.arcs + set.count);
    return loops;
}

} // namespace detail

/* ------------------------------------------------------------------------
 * Threads of the host
 * --------------------------------------------------------------------- */

/* While it lives, the calls that its own thread makes share their work by
   parallel_for, see hmf_parallel_for_fn.  The innermost one counts.  The bits of
   the results are the same as without. */
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

/* A structure that the library made, with its arrays: result->count and the like. */
template <class T>
class Result {
public:
    explicit Result(detail::Handle<T> handle) noexcept : handle_(std::move(handle)) {}

    const T* get() const noexcept { return handle_.get(); }
    const T* operator->() const noexcept { return handle_.get(); }

protected:
    template <class E>
    static Span<E> span(const E* data, uint64_t size) noexcept {
        return Span<E>(data, static_cast<std::size_t>(size));
    }

private:
    detail::Handle<T> handle_;
};

/* What hmf_singularities gives. */
class Singularities : public Result<hmf_singularity_set> {
public:
    using Result::Result;
    Span<Singularity> list() const noexcept { return span(get()->list, get()->count); }
    Span<int32_t> vertex_index() const noexcept { return span(get()->vertex_index, get()->vertex_count); }
    Span<uint32_t> vertex_cluster() const noexcept { return span(get()->vertex_cluster, get()->vertex_count); }
    Span<int32_t> triangle_index() const noexcept { return span(get()->triangle_index, get()->triangle_count); }
};

/* ------------------------------------------------------------------------
 * Foliation
 * --------------------------------------------------------------------- */

struct Solution;

/* An immutable measured foliation; it may outlive its hierarchy. */
class Foliation {
public:
    Foliation(Foliation&&) = default;
    Foliation& operator=(Foliation&&) = default;

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

    /* hmf_energy */
    double energy(const ProgressFunction& progress = nullptr) const {
        double energy = 0;
        detail::fill(progress, [&](const hmf_control* control, hmf_error* error) {
            return hmf_energy(get(), control, &energy, error);
        });
        return energy;
    }

    /* hmf_residuals: vertex_count */
    std::vector<double> residuals(const ProgressFunction& progress = nullptr) const {
        // Euler: edges = 3 (vertices + 2 genus - 2).
        std::vector<double> residuals(get() ? values().size() / 3 + 2 - 2 * genus_ : 0);
        detail::fill(progress, [&](const hmf_control* control, hmf_error* error) {
            return hmf_residuals(get(), control, residuals.data(), residuals.size(), error);
        });
        return residuals;
    }

    /* hmf_conformal_scale: triangle_count */
    std::vector<double> conformal_scale(const ProgressFunction& progress = nullptr) const {
        // Euler: 2 edges = 3 triangles.
        std::vector<double> scale(get() ? values().size() / 3 * 2 : 0);
        detail::fill(progress, [&](const hmf_control* control, hmf_error* error) {
            return hmf_conformal_scale(get(), control, scale.data(), scale.size(), nullptr, error);
        });
        return scale;
    }

    /* hmf_conformal_scale: how uneven it is. */
    double unevenness(const ProgressFunction& progress = nullptr) const {
        double unevenness = 0;
        detail::fill(progress, [&](const hmf_control* control, hmf_error* error) {
            return hmf_conformal_scale(get(), control, nullptr, 0, &unevenness, error);
        });
        return unevenness;
    }

    /* hmf_singularities */
    Singularities singularities(const ProgressFunction& progress = nullptr) const {
        return Singularities(
            detail::make<hmf_singularity_set>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
                return hmf_singularities(get(), control, out, error);
            }));
    }

    /* hmf_interpolate: the same foliation on another level. */
    Foliation to_level(std::size_t level, const ProgressFunction& progress = nullptr) const {
        return Foliation(detail::make<hmf_foliation>(progress,
                                                     [&](const hmf_control* control, auto out, hmf_error* error) {
                                                         return hmf_interpolate(get(), level, control, out, error);
                                                     }),
                         genus_);
    }

    /* hmf_relax */
    Solution relax(const SolveOptions& options = {}, const ProgressFunction& progress = nullptr) const;

private:
    friend class Hierarchy;

    Foliation(detail::Handle<hmf_foliation> handle, std::size_t genus) noexcept :
        handle_(std::move(handle)), genus_(genus) {}

    template <class Call>
    static Solution solved(const SolveOptions& options, const ProgressFunction& progress, std::size_t genus,
                           Call&& call);

    detail::Handle<hmf_foliation> handle_;
    std::size_t genus_;
};

/* What hmf_solve and hmf_relax give. */
struct Solution {
    Foliation foliation; /* closed and without poles, even if the optimization was stopped */
    hmf_status status;   /* HMF_OK, HMF_LIMIT_*, or HMF_CANCELLED */
    std::string message; /* why it was stopped; empty with HMF_OK */
    Report report;
};

template <class Call>
Solution Foliation::solved(const SolveOptions& options, const ProgressFunction& progress, std::size_t genus,
                           Call&& call) {
    hmf_solve_options all = options;
    all.struct_size = sizeof all;
    all.method = static_cast<int32_t>(options.method);
    all.start = options.start ? options.start->get() : nullptr;
    hmf_error error = {};
    detail::Handle<hmf_foliation> handle = detail::make<hmf_foliation>(
        progress,
        [&](const hmf_control* control, hmf_foliation** out, hmf_error* e) { return call(&all, control, out, e); },
        error);
    Report report(*hmf_foliation_report(handle.get()));
    return Solution{Foliation(std::move(handle), genus), error.status, error.message, std::move(report)};
}

inline Solution Foliation::relax(const SolveOptions& options, const ProgressFunction& progress) const {
    return solved(options, progress, genus_, [&](auto all, const hmf_control* control, auto out, hmf_error* error) {
        return hmf_relax(get(), all, control, out, error);
    });
}

/* ------------------------------------------------------------------------
 * Hierarchy
 * --------------------------------------------------------------------- */

/* What hmf_even_design gives. */
struct Design {
    std::vector<uint32_t> marked_vertices;
    Loops loops; /* of level 0 */
    double unevenness;
    double unevenness_before;
    uint64_t solves;
};

/* An immutable hierarchy of triangle meshes. */
class Hierarchy {
public:
    /* hmf_hierarchy_create.  positions: vertex_count x 3; triangles: triangle_count x 3. */
    Hierarchy(Span<double> positions, Span<uint32_t> triangles, const BuildOptions& options = {},
              const ProgressFunction& progress = nullptr) {
        detail::check_triples(positions.size(), "positions", "vertex");
        detail::check_triples(triangles.size(), "triangles", "triangle");
        const hmf_hierarchy_options all = detail::raw(options);
        handle_ = detail::make<hmf_hierarchy>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
            return hmf_hierarchy_create(positions.data(), positions.size() / 3, triangles.data(), triangles.size() / 3,
                                        &all, control, out, error);
        });
    }

    Hierarchy(Hierarchy&&) = default;
    Hierarchy& operator=(Hierarchy&&) = default;

    /* hmf_suggest_marks */
    static std::vector<uint32_t> suggest_marks(Span<double> positions, Span<uint32_t> triangles,
                                               const BuildOptions& options = {},
                                               const ProgressFunction& progress = nullptr) {
        detail::check_triples(positions.size(), "positions", "vertex");
        detail::check_triples(triangles.size(), "triangles", "triangle");
        const hmf_hierarchy_options all = detail::raw(options);
        const auto set =
            detail::make<hmf_mark_set>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
                return hmf_suggest_marks(positions.data(), positions.size() / 3, triangles.data(), triangles.size() / 3,
                                         &all, control, out, error);
            });
        return {set->vertices, set->vertices + set->count};
    }

    /* hmf_even_design: marked vertices for the options of a hierarchy, and loops to solve for on it. */
    static Design even_design(Span<double> positions, Span<uint32_t> triangles, const DesignOptions& options = {},
                              const ProgressFunction& progress = nullptr) {
        detail::check_triples(positions.size(), "positions", "vertex");
        detail::check_triples(triangles.size(), "triangles", "triangle");
        const hmf_hierarchy_options build = detail::raw(options.build);
        hmf_design_options all = {};
        all.struct_size = sizeof all;
        all.no_poles = options.no_poles;
        all.build = &build;
        all.solve_limit = options.solve_limit;
        const auto made =
            detail::make<hmf_design>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
                return hmf_even_design(positions.data(), positions.size() / 3, triangles.data(), triangles.size() / 3,
                                       &all, control, out, error);
            });
        return {{made->marked_vertices, made->marked_vertices + made->marked_count},
                detail::own(*made->loops),
                made->unevenness,
                made->unevenness_before,
                made->solves};
    }

    /* hmf_hierarchy_memory_estimate */
    static uint64_t memory_estimate(std::size_t vertex_count, std::size_t triangle_count,
                                    const BuildOptions& options = {}) {
        const hmf_hierarchy_options all = detail::raw(options);
        return hmf_hierarchy_memory_estimate(vertex_count, triangle_count, &all);
    }

    /* The object, for calls of hmf.h; it stays ours. */
    const hmf_hierarchy* get() const noexcept { return handle_.get(); }

    uint64_t memory() const noexcept { return hmf_hierarchy_memory(get()); }
    std::size_t level_count() const noexcept { return hmf_level_count(get()); }
    std::size_t coarsest_level() const noexcept { return level_count() - 1; }
    std::size_t genus() const noexcept { return hmf_genus(get()); }
    std::size_t boundary_count() const noexcept { return hmf_boundary_count(get()); }
    LevelInfo level(std::size_t level) const {
        LevelInfo info = {};
        detail::check([&](hmf_error* error) { return hmf_level_counts(get(), level, &info, error); });
        return info;
    }

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
    Loops loops(std::size_t level, LoopsKind kind = LoopsKind::cut, const ProgressFunction& progress = nullptr) const {
        return detail::own(
            *detail::make<hmf_loop_set>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
                return hmf_loops(get(), level, static_cast<int32_t>(kind), control, out, error);
            }));
    }

    /* hmf_foliation_from_loops */
    Foliation initialize(const Loops& loops, const ProgressFunction& progress = nullptr) const {
        const hmf_loop_set set = detail::raw(loops);
        const auto make = [&](const hmf_control* control, auto out, hmf_error* error) {
            return hmf_foliation_from_loops(get(), &set, control, out, error);
        };
        return Foliation(detail::make<hmf_foliation>(progress, make), genus());
    }

    /* hmf_foliation_from_values: a foliation of values, edge_count of the level. */
    Foliation foliation(std::size_t level, Span<double> values, const ProgressFunction& progress = nullptr) const {
        return Foliation(detail::make<hmf_foliation>(progress,
                                                     [&](const hmf_control* control, auto out, hmf_error* error) {
                                                         return hmf_foliation_from_values(get(), level, values.data(),
                                                                                     values.size(), control, out,
                                                                                     error);
                                                     }),
                         genus());
    }

    /* hmf_solve from options.start; without a start hmf_solve_cut_system. */
    Solution solve(const SolveOptions& options = {}, const ProgressFunction& progress = nullptr) const {
        if (options.start) return solve_set(nullptr, options, progress);
        return Foliation::solved(options, progress, genus(),
                                 [&](auto all, const hmf_control* control, auto out, hmf_error* error) {
                                     return hmf_solve_cut_system(get(), all, control, out, error);
                                 });
    }

    /* hmf_solve */
    Solution solve(const Loops& loops, const SolveOptions& options = {},
                   const ProgressFunction& progress = nullptr) const {
        const hmf_loop_set set = detail::raw(loops);
        return solve_set(&set, options, progress);
    }

private:
    template <class T>
    std::vector<T> fill(std::size_t level, uint64_t LevelInfo::*count, std::size_t width,
                        hmf_status (*call)(const hmf_hierarchy*, std::size_t, T*, std::size_t, hmf_error*)) const {
        std::vector<T> array(width * static_cast<std::size_t>(this->level(level).*count));
        detail::check([&](hmf_error* error) { return call(get(), level, array.data(), array.size(), error); });
        return array;
    }

    Solution solve_set(const hmf_loop_set* loops, const SolveOptions& options, const ProgressFunction& progress) const {
        return Foliation::solved(options, progress, genus(),
                                 [&](auto all, const hmf_control* control, auto out, hmf_error* error) {
                                     return hmf_solve(get(), loops, all, control, out, error);
                                 });
    }

    detail::Handle<hmf_hierarchy> handle_;
};

/* ------------------------------------------------------------------------
 * Several components
 * --------------------------------------------------------------------- */

struct ComponentSolutions;

/* What hmf_components gives. */
class Components : public Result<hmf_component_set> {
public:
    /* The options: mollify, marked vertices (of the whole mesh), memory. */
    Components(Span<double> positions, Span<uint32_t> triangles, const BuildOptions& options = {},
               const ProgressFunction& progress = nullptr) :
        Result(divide(positions, triangles, options, progress)) {}

    std::size_t size() const noexcept { return static_cast<std::size_t>(get()->count); }
    const hmf_component& operator[](std::size_t k) const noexcept { return get()->list[k]; }

    /* Component k with numbers of its own, for a Hierarchy. */
    Span<double> positions(std::size_t k) const noexcept {
        return part(get()->part_positions, (*this)[k].first_vertex, (*this)[k].vertex_count, 3);
    }
    Span<uint32_t> triangles(std::size_t k) const noexcept {
        return part(get()->part_triangles, (*this)[k].first_triangle, (*this)[k].triangle_count, 3);
    }
    Span<uint32_t> marked_vertices(std::size_t k) const noexcept {
        return part(get()->part_marks, (*this)[k].first_mark, (*this)[k].marked_count);
    }

    /* Its numbers in the whole mesh. */
    Span<uint32_t> whole_vertices(std::size_t k) const noexcept {
        return part(get()->whole_vertices, (*this)[k].first_vertex, (*this)[k].vertex_count);
    }
    Span<uint32_t> whole_edges(std::size_t k) const noexcept {
        return part(get()->whole_edges, (*this)[k].first_edge, (*this)[k].edge_count);
    }
    Span<uint32_t> whole_triangles(std::size_t k) const noexcept {
        return part(get()->whole_triangles, (*this)[k].first_triangle, (*this)[k].triangle_count);
    }

    /* Loops of the whole mesh (level 0): those of each component, in its numbers.  Throws
       HMF_ERROR_LOOP_INDEX where an element does not exist, HMF_ERROR_LOOP_NOT_CLOSED where a loop is on several. */
    std::vector<Loops> split(const Loops& whole) const;

    /* Solves each component, with the loops of the library or with those of the whole mesh.  options: as for a
       Hierarchy, but for marked vertices, which are those given to the constructor; start and stop_level are not
       used.  What is wrong with one component, or its loops, is said in its row; other failures are thrown. */
    ComponentSolutions solve(const BuildOptions& build = {}, const SolveOptions& options = {},
                             const ProgressFunction& progress = nullptr) const;
    ComponentSolutions solve(const Loops& loops, const BuildOptions& build = {}, const SolveOptions& options = {},
                             const ProgressFunction& progress = nullptr) const;

private:
    static detail::Handle<hmf_component_set> divide(Span<double> positions, Span<uint32_t> triangles,
                                                    const BuildOptions& options, const ProgressFunction& progress) {
        detail::check_triples(positions.size(), "positions", "vertex");
        detail::check_triples(triangles.size(), "triangles", "triangle");
        const hmf_hierarchy_options all = detail::raw(options);
        return detail::make<hmf_component_set>(progress, [&](const hmf_control* control, auto out, hmf_error* error) {
            return hmf_components(positions.data(), positions.size() / 3, triangles.data(), triangles.size() / 3, &all,
                                  control, out, error);
        });
    }

    template <class T>
    static Span<T> part(const T* array, uint64_t first, uint64_t count, uint64_t width = 1) noexcept {
        return span(array + width * first, width * count);
    }

    ComponentSolutions solve_each(const std::vector<Loops>* loops, BuildOptions build, SolveOptions options,
                                  const ProgressFunction& progress) const;
};

/* One component of ComponentSolutions. */
struct ComponentSolution {
    hmf_status status;                /* that of the solution; without one, why there is none */
    std::string message;              /* likewise; empty with HMF_OK */
    std::optional<Solution> solution; /* of this component alone */
};

/* One foliation over all components. */
struct ComponentSolutions {
    std::vector<double> values; /* one for each edge of the whole mesh; 0 where a component has none */
    std::vector<ComponentSolution> components;
};

inline std::vector<Loops> Components::split(const Loops& whole) const {
    const bool triangles = whole.kind == LoopElements::triangles;
    const uint32_t* const component = triangles ? get()->triangle_component : get()->vertex_component;
    const uint32_t* const number = triangles ? get()->triangle_part : get()->vertex_part;
    const uint64_t count = triangles ? get()->triangle_count : get()->vertex_count;
    std::vector<Loops> parts(size());
    for (Loops& own : parts) own.kind = whole.kind;
    for (std::size_t c = 0; c < whole.size(); ++c) {
        std::vector<uint32_t> elements;
        uint32_t on = HMF_NONE;
        for (const uint32_t element : whole[c]) {
            const uint32_t k = element < count ? component[element] : HMF_NONE;
            if (k == HMF_NONE)
                throw Error(HMF_ERROR_LOOP_INDEX, HMF_ELEMENT_LOOP, c,
                            "Loop " + std::to_string(c) + " names element " + std::to_string(element)
                                + ", which no component has.");
            if (on != HMF_NONE && k != on)
                throw Error(HMF_ERROR_LOOP_NOT_CLOSED, HMF_ELEMENT_LOOP, c,
                            "Loop " + std::to_string(c) + " lies on the components " + std::to_string(on) + " and "
                                + std::to_string(k) + ". Give a loop on one of them.");
            on = k;
            elements.push_back(number[element]);
        }
        if (on == HMF_NONE) continue;
        parts[on].add(elements, whole.weights[c]);
        parts[on].arcs.resize(parts[on].size(), 0);
        if (!whole.arcs.empty()) parts[on].arcs.back() = whole.arcs[c];
    }
    return parts;
}

inline ComponentSolutions Components::solve_each(const std::vector<Loops>* loops, BuildOptions build,
                                                 SolveOptions options, const ProgressFunction& progress) const {
    options.start = nullptr;
    options.stop_level = 0;
    ComponentSolutions all;
    all.values.resize(static_cast<std::size_t>(get()->edge_count));
    double done = 0;
    for (std::size_t k = 0; k < size(); ++k) {
        const hmf_component& c = (*this)[k];
        const double share = static_cast<double>(c.triangle_count) / static_cast<double>(get()->triangle_count);
        // About a quarter of the time is the build.
        const auto from_to = [&](double from, double to) -> ProgressFunction {
            if (!progress) return nullptr;
            return [&progress, from, to](double fraction) { return progress(from + fraction * (to - from)); };
        };
        all.components.push_back({c.status, c.status == HMF_OK ? "" : hmf_status_string(c.status), std::nullopt});
        ComponentSolution& row = all.components.back();
        if (c.status == HMF_OK && loops && (*loops)[k].size() == 0) {
            row.status = HMF_ERROR_LOOP_COUNT;
            row.message = "No loop lies on it.";
        }
        if (row.status == HMF_OK) {
            try {
                build.marked_vertices = marked_vertices(k);
                const Hierarchy hierarchy(positions(k), triangles(k), build, from_to(done, done + share / 4));
                const ProgressFunction rest = from_to(done + share / 4, done + share);
                row.solution = loops ? hierarchy.solve((*loops)[k], options, rest) : hierarchy.solve(options, rest);
                row.status = row.solution->status;
                row.message = row.solution->message;
                const Span<double> own = row.solution->foliation.values();
                const Span<uint32_t> edges = whole_edges(k);
                for (std::size_t e = 0; e < own.size(); ++e) all.values[edges[e]] = own[e];
            } catch (const Error& error) {
                // What is wrong with this component, or its loops, is said in its row.
                if (error.status() < 300 && error.status() != HMF_ERROR_UNSUPPORTED) throw;
                row.status = error.status();
                row.message = error.what();
            }
        }
        done += share;
    }
    return all;
}

inline ComponentSolutions Components::solve(const BuildOptions& build, const SolveOptions& options,
                                            const ProgressFunction& progress) const {
    return solve_each(nullptr, build, options, progress);
}

inline ComponentSolutions Components::solve(const Loops& loops, const BuildOptions& build, const SolveOptions& options,
                                            const ProgressFunction& progress) const {
    const std::vector<Loops> parts = split(loops);
    return solve_each(&parts, build, options, progress);
}

} // namespace cpp
} // namespace hmf

#endif /* HMF_HMF_HPP */
