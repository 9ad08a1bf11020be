// What the caller's allocator and progress function see, for every function of
// the interface: the n-th allocation fails, the n-th progress call cancels, the
// memory limit; no memory is lost, and nothing is given.  Lifetimes, and the
// same bits twice and from many threads.
#include "support/meter.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <thread>

using namespace test;

namespace {

// The bytes of a result, to compare: everything but pointers and seconds.
using Bits = std::vector<double>;

template <class T>
void append(Bits& bits, const T* from, uint64_t count) {
    for (uint64_t i = 0; i < count; ++i) bits.push_back(static_cast<double>(from[i]));
}

Bits bits_of(const hmf_loop_set& s) {
    Bits bits{static_cast<double>(s.element_kind), static_cast<double>(s.level)};
    append(bits, s.offsets, s.count + 1);
    append(bits, s.elements, s.offsets[s.count]);
    if (s.weights) append(bits, s.weights, s.count);
    return bits;
}

Bits bits_of(const hmf_foliation& f) {
    size_t count = 0;
    const double* values = hmf_foliation_values(&f, &count);
    Bits bits{static_cast<double>(hmf_foliation_level(&f)), hmf_foliation_unit(&f)};
    append(bits, values, count);
    if (const hmf_report* r = hmf_foliation_report(&f)) {
        bits.insert(bits.end(), {r->energy, r->residual_max, r->residual_mean, static_cast<double>(r->zeros)});
        for (uint64_t i = 0; i < r->level_count; ++i)
            bits.push_back(static_cast<double>(r->levels[i].iterations + r->levels[i].linear_solves));
        for (uint64_t i = 0; i < r->history_count; ++i) bits.push_back(r->history[i].energy);
    }
    return bits;
}

Bits bits_of(const hmf_singularity_set& s) {
    Bits bits;
    for (uint64_t i = 0; i < s.count; ++i) {
        const hmf_singularity& at = s.list[i];
        bits.insert(bits.end(), {double(at.kind), double(at.index), double(at.element), double(at.size)});
        append(bits, at.position, 3);
    }
    append(bits, s.vertex_index, s.vertex_count);
    append(bits, s.vertex_cluster, s.vertex_count);
    append(bits, s.triangle_index, s.triangle_count);
    return bits;
}

Bits bits_of(const hmf_parameterization& p) {
    Bits bits{p.dilatation_mean, p.dilatation_median, p.dilatation_p99, p.seam_length, p.area};
    append(bits, p.corner_uv, 6 * p.triangle_count);
    append(bits, p.transition, 3 * p.edge_count);
    append(bits, p.seam, p.edge_count);
    append(bits, p.cone, p.vertex_count);
    append(bits, p.dilatation, p.triangle_count);
    append(bits, p.differential, 2 * p.triangle_count);
    return bits;
}

Bits bits_of(const hmf_lines& l) {
    Bits bits;
    for (uint64_t i = 0; i < l.line_count; ++i) {
        const hmf_line& line = l.lines[i];
        bits.insert(bits.end(), {double(line.kind), double(line.closed), double(line.begin), double(line.end),
                                 double(line.begin_zero), double(line.end_zero), double(line.cylinder),
                                 double(line.source), line.height, line.length});
    }
    append(bits, l.offsets, l.line_count + 1);
    append(bits, l.points, 3 * l.point_count);
    append(bits, l.point_edges, l.point_count);
    return bits;
}

Bits bits_of(const hmf_cylinder_set& c) {
    Bits bits = bits_of(*c.leaves);
    for (uint64_t i = 0; i < c.count; ++i) {
        const hmf_cylinder& at = c.list[i];
        bits.insert(bits.end(), {double(at.loop), at.height, at.circumference, at.modulus, at.area});
    }
    return bits;
}

Bits bits_of(const hmf_design& d) {
    Bits bits = bits_of(*d.loops);
    append(bits, d.loops->weights, d.loops->count);
    append(bits, d.marked_vertices, d.marked_count);
    bits.insert(bits.end(), {d.unevenness, d.unevenness_before, double(d.solves)});
    return bits;
}

Bits bits_of(const hmf_quad_mesh& q) {
    Bits bits;
    append(bits, q.positions, 3 * q.vertex_count);
    append(bits, q.quads, 4 * q.quad_count);
    return bits;
}

// One call of the interface.  Fills `bits` if it succeeds; checks that a
// failing one gives nothing.
struct Function {
    const char* name;
    bool keeps; // makes something that stays with the foliation
    std::function<hmf_status(const hmf_control*, Bits*)> call;
};

template <class T, class Call>
hmf_status one_call(Bits* bits, Call&& call) {
    hmf_error error{};
    T* out = reinterpret_cast<T*>(&error); // must be overwritten
    const hmf_status status = call(&out, &error);
    const Owned<T> owner(out);
    EXPECT_EQ(error.status, status);
    EXPECT_TRUE(status == HMF_OK || std::strlen(error.message) > 10);
    EXPECT_EQ(out == nullptr, status != HMF_OK);
    if (out && bits) *bits = bits_of(*out);
    return status;
}

template <class Call>
hmf_status one_array(Bits* bits, size_t count, Call&& call) {
    hmf_error error{};
    Bits values(count, -7);
    const hmf_status status = call(values.data(), &error);
    EXPECT_EQ(error.status, status);
    for (const double x : values) EXPECT_TRUE(status == HMF_OK || x == -7);
    if (bits) *bits = values;
    return status;
}

// A hierarchy of several levels, foliations on it, and every function that
// takes them.
struct Story {
    Story(const TriMesh& mesh, const hmf_build_options& build) :
        hierarchy(mesh, build), h(hierarchy.get()), loops(library_loops(hierarchy, hierarchy.coarsest())),
        set(loops.view()), rough(interpolate(initialize(hierarchy, loops), 0)), vertices(mesh.vertex_count()) {
        refresh();
        coarse = interpolate(harmonic, hierarchy.coarsest());
        values = values_of(harmonic);
        read = create(hierarchy, 0, values);
        add_core();
        add_design(mesh, build);
        for (Foliation* f : {&harmonic, &read}) add_uses(*f, f == &harmonic);
    }
    Story(const Story&) = delete;

    // The minimum, as it comes from the solver: nothing has been kept with it.
    void refresh() {
        harmonic.reset();
        harmonic = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0)).foliation;
    }

    Hierarchy hierarchy;
    const hmf_hierarchy* h;
    Loops loops;
    hmf_loop_set set;
    Foliation rough, harmonic, coarse, read; // read: from the values
    std::vector<double> values;
    size_t vertices;
    std::vector<Function> functions;

private:
    template <class T, class Call>
    void add(const char* name, Call call, bool keeps = false) {
        functions.push_back({name, keeps, [call](const hmf_control* control, Bits* bits) {
                                 return one_call<T>(bits, [&](T** out, hmf_error* e) { return call(control, out, e); });
                             }});
    }

    void add_core() {
        for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_HANDLE, HMF_LOOPS_TUNNEL, HMF_LOOPS_PANTS})
            add<hmf_loop_set>("hmf_loops",
                              [this, kind](auto c, auto out, auto e) { return hmf_loops(h, 0, kind, c, out, e); });
        add<hmf_foliation>("hmf_initialize",
                           [this](auto c, auto out, auto e) { return hmf_initialize(h, &set, c, out, e); });
        add<hmf_foliation>("hmf_initialize, own loops",
                           [this](auto c, auto out, auto e) { return hmf_initialize(h, nullptr, c, out, e); });
        add<hmf_foliation>("hmf_foliation_create", [this](auto c, auto out, auto e) {
            return hmf_foliation_create(h, 0, values.data(), values.size(), c, out, e);
        });
        for (const int32_t method : {HMF_METHOD_NEWTON, HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
            const hmf_solve_options options = solve_options(method, method == HMF_METHOD_NEWTON ? 0 : 1e-3);
            add<hmf_foliation>("hmf_solve", [this, options](auto c, auto out, auto e) {
                return hmf_solve(h, &set, &options, c, out, e);
            });
            add<hmf_foliation>("hmf_relax", [this, options](auto c, auto out, auto e) {
                return hmf_relax(rough.get(), &options, c, out, e);
            });
        }
        add<hmf_foliation>("hmf_solve, start", [this](auto c, auto out, auto e) {
            hmf_solve_options from = solve_options(HMF_METHOD_NEWTON, 0);
            from.start = rough.get();
            return hmf_solve(h, nullptr, &from, c, out, e);
        });
        add<hmf_foliation>("hmf_interpolate, coarser", [this](auto c, auto out, auto e) {
            return hmf_interpolate(harmonic.get(), hierarchy.coarsest(), c, out, e);
        });
        add<hmf_foliation>("hmf_interpolate, finer",
                           [this](auto c, auto out, auto e) { return hmf_interpolate(coarse.get(), 0, c, out, e); });
    }

    void add_design(const TriMesh& mesh, const hmf_build_options& build) {
        add<hmf_design>("hmf_even_design", [&mesh, build](auto c, auto out, auto e) {
            hmf_design_options options{};
            options.struct_size = sizeof options;
            options.build = &build;
            options.solve_limit = 5;
            return hmf_even_design(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                   mesh.triangle_count(), &options, c, out, e);
        });
    }

    void add_uses(const Foliation& f, bool minimum) {
        functions.push_back(
            {"hmf_energy", false, [&f](const hmf_control* c, Bits* bits) {
                 return one_array(bits, 1, [&](double* out, hmf_error* e) { return hmf_energy(f.get(), c, out, e); });
             }});
        functions.push_back({"hmf_residuals", false, [&f, this](const hmf_control* c, Bits* bits) {
                                 return one_array(bits, vertices, [&](double* out, hmf_error* e) {
                                     return hmf_residuals(f.get(), c, out, vertices, e);
                                 });
                             }});
        functions.push_back({"hmf_conformal_scale", false, [&f](const hmf_control* c, Bits* bits) {
                                 return one_array(bits, 1, [&](double* out, hmf_error* e) {
                                     return hmf_conformal_scale(f.get(), c, nullptr, 0, out, e);
                                 });
                             }});
        add<hmf_singularity_set>("hmf_singularities",
                                 [&f](auto c, auto out, auto e) { return hmf_singularities(f.get(), c, out, e); });
        add<hmf_parameterization>(
            "hmf_parameterize",
            [&f](auto c, auto out, auto e) { return hmf_parameterize(f.get(), nullptr, c, out, e); }, minimum);
        for (const int32_t leaves : {HMF_LEAVES_FOLIATION, HMF_LEAVES_CONJUGATE})
            add<hmf_lines>(
                "hmf_trace",
                [&f, leaves](auto c, auto out, auto e) {
                    hmf_trace_options options{};
                    options.struct_size = sizeof options;
                    options.critical = 1;
                    options.spacing = 0.3;
                    options.length_limit = 3;
                    options.leaves = leaves;
                    const uint32_t triangle = 7;
                    const double middle[3] = {0.3, 0.3, 0.4};
                    options.point_count = 1;
                    options.point_triangles = &triangle;
                    options.point_barycentrics = middle;
                    return hmf_trace(f.get(), &options, c, out, e);
                },
                minimum && leaves == HMF_LEAVES_CONJUGATE);
        add<hmf_cylinder_set>("hmf_cylinders",
                              [&f, this](auto c, auto out, auto e) { return hmf_cylinders(f.get(), &set, c, out, e); });
        add<hmf_cylinder_set>("hmf_cylinders, no loops",
                              [&f](auto c, auto out, auto e) { return hmf_cylinders(f.get(), nullptr, c, out, e); });
        add<hmf_quad_mesh>("hmf_quads",
                           [&f](auto c, auto out, auto e) { return hmf_quads(f.get(), nullptr, c, out, e); });
    }
};

hmf_status build(const TriMesh& mesh, const hmf_build_options& options, const hmf_control* control = nullptr) {
    hmf_error error{};
    hmf_hierarchy* hierarchy = reinterpret_cast<hmf_hierarchy*>(&error); // must be overwritten
    const hmf_status status = hmf_build(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                        mesh.triangle_count(), &options, control, &hierarchy, &error);
    EXPECT_EQ(hierarchy == nullptr, status != HMF_OK);
    EXPECT_EQ(error.status, status);
    hmf_destroy(hierarchy);
    return status;
}

std::vector<TriMesh> story_meshes() { return {pretzel(2, 1), with_random_flips(pretzel(2, 1), 400, 0.7, 3)}; }

} // namespace

// --- Memory ------------------------------------------------------------------

TEST(Resources, EveryAllocationMayFailInTheBuild) {
    for (const TriMesh& mesh : {torus(12, 8, 2, 1), with_random_flips(plate(2), 20, -1, 3)}) {
        Meter meter;
        ASSERT_EQ(build(mesh, meter.options()), HMF_OK);
        ASSERT_EQ(meter.used, 0u);
        const uint64_t calls = meter.calls;
        ASSERT_GT(calls, 20u);
        for (uint64_t fail = 1; fail <= calls; ++fail) {
            Meter failing;
            failing.fail = fail;
            ASSERT_EQ(build(mesh, failing.options()), HMF_ERROR_MEMORY) << "allocation " << fail << " of " << calls;
            ASSERT_EQ(failing.used, 0u) << "allocation " << fail << " of " << calls;
        }
    }
}

TEST(Resources, EveryAllocationMayFail) {
    for (const TriMesh& mesh : story_meshes()) {
        Meter meter;
        {
            Story story(mesh, meter.options(80));
            for (const Function& function : story.functions) {
                SCOPED_TRACE(function.name);
                // Runs the call on a foliation without anything kept; what it keeps goes with the foliation.
                uint64_t calls = 0;
                const auto run = [&](uint64_t fail, Bits* bits) {
                    if (function.keeps) story.refresh();
                    const uint64_t held = meter.used;
                    meter.calls = 0;
                    meter.fail = fail;
                    const hmf_status status = function.call(nullptr, bits);
                    calls = meter.calls;
                    meter.fail = 0;
                    if (!function.keeps) { EXPECT_EQ(meter.used, held); }
                    return status;
                };
                Bits expected, bits;
                ASSERT_EQ(run(0, &expected), HMF_OK);
                const uint64_t all = calls;
                EXPECT_GT(all, 0u);
                // All of the first ones, then fewer: loops of the same allocations.
                for (uint64_t fail = 1; fail <= all; fail += 1 + fail / 128)
                    ASSERT_EQ(run(fail, nullptr), HMF_ERROR_MEMORY) << "allocation " << fail << " of " << all;
                // After a failure the same foliation is as good as before.
                ASSERT_EQ(function.call(nullptr, &bits), HMF_OK);
                EXPECT_EQ(bits, expected);
            }
        }
        EXPECT_EQ(meter.used, 0u);
    }
}

// Large enough for several levels of the linear solver.
TEST(Resources, AllocationsMayFailInNewton) {
    Meter meter;
    const Hierarchy hierarchy(pretzel(2, 3), meter.options());
    ASSERT_TRUE(hierarchy);
    const uint64_t held = meter.used, first = meter.calls;
    const hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 0);
    ASSERT_EQ(solve(hierarchy, nullptr, options).status, HMF_OK);
    ASSERT_EQ(meter.used, held);
    const uint64_t calls = meter.calls - first;
    ASSERT_GT(calls, 100u);
    for (uint64_t n = 1; n <= calls; n += 1 + calls / 60) {
        meter.fail = meter.calls + n;
        EXPECT_EQ(solve(hierarchy, nullptr, options).status, HMF_ERROR_MEMORY);
        ASSERT_EQ(meter.used, held) << "allocation " << n << " of " << calls;
    }
}

// The limit bounds the hierarchy with what each call takes, its result as well.
// Solving takes most here, more than the results together.
TEST(Resources, MemoryLimitIsKept) {
    const TriMesh mesh = torus(30, 16, 2, 1);
    uint64_t refused = 0;
    bool done = false;
    for (uint64_t limit = 64; !done; limit += limit / 8 + 1) {
        Meter meter;
        hmf_build_options options = meter.options();
        options.memory_limit = limit;
        hmf_hierarchy* h = nullptr;
        hmf_status status = hmf_build(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                      mesh.triangle_count(), &options, nullptr, &h, nullptr);
        hmf_loop_set* loops = nullptr;
        hmf_foliation* f = nullptr;
        hmf_quad_mesh* quads = nullptr;
        if (!status) status = hmf_loops(h, 0, HMF_LOOPS_CUT, nullptr, &loops, nullptr);
        if (!status) status = hmf_solve(h, loops, nullptr, nullptr, &f, nullptr);
        if (!status) status = hmf_quads(f, nullptr, nullptr, &quads, nullptr);
        ASSERT_LE(meter.peak, limit);
        if (status == HMF_OK) {
            done = true;
        } else {
            ASSERT_EQ(status, HMF_ERROR_MEMORY_LIMIT) << limit;
            ++refused;
        }
        hmf_free(loops);
        hmf_free(quads);
        hmf_foliation_destroy(f);
        hmf_destroy(h);
        ASSERT_EQ(meter.used, 0u);
        ASSERT_LT(limit, uint64_t{1} << 32) << "no limit is enough";
    }
    EXPECT_GT(refused, 10u);

    Meter meter;
    hmf_build_options options = meter.options();
    options.memory_limit = hmf_memory_estimate(mesh.vertex_count(), mesh.triangle_count(), &options);
    EXPECT_EQ(build(mesh, options), HMF_OK) << "the estimate is an upper bound";
}

// The object itself counts as well.
TEST(Resources, MemoryLimitHoldsToTheByte) {
    const TriMesh mesh = torus(30, 16, 2, 1);
    Meter free;
    ASSERT_EQ(build(mesh, free.options()), HMF_OK);
    for (const uint64_t spare : {0, 1, 100, 1000}) {
        Meter meter;
        hmf_build_options options = meter.options();
        options.memory_limit = free.peak - spare;
        EXPECT_EQ(build(mesh, options), spare ? HMF_ERROR_MEMORY_LIMIT : HMF_OK) << spare;
        EXPECT_LE(meter.peak, options.memory_limit);
        EXPECT_EQ(meter.used, 0u);
    }
}

// A hundred rounds on one hierarchy: memory returns to where it was.
TEST(Resources, MemoryIsFlat) {
    Meter meter;
    {
        const Hierarchy hierarchy(pretzel(2, 1), meter.options());
        ASSERT_TRUE(hierarchy);
        const uint64_t held = meter.used;
        EXPECT_EQ(hmf_hierarchy_memory(hierarchy.get()), held);
        for (int round = 0; round < 100; ++round) {
            {
                const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_WHITEHEAD, 1e-3, 20));
                ASSERT_LT(solution.status, HMF_ERROR_NULL);
                EXPECT_LE(held + solution.report.peak_memory_bytes, meter.peak);
                ASSERT_GT(meter.used, held);
            }
            ASSERT_EQ(meter.used, held);
        }
    }
    EXPECT_EQ(meter.used, 0u);
}

// --- Lifetimes ---------------------------------------------------------------

// Foliations keep what they need of their hierarchy, results need nothing.
TEST(Lifetimes, FoliationsOutliveTheirHierarchy) {
    const TriMesh mesh = pretzel(2, 1);
    Meter meter;
    hmf_build_options options = meter.options();
    hmf_hierarchy* h = nullptr;
    ASSERT_EQ(hmf_build(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                        &options, nullptr, &h, nullptr),
              HMF_OK);
    hmf_foliation* f = nullptr;
    ASSERT_EQ(hmf_solve(h, nullptr, nullptr, nullptr, &f, nullptr), HMF_OK);
    double before = 0, after = 0;
    ASSERT_EQ(hmf_energy(f, nullptr, &before, nullptr), HMF_OK);
    const uint64_t held = meter.used;
    hmf_destroy(h);
    EXPECT_EQ(meter.used, held) << "the foliation holds on to its hierarchy";
    ASSERT_EQ(hmf_energy(f, nullptr, &after, nullptr), HMF_OK);
    EXPECT_EQ(before, after);
    // It makes others, which hold on as well.
    hmf_foliation* coarse = nullptr;
    ASSERT_EQ(hmf_interpolate(f, 1, nullptr, &coarse, nullptr), HMF_OK);
    hmf_quad_mesh* quads = nullptr;
    ASSERT_EQ(hmf_quads(f, nullptr, nullptr, &quads, nullptr), HMF_OK);
    hmf_foliation_destroy(f);
    hmf_foliation* fine = nullptr;
    ASSERT_EQ(hmf_interpolate(coarse, 0, nullptr, &fine, nullptr), HMF_OK);
    hmf_foliation* relaxed = nullptr;
    ASSERT_EQ(hmf_relax(fine, nullptr, nullptr, &relaxed, nullptr), HMF_OK);
    EXPECT_NEAR(hmf_foliation_report(relaxed)->energy, before, 1e-9 * before);
    hmf_foliation_destroy(coarse);
    hmf_foliation_destroy(fine);
    hmf_foliation_destroy(relaxed);
    // Results live until they are freed.
    EXPECT_EQ(quads->vertex_count, quads->quad_count - 2);
    for (uint64_t i = 0; i < 4 * quads->quad_count; ++i) ASSERT_LT(quads->quads[i], quads->vertex_count);
    EXPECT_GT(meter.used, 0u);
    hmf_free(quads);
    EXPECT_EQ(meter.used, 0u);
}

// --- Progress ----------------------------------------------------------------

TEST(ProgressOf, TheBuild) {
    const TriMesh mesh = pretzel(2, 3);
    Progress all;
    Meter meter;
    const hmf_build_options options = meter.options();
    hmf_control control = all.control();
    ASSERT_EQ(build(mesh, options, &control), HMF_OK);
    EXPECT_TRUE(all.rising);
    EXPECT_EQ(all.last, 1);
    ASSERT_GE(all.calls, 3u);
    // The last call reports the end; there is nothing left to cancel.
    for (uint64_t stop = 1; stop < all.calls; stop += 1 + all.calls / 50) {
        for (const int32_t answer : {HMF_PROGRESS_CANCEL, HMF_PROGRESS_FINISH, 12345}) {
            Progress progress;
            progress.stop = stop;
            progress.answer = answer;
            control = progress.control();
            ASSERT_EQ(build(mesh, options, &control), HMF_CANCELLED) << "call " << stop << " of " << all.calls;
            EXPECT_EQ(progress.calls, stop) << "called again after the answer";
            ASSERT_EQ(meter.used, 0u);
        }
    }
}

// Solve and relax may give a foliation all the same: see below.
TEST(ProgressOf, EveryFunction) {
    for (const TriMesh& mesh : story_meshes()) {
        Meter meter;
        {
            Story story(mesh, meter.options(80));
            for (const Function& function : story.functions) {
                SCOPED_TRACE(function.name);
                const auto run = [&](Progress& progress, Bits* bits) {
                    if (function.keeps) story.refresh();
                    const uint64_t held = meter.used;
                    const hmf_control control = progress.control();
                    const hmf_status status = function.call(&control, bits);
                    if (!function.keeps) { EXPECT_EQ(meter.used, held); }
                    EXPECT_TRUE(progress.rising);
                    return status;
                };
                Bits alone, watched;
                ASSERT_EQ(function.call(nullptr, &alone), HMF_OK);
                Progress all;
                ASSERT_EQ(run(all, &watched), HMF_OK);
                EXPECT_EQ(alone, watched);
                EXPECT_GT(all.calls, 0u);
                EXPECT_EQ(all.last, 1);
                const std::string name = function.name;
                if (name.compare(0, 9, "hmf_solve") == 0 || name == "hmf_relax") continue;
                for (const int32_t answer : {HMF_PROGRESS_CANCEL, HMF_PROGRESS_FINISH, -5})
                    for (uint64_t stop = 1; stop < all.calls; stop += 1 + all.calls / 50) {
                        Progress progress;
                        progress.stop = stop;
                        progress.answer = answer;
                        ASSERT_EQ(run(progress, nullptr), HMF_CANCELLED)
                            << "call " << stop << " of " << all.calls << " answers " << answer;
                        EXPECT_EQ(progress.calls, stop) << "called again after the answer";
                    }
            }
        }
        EXPECT_EQ(meter.used, 0u);
    }
}

TEST(ProgressOf, SolveAndRelax) {
    Meter meter;
    const Hierarchy hierarchy(pretzel(2, 2), meter.options());
    ASSERT_TRUE(hierarchy);
    const LevelMesh mesh = read_level(hierarchy, 0);
    const Foliation start = initialize(hierarchy, library_loops(hierarchy, 0));
    const uint64_t held = meter.used;
    for (const bool relaxing : {false, true})
        for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL, HMF_METHOD_NEWTON}) {
            SCOPED_TRACE(testing::Message() << (relaxing ? "relax, method " : "solve, method ") << method);
            const hmf_solve_options options = solve_options(method, method == HMF_METHOD_NEWTON ? 0 : 1e-4);
            const auto run = [&](Progress& progress) {
                const hmf_control control = progress.control();
                return relaxing ? relax(start, options, &control) : solve(hierarchy, nullptr, options, &control);
            };
            Progress all;
            const Solution whole = run(all);
            ASSERT_LT(whole.status, HMF_CANCELLED) << whole.error.message;
            const uint64_t held_now = meter.used;
            EXPECT_TRUE(all.rising);
            if (whole.status == HMF_OK) { EXPECT_EQ(all.last, 1); }
            ASSERT_GE(all.calls, 3u);
            size_t given = 0;
            for (uint64_t stop = 1; stop < all.calls; stop += 1 + all.calls / 15)
                for (const int32_t answer : {HMF_PROGRESS_CANCEL, HMF_PROGRESS_FINISH}) {
                    SCOPED_TRACE(testing::Message() << "call " << stop << " of " << all.calls << " answers " << answer);
                    Progress progress;
                    progress.stop = stop;
                    progress.answer = answer;
                    Solution stopped = run(progress);
                    EXPECT_TRUE(progress.rising);
                    if (answer == HMF_PROGRESS_FINISH && stopped.status == HMF_OK) {
                        EXPECT_EQ(stopped.values, whole.values); // asked too late: there was nothing left to improve
                        continue;
                    }
                    ASSERT_EQ(stopped.status, HMF_CANCELLED);
                    if (answer == HMF_PROGRESS_FINISH) {
                        EXPECT_TRUE(stopped.foliation);
                    } else {
                        EXPECT_EQ(progress.calls, stop) << "called again after the answer";
                    }
                    if (stopped.foliation) {
                        ++given;
                        const double residual = stopped.report.residual_max;
                        EXPECT_EQ(stopped.report.converged, residual >= 0 && residual <= 1e-8);
                        expect_foliation(mesh, stopped.foliation);
                    }
                    stopped.foliation.reset();
                    ASSERT_EQ(meter.used, held_now);
                }
            EXPECT_GT(given, 0u);
        }
    EXPECT_EQ(meter.used, held);
}

TEST(ProgressOf, LimitsStillGiveAFoliation) {
    const Hierarchy hierarchy(pretzel(3, 3), 0.5, 400);
    ASSERT_TRUE(hierarchy);
    const LevelMesh mesh = read_level(hierarchy, 0);
    for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
        SCOPED_TRACE(method);
        const Solution few = solve(hierarchy, nullptr, solve_options(method, 1e-14, 2));
        EXPECT_EQ(few.status, HMF_LIMIT_ITERATIONS);
        EXPECT_EQ(few.report.converged, 0);
        expect_foliation(mesh, few.foliation);
        hmf_solve_options options = solve_options(method, 1e-15);
        options.time_limit = 1e-9;
        const Solution quick = solve(hierarchy, nullptr, options);
        EXPECT_EQ(quick.status, HMF_LIMIT_TIME);
        expect_foliation(mesh, quick.foliation);
    }
}

// What runs out on the coarsest level is carried to the finest, and nothing is done on the way.
TEST(ProgressOf, NothingIsOptimisedAfterTheTimeLimit) {
    const Hierarchy hierarchy(pretzel(3, 3), 0.5, 400);
    ASSERT_TRUE(hierarchy);
    ASSERT_GE(hierarchy.levels(), 3u);
    for (const int32_t method : {HMF_METHOD_NEWTON, HMF_METHOD_WHITEHEAD}) {
        SCOPED_TRACE(method);
        hmf_solve_options options = solve_options(method, 1e-15);
        options.time_limit = 1e-9;
        const Solution solution = solve(hierarchy, nullptr, options);
        EXPECT_EQ(solution.status, HMF_LIMIT_TIME);
        ASSERT_EQ(solution.report.level_count, hierarchy.levels());
        for (size_t k = 0; k < hierarchy.coarsest(); ++k) {
            EXPECT_EQ(solution.report.levels[k].iterations, 0u) << k;
            EXPECT_EQ(solution.report.levels[k].linear_solves, 0u) << k;
        }
        expect_foliation(read_level(hierarchy, 0), solution.foliation);
    }
}

// --- Determinism -------------------------------------------------------------

TEST(SameBits, TwiceAndFromTwoThreads) {
    for (const TriMesh& mesh : story_meshes()) {
        hmf_build_options options{};
        options.struct_size = sizeof options;
        options.coarsest = 80;
        const Story story(mesh, options), other(mesh, options);
        std::vector<Bits> first, again;
        const auto run = [](const Story& on, std::vector<Bits>& all) {
            for (const Function& function : on.functions) {
                all.emplace_back();
                EXPECT_EQ(function.call(nullptr, &all.back()), HMF_OK) << function.name;
            }
        };
        run(other, first);
        std::thread beside([&] { run(story, again); });
        std::vector<Bits> here;
        run(story, here);
        beside.join();
        for (size_t i = 0; i < first.size(); ++i) {
            SCOPED_TRACE(story.functions[i].name);
            EXPECT_FALSE(first[i].empty());
            EXPECT_EQ(first[i], again[i]);
            EXPECT_EQ(first[i], here[i]);
        }
    }
}
