// Values from outside as the start of a solve: the same minimum, with no more
// linear solves than from loops.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace test;

namespace {

double relative(double a, double b) { return std::abs(a - b) / std::max(std::abs(a), std::abs(b)); }

struct Outcome {
    hmf_status status = HMF_ERROR_INTERNAL;
    std::vector<double> values;
    double energy = 0;
    uint64_t linear_solves = 0;
    hmf_error error{};
};

// From loops, or from values of a level where loops is NULL.
Outcome run(const Hierarchy& hierarchy, const Loops* loops, const std::vector<double>& initial,
            size_t initial_level = 0, int32_t method = HMF_METHOD_NEWTON) {
    Outcome result;
    hmf_solve_options options = solve_options(method, 0);
    if (!loops) {
        options.initial_values = initial.data();
        options.initial_count = initial.size();
        options.initial_level = initial_level;
    }
    std::vector<hmf_level_report> levels(hierarchy.levels());
    hmf_report report{};
    report.struct_size = sizeof report;
    report.levels = levels.data();
    report.level_capacity = levels.size();
    result.values.resize(hierarchy.edges(0));
    const hmf_loop_set set = loops ? loops->view() : hmf_loop_set{};
    result.status = hmf_solve(hierarchy.get(), loops ? &set : nullptr, &options, result.values.data(),
                              result.values.size(), &report, &result.error);
    result.energy = report.energy;
    for (const hmf_level_report& level : levels) result.linear_solves += level.linear_solves;
    return result;
}

TriMesh jittered(const TriMesh& mesh, double size, uint64_t seed) {
    TriMesh result = mesh;
    Random random(seed);
    for (double& x : result.positions) x += size * (random.unit() - 0.5);
    return result;
}

} // namespace

TEST(Reuse, OwnResult) {
    const Hierarchy hierarchy(pretzel(3, 3));
    ASSERT_TRUE(hierarchy);
    ASSERT_GT(hierarchy.levels(), 2u);
    const Loops loops = library_loops(hierarchy, 0);
    const Outcome scratch = run(hierarchy, &loops, {});
    ASSERT_EQ(scratch.status, HMF_OK) << scratch.error.message;
    const Outcome again = run(hierarchy, nullptr, scratch.values);
    ASSERT_EQ(again.status, HMF_OK) << again.error.message;
    EXPECT_LT(relative(again.energy, scratch.energy), 1e-10);
    EXPECT_LE(again.linear_solves, scratch.linear_solves);
    expect_foliation(hierarchy, read_level(hierarchy, 0), again.values);
}

// Frames of an animation: the same triangles, other positions.
TEST(Reuse, ResultOfAnotherGeometry) {
    const TriMesh mesh = pretzel(3, 3);
    for (const uint64_t seed : {1, 2, 3}) {
        SCOPED_TRACE(seed);
        const Hierarchy first(mesh),
            second(transformed(jittered(mesh, 0.02, seed),
                               {1.3, 0.1 * static_cast<double>(seed), 0, 0, 1, 0, 0, 0.2, 0.8}));
        ASSERT_TRUE(first && second);
        const Loops loops = library_loops(first, 0);
        const Outcome before = run(first, &loops, {});
        ASSERT_EQ(before.status, HMF_OK) << before.error.message;
        const Outcome scratch = run(second, &loops, {}), reused = run(second, nullptr, before.values);
        ASSERT_EQ(scratch.status, HMF_OK) << scratch.error.message;
        ASSERT_EQ(reused.status, HMF_OK) << reused.error.message;
        EXPECT_LT(relative(reused.energy, scratch.energy), 1e-10);
        EXPECT_LE(reused.linear_solves, scratch.linear_solves + 1);
        EXPECT_GT(relative(before.energy, scratch.energy), 1e-3);
    }
}

// Far from the minimum: the initial foliation of loops on the input mesh.
TEST(Reuse, InitialFoliation) {
    const Hierarchy hierarchy(with_random_flips(pretzel(2, 3), 20000, 0.8, 5));
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    const hmf_loop_set set = loops.view();
    std::vector<double> start(hierarchy.edges(0));
    ASSERT_EQ(hmf_initialize(hierarchy.get(), &set, start.data(), start.size(), nullptr), HMF_OK);
    const Outcome scratch = run(hierarchy, &loops, {});
    ASSERT_EQ(scratch.status, HMF_OK) << scratch.error.message;
    const Outcome reused = run(hierarchy, nullptr, start);
    ASSERT_EQ(reused.status, HMF_OK) << reused.error.message;
    EXPECT_LT(relative(reused.energy, scratch.energy), 1e-10);
    EXPECT_EQ(reused.linear_solves, scratch.linear_solves); // it is what the loops give
}

TEST(Reuse, OfAnyLevelWithAnyMethod) {
    const Hierarchy hierarchy(pretzel(2, 3));
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    const Outcome scratch = run(hierarchy, &loops, {});
    ASSERT_EQ(scratch.status, HMF_OK);
    for (size_t level = 0; level < hierarchy.levels(); ++level)
        for (const int32_t method : {HMF_METHOD_NEWTON, HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
            SCOPED_TRACE(testing::Message() << "level " << level << " method " << method);
            std::vector<double> there(hierarchy.edges(level));
            ASSERT_EQ(hmf_interpolate(hierarchy.get(), 0, scratch.values.data(), scratch.values.size(), level,
                                      there.data(), there.size(), nullptr),
                      HMF_OK);
            const Outcome reused = run(hierarchy, nullptr, there, level, method);
            ASSERT_LT(reused.status, HMF_CANCELLED) << reused.error.message;
            EXPECT_LT(relative(reused.energy, scratch.energy), method == HMF_METHOD_NEWTON ? 1e-10 : 2e-3);
        }
}

// Up and down the levels, with some moves on the way: restriction,
// interpolation and moves keep the class, so the minimum is the same.
TEST(Reuse, RandomWalksOverTheLevels) {
    const TriMesh meshes[] = {pretzel(3, 3), with_random_flips(pretzel(2, 3), 80000, -1, 6),
                              with_bad_triangles(pretzel(2, 3), 200, 0.01, 7)};
    for (size_t m = 0; m < 3; ++m) {
        const Hierarchy hierarchy(meshes[m], 0.6, 150);
        ASSERT_TRUE(hierarchy);
        ASSERT_GT(hierarchy.levels(), 3u);
        const Loops loops = library_loops(hierarchy, hierarchy.coarsest());
        const hmf_loop_set set = loops.view();
        const Outcome scratch = run(hierarchy, &loops, {});
        ASSERT_EQ(scratch.status, HMF_OK) << scratch.error.message;
        for (const uint64_t seed : {1, 2, 3, 4}) {
            SCOPED_TRACE(testing::Message() << "mesh " << m << " seed " << seed);
            Random random(seed);
            std::vector<double> values(hierarchy.edges(hierarchy.coarsest()));
            ASSERT_EQ(hmf_initialize(hierarchy.get(), &set, values.data(), values.size(), nullptr), HMF_OK);
            size_t level = hierarchy.coarsest();
            for (size_t step = 0; step < 12; ++step) {
                const size_t next = step == 11 ? 0 : random.below(hierarchy.levels());
                std::vector<double> there(hierarchy.edges(next));
                hmf_error error{};
                ASSERT_EQ(hmf_interpolate(hierarchy.get(), level, values.data(), values.size(), next, there.data(),
                                          there.size(), &error),
                          HMF_OK)
                    << error.message;
                level = next;
                values = there;
                const LevelMesh mesh = read_level(hierarchy, level);
                expect_foliation(hierarchy, mesh, values);
                if (random.below(2) == 0) continue;
                const Solution moved =
                    relax(hierarchy, level, values, solve_options(HMF_METHOD_WHITEHEAD, 1e-12, 1 + random.below(4)));
                ASSERT_LT(moved.status, HMF_CANCELLED) << moved.error.message;
                values = moved.values;
                expect_foliation(hierarchy, mesh, values);
            }
            const Solution relaxed = relax(hierarchy, 0, values, solve_options(HMF_METHOD_NEWTON, 0));
            EXPECT_EQ(relaxed.status, HMF_OK) << relaxed.error.message;
            EXPECT_LT(relative(relaxed.report.energy, scratch.energy), 1e-10);
        }
    }
}

// What comes back on the caller's edges.  Energy and residuals are those of the
// report, to the bit, unless a vertex had to be moved on the way back; the
// minimum of the class is the same in any case.
TEST(Reuse, RoundTripOfTheInputMesh) {
    size_t exact = 0, moved = 0;
    const TriMesh meshes[] = {
        pretzel(2, 3), with_random_flips(pretzel(2, 3), 6000, 0.9, 1), with_random_flips(pretzel(3, 2), 3000, 0.95, 2),
        with_random_flips(pretzel(2, 3), 80000, -1, 3), with_bad_triangles(pretzel(2, 3), 300, 0.01, 4)};
    for (const TriMesh& mesh : meshes) {
        const Hierarchy hierarchy(mesh);
        ASSERT_TRUE(hierarchy);
        const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
        ASSERT_EQ(solution.status, HMF_OK) << solution.error.message;
        const std::vector<double>& values = solution.values;
        double energy = 0;
        ASSERT_EQ(hmf_energy(hierarchy.get(), 0, values.data(), values.size(), &energy, nullptr), HMF_OK);
        std::vector<double> residual(mesh.vertex_count());
        ASSERT_EQ(
            hmf_residuals(hierarchy.get(), 0, values.data(), values.size(), residual.data(), residual.size(), nullptr),
            HMF_OK);
        const double residual_max = *std::max_element(residual.begin(), residual.end());
        if (solution.report.bad_flips == 0) {
            EXPECT_EQ(energy, solution.report.energy);
            EXPECT_EQ(residual_max, solution.report.residual_max);
            ++exact;
        } else {
            EXPECT_GE(energy, solution.report.energy * (1 - 1e-14));
            ++moved;
        }
        const Solution again = relax(hierarchy, 0, values, solve_options(HMF_METHOD_NEWTON, 0));
        ASSERT_EQ(again.status, HMF_OK) << again.error.message;
        EXPECT_LT(relative(again.report.energy, solution.report.energy), 1e-12);
    }
    EXPECT_GT(exact, 0u);
    EXPECT_GT(moved, 0u);
}

// Passing values on and on costs no bits.
TEST(Reuse, AgainAndAgain) {
    const Hierarchy hierarchy(with_random_flips(pretzel(2, 2), 3000, 0.9, 8), 0.5, 200);
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    const Outcome first = run(hierarchy, &loops, {});
    ASSERT_EQ(first.status, HMF_OK) << first.error.message;
    Outcome last = first;
    for (int round = 0; round < 12; ++round) {
        last = run(hierarchy, nullptr, last.values);
        ASSERT_EQ(last.status, HMF_OK) << "round " << round << ": " << last.error.message;
        Solution relaxed = relax(hierarchy, 0, last.values, solve_options(HMF_METHOD_NEWTON, 0));
        ASSERT_EQ(relaxed.status, HMF_OK) << "round " << round << ": " << relaxed.error.message;
        last.values = relaxed.values;
    }
    EXPECT_LT(relative(last.energy, first.energy), 1e-10);
    expect_foliation(hierarchy, read_level(hierarchy, 0), last.values);
}

TEST(Reuse, Errors) {
    const Hierarchy hierarchy(pretzel(2, 2), 0.5, 100);
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    const hmf_loop_set set = loops.view();
    const Outcome good = run(hierarchy, &loops, {});
    ASSERT_EQ(good.status, HMF_OK);
    hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 0);
    options.initial_values = good.values.data();
    options.initial_count = good.values.size();
    std::vector<double> values(good.values.size(), -1);
    const auto status = [&](const hmf_loop_set* given) {
        const hmf_status result =
            hmf_solve(hierarchy.get(), given, &options, values.data(), values.size(), nullptr, nullptr);
        if (result >= HMF_ERROR_NULL)
            EXPECT_EQ(std::count(values.begin(), values.end(), -1.0), static_cast<long>(values.size()));
        return result;
    };
    EXPECT_EQ(status(&set), HMF_ERROR_OPTIONS);
    options.initial_count -= 1;
    EXPECT_EQ(status(nullptr), HMF_ERROR_CAPACITY);
    options.initial_count += 1;
    options.initial_level = hierarchy.levels();
    EXPECT_EQ(status(nullptr), HMF_ERROR_LEVEL);
    options.initial_level = 1;
    EXPECT_EQ(status(nullptr), HMF_ERROR_CAPACITY);
    options.initial_level = 0;
    std::vector<double> bad = good.values;
    options.initial_values = bad.data();
    bad[7] += 1;
    EXPECT_EQ(status(nullptr), HMF_ERROR_VALUE_NOT_CLOSED);
    bad[7] = std::nan("");
    EXPECT_EQ(status(nullptr), HMF_ERROR_VALUE_NOT_FINITE);
    std::fill(bad.begin(), bad.end(), 0.0);
    EXPECT_EQ(status(nullptr), HMF_ERROR_VALUE_POLE);
    // In place.
    values = good.values;
    options.initial_values = values.data();
    EXPECT_EQ(status(nullptr), HMF_OK);
}
