#include "unique.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test {

namespace {

double relative(double a, double b) { return std::abs(a - b) / std::max(std::abs(a), std::abs(b)); }

} // namespace

void expect_unique(const TriMesh& mesh, const UniqueOptions& options) {
    // One set of curves: the loops of level 0 depend on the hierarchy, the
    // numbers of the input's triangles do not.
    Loops loops;
    {
        const Hierarchy hierarchy(mesh, options.ratios.front(), options.coarsest.front());
        ASSERT_TRUE(hierarchy);
        loops = library_loops(hierarchy, 0);
    }
    const hmf_solve_options exact = solve_options(HMF_METHOD_NEWTON, 0);
    double expected = 0; // the first energy of Newton's method
    bool first = true;
    for (const double ratio : options.ratios)
        for (const uint64_t coarsest : options.coarsest) {
            SCOPED_TRACE(testing::Message() << "ratio " << ratio << " coarsest " << coarsest);
            const Hierarchy hierarchy(mesh, ratio, coarsest);
            ASSERT_TRUE(hierarchy);
            const LevelMesh level = read_level(hierarchy, 0);
            const Solution newton = solve(hierarchy, &loops, exact);
            EXPECT_EQ(newton.status, HMF_OK) << "newton: " << newton.error.message;
            ASSERT_LT(newton.status, HMF_ERROR_NULL);
            EXPECT_LE(newton.report.residual_max, 1e-8);
            expect_foliation(level, newton.foliation);
            if (first) expected = newton.report.energy;
            EXPECT_LT(relative(newton.report.energy, expected), 1e-10)
                << "newton " << newton.report.energy << " instead of " << expected;

            if (first && options.relaxed) {
                const size_t top = hierarchy.coarsest();
                const Foliation there = interpolate(initialize(hierarchy, loops), top);
                expect_foliation(read_level(hierarchy, top), there);
                const Foliation back = interpolate(there, 0);
                expect_foliation(level, back);
                const Solution relaxed = relax(back, exact);
                EXPECT_EQ(relaxed.status, HMF_OK) << "relax: " << relaxed.error.message;
                ASSERT_LT(relaxed.status, HMF_ERROR_NULL);
                EXPECT_LT(relative(relaxed.report.energy, expected), 1e-10)
                    << "relax " << relaxed.report.energy << " instead of " << expected;
            }
            if (options.paper) {
                const Solution paper = solve(hierarchy, &loops, solve_options(HMF_METHOD_WHITEHEAD, 1e-10));
                EXPECT_TRUE(paper.status == HMF_OK || paper.status == HMF_LIMIT_STALLED)
                    << "whitehead: " << paper.error.message;
                ASSERT_LT(paper.status, HMF_ERROR_NULL);
                expect_foliation(level, paper.foliation);
                EXPECT_LT(relative(paper.report.energy, expected), 1e-6)
                    << "whitehead " << paper.report.energy << " instead of " << expected;
                // The minimum is the minimum.
                EXPECT_GE(paper.report.energy, expected * (1 - 1e-10));
            }
            first = false;
        }
}

} // namespace test
