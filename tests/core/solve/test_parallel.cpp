// Threads of the host: the same bits for every number of them and every
// schedule, failures as without them, and the pool of hmf/pool.h.
#include <gtest/gtest.h>

#include <hmf/pool.h>

#include <atomic>
#include <thread>

#include "src/core/base/parallel.hpp"
#include "support/watched_host.hpp"
#include "support/sample.hpp"
#include "support/all_calls.hpp"
#include "support/adversarial_scheduler.hpp"

namespace test_parallel {

using namespace test;

namespace {

const uint32_t some_workers[] = {1, 2, 3, 7, 16};

// Of several blocks a pass, with triangles as they come.
std::vector<TriMesh> large_meshes() {
    TorusOptions random;
    random.random_diagonals = true;
    random.jitter = 0.3;
    random.stretch = 2;
    return {torus(120, 80, 3, 1, random), with_random_flips(torus(90, 120, 3, 1), 3000, 0.2, 5)};
}

Bits bits_of_build(const TriMesh& mesh, const hmf_control* control) {
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    hmf_hierarchy* h = nullptr;
    hmf_error error{};
    expect_ok(hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                   mesh.triangle_count(), &options, control, &h, &error),
              error);
    Bits bits;
    for (size_t level = 0; level < hmf_hierarchy_describe(h)->level_count; ++level) {
        const auto mesh =
            make<hmf_level_mesh>([&](auto out, hmf_error* e) { return hmf_level(h, level, nullptr, out, e); });
        append(bits, mesh->weights, mesh->edge_count);
        append(bits, mesh->positions, 3 * mesh->vertex_count);
        append(bits, mesh->edge_vertices, 2 * mesh->edge_count);
    }
    hmf_hierarchy_destroy(h);
    return bits;
}

} // namespace

// --- Blocks --------------------------------------------------------------------

TEST(Parallel, BlocksAreThoseOfTheProblem) {
    for (const uint32_t workers : some_workers)
        for (const size_t n : {size_t{0}, size_t{1}, size_t{4096}, size_t{4097}, size_t{100000}, size_t{3000000}}) {
            AdversarialScheduler host(workers, n);
            const hmf_control control = host.lend();
            const hmf::Parallel parallel(control.parallel_for, control.parallel_user, control.workers);
            const hmf::Parallel alone;
            EXPECT_EQ(parallel.slots(), workers);
            EXPECT_EQ(alone.slots(), 1u);
            std::vector<uint8_t> met(n, 0);
            parallel.for_blocks(n, [&](size_t begin, size_t end) {
                for (size_t i = begin; i < end; ++i) ++met[i];
            });
            EXPECT_EQ(static_cast<size_t>(std::count(met.begin(), met.end(), 1)), n);
            const auto sum = [](size_t begin, size_t end) {
                double s = 0;
                for (size_t i = begin; i < end; ++i) s += 1 / (1.0 + static_cast<double>(i % 1000));
                return s;
            };
            EXPECT_EQ(parallel.sum_blocks<double>(n, sum), alone.sum_blocks<double>(n, sum));
            EXPECT_EQ(host.violations, 0u);
            EXPECT_EQ(host.calls > 0, workers > 1 && n > 4096);
        }
}

// No two tasks have one slot at the same time.
TEST(Parallel, SlotsAreOwned) {
    AdversarialScheduler host(7);
    const hmf_control control = host.lend();
    const hmf::Parallel parallel(control.parallel_for, control.parallel_user, control.workers);
    for (int round = 0; round < 40; ++round) {
        std::atomic<bool> taken[7]{};
        std::atomic<uint32_t> twice{0}, blocks{0};
        parallel.for_each(200, [&](uint32_t, uint32_t slot) {
            if (slot >= 7 || taken[slot].exchange(true)) ++twice;
            std::this_thread::yield();
            taken[slot] = false;
            ++blocks;
        });
        EXPECT_EQ(twice, 0u);
        EXPECT_EQ(blocks, 200u);
    }
}

// --- Bits ----------------------------------------------------------------------

TEST(Parallel, SameBitsOfTheBuild) {
    for (const TriMesh& mesh : large_meshes()) {
        const Bits expected = bits_of_build(mesh, nullptr);
        for (const uint32_t workers : some_workers) {
            AdversarialScheduler host(workers, 7 * workers);
            const hmf_control control = host.lend();
            EXPECT_EQ(bits_of_build(mesh, &control), expected) << workers;
            EXPECT_EQ(host.violations, 0u);
        }
    }
}

// Of several defects the first one counts, whatever block it is in.
TEST(Parallel, SameSentenceOfADefect) {
    const TriMesh sound = large_meshes()[0];
    const size_t F = sound.triangle_count();
    Random random(3);
    const auto turn = [&](TriMesh& mesh) {
        std::swap(mesh.triangles[3 * random.below(F)], mesh.triangles[3 * random.below(F)]);
    };
    const auto repeat = [&](TriMesh& mesh) {
        const size_t t = random.below(F);
        for (size_t s = 0; s < 3; ++s) mesh.triangles.push_back(mesh.triangles[3 * t + s]);
    };
    const auto reverse = [&](TriMesh& mesh) {
        const size_t t = random.below(F);
        std::swap(mesh.triangles[3 * t], mesh.triangles[3 * t + 1]);
    };
    const auto forget = [&](TriMesh& mesh) { mesh.positions.insert(mesh.positions.end(), {1, 2, 3}); };
    const std::function<void(TriMesh&)> defects[] = {turn, repeat, reverse, forget};
    for (int round = 0; round < 8; ++round) {
        TriMesh mesh = sound;
        for (int n = 0; n < 3; ++n) defects[round % 4](mesh);
        const auto sentence = [&](const hmf_control* control) {
            hmf_hierarchy* h = nullptr;
            hmf_error error{};
            EXPECT_NE(hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                           mesh.triangle_count(), nullptr, control, &h, &error),
                      HMF_OK);
            return std::to_string(error.status) + " " + std::to_string(error.index) + " " + error.message;
        };
        AdversarialScheduler host(7, static_cast<uint64_t>(round));
        const hmf_control control = host.lend();
        EXPECT_EQ(sentence(&control), sentence(nullptr));
        EXPECT_EQ(host.violations, 0u);
    }
}

TEST(Parallel, SameBitsOfEveryFunction) {
    const std::vector<TriMesh> meshes = large_meshes();
    for (size_t m = 0; m < meshes.size(); ++m) {
        const uint32_t workers = m == 0 ? 3 : 16;
        hmf_hierarchy_options build{};
        build.struct_size = sizeof build;
        AllCalls all_calls(meshes[m], build);
        for (const Function& function : all_calls.functions) {
            SCOPED_TRACE(function.name);
            Bits expected;
            if (function.keeps) all_calls.refresh();
            ASSERT_EQ(function.call(nullptr, &expected), HMF_OK);
            if (function.keeps) all_calls.refresh();
            AdversarialScheduler host(workers, 3 * workers);
            const hmf_control control = host.lend();
            Bits bits;
            ASSERT_EQ(function.call(&control, &bits), HMF_OK);
            EXPECT_EQ(bits, expected) << workers;
            EXPECT_EQ(host.violations, 0u);
        }
    }
}

TEST(Parallel, SameBitsOfSolveOnRandomProblems) {
    Random random(11);
    for (int round = 0; round < sample(4, 1); ++round) {
        TorusOptions shape;
        shape.random_diagonals = round % 2;
        shape.jitter = 0.4 * random.unit();
        shape.stretch = 1 + 3 * random.unit();
        shape.seed = random.bits();
        const uint64_t seed = random.bits();
        const size_t flips = random.below(5000), m = 60 + random.below(90);
        const TriMesh mesh = with_random_flips(torus(80 + random.below(120), m, 3, 1, shape), flips, 0.1, seed);
        const Hierarchy hierarchy(mesh, 0.2 + 0.6 * random.unit());
        ASSERT_TRUE(hierarchy);
        const auto run = [&](const hmf_control* control) {
            return bits_of(*make<hmf_foliation>([&](auto out, auto error) {
                return hmf_solve_cut_system(hierarchy.get(), nullptr, control, out, error);
            }));
        };
        const Bits expected = run(nullptr);
        for (const uint32_t workers : some_workers) {
            AdversarialScheduler host(workers, random.bits());
            const hmf_control control = host.lend();
            EXPECT_EQ(run(&control), expected) << round << ", " << workers;
            EXPECT_EQ(host.violations, 0u);
            EXPECT_EQ(host.calls > 0, workers > 1);
        }
    }
}

// --- Failures ------------------------------------------------------------------

TEST(Parallel, FailuresWithThreads) {
    WatchedHost watched;
    {
        const TriMesh mesh = large_meshes()[1];
        const Hierarchy hierarchy(mesh, watched.options());
        ASSERT_TRUE(hierarchy);
        AdversarialScheduler host(5);
        const uint64_t held = watched.used, first = watched.calls;
        Progress progress;
        hmf_control control = host.lend(progress.control());
        const auto run = [&] {
            hmf_foliation* f = nullptr;
            const hmf_status status = hmf_solve_cut_system(hierarchy.get(), nullptr, &control, &f, nullptr);
            EXPECT_EQ(f != nullptr, status == HMF_OK);
            hmf_foliation_destroy(f);
            EXPECT_EQ(watched.used, held);
            return status;
        };
        ASSERT_EQ(run(), HMF_OK);
        EXPECT_TRUE(progress.rising);
        const uint64_t allocations = watched.calls - first, reports = progress.calls;
        for (uint64_t n = 1; n <= allocations; n += 1 + allocations / 12) {
            watched.fail = watched.calls + n;
            progress = {};
            EXPECT_EQ(run(), HMF_ERROR_MEMORY) << "allocation " << n << " of " << allocations;
        }
        watched.fail = 0;
        for (uint64_t n = 1; n < reports - 1; n += 1 + reports / 12) {
            progress = {};
            progress.stop = n;
            EXPECT_EQ(run(), HMF_CANCELLED) << "report " << n << " of " << reports;
        }
        EXPECT_EQ(host.violations, 0u);
    }
    EXPECT_EQ(watched.used, 0u);
}

// --- Pool ----------------------------------------------------------------------

namespace {

struct Counter {
    std::atomic<uint32_t> met[64]{};
    static void task(void* user, uint32_t index) { ++static_cast<Counter*>(user)->met[index]; }
    // The first count of them once, no other.
    bool is(uint32_t count) const {
        for (uint32_t i = 0; i < 64; ++i)
            if (met[i] != (i < count)) return false;
        return true;
    }
};

} // namespace

TEST(Pool, EachTaskOnce) {
    for (const uint32_t threads : some_workers) {
        hmf_pool* const pool = hmf_pool_create(threads);
        ASSERT_NE(pool, nullptr);
        EXPECT_EQ(hmf_pool_threads(pool), threads);
        for (uint32_t round = 0; round < 2000; ++round) {
            Counter counter;
            hmf_pool_run(pool, Counter::task, &counter, round % 65);
            ASSERT_TRUE(counter.is(round % 65)) << threads << ", " << round;
        }
        hmf_pool_destroy(pool);
    }
    hmf_pool* const all = hmf_pool_create(0);
    EXPECT_EQ(hmf_pool_threads(all), std::max(1u, std::thread::hardware_concurrency()));
    hmf_pool_destroy(all);
}

TEST(Pool, NullIsOneThread) {
    Counter counter;
    hmf_pool_run(nullptr, Counter::task, &counter, 9);
    EXPECT_TRUE(counter.is(9));
    EXPECT_EQ(hmf_pool_threads(nullptr), 1u);
    hmf_pool_destroy(nullptr);
}

TEST(Pool, ManyCallersAtOnce) {
    hmf_pool* const pool = hmf_pool_create(3);
    std::atomic<uint32_t> wrong{0};
    std::vector<std::thread> callers;
    for (int i = 0; i < 5; ++i)
        callers.emplace_back([&] {
            for (uint32_t round = 0; round < 500; ++round) {
                Counter counter;
                hmf_pool_run(pool, Counter::task, &counter, 2 + round % 60);
                wrong += !counter.is(2 + round % 60);
            }
        });
    for (std::thread& t : callers) t.join();
    EXPECT_EQ(wrong, 0u);
    hmf_pool_destroy(pool);
}

// Several threads with one pool on one hierarchy and one foliation.
TEST(Pool, ManyThreadsOnOneHierarchy) {
    const TriMesh mesh = large_meshes()[0];
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    const Foliation shared = make<hmf_foliation>(
        [&](auto out, auto error) { return hmf_solve_cut_system(hierarchy.get(), nullptr, nullptr, out, error); });
    const Bits expected = bits_of(*shared);
    const Bits map = bits_of(*make<hmf_parameterization>(
        [&](auto out, auto error) { return hmf_parameterize(shared.get(), nullptr, nullptr, out, error); }));
    const Foliation again = make<hmf_foliation>(
        [&](auto out, auto error) { return hmf_solve_cut_system(hierarchy.get(), nullptr, nullptr, out, error); });
    hmf_pool* const pool = hmf_pool_create(3);
    hmf_control control{};
    control.struct_size = sizeof control;
    control.workers = hmf_pool_threads(pool);
    control.parallel_for = hmf_pool_run;
    control.parallel_user = pool;
    Bits solved[3], mapped[3];
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i)
        threads.emplace_back([&, i] {
            hmf_foliation* f = nullptr;
            if (hmf_solve_cut_system(hierarchy.get(), nullptr, &control, &f, nullptr) == HMF_OK)
                solved[i] = bits_of(*f);
            hmf_foliation_destroy(f);
            // The first of them makes the flat surface that is kept with the foliation.
            hmf_parameterization* p = nullptr;
            if (hmf_parameterize(again.get(), nullptr, &control, &p, nullptr) == HMF_OK) mapped[i] = bits_of(*p);
            hmf_free(p);
        });
    for (std::thread& t : threads) t.join();
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(solved[i], expected);
        EXPECT_EQ(mapped[i], map);
    }
    hmf_pool_destroy(pool);
}

// Three solves share a pool; another thread than theirs asks one of them to stop, the others end as if alone.
TEST(Pool, CancelFromAnotherThread) {
    const TriMesh mesh = large_meshes()[0];
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    const Bits expected = bits_of(*make<hmf_foliation>(
        [&](auto out, auto error) { return hmf_solve_cut_system(hierarchy.get(), nullptr, nullptr, out, error); }));
    hmf_pool* const pool = hmf_pool_create(3);
    struct Asked {
        std::atomic<uint32_t> reports{0};
        std::atomic<bool> stop{false};
        static int32_t report(void* user, double) {
            Asked& asked = *static_cast<Asked*>(user);
            ++asked.reports;
            // The one that will be stopped waits for that: it cannot end before.
            while (asked.waits && asked.reports > 3 && !asked.stop) std::this_thread::yield();
            return asked.stop ? HMF_PROGRESS_CANCEL : HMF_PROGRESS_CONTINUE;
        }
        bool waits = false;
    } asked[3];
    asked[1].waits = true;
    hmf_status status[3];
    Bits bits[3];
    std::vector<std::thread> threads;
    for (int i = 0; i < 3; ++i)
        threads.emplace_back([&, i] {
            hmf_control control{};
            control.struct_size = sizeof control;
            control.workers = hmf_pool_threads(pool);
            control.parallel_for = hmf_pool_run;
            control.parallel_user = pool;
            control.progress = Asked::report;
            control.progress_user = &asked[i];
            hmf_foliation* f = nullptr;
            status[i] = hmf_solve_cut_system(hierarchy.get(), nullptr, &control, &f, nullptr);
            if (f) bits[i] = bits_of(*f);
            hmf_foliation_destroy(f);
        });
    while (asked[1].reports < 4) std::this_thread::yield();
    const uint32_t before = asked[1].reports;
    asked[1].stop = true;
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(status[1], HMF_CANCELLED);
    EXPECT_TRUE(bits[1].empty());
    EXPECT_EQ(asked[1].reports, before) << "called again after the answer";
    for (const int i : {0, 2}) {
        EXPECT_EQ(status[i], HMF_OK);
        EXPECT_EQ(bits[i], expected);
    }
    hmf_pool_destroy(pool);
}

} // namespace test_parallel
