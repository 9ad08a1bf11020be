// What the caller's allocator and progress function see, for every function of
// the interface: the n-th allocation fails, the n-th progress call cancels, the
// memory limit; no memory is lost, and nothing is given.  Lifetimes, and the
// same bits twice and from many threads.
#include "src/core/api/result.hpp"
#include "src/core/hierarchy/hierarchy.hpp"
#include "support/watched_host.hpp"
#include "support/sample.hpp"
#include "support/all_calls.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <thread>

namespace test_resources {

using namespace test;

namespace {

hmf_status build(const TriMesh& mesh, const hmf_hierarchy_options& options, const hmf_control* control = nullptr) {
    hmf_error error{};
    hmf_hierarchy* hierarchy = reinterpret_cast<hmf_hierarchy*>(&error); // must be overwritten
    const hmf_status status = hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                                   mesh.triangle_count(), &options, control, &hierarchy, &error);
    EXPECT_EQ(hierarchy == nullptr, status != HMF_OK);
    EXPECT_EQ(error.status, status);
    hmf_hierarchy_destroy(hierarchy);
    return status;
}

std::vector<TriMesh> story_meshes() { return {pretzel(2, 1), with_random_flips(pretzel(2, 1), 400, 0.7, 3)}; }

// Each mesh of a all_calls with every SHARES-th of its functions: quick cases.
constexpr size_t SHARES = 4;
struct OfEachFunction : testing::TestWithParam<size_t> {
    template <class Each>
    void run(Each each) {
        const TriMesh mesh = story_meshes().at(GetParam() / SHARES);
        WatchedHost watched;
        {
            AllCalls all_calls(mesh, watched.options(80));
            for (size_t i = GetParam() % SHARES; i < all_calls.functions.size(); i += SHARES) {
                SCOPED_TRACE(all_calls.functions[i].name);
                each(all_calls, all_calls.functions[i], watched);
                if (HasFatalFailure()) return;
            }
        }
        EXPECT_EQ(watched.used, 0u);
    }
};
INSTANTIATE_TEST_SUITE_P(Shares, OfEachFunction, testing::Range(size_t{0}, 2 * SHARES));

} // namespace

// --- Memory ------------------------------------------------------------------

TEST(Resources, EveryAllocationMayFailInTheBuild) {
    for (const TriMesh& mesh : {torus(12, 8, 2, 1), with_random_flips(plate(2), 20, -1, 3)}) {
        WatchedHost watched;
        ASSERT_EQ(build(mesh, watched.options()), HMF_OK);
        ASSERT_EQ(watched.used, 0u);
        const uint64_t calls = watched.calls;
        ASSERT_GT(calls, 20u);
        for (uint64_t fail = 1; fail <= calls; ++fail) {
            WatchedHost failing;
            failing.fail = fail;
            ASSERT_EQ(build(mesh, failing.options()), HMF_ERROR_MEMORY) << "allocation " << fail << " of " << calls;
            ASSERT_EQ(failing.used, 0u) << "allocation " << fail << " of " << calls;
        }
    }
}

TEST_P(OfEachFunction, EveryAllocationMayFail) {
    run([](AllCalls& all_calls, const Function& function, WatchedHost& watched) {
        // Runs the call on a foliation without anything kept; what it keeps goes with the foliation.
        uint64_t calls = 0;
        const auto run = [&](uint64_t fail, Bits* bits) {
            if (function.keeps) all_calls.refresh();
            const uint64_t held = watched.used;
            watched.calls = 0;
            watched.fail = fail;
            const hmf_status status = function.call(nullptr, bits);
            calls = watched.calls;
            watched.fail = 0;
            if (!function.keeps) { EXPECT_EQ(watched.used, held); }
            return status;
        };
        Bits expected, bits;
        ASSERT_EQ(run(0, &expected), HMF_OK);
        const uint64_t all = calls;
        EXPECT_GT(all, 0u);
        // All of the first ones, then fewer: loops of the same allocations.
        for (uint64_t fail = 1; fail <= all; fail += 1 + fail / sample(128, 24))
            ASSERT_EQ(run(fail, nullptr), HMF_ERROR_MEMORY) << "allocation " << fail << " of " << all;
        // After a failure the same foliation is as good as before.
        ASSERT_EQ(function.call(nullptr, &bits), HMF_OK);
        EXPECT_EQ(bits, expected);
    });
}

// Also where the stage that met it has gone on.
TEST(Resources, NothingIsGivenAfterAFailedAllocation) {
    for (const bool fails : {false, true}) {
        WatchedHost watched;
        const hmf_hierarchy h{WatchedHost::take, WatchedHost::give, &watched, 0};
        hmf::Memory memory(WatchedHost::take, WatchedHost::give, &watched, 0);
        hmf_error error{};
        hmf::Call call(memory, &error, nullptr, nullptr);
        watched.fail = fails ? watched.calls + 1 : 0;
        void* const block = memory.take(16);
        EXPECT_EQ(block == nullptr, fails);
        memory.give(block, 16);
        hmf_mark_set set{};
        hmf::ResultBlock results;
        hmf_mark_set* const made = results.make(set, h, call);
        EXPECT_EQ(made == nullptr, fails);
        EXPECT_EQ(call.status(), fails ? HMF_ERROR_MEMORY : HMF_OK);
        hmf_free(made);
        EXPECT_EQ(watched.used, 0u);
    }
}

// Large enough for several levels of the linear solver.
TEST(Resources, AllocationsMayFailInNewton) {
    WatchedHost watched;
    const Hierarchy hierarchy(pretzel(2, 3), watched.options());
    ASSERT_TRUE(hierarchy);
    const uint64_t held = watched.used, first = watched.calls;
    const hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 0);
    ASSERT_EQ(solve(hierarchy, nullptr, options).status, HMF_OK);
    ASSERT_EQ(watched.used, held);
    const uint64_t calls = watched.calls - first;
    ASSERT_GT(calls, 100u);
    for (uint64_t n = 1; n <= calls; n += 1 + calls / 60) {
        watched.fail = watched.calls + n;
        EXPECT_EQ(solve(hierarchy, nullptr, options).status, HMF_ERROR_MEMORY);
        ASSERT_EQ(watched.used, held) << "allocation " << n << " of " << calls;
    }
}

// The limit bounds the hierarchy with what each call takes, its result as well.
// Solving takes most here, more than the results together.
TEST(Resources, MemoryLimitIsKept) {
    const TriMesh mesh = torus(30, 16, 2, 1);
    uint64_t refused = 0;
    bool done = false;
    for (uint64_t limit = 64; !done; limit += limit / 8 + 1) {
        WatchedHost watched;
        hmf_hierarchy_options options = watched.options();
        options.memory_limit = limit;
        hmf_hierarchy* h = nullptr;
        hmf_status status = hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                                 mesh.triangle_count(), &options, nullptr, &h, nullptr);
        hmf_loop_set* loops = nullptr;
        hmf_foliation* f = nullptr;
        hmf_quad_mesh* quads = nullptr;
        hmf_chart_set* charts = nullptr;
        if (!status) status = hmf_loops(h, 0, HMF_LOOPS_CUT, nullptr, &loops, nullptr);
        if (!status) status = hmf_solve(h, loops, nullptr, nullptr, &f, nullptr);
        if (!status) status = hmf_quads(f, nullptr, nullptr, &quads, nullptr);
        if (!status) status = hmf_atlas(f, nullptr, nullptr, &charts, nullptr);
        ASSERT_LE(watched.peak, limit);
        if (status == HMF_OK) {
            done = true;
        } else {
            ASSERT_EQ(status, HMF_ERROR_MEMORY_LIMIT) << limit;
            ++refused;
        }
        hmf_free(loops);
        hmf_free(quads);
        hmf_free(charts);
        hmf_foliation_destroy(f);
        hmf_hierarchy_destroy(h);
        ASSERT_EQ(watched.used, 0u);
        ASSERT_LT(limit, uint64_t{1} << 32) << "no limit is enough";
    }
    EXPECT_GT(refused, 10u);

    WatchedHost watched;
    hmf_hierarchy_options options = watched.options();
    options.memory_limit = hmf_hierarchy_memory_estimate(mesh.vertex_count(), mesh.triangle_count(), &options);
    EXPECT_EQ(build(mesh, options), HMF_OK) << "the estimate is an upper bound";
}

// Every function: what it takes beside the hierarchy stays below the limit, or it says so; and as much as it needs
// without a limit is enough with one.
TEST_P(OfEachFunction, MemoryLimitIsKept) {
    run([](AllCalls& all_calls, const Function& function, WatchedHost& watched) {
        hmf_hierarchy& h = const_cast<hmf_hierarchy&>(*all_calls.h);
        const std::string name = function.name;
        // These have a hierarchy of their own: see MemoryLimitOfMeshes.
        if (name == "hmf_components" || name == "hmf_suggest_marks" || name == "hmf_even_design") return;
        const uint64_t held = hmf_hierarchy_describe(&h)->memory_bytes;
        const auto taken = [&](uint64_t limit, hmf_status& status) {
            if (function.keeps) all_calls.refresh();
            watched.peak = watched.used;
            const uint64_t before = watched.used;
            h.memory_limit = limit;
            status = function.call(nullptr, nullptr);
            h.memory_limit = 0;
            return watched.peak - before;
        };
        hmf_status status = HMF_OK;
        const uint64_t most = taken(0, status);
        ASSERT_EQ(status, HMF_OK);
        for (const double share : {0.0, 0.05, 0.2, 0.5, 0.7, 0.9, 0.99, 1.0}) {
            const uint64_t room = static_cast<uint64_t>(share * static_cast<double>(most));
            EXPECT_LE(taken(held + room, status), room) << share;
            EXPECT_EQ(status, room < most ? HMF_ERROR_MEMORY_LIMIT : HMF_OK) << share;
        }
    });
}

// Likewise where a mesh is given: the limit is that of the build options.
TEST(Resources, MemoryLimitOfMeshes) {
    const TriMesh mesh = pretzel(2, 1);
    const auto call = [&](int which, const hmf_hierarchy_options& build) {
        const double* const x = mesh.positions.data();
        const uint32_t* const t = mesh.triangles.data();
        const size_t n = mesh.vertex_count(), m = mesh.triangle_count();
        if (which == 0)
            return one_call<hmf_component_set>(
                nullptr, [&](auto out, auto e) { return hmf_components(x, n, t, m, &build, nullptr, out, e); });
        if (which == 1)
            return one_call<hmf_mark_set>(
                nullptr, [&](auto out, auto e) { return hmf_suggest_marks(x, n, t, m, &build, nullptr, out, e); });
        hmf_design_options options{};
        options.struct_size = sizeof options;
        options.build = &build;
        options.solve_limit = 5;
        return one_call<hmf_design>(
            nullptr, [&](auto out, auto e) { return hmf_even_design(x, n, t, m, &options, nullptr, out, e); });
    };
    for (const int which : {0, 1, 2}) {
        SCOPED_TRACE(which);
        WatchedHost free;
        ASSERT_EQ(call(which, free.options()), HMF_OK);
        const uint64_t enough = free.peak + sizeof(hmf_hierarchy); // counted, wherever it lies
        for (const double share : {0.01, 0.05, 0.2, 0.5, 0.7, 0.9, 0.99, 1.0}) {
            WatchedHost watched;
            hmf_hierarchy_options build = watched.options();
            build.memory_limit = static_cast<uint64_t>(share * static_cast<double>(enough));
            EXPECT_EQ(call(which, build), build.memory_limit < enough ? HMF_ERROR_MEMORY_LIMIT : HMF_OK) << share;
            EXPECT_LE(watched.peak, build.memory_limit) << share;
            EXPECT_EQ(watched.used, 0u);
        }
    }
}

// The object itself counts as well.
TEST(Resources, MemoryLimitHoldsToTheByte) {
    const TriMesh mesh = torus(30, 16, 2, 1);
    WatchedHost free;
    ASSERT_EQ(build(mesh, free.options()), HMF_OK);
    for (const uint64_t spare : {0, 1, 100, 1000}) {
        WatchedHost watched;
        hmf_hierarchy_options options = watched.options();
        options.memory_limit = free.peak - spare;
        EXPECT_EQ(build(mesh, options), spare ? HMF_ERROR_MEMORY_LIMIT : HMF_OK) << spare;
        EXPECT_LE(watched.peak, options.memory_limit);
        EXPECT_EQ(watched.used, 0u);
    }
}

// What a foliation says it holds is what the allocator sees, before and after a use that keeps something.
TEST(Resources, MemoryOfAFoliation) {
    WatchedHost watched;
    const Hierarchy hierarchy(pretzel(2, 1), watched.options());
    ASSERT_TRUE(hierarchy);
    EXPECT_EQ(hmf_foliation_memory(nullptr), 0u);
    const uint64_t held = watched.used;
    {
        const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
        ASSERT_EQ(solution.status, HMF_OK);
        const hmf_foliation* const f = solution.foliation.get();
        EXPECT_EQ(hmf_foliation_memory(f), watched.used - held);
        EXPECT_GE(hmf_foliation_memory(f), 8 * solution.values.size());
        hmf_parameterization* map = nullptr;
        ASSERT_EQ(hmf_parameterize(f, nullptr, nullptr, &map, nullptr), HMF_OK);
        hmf_free(map);
        const uint64_t after = hmf_foliation_memory(f);
        EXPECT_GT(after, 16 * solution.values.size());
        EXPECT_EQ(after, watched.used - held);
        ASSERT_EQ(hmf_parameterize(f, nullptr, nullptr, &map, nullptr), HMF_OK);
        hmf_free(map);
        EXPECT_EQ(hmf_foliation_memory(f), after);
    }
    EXPECT_EQ(watched.used, held);
}

// A hundred rounds on one hierarchy: memory returns to where it was.
TEST(Resources, MemoryIsFlat) {
    WatchedHost watched;
    {
        const Hierarchy hierarchy(pretzel(2, 1), watched.options());
        ASSERT_TRUE(hierarchy);
        const uint64_t held = watched.used;
        EXPECT_EQ(hmf_hierarchy_describe(hierarchy.get())->memory_bytes, held);
        for (int round = 0; round < 100; ++round) {
            {
                const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_WHITEHEAD, 1e-3, 20));
                ASSERT_LT(solution.status, HMF_ERROR_NULL);
                EXPECT_LE(held + solution.report.peak_memory_bytes, watched.peak);
                ASSERT_GT(watched.used, held);
            }
            ASSERT_EQ(watched.used, held);
        }
    }
    EXPECT_EQ(watched.used, 0u);
}

// Blocks of arrays that are kept for other arrays: no more memory than was in use at the peak, and
// none that is lost; an array of the size of one that was given back costs the host nothing.
TEST(Resources, ArraysTakeWhatOthersGaveBack) {
    WatchedHost watched;
    {
        const hmf_hierarchy_options options = watched.options();
        hmf::Memory memory(options.allocate, options.release, options.allocator_user, 0);
        memory.keep_arrays();
        hmf::Memory part(memory);
        constexpr size_t large = 1 << 20;
        hmf::Array<char> array[24];
        ASSERT_TRUE(array[0].allocate(memory, large));
        array[0].release();
        const uint64_t calls = watched.calls;
        ASSERT_TRUE(array[0].allocate(part, large - 1000));
        EXPECT_EQ(watched.calls, calls);
        EXPECT_EQ(array[0].size(), large - 1000);
        EXPECT_EQ(part.used(), memory.used());
        array[0].release();
        ASSERT_TRUE(array[0].allocate(memory, large / 2)); // too small for it
        EXPECT_EQ(watched.calls, calls + 1);
        Random random(7);
        for (int step = 0; step < 4000; ++step) {
            hmf::Array<char>& one = array[random.below(24)];
            const size_t size = 1 + random.below(3) * 65536 + random.below(200000);
            switch (random.below(4)) {
            case 0: one.release(); break;
            case 1:
                if (one.capacity() > 0) ASSERT_TRUE(one.reserve(size));
                break;
            default: ASSERT_TRUE(one.allocate(random.below(2) ? memory : part, size)); break;
            }
            ASSERT_LE(memory.used(), watched.used) << step;
            ASSERT_LE(watched.used, memory.peak()) << step;
            if (one.capacity() > 0) std::memset(one.data(), step, one.capacity());
        }
        memory.release_kept();
        EXPECT_EQ(watched.used, memory.used());
    }
    EXPECT_EQ(watched.used, 0u);
}

// What a large mesh takes, the hierarchy and beside it.  Where zeros have far to go it is up to a tenth more.
TEST(Resources, BytesOfASolve) {
    // With zeros parts of the mesh are solved for alone, with a multigrid of their own.
    for (const size_t genus : {1, 2}) {
        const TriMesh mesh = pretzel(genus, 5);
        const Hierarchy hierarchy(mesh);
        ASSERT_TRUE(hierarchy);
        const double edges = static_cast<double>(read_level(hierarchy, 0).edge_count);
        const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
        ASSERT_EQ(solution.status, HMF_OK);
        const double held = static_cast<double>(hmf_hierarchy_describe(hierarchy.get())->memory_bytes) / edges;
        const double beside = static_cast<double>(solution.report.peak_memory_bytes) / edges;
        EXPECT_LT(held + beside, 300) << edges << " edges, held " << held << ", beside " << beside;
    }
}

// --- Lifetimes ---------------------------------------------------------------

// Foliations keep what they need of their hierarchy, results need nothing.
TEST(Lifetimes, FoliationsOutliveTheirHierarchy) {
    const TriMesh mesh = pretzel(2, 1);
    WatchedHost watched;
    hmf_hierarchy_options options = watched.options();
    hmf_hierarchy* h = nullptr;
    ASSERT_EQ(hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                   mesh.triangle_count(), &options, nullptr, &h, nullptr),
              HMF_OK);
    hmf_foliation* f = nullptr;
    ASSERT_EQ(hmf_solve_cut_system(h, nullptr, nullptr, &f, nullptr), HMF_OK);
    double before = 0, after = 0;
    ASSERT_EQ(hmf_energy(f, nullptr, &before, nullptr), HMF_OK);
    const uint64_t held = watched.used;
    hmf_hierarchy_destroy(h);
    EXPECT_EQ(watched.used, held) << "the foliation holds on to its hierarchy";
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
    EXPECT_GT(watched.used, 0u);
    hmf_free(quads);
    EXPECT_EQ(watched.used, 0u);
}

// --- Progress ----------------------------------------------------------------

TEST(ProgressOf, TheBuild) {
    const TriMesh mesh = pretzel(2, 3);
    Progress all;
    WatchedHost watched;
    const hmf_hierarchy_options options = watched.options();
    hmf_control control = all.control();
    ASSERT_EQ(build(mesh, options, &control), HMF_OK);
    EXPECT_TRUE(all.rising);
    EXPECT_EQ(all.last, 1);
    ASSERT_GE(all.calls, 3u);
    // The last call reports the end; there is nothing left to cancel.
    for (uint64_t stop = 1; stop < all.calls; stop += 1 + all.calls / sample(50, 12)) {
        for (const int32_t answer : std::initializer_list<int32_t>{HMF_PROGRESS_CANCEL, HMF_PROGRESS_FINISH, 12345}) {
            Progress progress;
            progress.stop = stop;
            progress.answer = answer;
            control = progress.control();
            ASSERT_EQ(build(mesh, options, &control), HMF_CANCELLED) << "call " << stop << " of " << all.calls;
            EXPECT_EQ(progress.calls, stop) << "called again after the answer";
            ASSERT_EQ(watched.used, 0u);
        }
    }
}

// Solve and relax may give a foliation all the same: see below.
TEST_P(OfEachFunction, EveryReportMayCancel) {
    run([](AllCalls& all_calls, const Function& function, WatchedHost& watched) {
        const auto run = [&](Progress& progress, Bits* bits) {
            if (function.keeps) all_calls.refresh();
            const uint64_t held = watched.used;
            const hmf_control control = progress.control();
            const hmf_status status = function.call(&control, bits);
            if (!function.keeps) { EXPECT_EQ(watched.used, held); }
            EXPECT_TRUE(progress.rising);
            return status;
        };
        Bits alone, reported;
        ASSERT_EQ(function.call(nullptr, &alone), HMF_OK);
        Progress all;
        ASSERT_EQ(run(all, &reported), HMF_OK);
        EXPECT_EQ(alone, reported);
        EXPECT_GT(all.calls, 0u);
        EXPECT_EQ(all.last, 1);
        // These may give a foliation all the same: see SolveAndRelax.
        const std::string name = function.name;
        if (name.compare(0, 9, "hmf_solve") == 0 || name == "hmf_relax") return;
        for (const int32_t answer : std::initializer_list<int32_t>{HMF_PROGRESS_CANCEL, HMF_PROGRESS_FINISH, -5})
            for (uint64_t stop = 1; stop < all.calls; stop += 1 + all.calls / sample(50, 12)) {
                Progress progress;
                progress.stop = stop;
                progress.answer = answer;
                ASSERT_EQ(run(progress, nullptr), HMF_CANCELLED)
                    << "call " << stop << " of " << all.calls << " answers " << answer;
                EXPECT_EQ(progress.calls, stop) << "called again after the answer";
            }
    });
}

TEST(ProgressOf, SolveAndRelax) {
    WatchedHost watched;
    const Hierarchy hierarchy(pretzel(2, 2), watched.options());
    ASSERT_TRUE(hierarchy);
    const LevelMesh mesh = read_level(hierarchy, 0);
    const Foliation start = initialize(hierarchy, library_loops(hierarchy, 0));
    const uint64_t held = watched.used;
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
            const uint64_t held_now = watched.used;
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
                    ASSERT_EQ(watched.used, held_now);
                }
            EXPECT_GT(given, 0u);
        }
    EXPECT_EQ(watched.used, held);
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
TEST(ProgressOf, NothingIsOptimizedAfterTheTimeLimit) {
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
            EXPECT_EQ(solution.report.levels[k].sweep_count, 0u) << k;
            EXPECT_EQ(solution.report.levels[k].linear_solve_count, 0u) << k;
        }
        expect_foliation(read_level(hierarchy, 0), solution.foliation);
    }
}

// --- Determinism -------------------------------------------------------------

TEST(SameBits, TwiceAndFromTwoThreads) {
    for (const TriMesh& mesh : story_meshes()) {
        hmf_hierarchy_options options{};
        options.struct_size = sizeof options;
        options.coarsest = 80;
        const AllCalls all_calls(mesh, options), other(mesh, options);
        std::vector<Bits> first, again;
        const auto run = [](const AllCalls& on, std::vector<Bits>& all) {
            for (const Function& function : on.functions) {
                all.emplace_back();
                EXPECT_EQ(function.call(nullptr, &all.back()), HMF_OK) << function.name;
            }
        };
        run(other, first);
        std::thread beside([&] { run(all_calls, again); });
        std::vector<Bits> here;
        run(all_calls, here);
        beside.join();
        for (size_t i = 0; i < first.size(); ++i) {
            SCOPED_TRACE(all_calls.functions[i].name);
            EXPECT_FALSE(first[i].empty());
            EXPECT_EQ(first[i], again[i]);
            EXPECT_EQ(first[i], here[i]);
        }
    }
}

} // namespace test_resources
