// The figures that results carry of their own checks, on surfaces where they must be small. That each check sees a
// defect is shown by tests/mutation.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_checks {

using namespace test;

namespace {

const SolvedSurface& surface() {
    static const SolvedSurface solved(pretzel(2, 2));
    return solved;
}

const hmf_foliation* foliation() { return surface().solution.foliation.get(); }

Owned<hmf_lines> trace(int32_t leaves, double spacing) {
    hmf_trace_options options{};
    options.struct_size = sizeof options;
    options.leaves = leaves;
    options.spacing = spacing;
    options.critical = 1;
    const uint32_t triangles[] = {0, 17, 40};
    const double barycentrics[] = {0.2, 0.3, 0.5, 1. / 3, 1. / 3, 1. / 3, 0.6, 0.3, 0.1};
    options.point_count = 3;
    options.point_triangles = triangles;
    options.point_barycentrics = barycentrics;
    return make<hmf_lines>(
        [&](hmf_lines** out, hmf_error* error) { return hmf_trace(foliation(), &options, nullptr, out, error); });
}

} // namespace

TEST(Checks, Leaves) {
    const double largest = *std::max_element(surface().solution.values.begin(), surface().solution.values.end());
    for (const int32_t leaves : {HMF_LEAVES_FOLIATION, HMF_LEAVES_CONJUGATE})
        for (const double spacing : {0.5, 0.02}) {
            const auto lines = trace(leaves, spacing);
            ASSERT_TRUE(lines);
            EXPECT_GT(lines->compared_count, 20u);
            EXPECT_LT(lines->deviation, 1e-9 * largest);
        }
}

TEST(Checks, Cylinders) {
    const auto set = make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* error) {
        return hmf_cylinders(foliation(), nullptr, nullptr, out, error);
    });
    ASSERT_TRUE(set);
    double sum = 0;
    for (size_t c = 0; c < set->count; ++c) sum += set->list[c].height * set->list[c].circumference;
    EXPECT_NEAR(set->area_error, std::fabs(sum / surface().solution.report.energy - 1), 1e-12);
    EXPECT_LT(set->area_error, 1e-5);
}

TEST(Checks, Parameterization) {
    const auto map = make<hmf_parameterization>([&](hmf_parameterization** out, hmf_error* error) {
        return hmf_parameterize(foliation(), nullptr, nullptr, out, error);
    });
    ASSERT_TRUE(map);
    EXPECT_NEAR(map->energy_ratio, map->area / surface().solution.report.energy, 1e-4);
    EXPECT_LT(map->area_error, 1e-5);
    EXPECT_LE(map->circumference_least, map->circumference_most);
    EXPECT_NEAR(map->circumference_least, 1, 0.1);
    EXPECT_NEAR(map->circumference_most, 1, 0.1);
}

TEST(Checks, Atlas) {
    const auto charts = make<hmf_chart_set>(
        [&](hmf_chart_set** out, hmf_error* error) { return hmf_atlas(foliation(), nullptr, nullptr, out, error); });
    ASSERT_TRUE(charts);
    // Each side of a seam is the edge of a chart.
    EXPECT_EQ(charts->compared_count, 2 * charts->seam_edge_count);
    EXPECT_EQ(charts->speck_count, 0u);
}

} // namespace test_checks
