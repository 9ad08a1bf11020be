// Every status, and nothing written on failure: defects of the call, of its
// structures, of the mesh, of loops and of values.
#include "support/watched_host.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace test_errors {

using namespace test;

namespace {

// A failing call says so in its error, too.
void expect_error(hmf_status status, hmf_status expected, const hmf_error& error) {
    EXPECT_EQ(status, expected) << hmf_status_string(status) << " instead of " << hmf_status_string(expected) << "; "
                                << error.message;
    EXPECT_EQ(error.status, status);
    EXPECT_NE(std::memchr(error.message, 0, sizeof error.message), nullptr);
    EXPECT_GT(std::strlen(error.message), 10u);
    if (expected == HMF_ERROR_NULL) { EXPECT_EQ(error.index, 0u); } // there is nothing to point at
}

// Of a call that makes an object, call(&object, &error): a failing one leaves NULL.
template <class T, class Call>
hmf_error outcome(Call&& call) {
    hmf_error error{};
    T* out = reinterpret_cast<T*>(&error); // must be overwritten
    const hmf_status status = call(&out, &error);
    EXPECT_EQ(error.status, status);
    EXPECT_EQ(out == nullptr, status != HMF_OK);
    if (out && status == HMF_OK) Owned<T>{out};
    return error;
}

template <class T, class Call>
hmf_error expect_failure(hmf_status expected, Call&& call) {
    const hmf_error error = outcome<T>(std::forward<Call>(call));
    expect_error(error.status, expected, error);
    return error;
}

hmf_status build(const TriMesh& mesh, hmf_error& error, const hmf_hierarchy_options* options = nullptr) {
    hmf_hierarchy* hierarchy = reinterpret_cast<hmf_hierarchy*>(&error); // must be overwritten
    const hmf_status status = hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                                   mesh.triangle_count(), options, nullptr, &hierarchy, &error);
    EXPECT_EQ(hierarchy == nullptr, status != HMF_OK);
    hmf_hierarchy_destroy(hierarchy);
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

template <class T>
T sized() {
    T structure;
    std::memset(static_cast<void*>(&structure), 0, sizeof structure);
    structure.struct_size = sizeof structure;
    return structure;
}

// A structure of an older header ends early, and what is not there is the
// default; one of a newer header must end in zeros.  A size that no structure can
// have, which may cut a pointer in two, is refused.  call(structure, error)
// returns a status; `least` bytes are enough for it to succeed.
template <class T, class Call>
auto expect_reserved(const T& good, Call&& call, int) -> decltype(good.reserved, void()) {
    T other = good;
    other.reserved = 5;
    hmf_error error{};
    expect_error(call(&other, &error), HMF_ERROR_OPTIONS, error);
}
template <class T, class Call>
void expect_reserved(const T&, Call&&, long) {}

template <class T, class Call>
void expect_sizes(const T& good, Call&& call, size_t least = alignof(T)) {
    struct Longer {
        T known;
        uint64_t future;
    } longer;
    std::memset(static_cast<void*>(&longer), 0, sizeof longer);
    longer.known = good;
    hmf_error error{};
    longer.known.struct_size = sizeof longer;
    EXPECT_EQ(call(&longer.known, &error), HMF_OK) << error.message;
    longer.future = 1;
    expect_error(call(&longer.known, &error), HMF_ERROR_OPTIONS, error);
    expect_reserved(good, call, 0);
    // What lies beyond struct_size is not read.
    T cut;
    for (size_t size = least; size < sizeof good; size += alignof(T)) {
        std::memset(static_cast<void*>(&cut), 0xff, sizeof cut);
        std::memcpy(static_cast<void*>(&cut), &good, size);
        cut.struct_size = static_cast<uint32_t>(size);
        error = hmf_error{};
        EXPECT_EQ(call(&cut, &error), HMF_OK) << size << " bytes: " << error.message;
    }
    std::vector<uint32_t> refused{0, 1u << 20, 8u << 20, UINT32_MAX, UINT32_MAX - 7};
    for (uint32_t size = 1; size < sizeof longer; ++size)
        if (size % alignof(T) != 0) refused.push_back(size);
    for (const uint32_t size : refused) {
        cut = good;
        cut.struct_size = size;
        error = hmf_error{};
        expect_error(call(&cut, &error), HMF_ERROR_OPTIONS, error);
        EXPECT_EQ(error.element, HMF_ELEMENT_OPTION);
        EXPECT_EQ(error.index, 0u);
    }
}

// Loops and values on a small torus of one level.
class OnTorus : public testing::Test {
protected:
    static constexpr uint32_t n = 12, m = 8;
    Hierarchy hierarchy{small_torus()};
    LevelMesh mesh = read_level(hierarchy, 0);

    // Triangles between column i and i + 1, in a ring around the tube; triangles
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
    hmf_error initialized(const hmf_loop_set* set) {
        return outcome<hmf_foliation>([&](hmf_foliation** out, hmf_error* error) {
            return hmf_foliation_from_loops(hierarchy.get(), set, nullptr, out, error);
        });
    }
    hmf_error solved(const hmf_loop_set* set, const hmf_solve_options* options = nullptr) {
        return outcome<hmf_foliation>([&](hmf_foliation** out, hmf_error* error) {
            return hmf_solve(hierarchy.get(), set, options, nullptr, out, error);
        });
    }
    void expect_loops(const std::vector<std::vector<uint32_t>>& given, hmf_status expected, uint64_t bad_loop,
                      const std::vector<double>& weights = {}) {
        Loops loops;
        for (const auto& loop : given) loops.add(loop);
        loops.weights = weights;
        const hmf_loop_set set = loops.view();
        for (const hmf_error& error : {initialized(&set), solved(&set)}) {
            if (expected == HMF_OK) {
                EXPECT_EQ(error.status, HMF_OK) << error.message;
                continue;
            }
            expect_error(error.status, expected, error);
            EXPECT_EQ(error.element, HMF_ELEMENT_LOOP);
            EXPECT_EQ(error.index, bad_loop);
        }
    }
    Foliation good() {
        Loops loops;
        loops.add(ring(3));
        return initialize(hierarchy, loops);
    }
    hmf_error created(const std::vector<double>& values, size_t level = 0) {
        return outcome<hmf_foliation>([&](hmf_foliation** out, hmf_error* error) {
            return hmf_foliation_from_values(hierarchy.get(), level, values.data(), values.size(), nullptr, out, error);
        });
    }
    void expect_values(const std::vector<double>& values, hmf_status expected) {
        const hmf_error error = created(values);
        expect_error(error.status, expected, error);
    }
    // Only what counts poles accepts them.
    void expect_poles(const std::vector<double>& values) {
        const Foliation f = create(hierarchy, 0, values);
        ASSERT_TRUE(f);
        EXPECT_EQ(values_of(f), values);
        EXPECT_GE(energy(f), 0);
        const Indices own = count_indices(mesh, values);
        ASSERT_GT(own.poles, 0u);
        const auto set = singularities(f);
        size_t poles = 0;
        long sum = 0;
        for (size_t i = 0; i < set->count; ++i) poles += set->list[i].index > 0, sum += set->list[i].index;
        EXPECT_EQ(poles, own.poles);
        EXPECT_EQ(sum, 0);

        const hmf_status refused = HMF_ERROR_VALUE_POLE;
        expect_failure<hmf_residual_set>(
            refused, [&](auto out, hmf_error* e) { return hmf_residuals(f.get(), nullptr, out, e); });
        hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 0);
        expect_failure<hmf_foliation>(
            refused, [&](auto out, hmf_error* e) { return hmf_relax(f.get(), nullptr, nullptr, out, e); });
        expect_failure<hmf_foliation>(
            refused, [&](auto out, hmf_error* e) { return hmf_interpolate(f.get(), 0, nullptr, out, e); });
        options.start = f.get();
        expect_error(solved(nullptr, &options).status, refused, solved(nullptr, &options));
        expect_failure<hmf_parameterization>(
            refused, [&](auto out, hmf_error* e) { return hmf_parameterize(f.get(), nullptr, nullptr, out, e); });
        expect_failure<hmf_lines>(refused,
                                  [&](auto out, hmf_error* e) { return hmf_trace(f.get(), nullptr, nullptr, out, e); });
        expect_failure<hmf_cylinder_set>(
            refused, [&](auto out, hmf_error* e) { return hmf_cylinders(f.get(), nullptr, nullptr, out, e); });
        expect_failure<hmf_quad_mesh>(
            refused, [&](auto out, hmf_error* e) { return hmf_quads(f.get(), nullptr, nullptr, out, e); });
        expect_failure<hmf_chart_set>(
            refused, [&](auto out, hmf_error* e) { return hmf_atlas(f.get(), nullptr, nullptr, out, e); });
    }
};

} // namespace

// --- The call ----------------------------------------------------------------

TEST_F(OnTorus, NullPointers) {
    const TriMesh t = small_torus();
    hmf_error error{};
    const double* positions = t.positions.data();
    const uint32_t* triangles = t.triangles.data();
    const size_t vertices = t.vertex_count(), faces = t.triangle_count();
    hmf_hierarchy* h = nullptr;
    expect_error(hmf_hierarchy_create(nullptr, vertices, triangles, faces, nullptr, nullptr, &h, &error),
                 HMF_ERROR_NULL, error);
    expect_error(hmf_hierarchy_create(positions, vertices, nullptr, faces, nullptr, nullptr, &h, &error),
                 HMF_ERROR_NULL, error);
    expect_error(hmf_hierarchy_create(positions, vertices, triangles, faces, nullptr, nullptr, nullptr, &error),
                 HMF_ERROR_NULL, error);
    EXPECT_EQ(h, nullptr);
    expect_error(hmf_components(positions, vertices, triangles, faces, nullptr, nullptr, nullptr, &error),
                 HMF_ERROR_NULL, error);
    expect_error(hmf_even_design(positions, vertices, triangles, faces, nullptr, nullptr, nullptr, &error),
                 HMF_ERROR_NULL, error);
    // First the object is missing, then the output.
    const Foliation f = good();
    const std::vector<double> values = values_of(f);
    const double* const v = values.data();
    const size_t count = values.size();
    double value = 0;
    const Loops loops = library_loops(hierarchy, 0);
    const hmf_loop_set set = loops.view();
    hmf_foliation* none = nullptr;
    expect_error(hmf_solve(hierarchy.get(), nullptr, nullptr, nullptr, &none, &error), HMF_ERROR_NULL, error);
    expect_error(hmf_foliation_from_loops(hierarchy.get(), nullptr, nullptr, &none, &error), HMF_ERROR_NULL, error);
    EXPECT_EQ(none, nullptr);
    for (const bool there : {false, true}) {
        SCOPED_TRACE(there);
        const hmf_hierarchy* const x = there ? hierarchy.get() : nullptr;
        const hmf_foliation* const y = there ? f.get() : nullptr;
        double* const reals = there ? nullptr : &value;
        const auto check = [&](hmf_status status) {
            expect_error(status, HMF_ERROR_NULL, error);
            error = hmf_error{};
        };
        check(hmf_energy(y, nullptr, reals, &error));
        const auto make = [&](auto* kind, auto&& call) {
            using T = std::remove_pointer_t<decltype(kind)>;
            if (there) {
                check(call(static_cast<T**>(nullptr), &error));
            } else {
                expect_failure<T>(HMF_ERROR_NULL, call);
            }
        };
        make(static_cast<hmf_level_mesh*>(nullptr), [&](auto out, auto e) { return hmf_level(x, 0, nullptr, out, e); });
        make(static_cast<hmf_residual_set*>(nullptr),
             [&](auto out, auto e) { return hmf_residuals(y, nullptr, out, e); });
        make(static_cast<hmf_scale*>(nullptr),
             [&](auto out, auto e) { return hmf_conformal_scale(y, nullptr, out, e); });
        make(static_cast<hmf_loop_set*>(nullptr),
             [&](auto out, auto e) { return hmf_loops(x, 0, HMF_LOOPS_CUT, nullptr, out, e); });
        hmf_foliation* const made = nullptr;
        make(made, [&](auto out, auto e) { return hmf_foliation_from_loops(x, &set, nullptr, out, e); });
        make(made, [&](auto out, auto e) { return hmf_foliation_from_values(x, 0, v, count, nullptr, out, e); });
        make(made, [&](auto out, auto e) { return hmf_solve(x, &set, nullptr, nullptr, out, e); });
        make(made, [&](auto out, auto e) { return hmf_solve_cut_system(x, nullptr, nullptr, out, e); });
        make(made, [&](auto out, auto e) { return hmf_relax(y, nullptr, nullptr, out, e); });
        make(made, [&](auto out, auto e) { return hmf_interpolate(y, 0, nullptr, out, e); });
        make(static_cast<hmf_singularity_set*>(nullptr),
             [&](auto out, auto e) { return hmf_singularities(y, nullptr, out, e); });
        make(static_cast<hmf_parameterization*>(nullptr),
             [&](auto out, auto e) { return hmf_parameterize(y, nullptr, nullptr, out, e); });
        make(static_cast<hmf_lines*>(nullptr),
             [&](auto out, auto e) { return hmf_trace(y, nullptr, nullptr, out, e); });
        make(static_cast<hmf_cylinder_set*>(nullptr),
             [&](auto out, auto e) { return hmf_cylinders(y, nullptr, nullptr, out, e); });
        make(static_cast<hmf_quad_mesh*>(nullptr),
             [&](auto out, auto e) { return hmf_quads(y, nullptr, nullptr, out, e); });
        make(static_cast<hmf_chart_set*>(nullptr),
             [&](auto out, auto e) { return hmf_atlas(y, nullptr, nullptr, out, e); });
    }
    expect_failure<hmf_foliation>(HMF_ERROR_NULL, [&](auto out, hmf_error* e) {
        return hmf_foliation_from_values(hierarchy.get(), 0, nullptr, count, nullptr, out, e);
    });
    // The error itself is optional.
    EXPECT_EQ(hmf_energy(nullptr, nullptr, &value, nullptr), HMF_ERROR_NULL);
}

// The defaults fill the structure of the caller, whichever version it is of, and nothing beside it.
template <class Options>
void expect_defaults(void (*init)(Options*, uint32_t)) {
    for (const size_t size : {sizeof(Options), size_t{8}, sizeof(Options) + 24}) {
        SCOPED_TRACE(size);
        alignas(Options) unsigned char bytes[sizeof(Options) + 32];
        std::memset(bytes, 0xa5, sizeof bytes);
        init(reinterpret_cast<Options*>(bytes), static_cast<uint32_t>(size));
        uint32_t written = 0;
        std::memcpy(&written, bytes, sizeof written);
        EXPECT_EQ(written, size);
        for (size_t i = sizeof(Options); i < sizeof bytes; ++i) EXPECT_EQ(bytes[i], i < size ? 0 : 0xa5) << i;
        for (size_t i = size; i < sizeof(Options); ++i) EXPECT_EQ(bytes[i], 0xa5) << i;
    }
    init(nullptr, sizeof(Options));
}

TEST_F(OnTorus, OptionsHaveDefaults) {
    expect_defaults(hmf_control_init);
    expect_defaults(hmf_hierarchy_options_init);
    expect_defaults(hmf_solve_options_init);
    expect_defaults(hmf_design_options_init);
    expect_defaults(hmf_parameterize_options_init);
    expect_defaults(hmf_trace_options_init);
    expect_defaults(hmf_quad_options_init);
    expect_defaults(hmf_atlas_options_init);
    hmf_solve_options options;
    hmf_solve_options_init(&options, sizeof options);
    EXPECT_EQ(options.method, HMF_METHOD_NEWTON);
    EXPECT_EQ(options.iteration_limit, 100000u);
    const Foliation defaults = make<hmf_foliation>(
        [&](auto out, hmf_error* e) { return hmf_solve_cut_system(hierarchy.get(), nullptr, nullptr, out, e); });
    const Foliation same = make<hmf_foliation>(
        [&](auto out, hmf_error* e) { return hmf_solve_cut_system(hierarchy.get(), &options, nullptr, out, e); });
    EXPECT_EQ(values_of(defaults), values_of(same));
    hmf_atlas_options atlas;
    hmf_atlas_options_init(&atlas, sizeof atlas);
    EXPECT_EQ(atlas.margin, 1.0 / 512);
}

TEST(Call, NullIsFreed) {
    hmf_hierarchy_destroy(nullptr);
    hmf_foliation_destroy(nullptr);
    hmf_free(nullptr);
    size_t count = 7;
    EXPECT_EQ(hmf_foliation_values(nullptr, &count), nullptr);
    EXPECT_EQ(count, 0u);
    EXPECT_EQ(hmf_foliation_values(nullptr, nullptr), nullptr);
    EXPECT_EQ(hmf_foliation_level(nullptr), 0u);
    EXPECT_EQ(hmf_foliation_unit(nullptr), 0);
    EXPECT_EQ(hmf_foliation_report(nullptr), nullptr);
}

TEST_F(OnTorus, BuildOptions) {
    const TriMesh t = small_torus();
    const auto expect_options = [&](void (*change)(hmf_hierarchy_options&), hmf_status expected) {
        hmf_hierarchy_options options = sized<hmf_hierarchy_options>();
        change(options);
        hmf_error error{};
        const hmf_status status = build(t, error, &options);
        if (expected == HMF_OK) {
            EXPECT_EQ(status, HMF_OK) << error.message;
        } else {
            expect_error(status, expected, error);
        }
    };
    expect_options([](hmf_hierarchy_options&) {}, HMF_OK);
    expect_options([](hmf_hierarchy_options& o) { o.ratio = 0.04; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.ratio = 0.96; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.ratio = -0.5; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.ratio = NAN; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.ratio = 0.05; }, HMF_OK);
    expect_options([](hmf_hierarchy_options& o) { o.ratio = 0.95; }, HMF_OK);
    expect_options([](hmf_hierarchy_options& o) { o.collapse = 4; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.collapse = -1; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.allocate = WatchedHost::take; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.release = WatchedHost::give; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.coarsest = UINT64_MAX; }, HMF_OK);
    expect_options([](hmf_hierarchy_options& o) { o.position_stride = 24; }, HMF_OK);
    expect_options([](hmf_hierarchy_options& o) { o.position_stride = 8; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.position_stride = 16; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.position_stride = 25; }, HMF_ERROR_OPTIONS);
    expect_options([](hmf_hierarchy_options& o) { o.position_stride = 28; }, HMF_ERROR_OPTIONS);
    // Steps that would go back by a few bytes.
    for (const uint64_t near : {7u, 23u, 63u})
        for (const uint64_t stride : {UINT64_MAX - near, (uint64_t{1} << 63) - near - 1, (uint64_t{1} << 61) + 24}) {
            hmf_hierarchy_options options = sized<hmf_hierarchy_options>();
            options.position_stride = stride;
            hmf_error error{};
            expect_error(build(t, error, &options), HMF_ERROR_OPTIONS, error);
        }
}

TEST_F(OnTorus, StructuresOfOtherHeaders) {
    const TriMesh t = small_torus();
    const Foliation f = good();
    const Solution harmonic = relax(f, solve_options(HMF_METHOD_NEWTON, 0));
    ASSERT_EQ(harmonic.status, HMF_OK);
    {
        SCOPED_TRACE("hmf_hierarchy_options");
        expect_sizes(sized<hmf_hierarchy_options>(),
                     [&](const hmf_hierarchy_options* o, hmf_error* error) { return build(t, *error, o); });
    }
    {
        SCOPED_TRACE("hmf_solve_options");
        expect_sizes(sized<hmf_solve_options>(), [&](const hmf_solve_options* o, hmf_error* error) {
            *error = outcome<hmf_foliation>(
                [&](auto out, hmf_error* e) { return hmf_solve_cut_system(hierarchy.get(), o, nullptr, out, e); });
            return error->status;
        });
        expect_sizes(sized<hmf_solve_options>(), [&](const hmf_solve_options* o, hmf_error* error) {
            *error =
                outcome<hmf_foliation>([&](auto out, hmf_error* e) { return hmf_relax(f.get(), o, nullptr, out, e); });
            return error->status;
        });
    }
    {
        SCOPED_TRACE("hmf_parameterize_options");
        expect_sizes(sized<hmf_parameterize_options>(), [&](const hmf_parameterize_options* o, hmf_error* error) {
            *error = outcome<hmf_parameterization>(
                [&](auto out, hmf_error* e) { return hmf_parameterize(harmonic.foliation.get(), o, nullptr, out, e); });
            return error->status;
        });
    }
    {
        SCOPED_TRACE("hmf_trace_options");
        expect_sizes(sized<hmf_trace_options>(), [&](const hmf_trace_options* o, hmf_error* error) {
            *error = outcome<hmf_lines>([&](auto out, hmf_error* e) { return hmf_trace(f.get(), o, nullptr, out, e); });
            return error->status;
        });
    }
    {
        SCOPED_TRACE("hmf_quad_options");
        expect_sizes(sized<hmf_quad_options>(), [&](const hmf_quad_options* o, hmf_error* error) {
            *error = outcome<hmf_quad_mesh>(
                [&](auto out, hmf_error* e) { return hmf_quads(harmonic.foliation.get(), o, nullptr, out, e); });
            return error->status;
        });
    }
    {
        SCOPED_TRACE("hmf_atlas_options");
        expect_sizes(sized<hmf_atlas_options>(), [&](const hmf_atlas_options* o, hmf_error* error) {
            *error = outcome<hmf_chart_set>(
                [&](auto out, hmf_error* e) { return hmf_atlas(harmonic.foliation.get(), o, nullptr, out, e); });
            return error->status;
        });
    }
    {
        SCOPED_TRACE("hmf_loop_set");
        Loops loops;
        loops.add(ring(1));
        const size_t least = offsetof(hmf_loop_set, weights);
        expect_sizes(
            loops.view(),
            [&](const hmf_loop_set* set, hmf_error* error) {
                *error = initialized(set);
                return error->status;
            },
            least);
        expect_sizes(
            loops.view(),
            [&](const hmf_loop_set* set, hmf_error* error) {
                *error = solved(set);
                return error->status;
            },
            least);
        expect_sizes(
            loops.view(),
            [&](const hmf_loop_set* set, hmf_error* error) {
                *error = outcome<hmf_cylinder_set>([&](auto out, hmf_error* e) {
                    return hmf_cylinders(harmonic.foliation.get(), set, nullptr, out, e);
                });
                return error->status;
            },
            least);
    }
    {
        SCOPED_TRACE("hmf_control");
        Progress progress;
        const hmf_control control = progress.control();
        const auto every = [&](auto&& call) { expect_sizes(control, call, sizeof control); };
        const hmf_hierarchy* const h = hierarchy.get();
        const std::vector<double> values = values_of(f);
        std::vector<double> residual(mesh.vertex_count);
        double energy = 0;
        every([&](const hmf_control* c, hmf_error* error) {
            hmf_hierarchy* made = nullptr;
            const hmf_status status = hmf_hierarchy_create(t.positions.data(), t.vertex_count(), t.triangles.data(),
                                                           t.triangle_count(), nullptr, c, &made, error);
            hmf_hierarchy_destroy(made);
            return status;
        });
        const auto making = [&](auto* kind, auto&& call) {
            every([&](const hmf_control* c, hmf_error* error) {
                *error = outcome<std::remove_pointer_t<decltype(kind)>>(
                    [&](auto out, hmf_error* e) { return call(c, out, e); });
                return error->status;
            });
        };
        const hmf_foliation *const g = f.get(), *const best = harmonic.foliation.get();
        hmf_foliation* const foliation = nullptr;
        const Loops loops = [&] {
            Loops l;
            l.add(ring(3));
            return l;
        }();
        const hmf_loop_set set = loops.view();
        making(static_cast<hmf_loop_set*>(nullptr),
               [&](auto c, auto out, auto e) { return hmf_loops(h, 0, HMF_LOOPS_CUT, c, out, e); });
        making(foliation, [&](auto c, auto out, auto e) { return hmf_foliation_from_loops(h, &set, c, out, e); });
        making(foliation, [&](auto c, auto out, auto e) {
            return hmf_foliation_from_values(h, 0, values.data(), values.size(), c, out, e);
        });
        making(foliation, [&](auto c, auto out, auto e) { return hmf_solve(h, &set, nullptr, c, out, e); });
        making(foliation, [&](auto c, auto out, auto e) { return hmf_relax(g, nullptr, c, out, e); });
        making(foliation, [&](auto c, auto out, auto e) { return hmf_interpolate(g, 0, c, out, e); });
        every([&](const hmf_control* c, hmf_error* e) { return hmf_energy(g, c, &energy, e); });
        making(static_cast<hmf_level_mesh*>(nullptr),
               [&](auto c, auto out, auto e) { return hmf_level(h, 0, c, out, e); });
        making(static_cast<hmf_residual_set*>(nullptr),
               [&](auto c, auto out, auto e) { return hmf_residuals(g, c, out, e); });
        making(static_cast<hmf_singularity_set*>(nullptr),
               [&](auto c, auto out, auto e) { return hmf_singularities(g, c, out, e); });
        making(static_cast<hmf_parameterization*>(nullptr),
               [&](auto c, auto out, auto e) { return hmf_parameterize(best, nullptr, c, out, e); });
        making(static_cast<hmf_lines*>(nullptr),
               [&](auto c, auto out, auto e) { return hmf_trace(g, nullptr, c, out, e); });
        making(static_cast<hmf_cylinder_set*>(nullptr),
               [&](auto c, auto out, auto e) { return hmf_cylinders(best, &set, c, out, e); });
        making(static_cast<hmf_quad_mesh*>(nullptr),
               [&](auto c, auto out, auto e) { return hmf_quads(best, nullptr, c, out, e); });
        hmf_quad_options wish{};
        wish.struct_size = sizeof wish;
        wish.count = 9000; // refined
        wish.merge = 1;
        wish.relax = 2;
        making(static_cast<hmf_quad_mesh*>(nullptr),
               [&](auto c, auto out, auto e) { return hmf_quads(best, &wish, c, out, e); });
        making(static_cast<hmf_chart_set*>(nullptr),
               [&](auto c, auto out, auto e) { return hmf_atlas(best, nullptr, c, out, e); });
        // Without the function there is nothing to call.
        hmf_control none = control;
        none.struct_size = offsetof(hmf_control, progress);
        EXPECT_EQ(hmf_energy(g, &none, &energy, nullptr), HMF_OK);
    }
}

TEST_F(OnTorus, SolveOptions) {
    const Foliation f = good();
    const auto expect_options = [&](const hmf_solve_options& options, hmf_status expected) {
        const hmf_error error = solved(nullptr, &options);
        expect_error(error.status, expected, error);
        expect_failure<hmf_foliation>(
            expected, [&](auto out, hmf_error* e) { return hmf_relax(f.get(), &options, nullptr, out, e); });
    };
    for (const int32_t method : {-1, HMF_METHOD_PAPER + 1, 99})
        expect_options(solve_options(method, 0), HMF_ERROR_OPTIONS);
    for (const double tolerance : {-1e-6, static_cast<double>(NAN), static_cast<double>(INFINITY)})
        expect_options(solve_options(HMF_METHOD_WHITEHEAD, tolerance), HMF_ERROR_OPTIONS);
    hmf_solve_options options = solve_options(HMF_METHOD_WHITEHEAD, 0);
    options.time_limit = -1;
    expect_options(options, HMF_ERROR_OPTIONS);
    options.time_limit = NAN;
    expect_options(options, HMF_ERROR_OPTIONS);
    options = solve_options(HMF_METHOD_WHITEHEAD, 0);
    options.stop_level = hmf_hierarchy_describe(hierarchy.get())->level_count;
    EXPECT_EQ(solved(nullptr, &options).status, HMF_ERROR_LEVEL);

    expect_failure<hmf_loop_set>(
        HMF_ERROR_OPTIONS, [&](auto out, hmf_error* e) { return hmf_loops(hierarchy.get(), 0, 17, nullptr, out, e); });
    Loops loops;
    loops.add(ring(1));
    hmf_loop_set set = loops.view();
    set.element_kind = 3;
    EXPECT_EQ(initialized(&set).status, HMF_ERROR_OPTIONS);
    set = loops.view();
    set.offsets = nullptr;
    EXPECT_EQ(initialized(&set).status, HMF_ERROR_NULL);
    set = loops.view();
    set.elements = nullptr;
    EXPECT_EQ(initialized(&set).status, HMF_ERROR_NULL);
    // Loops and a start are two classes.
    options = solve_options(HMF_METHOD_NEWTON, 0);
    options.start = f.get();
    set = loops.view();
    EXPECT_EQ(solved(&set, &options).status, HMF_ERROR_OPTIONS);
    EXPECT_EQ(solved(nullptr, &options).status, HMF_OK);
}

TEST_F(OnTorus, CountsAndLevels) {
    const hmf_hierarchy* h = hierarchy.get();
    const size_t none = hmf_hierarchy_describe(h)->level_count;
    const size_t edges = mesh.edge_count;
    const Foliation f = good();
    const std::vector<double> values = values_of(f);
    const std::vector<double> more(edges + 1, 0);
    for (const hmf_status expected : {HMF_ERROR_COUNT, HMF_ERROR_LEVEL}) {
        const size_t level = expected == HMF_ERROR_LEVEL ? none : 0, less = expected == HMF_ERROR_COUNT ? 1 : 0;
        expect_failure<hmf_foliation>(expected, [&](auto out, hmf_error* e) {
            return hmf_foliation_from_values(h, level, values.data(), edges - less, nullptr, out, e);
        });
    }
    expect_failure<hmf_foliation>(HMF_ERROR_COUNT, [&](auto out, hmf_error* e) {
        return hmf_foliation_from_values(h, 0, more.data(), edges + 1, nullptr, out, e);
    });
    expect_failure<hmf_level_mesh>(HMF_ERROR_LEVEL,
                                   [&](auto out, hmf_error* e) { return hmf_level(h, none, nullptr, out, e); });
    expect_failure<hmf_loop_set>(
        HMF_ERROR_LEVEL, [&](auto out, hmf_error* e) { return hmf_loops(h, none, HMF_LOOPS_CUT, nullptr, out, e); });
    expect_failure<hmf_foliation>(
        HMF_ERROR_LEVEL, [&](auto out, hmf_error* e) { return hmf_interpolate(f.get(), none, nullptr, out, e); });
}

TEST(Call, LoopsNeedALevelThatExists) {
    const Hierarchy hierarchy(torus(60, 24, 2, 1), 0.5, 200);
    ASSERT_TRUE(hierarchy);
    Loops loops = library_loops(hierarchy, 1);
    loops.level = hierarchy.levels();
    const hmf_loop_set set = loops.view();
    expect_failure<hmf_foliation>(HMF_ERROR_LEVEL, [&](auto out, hmf_error* e) {
        return hmf_foliation_from_loops(hierarchy.get(), &set, nullptr, out, e);
    });
    expect_failure<hmf_foliation>(HMF_ERROR_LEVEL, [&](auto out, hmf_error* e) {
        return hmf_solve(hierarchy.get(), &set, nullptr, nullptr, out, e);
    });
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
        expect_error(hmf_hierarchy_create(x, c[0], t, c[1], nullptr, nullptr, &h, &error), HMF_ERROR_MESH_COUNTS,
                     error);
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
    mesh.triangles = {0, 1, 9}; // two disks
    expect_build(mesh, HMF_ERROR_MESH_UNUSED_VERTEX);
    mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    mesh.triangles = {0, 1, 2, 2, 1, 3};
    expect_build(mesh, HMF_ERROR_MESH_GENUS);

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
    // Around one vertex: the triangles at vertex 27, in order.
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
    const hmf_loop_set set = none.view();
    EXPECT_EQ(initialized(&set).status, HMF_ERROR_LOOP_COUNT);
}

TEST_F(OnTorus, LoopWeights) {
    for (const double bad :
         {0.0, -1.0, static_cast<double>(NAN), static_cast<double>(INFINITY), 1e100, 0.9e-100, 5e-324})
        expect_loops({ring(2)}, HMF_ERROR_LOOP_WEIGHT, 0, {bad});
    for (const double good : {1e-100, 3.0, 0.999e100}) expect_loops({ring(2)}, HMF_OK, 0, {good});
}

TEST(BadLoops, WeightsSpanTooMuch) {
    const Hierarchy hierarchy(pretzel(2, 2));
    ASSERT_TRUE(hierarchy);
    Loops loops = library_loops(hierarchy, hierarchy.coarsest());
    loops.weights = {1, 1048576};
    EXPECT_TRUE(initialize(hierarchy, loops));
    loops.weights = {1, 1048577};
    const hmf_loop_set set = loops.view();
    expect_failure<hmf_foliation>(HMF_ERROR_LOOP_WEIGHT, [&](auto out, hmf_error* e) {
        return hmf_foliation_from_loops(hierarchy.get(), &set, nullptr, out, e);
    });
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
    expect_foliation(read_level(hierarchy, 0), solution.foliation);
}

// --- Values ------------------------------------------------------------------

TEST_F(OnTorus, ValueDefects) {
    const std::vector<double> good = values_of(this->good());
    for (const double bad : {-1.0, static_cast<double>(NAN), static_cast<double>(INFINITY)}) {
        std::vector<double> values = good;
        values[33] = bad;
        expect_values(values, HMF_ERROR_VALUE_NOT_FINITE);
    }
    std::vector<double> values = good;
    values[33] += 5; // longer than the two other sides
    expect_values(values, HMF_ERROR_VALUE_NOT_CLOSED);
    // Powers of two from one end of the doubles to the other: the same foliation, or a sentence.
    for (int exponent = -1100; exponent <= 1000; exponent += 25) {
        values = good;
        for (double& x : values) x = std::ldexp(x, exponent);
        const hmf_error error = created(values);
        if (error.status == HMF_OK) {
            const Foliation f = create(hierarchy, 0, values);
            EXPECT_EQ(values_of(f), values) << exponent;
            EXPECT_GT(hmf_foliation_unit(f.get()), 0) << exponent;
        } else {
            EXPECT_TRUE(exponent < -896 || exponent > 996) << exponent;
            // As zeros they are all a pole.
            const hmf_status expected = exponent < -1074 ? HMF_ERROR_VALUE_POLE : HMF_ERROR_VALUE_NOT_FINITE;
            expect_error(error.status, expected, error);
        }
    }
    values = good;
    for (double& x : values) x = x > 0 ? x + 1e-30 : 1e-30; // no common unit
    values[7] = 1;
    expect_values(values, HMF_ERROR_VALUE_NOT_CLOSED);
}

TEST_F(OnTorus, Poles) {
    std::vector<double> values(mesh.edge_count, 0);
    expect_values(values, HMF_ERROR_VALUE_POLE); // the whole surface is one
    // Heights of a function on the vertices: closed, but with extrema.
    for (size_t e = 0; e < mesh.edge_count; ++e)
        values[e] = std::abs(static_cast<double>(mesh.edge_vertices[2 * e])
                             - static_cast<double>(mesh.edge_vertices[2 * e + 1]));
    ASSERT_EQ(closedness_defect(mesh, values), "");
    expect_poles(values);
}

} // namespace test_errors
