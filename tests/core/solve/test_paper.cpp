// HMF_METHOD_PAPER, "case 4" of [W] 4.2.2 as printed: the poles that it leaves are counted and said, and without a bad
// flip nothing is different.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace test_paper {

using namespace test;

namespace {

struct Pair {
    Solution paper, whitehead;
};

Pair solve_both(const Hierarchy& hierarchy, const Loops& loops, double tolerance) {
    return {solve(hierarchy, &loops, solve_options(HMF_METHOD_PAPER, tolerance)),
            solve(hierarchy, &loops, solve_options(HMF_METHOD_WHITEHEAD, tolerance))};
}

} // namespace

TEST(Paper, IsWhiteheadWithoutABadFlip) {
    size_t same = 0;
    for (const TriMesh& mesh : {torus(40, 24, 3, 1), pretzel(2, 2), pretzel(3, 2), joined_tori(24, 14, 8, 5)}) {
        const Hierarchy hierarchy(mesh, 0.5, 150);
        const Pair both = solve_both(hierarchy, library_loops(hierarchy, 0), 0);
        EXPECT_EQ(both.paper.report.method, HMF_METHOD_PAPER);
        if (both.whitehead.report.bad_flips > 0) continue;
        ++same;
        EXPECT_EQ(both.paper.status, HMF_OK) << both.paper.error.message;
        EXPECT_EQ(both.paper.report.class_state, HMF_CLASS_PROVEN);
        EXPECT_EQ(both.paper.values, both.whitehead.values);
        EXPECT_EQ(both.paper.report.energy, both.whitehead.report.energy);
    }
    EXPECT_GT(same, 0u) << "all have bad flips: the test tests nothing";
}

// Meshes with many flips between levels: the ones that the formula turns into poles are moved first, or not.  A few
// sweeps do not remove them.
TEST(Paper, LeavesPolesWhereWhiteheadLeavesNone) {
    size_t with_poles = 0, with_bad_flips = 0;
    for (uint64_t seed = 1; seed <= 8; ++seed) {
        SCOPED_TRACE(seed);
        Random random(seed);
        const size_t smoothings = random.below(4);
        TriMesh mesh = pretzel(2 + random.below(3), 3, smoothings);
        mesh = with_random_flips(mesh, mesh.triangle_count() / 2, 0.7, seed);
        mesh = transformed(mesh, {2 + 200 * random.unit(), 0, 0, 0, 1, 0, 0, 0, 1});
        const Hierarchy hierarchy(mesh, 0.25, 150);
        ASSERT_TRUE(hierarchy);
        const Pair both = solve_both(hierarchy, library_loops(hierarchy, 0, HMF_LOOPS_PANTS), 0.1);
        EXPECT_EQ(both.whitehead.status, HMF_OK);
        EXPECT_EQ(both.whitehead.report.poles, 0u);
        EXPECT_EQ(both.whitehead.report.bad_flips_left, 0u);
        EXPECT_EQ(both.whitehead.report.class_state, HMF_CLASS_PROVEN);
        ASSERT_LT(both.paper.status, HMF_ERROR_NULL) << both.paper.error.message;
        const hmf_report& report = both.paper.report;
        EXPECT_LE(report.bad_flips_left, report.bad_flips);
        // What the report counts is there.
        const LevelMesh level = read_level(hierarchy, 0);
        EXPECT_EQ(closedness_defect(level, both.paper.values), "");
        const Indices indices = count_indices(level, both.paper.values);
        EXPECT_EQ(indices.poles > 0, report.poles > 0);
        EXPECT_EQ(indices.sum, 4 - 4 * static_cast<long>(mesh.genus));
        EXPECT_EQ(report.index_sum, indices.sum);
        const bool right = report.poles == 0 && report.class_state == HMF_CLASS_PROVEN;
        EXPECT_EQ(both.paper.status, right ? HMF_OK : HMF_LIMIT_CLASS) << both.paper.error.message;
        if (report.bad_flips_left == 0) { EXPECT_TRUE(right); }
        with_bad_flips += report.bad_flips_left > 0;
        if (report.poles == 0) continue;
        ++with_poles;
        EXPECT_EQ(report.class_state, HMF_CLASS_LOST);
        EXPECT_GT(report.bad_flips_left, 0u);
        // Nothing goes on from there.
        hmf_foliation* out = nullptr;
        hmf_error error{};
        EXPECT_EQ(hmf_relax(both.paper.foliation.get(), nullptr, nullptr, &out, &error), HMF_ERROR_VALUE_POLE);
    }
    EXPECT_GT(with_bad_flips, 0u);
    EXPECT_GT(with_poles, 0u) << "no mesh has poles: the test tests nothing";
}

} // namespace test_paper
