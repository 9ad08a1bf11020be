// The figures that results carry of their own checks, on surfaces where they must be small. That each check sees a
// defect is shown by tests/mutation.
#include "src/applications/api/shared_flat.hpp"
#include "src/applications/parameterize/check_cylinders.hpp"
#include "src/applications/parameterize/harmonic_form.hpp"
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

namespace {

// (du, dv) of a foliation of a torus, which has no zeros.
struct FlatTorus {
    SolvedSurface solved{torus(24, 16, 3, 1)};
    hmf::Memory memory{nullptr, nullptr, nullptr, 0};
    hmf::Call call{memory, nullptr, nullptr, nullptr};
    hmf::State state;
    hmf::FlatConeMetric flat;

    FlatTorus() {
        EXPECT_EQ(hmf::load_solved_in_unit_of_values(*solved.solution.foliation, state, call), HMF_OK);
        EXPECT_EQ(hmf::flat_cone_metric(state, 0, flat, call), HMF_OK);
    }
};

} // namespace

// du + dv is closed and coclosed, but u changes along a leaf.
TEST(Checks, PeriodsAlongLeaves) {
    FlatTorus on;
    hmf::CylinderCheck right, wrong;
    const hmf::MovedZeros moved;
    ASSERT_EQ(hmf::check_cylinders(on.state, moved, on.flat.bundle, on.flat.du, right, on.call), HMF_OK);
    EXPECT_EQ(right.open, 0u);
    for (uint32_t e = 0; e < on.state.foliation.mesh.edge_count; ++e) on.flat.du.value[e] += on.flat.dv.value[e];
    ASSERT_EQ(hmf::check_cylinders(on.state, moved, on.flat.bundle, on.flat.du, wrong, on.call), HMF_OK);
    EXPECT_GT(wrong.open, 0u);
}

// u of one vertex that is regular in the foliation is moved: du stays closed, in the same class.
TEST(Checks, FluxesAtRegularVertices) {
    FlatTorus on;
    const hmf::Mesh& mesh = on.state.foliation.mesh;
    const double* const weight = on.state.hierarchy->levels[on.state.level].weight;
    const std::vector<uint8_t> regular(mesh.vertex_count, 1);
    const double energy = on.solved.solution.report.energy;
    hmf::VertexCharts charts;
    hmf::TwistedLaplacian laplacian;
    ASSERT_TRUE(charts.build(mesh, on.flat.bundle, on.call));
    ASSERT_EQ(laplacian.build(mesh, on.flat.bundle, charts, weight, on.call), HMF_OK);
    hmf::TwistedForm& du = on.flat.du;
    const auto largest = std::max_element(du.value.begin(), du.value.end());
    const uint32_t v = mesh.origin[2 * static_cast<uint32_t>(largest - du.value.begin())];
    const int64_t far = *largest;
    for (const bool by_values : {false, true}) {
        const hmf::TwistedLaplacian::Known known{regular.data(), 1e-4, energy, by_values};
        hmf::Call call{on.memory, nullptr, nullptr, nullptr};
        ASSERT_EQ(laplacian.make_harmonic(du, 1e-7, call, known), HMF_OK);
        for (const uint32_t h : mesh.around(v)) du.add(on.flat.bundle, h, charts.chart[h] * far);
        EXPECT_EQ(laplacian.make_harmonic(du, 1e-7, call, known),
                  by_values ? HMF_ERROR_VALUE_NOT_HARMONIC : HMF_ERROR_INTERNAL);
        for (const uint32_t h : mesh.around(v)) du.add(on.flat.bundle, h, -charts.chart[h] * far);
    }
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
