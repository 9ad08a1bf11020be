// Every status, nothing written on failure, no memory lost: defects of the
// call, of the mesh, of loops and of values; the n-th allocation fails; the
// n-th progress call cancels; the memory limit.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

using namespace test;

namespace {

// A failing call says so in its error, too.
void expect_error(hmf_status status, hmf_status expected, const hmf_error& error) {
    EXPECT_EQ(status, expected) << hmf_status_string(status) << " instead of " << hmf_status_string(expected) << "; "
                                << error.message;
    EXPECT_EQ(error.status, status);
    EXPECT_NE(std::memchr(error.message, 0, sizeof error.message), nullptr);
    EXPECT_GT(std::strlen(error.message), 10u);
}

hmf_status build(const TriMesh& mesh, hmf_error& error, const hmf_build_options* options = nullptr) {
    hmf_hierarchy* hierarchy = reinterpret_cast<hmf_hierarchy*>(&error); // must be overwritten
    const hmf_status status = hmf_build(mesh.positions.data(), mesh.vertex_count(), 0, mesh.triangles.data(),
                                        mesh.triangle_count(), options, &hierarchy, &error);
    EXPECT_EQ(hierarchy == nullptr, status != HMF_OK);
    hmf_destroy(hierarchy);
    return status;
}

void expect_build(const TriMesh& mesh, hmf_status expected) {
    hmf_error error{};
    const hmf_status status = build(mesh, error);
    expect_error(status, expected, error);
}

TriMesh small_torus() { return torus(12, 8, 2, 1); }

// Two copies of the torus; the vertices of `shared` are the same in both.
TriMesh two_tori(const std::vector<uint32_t>& shared) {
    TriMesh mesh = small_torus();
    const TriMesh other = small_torus();
    std::vector<uint32_t> number(other.vertex_count());
    for (uint32_t v = 0; v < other.vertex_count(); ++v) {
        if (std::count(shared.begin(), shared.end(), v)) {
            number[v] = v;
            continue;
        }
        number[v] = static_cast<uint32_t>(mesh.vertex_count());
        const double* p = &other.positions[3 * v];
        mesh.positions.insert(mesh.positions.end(), {p[0] + 0.1, p[1] + 7, p[2] + 0.3});
    }
    for (uint32_t v : other.triangles) mesh.triangles.push_back(number[v]);
    return mesh;
}

// Counts bytes and calls; refuses the call number `fail` (from 1).
struct Meter {
    uint64_t used = 0, peak = 0, calls = 0, fail = 0;

    static void* take(void* user, size_t size) {
        Meter& meter = *static_cast<Meter*>(user);
        if (++meter.calls == meter.fail) return nullptr;
        meter.used += size;
        meter.peak = std::max(meter.peak, meter.used);
        // Fresh memory is never zero by luck.
        void* block = std::malloc(size ? size : 1);
        std::memset(block, 0xa5, size);
        return block;
    }
    static void give(void* user, void* block, size_t size) {
        Meter& meter = *static_cast<Meter*>(user);
        EXPECT_NE(block, nullptr);
        EXPECT_GE(meter.used, size);
        meter.used -= size;
        std::free(block);
    }
    hmf_build_options options() {
        hmf_build_options o;
        hmf_build_options_init(&o);
        o.allocate = take;
        o.release = give;
        o.allocator_user = this;
        o.coarsest = 40; // several levels even on small meshes
        return o;
    }
};

struct Progress {
    uint64_t calls = 0, stop = 0;
    int32_t answer = HMF_PROGRESS_CANCEL;
    double last = 0;
    bool rising = true;

    static int32_t call(void* user, double fraction) {
        Progress& p = *static_cast<Progress*>(user);
        if (!(fraction >= p.last && fraction <= 1)) p.rising = false;
        p.last = fraction;
        return ++p.calls == p.stop ? p.answer : HMF_PROGRESS_CONTINUE;
    }
};

// Every call of the interface once; the first failure ends it.
hmf_status whole_story(const TriMesh& mesh, const hmf_build_options& options, int32_t method) {
    hmf_hierarchy* h = nullptr;
    hmf_error error{};
    hmf_status s = hmf_build(mesh.positions.data(), mesh.vertex_count(), 0, mesh.triangles.data(),
                             mesh.triangle_count(), &options, &h, &error);
    if (s != HMF_OK) {
        EXPECT_EQ(h, nullptr);
        EXPECT_EQ(error.status, s);
        return s;
    }
    const size_t coarsest = hmf_level_count(h) - 1;
    hmf_level_info fine{}, coarse{};
    EXPECT_EQ(hmf_level_counts(h, 0, &fine, nullptr), HMF_OK);
    EXPECT_EQ(hmf_level_counts(h, coarsest, &coarse, nullptr), HMF_OK);
    std::vector<uint64_t> offsets(hmf_genus(h) + 1);
    std::vector<uint32_t> elements(coarse.triangle_count * offsets.size());
    std::vector<double> start(coarse.edge_count), values(fine.edge_count, -1), residual(fine.vertex_count, -1),
        carried(fine.edge_count, -1);
    std::vector<int32_t> index(fine.vertex_count, 77);
    size_t loops = 0, total = 0, list = 0;
    double energy = -1;
    hmf_solve_options solve = solve_options(method, 1e-3, 40);
    hmf_loop_set set{};
    const size_t n = fine.edge_count;
    const auto untouched = [](const std::vector<double>& v) {
        return std::count(v.begin(), v.end(), -1.0) == static_cast<long>(v.size());
    };

    s = hmf_loops(h, coarsest, HMF_LOOPS_CUT, offsets.data(), offsets.size(), elements.data(), elements.size(), &loops,
                  &total, &error);
    if (s == HMF_OK) {
        set.struct_size = sizeof set;
        set.element_kind = HMF_LOOP_TRIANGLES;
        set.level = coarsest;
        set.count = loops;
        set.offsets = offsets.data();
        set.elements = elements.data();
        s = hmf_initialize(h, &set, start.data(), start.size(), &error);
    }
    if (s == HMF_OK) {
        s = hmf_interpolate(h, coarsest, start.data(), start.size(), 0, carried.data(), n, &error);
        EXPECT_TRUE(s == HMF_OK || untouched(carried));
    }
    if (s == HMF_OK) {
        hmf_report report{};
        report.struct_size = sizeof report;
        s = hmf_solve(h, &set, &solve, values.data(), n, &report, &error);
        if (s >= HMF_ERROR_NULL) {
            EXPECT_TRUE(untouched(values));
        } else {
            s = HMF_OK; // a limit
        }
    }
    if (s == HMF_OK) {
        const std::vector<double> before = carried;
        s = hmf_relax(h, 0, &solve, carried.data(), n, nullptr, &error);
        if (s >= HMF_ERROR_NULL) {
            EXPECT_EQ(carried, before);
        } else {
            s = HMF_OK;
        }
    }
    if (s == HMF_OK) {
        s = hmf_energy(h, 0, values.data(), n, &energy, &error);
        EXPECT_TRUE(s == HMF_OK || energy == -1);
    }
    if (s == HMF_OK) {
        s = hmf_residuals(h, 0, values.data(), n, residual.data(), residual.size(), &error);
        EXPECT_TRUE(s == HMF_OK || untouched(residual));
    }
    if (s == HMF_OK) {
        s = hmf_singularities(h, 0, values.data(), n, index.data(), index.size(), nullptr, 0, nullptr, 0, nullptr, 0,
                              &list, &error);
        EXPECT_TRUE(s == HMF_OK || std::count(index.begin(), index.end(), 77) == static_cast<long>(index.size()));
    }
    if (s != HMF_OK) {
        EXPECT_EQ(error.status, s);
        EXPECT_GT(std::strlen(error.message), 10u);
    }
    hmf_destroy(h);
    return s;
}

// Loops and values on a small torus of one level.
class OnTorus : public testing::Test {
protected:
    static constexpr uint32_t n = 12, m = 8;
    Hierarchy hierarchy{small_torus()};
    LevelMesh mesh = read_level(hierarchy, 0);

    // Triangles between column i and i + 1, in a ring round the tube; triangles
    // 2 (i m + j) and 2 (i m + j) + 1 fill the cell (i, j).
    static std::vector<uint32_t> ring(uint32_t i) {
        std::vector<uint32_t> loop;
        for (uint32_t j = 0; j < m; ++j) loop.insert(loop.end(), {2 * (i * m + j), 2 * (i * m + j) + 1});
        return loop;
    }
    // The other way: a row j of cells.
    static std::vector<uint32_t> row(uint32_t j) {
        std::vector<uint32_t> loop;
        for (uint32_t i = 0; i < n; ++i) loop.insert(loop.end(), {2 * (i * m + j) + 1, 2 * (i * m + j)});
        return loop;
    }
    void expect_loops(const std::vector<std::vector<uint32_t>>& given, hmf_status expected, uint64_t bad_loop,
                      const std::vector<double>& weights = {}) {
        Loops loops;
        for (const auto& loop : given) loops.add(loop);
        loops.weights = weights;
        const hmf_loop_set set = loops.view();
        std::vector<double> values(mesh.edge_count, -1);
        const std::vector<double> before = values;
        hmf_error error{};
        hmf_status status = hmf_initialize(hierarchy.get(), &set, values.data(), values.size(), &error);
        if (expected == HMF_OK) {
            EXPECT_EQ(status, HMF_OK) << error.message;
            return;
        }
        expect_error(status, expected, error);
        EXPECT_EQ(error.element, HMF_ELEMENT_LOOP);
        EXPECT_EQ(error.index, bad_loop);
        EXPECT_EQ(values, before);
        error = hmf_error{};
        status = hmf_solve(hierarchy.get(), &set, nullptr, values.data(), values.size(), nullptr, &error);
        expect_error(status, expected, error);
        EXPECT_EQ(values, before);
    }
    std::vector<double> valid_values() {
        Loops loops;
        loops.add(ring(3));
        std::vector<double> values(mesh.edge_count);
        const hmf_loop_set set = loops.view();
        EXPECT_EQ(hmf_initialize(hierarchy.get(), &set, values.data(), values.size(), nullptr), HMF_OK);
        return values;
    }
    // poles: hmf_singularities accepts them, it is what it counts.
    void expect_values(const std::vector<double>& values, hmf_status expected) {
        std::vector<double> work = values, out(mesh.edge_count, -1), residual(mesh.vertex_count, -1);
        double energy = -1;
        size_t count = 12345;
        hmf_error error{};
        expect_error(hmf_relax(hierarchy.get(), 0, nullptr, work.data(), work.size(), nullptr, &error), expected,
                     error);
        EXPECT_EQ(std::memcmp(work.data(), values.data(), work.size() * sizeof(double)), 0);
        error = hmf_error{};
        expect_error(
            hmf_interpolate(hierarchy.get(), 0, values.data(), values.size(), 0, out.data(), out.size(), &error),
            expected, error);
        EXPECT_EQ(std::count(out.begin(), out.end(), -1.0), static_cast<long>(out.size()));
        if (expected == HMF_ERROR_VALUE_POLE) return;
        error = hmf_error{};
        expect_error(hmf_energy(hierarchy.get(), 0, values.data(), values.size(), &energy, &error), expected, error);
        EXPECT_EQ(energy, -1);
        error = hmf_error{};
        expect_error(
            hmf_residuals(hierarchy.get(), 0, values.data(), values.size(), residual.data(), residual.size(), &error),
            expected, error);
        EXPECT_EQ(std::count(residual.begin(), residual.end(), -1.0), static_cast<long>(residual.size()));
        error = hmf_error{};
        expect_error(hmf_singularities(hierarchy.get(), 0, values.data(), values.size(), nullptr, 0, nullptr, 0,
                                       nullptr, 0, nullptr, 0, &count, &error),
                     expected, error);
        EXPECT_EQ(count, 12345u);
    }
};

} // namespace

// --- The call ----------------------------------------------------------------

TEST_F(OnTorus, NullPointers) {
    const TriMesh t = small_torus();
    hmf_error error{};
    hmf_hierarchy* h = nullptr;
    expect_error(hmf_build(nullptr, t.vertex_count(), 0, t.triangles.data(), t.triangle_count(), nullptr, &h, &error),
                 HMF_ERROR_NULL, error);
    expect_error(hmf_build(t.positions.data(), t.vertex_count(), 0, nullptr, t.triangle_count(), nullptr, &h, &error),
                 HMF_ERROR_NULL, error);
    expect_error(hmf_build(t.positions.data(), t.vertex_count(), 0, t.triangles.data(), t.triangle_count(), nullptr,
                           nullptr, &error),
                 HMF_ERROR_NULL, error);
    EXPECT_EQ(h, nullptr);
    hmf_level_info info{};
    uint32_t index = 0;
    double value = 0;
    size_t count = 0;
    const hmf_hierarchy* g = hierarchy.get();
    for (const hmf_hierarchy* x : {static_cast<const hmf_hierarchy*>(nullptr), g}) {
        // With a hierarchy it is the output that is missing.
        expect_error(hmf_level_counts(x, 0, x ? nullptr : &info, &error), HMF_ERROR_NULL, error);
        expect_error(hmf_level_edge_vertices(x, 0, x ? nullptr : &index, 1, &error), HMF_ERROR_NULL, error);
        expect_error(hmf_level_triangle_edges(x, 0, x ? nullptr : &index, 1, &error), HMF_ERROR_NULL, error);
        expect_error(hmf_level_triangle_vertices(x, 0, x ? nullptr : &index, 1, &error), HMF_ERROR_NULL, error);
        expect_error(hmf_level_weights(x, 0, x ? nullptr : &value, 1, &error), HMF_ERROR_NULL, error);
        expect_error(hmf_level_positions(x, 0, x ? nullptr : &value, 1, &error), HMF_ERROR_NULL, error);
        expect_error(hmf_loops(x, 0, HMF_LOOPS_CUT, nullptr, 0, nullptr, 0, x ? nullptr : &count, &count, &error),
                     HMF_ERROR_NULL, error);
        expect_error(hmf_solve(x, nullptr, nullptr, x ? nullptr : &value, 1, nullptr, &error), HMF_ERROR_NULL, error);
        expect_error(hmf_relax(x, 0, nullptr, x ? nullptr : &value, 1, nullptr, &error), HMF_ERROR_NULL, error);
        expect_error(hmf_interpolate(x, 0, x ? nullptr : &value, mesh.edge_count, 0, &value, mesh.edge_count, &error),
                     HMF_ERROR_NULL, error);
        expect_error(hmf_energy(x, 0, x ? nullptr : &value, mesh.edge_count, &value, &error), HMF_ERROR_NULL, error);
        expect_error(hmf_residuals(x, 0, &value, 1, x ? nullptr : &value, 1, &error), HMF_ERROR_NULL, error);
        expect_error(hmf_singularities(x, 0, &value, 1, nullptr, 0, nullptr, 0, nullptr, 0, nullptr, 0,
                                       x ? nullptr : &count, &error),
                     HMF_ERROR_NULL, error);
    }
    // The error itself is optional.
    EXPECT_EQ(hmf_level_counts(nullptr, 0, &info, nullptr), HMF_ERROR_NULL);
}

TEST_F(OnTorus, BuildOptions) {
    const TriMesh t = small_torus();
    const auto expect_options = [&](void (*change)(hmf_build_options&), hmf_status expected) {
        hmf_build_options options;
        hmf_build_options_init(&options);
        change(options);
        hmf_error error{};
        const hmf_status status = build(t, error, &options);
        if (expected == HMF_OK) {
            EXPECT_EQ(status, HMF_OK) << error.message;
        } else {
            expect_error(status, expected, error);
        }
    };
    expect_options([](hmf_build_options&) {}, HMF_OK);
    expect_options([](hmf_build_options& o) { o.ratio = 0.04; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_build_options& o) { o.ratio = 0.96; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_build_options& o) { o.ratio = -0.5; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_build_options& o) { o.ratio = NAN; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_build_options& o) { o.ratio = 0.05; }, HMF_OK);
    expect_options([](hmf_build_options& o) { o.ratio = 0.95; }, HMF_OK);
    expect_options([](hmf_build_options& o) { o.collapse = 4; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_build_options& o) { o.collapse = -1; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_build_options& o) { o.allocate = Meter::take; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_build_options& o) { o.release = Meter::give; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_build_options& o) { o.struct_size = 0; }, HMF_ERROR_OPTIONS);
    // An older, shorter structure; all zero is all default.
    expect_options(
        [](hmf_build_options& o) {
            o.struct_size = offsetof(hmf_build_options, memory_limit);
            o.memory_limit = 1;
        },
        HMF_OK);
    expect_options(
        [](hmf_build_options& o) {
            std::memset(&o, 0, sizeof o);
            o.struct_size = sizeof o;
        },
        HMF_OK);
    expect_options([](hmf_build_options& o) { o.coarsest = UINT64_MAX; }, HMF_OK);

    struct Longer {
        hmf_build_options known;
        uint64_t future;
    } longer;
    std::memset(&longer, 0, sizeof longer);
    hmf_build_options_init(&longer.known);
    longer.known.struct_size = sizeof longer;
    hmf_error error{};
    EXPECT_EQ(build(t, error, &longer.known), HMF_OK) << error.message;
    longer.future = 1;
    expect_error(build(t, error, &longer.known), HMF_ERROR_OPTIONS, error);

    hmf_hierarchy* h = nullptr;
    for (const size_t stride : {8, 16, 28, 25}) {
        error = hmf_error{};
        expect_error(hmf_build(t.positions.data(), t.vertex_count(), stride, t.triangles.data(), t.triangle_count(),
                               nullptr, &h, &error),
                     HMF_ERROR_OPTIONS, error);
    }
}

TEST_F(OnTorus, SolveOptionsAndReports) {
    const std::vector<double> start = valid_values();
    const auto expect_options = [&](const hmf_solve_options& options, hmf_status expected) {
        std::vector<double> values(mesh.edge_count, -1);
        const std::vector<double> before = values;
        hmf_error error{};
        expect_error(hmf_solve(hierarchy.get(), nullptr, &options, values.data(), values.size(), nullptr, &error),
                     expected, error);
        EXPECT_EQ(values, before);
        values = start;
        error = hmf_error{};
        expect_error(hmf_relax(hierarchy.get(), 0, &options, values.data(), values.size(), nullptr, &error), expected,
                     error);
        EXPECT_EQ(values, start);
    };
    for (const int32_t method : {-1, 4, 99}) expect_options(solve_options(method, 0), HMF_ERROR_OPTIONS);
    for (const double tolerance : {-1e-6, static_cast<double>(NAN), static_cast<double>(INFINITY)})
        expect_options(solve_options(HMF_METHOD_WHITEHEAD, tolerance), HMF_ERROR_OPTIONS);
    hmf_solve_options options = solve_options(HMF_METHOD_WHITEHEAD, 0);
    options.time_limit = -1;
    expect_options(options, HMF_ERROR_OPTIONS);
    options.time_limit = NAN;
    expect_options(options, HMF_ERROR_OPTIONS);
    options = solve_options(HMF_METHOD_WHITEHEAD, 0);
    options.struct_size = 1;
    expect_options(options, HMF_ERROR_OPTIONS);

    std::vector<double> values(mesh.edge_count, -1);
    hmf_error error{};
    options = solve_options(HMF_METHOD_WHITEHEAD, 0);
    options.stop_level = 1;
    expect_error(hmf_solve(hierarchy.get(), nullptr, &options, values.data(), values.size(), nullptr, &error),
                 HMF_ERROR_LEVEL, error);
    options.stop_level = 0;
    hmf_report report{};
    expect_error(hmf_solve(hierarchy.get(), nullptr, &options, values.data(), values.size(), &report, &error),
                 HMF_ERROR_OPTIONS, error);
    size_t count = 0;
    expect_error(hmf_loops(hierarchy.get(), 0, 17, nullptr, 0, nullptr, 0, &count, &count, &error), HMF_ERROR_OPTIONS,
                 error);
    Loops loops;
    loops.add(ring(1));
    hmf_loop_set set = loops.view();
    set.element_kind = 3;
    expect_error(hmf_initialize(hierarchy.get(), &set, values.data(), values.size(), &error), HMF_ERROR_OPTIONS, error);
    set = loops.view();
    set.struct_size = 2;
    expect_error(hmf_initialize(hierarchy.get(), &set, values.data(), values.size(), &error), HMF_ERROR_OPTIONS, error);
    set = loops.view();
    set.offsets = nullptr;
    expect_error(hmf_initialize(hierarchy.get(), &set, values.data(), values.size(), &error), HMF_ERROR_NULL, error);
    EXPECT_EQ(std::count(values.begin(), values.end(), -1.0), static_cast<long>(values.size()));
}

TEST_F(OnTorus, CapacitiesAndLevels) {
    const hmf_hierarchy* h = hierarchy.get();
    const size_t edges = mesh.edge_count, triangles = mesh.triangle_count, vertices = mesh.vertex_count;
    const std::vector<double> values = valid_values();
    std::vector<uint32_t> index(3 * edges, 77);
    std::vector<double> reals(3 * edges, -1);
    std::vector<int32_t> integers(edges, 77);
    std::vector<uint64_t> offsets(2, 77);
    std::vector<hmf_singularity> list(1);
    size_t count = 12345, total = 12345;
    hmf_error error{};
    for (const hmf_status expected : {HMF_ERROR_CAPACITY, HMF_ERROR_LEVEL}) {
        const size_t level = expected == HMF_ERROR_LEVEL ? 1 : 0, less = expected == HMF_ERROR_CAPACITY ? 1 : 0;
        const auto check = [&](hmf_status status) {
            expect_error(status, expected, error);
            error = hmf_error{};
        };
        check(hmf_level_edge_vertices(h, level, index.data(), 2 * edges - less, &error));
        check(hmf_level_triangle_edges(h, level, index.data(), 3 * triangles - less, &error));
        check(hmf_level_triangle_vertices(h, level, index.data(), 3 * triangles - less, &error));
        check(hmf_level_weights(h, level, reals.data(), edges - less, &error));
        check(hmf_level_positions(h, level, reals.data(), 3 * vertices - less, &error));
        check(hmf_loops(h, level, HMF_LOOPS_CUT, offsets.data(), 2 - less, nullptr, 0, &count, &total, &error));
        check(
            hmf_loops(h, level, HMF_LOOPS_CUT, nullptr, 0, index.data(), less ? 1 : 3 * edges, &count, &total, &error));
        check(hmf_relax(h, level, nullptr, reals.data(), edges - less, nullptr, &error));
        check(hmf_interpolate(h, level, values.data(), edges, 0, reals.data(), edges - less, &error));
        check(hmf_interpolate(h, 0, values.data(), edges - less, level, reals.data(), edges, &error));
        check(hmf_residuals(h, level, values.data(), edges, reals.data(), vertices - less, &error));
        check(hmf_energy(h, level, values.data(), edges - less, reals.data(), &error));
        check(hmf_singularities(h, level, values.data(), edges, integers.data(), vertices - less, nullptr, 0, nullptr,
                                0, nullptr, 0, &count, &error));
        check(hmf_singularities(h, level, values.data(), edges, nullptr, 0, integers.data(), triangles - less, nullptr,
                                0, nullptr, 0, &count, &error));
        check(hmf_singularities(h, level, values.data(), edges, nullptr, 0, nullptr, 0, index.data(), vertices - less,
                                nullptr, 0, &count, &error));
    }
    expect_error(hmf_solve(h, nullptr, nullptr, reals.data(), edges - 1, nullptr, &error), HMF_ERROR_CAPACITY, error);
    Loops loops;
    loops.add(ring(1));
    const hmf_loop_set set = loops.view();
    expect_error(hmf_initialize(h, &set, reals.data(), edges - 1, &error), HMF_ERROR_CAPACITY, error);
    EXPECT_EQ(std::count(index.begin(), index.end(), 77u), static_cast<long>(index.size()));
    EXPECT_EQ(std::count(reals.begin(), reals.end(), -1.0), static_cast<long>(reals.size()));
    EXPECT_EQ(std::count(integers.begin(), integers.end(), 77), static_cast<long>(integers.size()));
    EXPECT_EQ(std::count(offsets.begin(), offsets.end(), 77u), static_cast<long>(offsets.size()));
    EXPECT_EQ(count, 12345u);
    EXPECT_EQ(total, 12345u);
}

TEST(Call, ListOfSingularitiesHasACapacity) {
    const Hierarchy hierarchy(pretzel(2, 2));
    ASSERT_TRUE(hierarchy);
    const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_WHITEHEAD, 1e-6));
    size_t count = 0;
    hmf_error error{};
    ASSERT_EQ(hmf_singularities(hierarchy.get(), 0, solution.values.data(), solution.values.size(), nullptr, 0, nullptr,
                                0, nullptr, 0, nullptr, 0, &count, nullptr),
              HMF_OK);
    ASSERT_GT(count, 0u);
    std::vector<hmf_singularity> list(count);
    size_t again = 12345;
    expect_error(hmf_singularities(hierarchy.get(), 0, solution.values.data(), solution.values.size(), nullptr, 0,
                                   nullptr, 0, nullptr, 0, list.data(), count - 1, &again, &error),
                 HMF_ERROR_CAPACITY, error);
    EXPECT_EQ(again, 12345u);
}

TEST(Call, LoopsNeedALevelThatExists) {
    const Hierarchy hierarchy(torus(60, 24, 2, 1), 0.5, 200);
    ASSERT_TRUE(hierarchy);
    Loops loops = library_loops(hierarchy, 1);
    std::vector<double> values(hierarchy.edges(0), -1);
    const std::vector<double> before = values;
    hmf_error error{};
    loops.level = hierarchy.levels();
    const hmf_loop_set set = loops.view();
    expect_error(hmf_initialize(hierarchy.get(), &set, values.data(), values.size(), &error), HMF_ERROR_LEVEL, error);
    error = hmf_error{};
    expect_error(hmf_solve(hierarchy.get(), &set, nullptr, values.data(), values.size(), nullptr, &error),
                 HMF_ERROR_LEVEL, error);
    EXPECT_EQ(values, before);
}

// --- The mesh ----------------------------------------------------------------

TEST(BadMesh, Counts) {
    const TriMesh good = small_torus();
    hmf_error error{};
    hmf_hierarchy* h = nullptr;
    const double* x = good.positions.data();
    const uint32_t* t = good.triangles.data();
    const size_t v = good.vertex_count(), f = good.triangle_count(), huge = size_t{0x7fffffff} / 3 + 2;
    const size_t counts[][2] = {{0, f},    {v, 0},        {0, 0},        {huge, f},
                                {v, huge}, {SIZE_MAX, f}, {v, SIZE_MAX}, {SIZE_MAX / 8, SIZE_MAX / 8}};
    for (const auto& c : counts) {
        error = hmf_error{};
        expect_error(hmf_build(x, c[0], 0, t, c[1], nullptr, &h, &error), HMF_ERROR_MESH_COUNTS, error);
        EXPECT_EQ(h, nullptr);
    }
}

TEST(BadMesh, IndexAndCoordinates) {
    hmf_error error{};
    for (const uint32_t bad : {96u, 97u, UINT32_MAX}) {
        TriMesh mesh = small_torus();
        mesh.triangles[3 * 17 + 1] = bad;
        expect_error(build(mesh, error), HMF_ERROR_MESH_INDEX, error);
        EXPECT_EQ(error.element, HMF_ELEMENT_TRIANGLE);
        EXPECT_EQ(error.index, 17u);
    }
    for (const double bad : {static_cast<double>(NAN), static_cast<double>(INFINITY), static_cast<double>(-INFINITY)})
        for (size_t x = 0; x < 3; ++x) {
            TriMesh mesh = small_torus();
            mesh.positions[3 * 23 + x] = bad;
            expect_error(build(mesh, error), HMF_ERROR_MESH_NOT_FINITE, error);
            EXPECT_EQ(error.element, HMF_ELEMENT_VERTEX);
            EXPECT_EQ(error.index, 23u);
        }
}

TEST(BadMesh, Triangles) {
    hmf_error error{};
    TriMesh mesh = small_torus();
    mesh.triangles[3 * 9 + 2] = mesh.triangles[3 * 9];
    expect_error(build(mesh, error), HMF_ERROR_MESH_REPEATED_VERTEX, error);
    EXPECT_EQ(error.element, HMF_ELEMENT_TRIANGLE);
    EXPECT_EQ(error.index, 9u);

    mesh = small_torus(); // two corners at one place
    for (size_t x = 0; x < 3; ++x)
        mesh.positions[3 * mesh.triangles[30] + x] = mesh.positions[3 * mesh.triangles[31] + x];
    expect_error(build(mesh, error), HMF_ERROR_MESH_DEGENERATE, error);
    EXPECT_EQ(error.element, HMF_ELEMENT_TRIANGLE);

    mesh = subdivide(plate(1)); // a corner in the middle of the opposite side
    const uint32_t a = mesh.triangles[0], b = mesh.triangles[1], c = mesh.triangles[2];
    for (size_t x = 0; x < 3; ++x)
        mesh.positions[3 * c + x] = 0.5 * (mesh.positions[3 * a + x] + mesh.positions[3 * b + x]);
    expect_build(mesh, HMF_ERROR_MESH_DEGENERATE);
}

TEST(BadMesh, Topology) {
    TriMesh mesh = small_torus();
    mesh.triangles.resize(mesh.triangles.size() - 3);
    expect_build(mesh, HMF_ERROR_MESH_BOUNDARY);

    mesh = small_torus();
    std::swap(mesh.triangles[60], mesh.triangles[61]);
    expect_build(mesh, HMF_ERROR_MESH_ORIENTATION);

    mesh = small_torus();
    mesh.positions.insert(mesh.positions.end(), {1, 2, 3});
    hmf_error error{};
    expect_error(build(mesh, error), HMF_ERROR_MESH_UNUSED_VERTEX, error);
    EXPECT_EQ(error.element, HMF_ELEMENT_VERTEX);
    EXPECT_EQ(error.index, 96u);

    expect_build(two_tori({}), HMF_ERROR_MESH_COMPONENTS);
    expect_error(build(two_tori({40}), error), HMF_ERROR_MESH_NON_MANIFOLD_VERTEX, error);
    EXPECT_EQ(error.element, HMF_ELEMENT_VERTEX);
    EXPECT_EQ(error.index, 40u);
    expect_build(two_tori({40, 41}), HMF_ERROR_MESH_NON_MANIFOLD_EDGE);

    TriMesh sphere = plate(1);
    sphere = voxel_surface({0, 1, 2}, {0, 1, 2}, {0, 1}, [](size_t, size_t, size_t) { return true; });
    ASSERT_EQ(mesh_defect(sphere), "");
    expect_build(sphere, HMF_ERROR_MESH_GENUS);

    TriMesh tetrahedron;
    tetrahedron.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    tetrahedron.triangles = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    expect_build(tetrahedron, HMF_ERROR_MESH_GENUS);

    // All clockwise is as good as all counter-clockwise.
    mesh = small_torus();
    for (size_t t = 0; t < mesh.triangle_count(); ++t) std::swap(mesh.triangles[3 * t], mesh.triangles[3 * t + 1]);
    EXPECT_EQ(build(mesh, error), HMF_OK) << error.message;
}

// --- Loops -------------------------------------------------------------------

TEST_F(OnTorus, GoodLoops) {
    expect_loops({ring(0)}, HMF_OK, 0);
    expect_loops({row(2)}, HMF_OK, 0);
    expect_loops({ring(5)}, HMF_OK, 0, {1e-9});
}

TEST_F(OnTorus, LoopDefects) {
    expect_loops({{}, ring(2)}, HMF_ERROR_LOOP_COUNT, 0);
    std::vector<uint32_t> loop = ring(4);
    loop[3] = 192;
    expect_loops({loop}, HMF_ERROR_LOOP_INDEX, 0);
    loop[3] = UINT32_MAX;
    expect_loops({loop}, HMF_ERROR_LOOP_INDEX, 0);
    loop = ring(4);
    loop.pop_back();
    expect_loops({loop}, HMF_ERROR_LOOP_NOT_CLOSED, 0);
    loop = ring(4);
    loop[3] = ring(8)[3];
    expect_loops({loop}, HMF_ERROR_LOOP_NOT_CLOSED, 0);
    loop = ring(4); // twice round
    const std::vector<uint32_t> once = loop;
    loop.insert(loop.end(), once.begin(), once.end());
    expect_loops({loop}, HMF_ERROR_LOOP_NOT_SIMPLE, 0);
    expect_loops({ring(0), row(3)}, HMF_ERROR_LOOP_CROSSING, 1);
    expect_loops({ring(0), ring(6)}, HMF_ERROR_LOOP_PARALLEL, 1);
    // Round one vertex: the triangles at vertex 27, in order.
    std::vector<uint32_t> star;
    uint32_t from = UINT32_MAX;
    for (uint32_t t = 0; t < mesh.triangle_count && star.empty(); ++t)
        if (std::count(&mesh.triangle_vertices[3 * t], &mesh.triangle_vertices[3 * t] + 3, 27u)) star.push_back(t);
    for (bool found = true; found;) {
        found = false;
        for (uint32_t t = 0; t < mesh.triangle_count && !found; ++t) {
            if (std::count(star.begin(), star.end(), t)
                || !std::count(&mesh.triangle_vertices[3 * t], &mesh.triangle_vertices[3 * t] + 3, 27u))
                continue;
            size_t shared = 0;
            for (size_t x = 0; x < 9; ++x)
                shared += mesh.triangle_edges[3 * t + x / 3] == mesh.triangle_edges[3 * star.back() + x % 3];
            if (shared != 1 || t == from) continue;
            star.push_back(t);
            found = true;
        }
    }
    ASSERT_EQ(star.size(), 6u);
    expect_loops({star}, HMF_ERROR_LOOP_TRIVIAL, 0);

    Loops none;
    hmf_loop_set set = none.view();
    std::vector<double> values(mesh.edge_count);
    hmf_error error{};
    expect_error(hmf_initialize(hierarchy.get(), &set, values.data(), values.size(), &error), HMF_ERROR_LOOP_COUNT,
                 error);
}

TEST_F(OnTorus, LoopWeights) {
    for (const double bad : {0.0, -1.0, static_cast<double>(NAN), static_cast<double>(INFINITY)})
        expect_loops({ring(2)}, HMF_ERROR_LOOP_WEIGHT, 0, {bad});
}

TEST(BadLoops, WeightsSpanTooMuch) {
    const Hierarchy hierarchy(pretzel(2, 2));
    ASSERT_TRUE(hierarchy);
    Loops loops = library_loops(hierarchy, hierarchy.coarsest());
    std::vector<double> values(hierarchy.edges(hierarchy.coarsest()));
    hmf_error error{};
    loops.weights = {1, 1048576};
    hmf_loop_set set = loops.view();
    EXPECT_EQ(hmf_initialize(hierarchy.get(), &set, values.data(), values.size(), &error), HMF_OK) << error.message;
    loops.weights = {1, 1048577};
    set = loops.view();
    expect_error(hmf_initialize(hierarchy.get(), &set, values.data(), values.size(), &error), HMF_ERROR_LOOP_WEIGHT,
                 error);
}

// A loop that separates the surface is essential all the same.
TEST(BadLoops, SeparatingLoopIsGood) {
    const Hierarchy hierarchy(joined_tori(24, 12, 9, 8));
    ASSERT_TRUE(hierarchy);
    Loops loops;
    loops.level = hierarchy.coarsest();
    loops.add(section(
        read_level(hierarchy, loops.level), [](const double* p) { return p[0] - 4.507; },
        [](const double*) { return 1.0; }));
    const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_WHITEHEAD, 1e-6));
    ASSERT_LT(solution.status, HMF_ERROR_NULL) << solution.error.message;
    expect_foliation(hierarchy, read_level(hierarchy, 0), solution.values);
}

// --- Values ------------------------------------------------------------------

TEST_F(OnTorus, ValueDefects) {
    const std::vector<double> good = valid_values();
    for (const double bad : {-1.0, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
        std::vector<double> values = good;
        values[33] = bad;
        expect_values(values, HMF_ERROR_VALUE_NOT_FINITE);
    }
    std::vector<double> values = good;
    values[33] += 5; // longer than the two other sides
    expect_values(values, HMF_ERROR_VALUE_NOT_CLOSED);
    values = good;
    for (double& x : values) x = x > 0 ? x + 1e-30 : 1e-30; // no common unit
    values[7] = 1;
    expect_values(values, HMF_ERROR_VALUE_NOT_CLOSED);
    values.assign(good.size(), 0);
    expect_values(values, HMF_ERROR_VALUE_POLE);
    // Heights of a function on the vertices: closed, but with extrema.
    for (size_t e = 0; e < mesh.edge_count; ++e)
        values[e] = std::abs(static_cast<double>(mesh.edge_vertices[2 * e])
                             - static_cast<double>(mesh.edge_vertices[2 * e + 1]));
    ASSERT_EQ(closedness_defect(mesh, values), "");
    const Indices own = count_indices(mesh, values);
    ASSERT_GT(own.poles, 0u);
    expect_values(values, HMF_ERROR_VALUE_POLE);
    // hmf_singularities counts what is there.
    size_t count = 0;
    std::vector<hmf_singularity> list(mesh.vertex_count + mesh.triangle_count);
    ASSERT_EQ(hmf_singularities(hierarchy.get(), 0, values.data(), values.size(), nullptr, 0, nullptr, 0, nullptr, 0,
                                list.data(), list.size(), &count, nullptr),
              HMF_OK);
    size_t poles = 0;
    long sum = 0;
    for (size_t i = 0; i < count; ++i) poles += list[i].index > 0, sum += list[i].index;
    EXPECT_EQ(poles, own.poles);
    EXPECT_EQ(sum, 0);
}

// --- Resources ---------------------------------------------------------------

TEST(Resources, EveryAllocationMayFail) {
    for (const TriMesh& mesh : {torus(12, 8, 2, 1), with_random_flips(plate(2), 20, -1, 3)})
        for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_NEWTON}) {
            Meter meter;
            hmf_status status = whole_story(mesh, meter.options(), method);
            if (status == HMF_ERROR_UNSUPPORTED) continue;
            ASSERT_EQ(status, HMF_OK);
            ASSERT_EQ(meter.used, 0u);
            const uint64_t calls = meter.calls;
            ASSERT_GT(calls, 20u);
            for (uint64_t fail = 1; fail <= calls; ++fail) {
                Meter failing;
                failing.fail = fail;
                status = whole_story(mesh, failing.options(), method);
                ASSERT_EQ(status, HMF_ERROR_MEMORY) << "allocation " << fail << " of " << calls;
                ASSERT_EQ(failing.used, 0u) << "allocation " << fail << " of " << calls;
            }
        }
}

TEST(Resources, MemoryLimitIsKept) {
    const TriMesh mesh = torus(30, 16, 2, 1);
    uint64_t refused = 0;
    bool done = false;
    for (uint64_t limit = 64; !done; limit += limit / 8 + 1) {
        Meter meter;
        hmf_build_options options = meter.options();
        options.memory_limit = limit;
        const hmf_status status = whole_story(mesh, options, HMF_METHOD_WHITEHEAD);
        ASSERT_LE(meter.peak, limit);
        ASSERT_EQ(meter.used, 0u);
        if (status == HMF_OK) {
            done = true;
        } else {
            ASSERT_EQ(status, HMF_ERROR_MEMORY_LIMIT) << limit;
            ++refused;
        }
        ASSERT_LT(limit, uint64_t{1} << 32) << "no limit is enough";
    }
    EXPECT_GT(refused, 10u);

    Meter meter;
    hmf_build_options options = meter.options();
    options.memory_limit = hmf_memory_estimate(mesh.vertex_count(), mesh.triangle_count(), &options);
    hmf_error error{};
    EXPECT_EQ(build(mesh, error, &options), HMF_OK) << "the estimate is an upper bound; " << error.message;
}

// The handle itself counts as well.
TEST(Resources, MemoryLimitHoldsToTheByte) {
    for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_NEWTON}) {
        const TriMesh mesh = torus(30, 16, 2, 1);
        Meter free;
        ASSERT_EQ(whole_story(mesh, free.options(), method), HMF_OK);
        for (const uint64_t spare : {0, 1, 100, 1000}) {
            Meter meter;
            hmf_build_options options = meter.options();
            options.memory_limit = free.peak - spare;
            EXPECT_EQ(whole_story(mesh, options, method), spare ? HMF_ERROR_MEMORY_LIMIT : HMF_OK) << spare;
            EXPECT_LE(meter.peak, options.memory_limit);
            EXPECT_EQ(meter.used, 0u);
        }
    }
}

// Large enough for several levels of the linear solver.
TEST(Resources, AllocationsMayFailInNewton) {
    Meter meter;
    const Hierarchy hierarchy(pretzel(2, 3), meter.options());
    ASSERT_TRUE(hierarchy);
    const uint64_t held = meter.used, first = meter.calls;
    const hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 0);
    const Solution whole = solve(hierarchy, nullptr, options);
    ASSERT_LT(whole.status, HMF_ERROR_NULL);
    const uint64_t calls = meter.calls - first;
    ASSERT_GT(calls, 100u);
    for (uint64_t n = 1; n <= calls; n += 1 + calls / 60) {
        meter.fail = meter.calls + n;
        std::vector<double> values(whole.values.size(), -1);
        hmf_error error{};
        hmf_report report{};
        report.struct_size = sizeof report;
        const hmf_status status =
            hmf_solve(hierarchy.get(), nullptr, &options, values.data(), values.size(), &report, &error);
        expect_error(status, HMF_ERROR_MEMORY, error);
        EXPECT_EQ(std::count(values.begin(), values.end(), -1.0), static_cast<long>(values.size()));
        ASSERT_EQ(meter.used, held) << "allocation " << n << " of " << calls;
    }
}

// A hundred rounds on one hierarchy: memory returns to where it was.
TEST(Resources, MemoryIsFlat) {
    Meter meter;
    const TriMesh mesh = pretzel(2, 1);
    {
        const Hierarchy hierarchy(mesh, meter.options());
        ASSERT_TRUE(hierarchy);
        const uint64_t held = meter.used;
        for (int round = 0; round < 100; ++round) {
            const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_WHITEHEAD, 1e-3, 20));
            ASSERT_LT(solution.status, HMF_ERROR_NULL);
            EXPECT_LE(held + solution.report.peak_memory_bytes, meter.peak);
            ASSERT_EQ(meter.used, held);
        }
    }
    EXPECT_EQ(meter.used, 0u);
}

// --- Progress and limits -----------------------------------------------------

TEST(Progress, RisesToOneAndCancelsTheBuild) {
    const TriMesh mesh = pretzel(2, 3);
    Progress all;
    Meter meter;
    hmf_build_options options = meter.options();
    options.progress = Progress::call;
    options.progress_user = &all;
    hmf_error error{};
    ASSERT_EQ(build(mesh, error, &options), HMF_OK) << error.message;
    EXPECT_TRUE(all.rising);
    EXPECT_EQ(all.last, 1);
    ASSERT_GE(all.calls, 3u);
    // The last call reports the end; there is nothing left to cancel.
    for (uint64_t stop = 1; stop < all.calls; stop += 1 + all.calls / 50) {
        for (const int32_t answer : {HMF_PROGRESS_CANCEL, HMF_PROGRESS_FINISH, 12345}) {
            Progress progress;
            progress.stop = stop;
            progress.answer = answer;
            options.progress_user = &progress;
            error = hmf_error{};
            ASSERT_EQ(build(mesh, error, &options), HMF_CANCELLED) << "call " << stop << " of " << all.calls;
            EXPECT_EQ(error.status, HMF_CANCELLED);
            EXPECT_EQ(progress.calls, stop) << "called again after the answer";
            ASSERT_EQ(meter.used, 0u);
        }
    }
}

TEST(Progress, CancelsOrFinishesTheSolution) {
    Meter meter;
    const Hierarchy hierarchy(pretzel(2, 2), meter.options());
    ASSERT_TRUE(hierarchy);
    const uint64_t held = meter.used;
    const LevelMesh mesh = read_level(hierarchy, 0);
    for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL, HMF_METHOD_NEWTON}) {
        SCOPED_TRACE(method);
        Progress all;
        hmf_solve_options options = solve_options(method, method == HMF_METHOD_NEWTON ? 0 : 1e-5);
        options.progress = Progress::call;
        options.progress_user = &all;
        const Solution whole = solve(hierarchy, nullptr, options);
        if (whole.status == HMF_ERROR_UNSUPPORTED) continue;
        ASSERT_LT(whole.status, HMF_CANCELLED) << whole.error.message;
        EXPECT_TRUE(all.rising);
        if (whole.status == HMF_OK) { EXPECT_EQ(all.last, 1); }
        ASSERT_GE(all.calls, 3u);
        const uint64_t step = 1 + all.calls / 40;
        for (uint64_t stop = 1; stop < all.calls; stop += step)
            for (const int32_t answer : {HMF_PROGRESS_CANCEL, HMF_PROGRESS_FINISH}) {
                SCOPED_TRACE(testing::Message() << "call " << stop << " of " << all.calls << " answers " << answer);
                Progress progress;
                progress.stop = stop;
                progress.answer = answer;
                options.progress_user = &progress;
                std::vector<double> values(mesh.edge_count, -1);
                hmf_report report{};
                report.struct_size = sizeof report;
                hmf_error error{};
                const hmf_status status =
                    hmf_solve(hierarchy.get(), nullptr, &options, values.data(), values.size(), &report, &error);
                EXPECT_TRUE(progress.rising);
                if (answer == HMF_PROGRESS_FINISH && status == HMF_OK) {
                    EXPECT_EQ(values, whole.values); // asked too late: there was nothing left to improve
                    continue;
                }
                ASSERT_EQ(status, HMF_CANCELLED);
                EXPECT_EQ(error.status, HMF_CANCELLED);
                ASSERT_EQ(meter.used, held);
                if (answer == HMF_PROGRESS_FINISH) {
                    EXPECT_EQ(report.values_written, 1);
                } else {
                    EXPECT_EQ(progress.calls, stop) << "called again after the answer";
                }
                if (report.values_written) {
                    expect_foliation(hierarchy, mesh, values);
                } else {
                    EXPECT_EQ(std::count(values.begin(), values.end(), -1.0), static_cast<long>(values.size()));
                }
            }
    }
}

TEST(Progress, LimitsStillGiveAFoliation) {
    const Hierarchy hierarchy(pretzel(3, 3), 0.5, 400);
    ASSERT_TRUE(hierarchy);
    const LevelMesh mesh = read_level(hierarchy, 0);
    for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
        SCOPED_TRACE(method);
        const Solution few = solve(hierarchy, nullptr, solve_options(method, 1e-14, 2));
        EXPECT_EQ(few.status, HMF_LIMIT_ITERATIONS);
        EXPECT_EQ(few.report.converged, 0);
        expect_foliation(hierarchy, mesh, few.values);
        hmf_solve_options options = solve_options(method, 1e-15);
        options.time_limit = 1e-9;
        const Solution quick = solve(hierarchy, nullptr, options);
        EXPECT_EQ(quick.status, HMF_LIMIT_TIME);
        expect_foliation(hierarchy, mesh, quick.values);
    }
}
