// hmf.hpp and applications.hpp: the classes give what the C calls give, failures become exceptions,
// and exceptions of a progress function pass through.
#include <hmf/applications.hpp>

#include "support/meshes.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <thread>
#include <type_traits>

namespace test_hpp {

namespace {

test::TriMesh mesh() { return test::pretzel(2, 3); }

hmf::Hierarchy make(const hmf::BuildOptions& options = {}, const hmf::ProgressFunction& progress = nullptr) {
    const test::TriMesh m = mesh();
    return hmf::Hierarchy(m.positions, m.triangles, options, progress);
}

template <class T>
std::vector<T> copy(hmf::Span<T> span) {
    return std::vector<T>(span.begin(), span.end());
}

hmf::BuildOptions with_levels() {
    hmf::BuildOptions options;
    options.coarsest = 100;
    return options;
}

// The error of a call that must fail.
template <class Call>
hmf::Error error_of(Call&& call) {
    try {
        call();
    } catch (const hmf::Error& error) {
        EXPECT_GT(std::string(error.what()).size(), 20u);
        return error;
    }
    ADD_FAILURE() << "the call succeeded";
    return hmf::Error(HMF_OK, HMF_ELEMENT_NONE, 0, "");
}

static_assert(!std::is_copy_constructible_v<hmf::Hierarchy> && std::is_nothrow_move_constructible_v<hmf::Hierarchy>);
static_assert(!std::is_copy_constructible_v<hmf::Foliation> && std::is_nothrow_move_constructible_v<hmf::Foliation>);
static_assert(!std::is_copy_constructible_v<hmf::QuadMesh> && std::is_nothrow_move_constructible_v<hmf::QuadMesh>);
static_assert(std::is_base_of_v<std::runtime_error, hmf::Error>);
static_assert(!std::is_convertible_v<std::vector<float>, hmf::Span<double>>);
static_assert(!std::is_convertible_v<std::vector<std::array<float, 6>>, hmf::Span<double>>);

TEST(Hpp, SameValuesAsC) {
    const test::TriMesh m = mesh();
    hmf_hierarchy* raw = nullptr;
    hmf_foliation* solved = nullptr;
    ASSERT_EQ(HMF_OK, hmf_hierarchy_create(m.positions.data(), m.vertex_count(), m.triangles.data(), m.triangle_count(),
                                           nullptr, nullptr, &raw, nullptr));
    ASSERT_EQ(HMF_OK, hmf_solve_cut_system(raw, nullptr, nullptr, &solved, nullptr));
    hmf_hierarchy_destroy(raw);
    size_t count = 0;
    const double* values = hmf_foliation_values(solved, &count);
    const std::vector<double> expected(values, values + count);
    const double unit = hmf_foliation_unit(solved);
    hmf_foliation_destroy(solved);

    const hmf::Hierarchy hierarchy(m.positions, m.triangles);
    const hmf::Solution solution = hmf::solve_cut_system(hierarchy);
    EXPECT_EQ(HMF_OK, solution.status);
    EXPECT_EQ("", solution.message);
    EXPECT_EQ(expected, copy(solution.foliation.values()));
    EXPECT_EQ(unit, solution.foliation.unit());
    EXPECT_EQ(expected, copy(hierarchy.solve(hmf::loops(hierarchy, hierarchy.coarsest_level())).foliation.values()));
}

TEST(Hpp, EvenDesign) {
    const test::TriMesh m = test::torus_with_finger(30, 16, 10, 2);
    const hmf::Design design = hmf::even_design(m.positions, m.triangles);
    hmf::BuildOptions options;
    options.marked_vertices = design.marked_vertices();
    const hmf::Solution solution = hmf::Hierarchy(m.positions, m.triangles, options).solve(design.loops());
    EXPECT_EQ(solution.status, HMF_OK);
    EXPECT_LT(design->unevenness, design->unevenness_before);
    const hmf::ConformalScale scale = hmf::conformal_scale(solution.foliation);
    EXPECT_NEAR(scale->unevenness, design->unevenness, 0.25 * design->unevenness);
    EXPECT_EQ(scale.log_scale().size(), m.triangle_count());
    hmf::DesignOptions plain;
    plain.no_poles = true;
    EXPECT_TRUE(hmf::even_design(m.positions, m.triangles, plain).marked_vertices().size() == 0);
}

TEST(Hpp, HarmonicForms) {
    const test::TriMesh m = test::pretzel(2, 1);
    const hmf::Hierarchy hierarchy(m.positions, m.triangles);
    const hmf::HarmonicForms forms = hmf::harmonic_forms(hierarchy);
    EXPECT_EQ(forms.form(3).size(), hierarchy.level(0).edge_count);
    for (const std::size_t size :
         {forms.intersections().size(), forms.inner_products().size(), forms.conjugation().size()})
        EXPECT_EQ(size, 16u);
    EXPECT_EQ(forms.intersections()[2], 1);
    EXPECT_NEAR(forms.conjugation()[8], forms.inner_products()[0], 1e-12);
    EXPECT_EQ(forms.period_real()[1], forms.period_real()[2]);
    EXPECT_GT(forms.period_imaginary()[3], 0);
    EXPECT_THROW(hmf::harmonic_forms(hierarchy, 99), hmf::Error);
}

TEST(Hpp, SpansOfManyContainers) {
    const test::TriMesh m = mesh();
    std::vector<std::array<double, 3>> points(m.vertex_count());
    for (size_t i = 0; i < points.size(); ++i)
        points[i] = {m.positions[3 * i], m.positions[3 * i + 1], m.positions[3 * i + 2]};
    const hmf::Hierarchy hierarchy(points, hmf::Span<uint32_t>(m.triangles.data(), m.triangles.size()));
    const hmf::LevelMesh finest = hierarchy.mesh(0);
    EXPECT_EQ(m.positions, copy(finest.positions()));
    EXPECT_EQ(m.triangles, copy(finest.triangle_vertices()));
    const uint32_t three[] = {4, 5, 6};
    EXPECT_EQ(3u, hmf::Span<uint32_t>(three).size());
    EXPECT_EQ(6u, hmf::Span<uint32_t>(three)[2]);
    EXPECT_EQ(0u, hmf::Span<double>().size());
}

TEST(Hpp, Levels) {
    const hmf::Hierarchy hierarchy = make(with_levels());
    EXPECT_EQ(2u, hierarchy.genus());
    EXPECT_GT(hierarchy.memory(), 0u);
    ASSERT_GT(hierarchy.level_count(), 2u);
    EXPECT_EQ(hierarchy.level_count() - 1, hierarchy.coarsest_level());
    for (size_t level = 0; level < hierarchy.level_count(); ++level) {
        const hmf::LevelInfo info = hierarchy.level(level);
        EXPECT_EQ(info.vertex_count + info.triangle_count + 2, info.edge_count);
        const hmf::LevelMesh mesh = hierarchy.mesh(level);
        const hmf::Span<uint32_t> ends = mesh.edge_vertices(), sides = mesh.triangle_edges();
        const hmf::Span<uint32_t> corners = mesh.triangle_vertices();
        ASSERT_EQ(2 * info.edge_count, ends.size());
        ASSERT_EQ(3 * info.triangle_count, sides.size());
        ASSERT_EQ(3 * info.triangle_count, corners.size());
        EXPECT_EQ(info.edge_count, mesh.weights().size());
        EXPECT_EQ(3 * info.vertex_count, mesh.positions().size());
        for (size_t t = 0; t < corners.size(); t += 3)
            for (size_t s = 0; s < 3; ++s) {
                const uint32_t a = corners[t + s], b = corners[t + (s + 1) % 3], *e = &ends[2 * sides[t + s]];
                EXPECT_TRUE((e[0] == a && e[1] == b) || (e[0] == b && e[1] == a));
            }
    }
    EXPECT_EQ(HMF_ERROR_LEVEL, error_of([&] { hierarchy.mesh(hierarchy.level_count()); }).status());
    EXPECT_EQ(HMF_ERROR_LEVEL, error_of([&] { hierarchy.level(hierarchy.level_count()); }).status());
}

TEST(Hpp, ReportAndSingularities) {
    const hmf::Hierarchy hierarchy = make(with_levels());
    const hmf::Solution solution = hmf::solve_cut_system(hierarchy);
    const hmf::Report& report = solution.report;
    EXPECT_EQ(HMF_METHOD_NEWTON, report.method);
    EXPECT_TRUE(report.converged);
    EXPECT_LT(report.residual_max, 1e-8);
    EXPECT_EQ(0u, report.poles);
    EXPECT_EQ(4u, report.zeros);
    EXPECT_EQ(-4, report.index_sum);
    EXPECT_EQ(hierarchy.level_count(), report.levels.size());
    EXPECT_EQ(report.history_count, report.history.size());
    EXPECT_GT(report.history.size(), 3u);

    const hmf::Singularities all = solution.foliation.singularities();
    int sum = 0;
    for (int32_t index : all.vertex_index()) sum += index;
    for (int32_t index : all.triangle_index()) sum += index;
    EXPECT_EQ(-4, sum);
    for (const hmf::Singularity& at : all.list()) sum -= at.index;
    EXPECT_EQ(0, sum);
    EXPECT_EQ(all.vertex_index().size(), all.vertex_cluster().size());
    EXPECT_EQ(all->count, all.list().size());

    double largest = 0;
    for (double r : solution.foliation.residuals()) largest = std::fmax(largest, r);
    EXPECT_LT(largest, 1e-8);
    EXPECT_NEAR(report.energy, solution.foliation.energy(), 1e-12 * report.energy);

    // A report is a copy: it needs no foliation.
    hmf::Solution other = hmf::solve_cut_system(hierarchy);
    const hmf::Report kept = std::move(other.report);
    other = solution.foliation.relax();
    EXPECT_EQ(report.energy, kept.energy);
    EXPECT_EQ(report.history.size(), kept.history.size());
}

// The small loop around a vertex makes a pole there.
TEST(Hpp, Poles) {
    const hmf::Hierarchy hierarchy = make();
    const std::vector<uint32_t> ends = copy(hierarchy.mesh(0).edge_vertices());
    std::vector<double> values(ends.size() / 2);
    for (size_t e = 0; e < values.size(); ++e)
        for (uint32_t v : {0u, 200u, 400u, 600u, 800u}) values[e] += (ends[2 * e] == v) + (ends[2 * e + 1] == v);
    const hmf::Foliation foliation = hierarchy.foliation(0, values);
    int sum = 0, poles = 0;
    const hmf::Singularities all = foliation.singularities();
    for (const hmf::Singularity& at : all.list()) sum += at.index, poles += at.index > 0;
    EXPECT_EQ(-4, sum);
    EXPECT_EQ(5, poles);
    EXPECT_GT(foliation.energy(), 0);
    EXPECT_EQ(HMF_ERROR_VALUE_POLE, error_of([&] { foliation.residuals(); }).status());
}

TEST(Hpp, LoopsUpAndDown) {
    const hmf::Hierarchy hierarchy = make(with_levels());
    hmf::Loops loops = hmf::loops(hierarchy, 1);
    ASSERT_EQ(2u, loops.size());
    EXPECT_EQ(loops.elements.size(), loops[0].size() + loops[1].size());
    loops.weights = {1, 0.5};

    const hmf::Foliation start = hierarchy.initialize(loops);
    const hmf::Solution relaxed = start.relax();
    hmf::SolveOptions options;
    options.stop_level = 1;
    const hmf::Solution solved = hierarchy.solve(loops, options);
    EXPECT_EQ(1u, solved.foliation.level());
    EXPECT_LT(solved.report.energy, start.energy());
    EXPECT_NEAR(solved.report.energy, relaxed.report.energy, 1e-9 * solved.report.energy);

    // The energy is the sum that the header defines.
    const std::vector<double> weights = copy(hierarchy.mesh(1).weights());
    double sum = 0;
    for (size_t e = 0; e < weights.size(); ++e)
        sum += weights[e] * solved.foliation.values()[e] * solved.foliation.values()[e];
    EXPECT_NEAR(sum, solved.foliation.energy(), 1e-12 * sum);

    const hmf::Foliation fine = solved.foliation.to_level(0), back = fine.to_level(1);
    EXPECT_EQ(0u, fine.level());
    EXPECT_NEAR(solved.report.energy, back.relax().report.energy, 1e-9 * sum);

    hmf::Loops own;
    own.add({0, 1});
    own.add(std::vector<uint32_t>{2, 3, 4}, 2);
    EXPECT_EQ((std::vector<uint64_t>{0, 2, 5}), own.offsets);
    EXPECT_EQ((std::vector<double>{1, 2}), own.weights);
    EXPECT_EQ(HMF_ELEMENT_LOOP, error_of([&] { hierarchy.solve(own); }).element());
    own.weights.pop_back();
    EXPECT_EQ(HMF_ERROR_COUNT, error_of([&] { hierarchy.solve(own); }).status());
    own.weights.push_back(1);
    own.elements.pop_back();
    EXPECT_EQ(HMF_ERROR_COUNT, error_of([&] { hierarchy.initialize(own); }).status());
}

TEST(Hpp, Errors) {
    test::TriMesh m = mesh();
    const std::vector<double> short_positions(m.positions.begin(), m.positions.end() - 1);
    EXPECT_EQ(HMF_ERROR_COUNT, error_of([&] { hmf::Hierarchy(short_positions, m.triangles); }).status());
    const std::vector<uint32_t> hole(m.triangles.begin(), m.triangles.end() - 3);
    const hmf::Hierarchy open(m.positions, hole);
    EXPECT_EQ(1u, open.boundary_count());
    EXPECT_EQ(HMF_ERROR_MESH_BOUNDARY, error_of([&] { hmf::loops(open, 0, HMF_LOOPS_HANDLE); }).status());
    hmf::Loops loops = hmf::loops(open, 0);
    EXPECT_EQ(loops.size(), loops.arcs.size());
    EXPECT_EQ(HMF_OK, open.solve(loops).status);
    loops.add_arc({0}, 1);
    EXPECT_NE(HMF_OK, error_of([&] { open.solve(loops); }).status());
    const std::vector<uint32_t> rest(m.triangles.begin(), m.triangles.end() - 2);
    EXPECT_EQ(HMF_ERROR_COUNT, error_of([&] { hmf::Hierarchy(m.positions, rest); }).status());
    m.positions[30] = std::nan("");
    const hmf::Error error = error_of([&] { hmf::Hierarchy(m.positions, m.triangles); });
    EXPECT_EQ(HMF_ERROR_MESH_NOT_FINITE, error.status());
    EXPECT_EQ(HMF_ELEMENT_VERTEX, error.element());
    EXPECT_EQ(10u, error.index());

    hmf::Hierarchy hierarchy = make();
    EXPECT_EQ(HMF_ERROR_COUNT, error_of([&] { hierarchy.foliation(0, std::vector<double>{1, 2, 3}); }).status());
    EXPECT_EQ(HMF_ERROR_VALUE_NOT_CLOSED, error_of([&] {
                                              std::vector<double> values(hierarchy.level(0).edge_count);
                                              values[0] = 1;
                                              hierarchy.foliation(0, values);
                                          }).status());
    const hmf::Hierarchy moved = std::move(hierarchy);
    EXPECT_EQ(2u, moved.genus());
    EXPECT_EQ(HMF_ERROR_NULL, error_of([&] {
                                  hmf::solve_cut_system(hierarchy);
                              }).status()); // NOLINT: what a moved-from object does is documented
}

TEST(Hpp, FoliationOutlivesItsHierarchy) {
    hmf::Foliation foliation = hmf::solve_cut_system(make()).foliation;
    const double energy = foliation.energy();
    hmf::Foliation moved = std::move(foliation);
    EXPECT_EQ(energy, moved.energy());
    EXPECT_EQ(HMF_ERROR_NULL, error_of([&] { foliation.energy(); }).status());    // NOLINT
    EXPECT_EQ(0u, foliation.values().size());                                     // NOLINT
    EXPECT_EQ(HMF_ERROR_NULL, error_of([&] { foliation.residuals(); }).status()); // NOLINT
    EXPECT_EQ(HMF_ERROR_NULL, error_of([&] { hmf::quads(foliation); }).status()); // NOLINT
    EXPECT_NEAR(energy, moved.to_level(0).relax().report.energy, 1e-9 * energy);
}

TEST(Hpp, LimitsGiveAResult) {
    const hmf::Hierarchy hierarchy = make(with_levels());
    hmf::SolveOptions options;
    options.time_limit = 1e-9;
    const hmf::Solution solution = hmf::solve_cut_system(hierarchy, options);
    EXPECT_EQ(HMF_LIMIT_TIME, solution.status);
    EXPECT_NE(std::string::npos, solution.message.find("time_limit"));
    EXPECT_FALSE(solution.report.converged);
    EXPECT_GT(solution.foliation.energy(), 0);
}

TEST(Hpp, Progress) {
    std::vector<double> fractions;
    const hmf::Hierarchy hierarchy = make(with_levels(), [&](double fraction) {
        fractions.push_back(fraction);
        return HMF_PROGRESS_CONTINUE;
    });
    EXPECT_EQ(1, fractions.back());

    const hmf::SolveOptions defaults;
    const auto cancel = [](double) { return HMF_PROGRESS_CANCEL; };
    EXPECT_EQ(HMF_CANCELLED, error_of([&] { hmf::solve_cut_system(hierarchy, defaults, cancel); }).status());
    EXPECT_EQ(HMF_CANCELLED, error_of([&] { hierarchy.initialize(hmf::loops(hierarchy, 0), cancel); }).status());
    int calls = 0;
    const hmf::Solution solution = hmf::solve_cut_system(
        hierarchy, defaults, [&](double) { return ++calls > 20 ? HMF_PROGRESS_FINISH : HMF_PROGRESS_CONTINUE; });
    EXPECT_EQ(HMF_CANCELLED, solution.status);
    EXPECT_NE("", solution.message);
    EXPECT_EQ(0u, solution.report.poles);
}

struct Unusual {
    int number;
};

TEST(Hpp, ExceptionsOfTheProgressFunctionPass) {
    int calls = 0;
    const hmf::ProgressFunction thrower = [&](double) -> hmf_progress {
        if (++calls == 3) throw Unusual{42};
        return HMF_PROGRESS_CONTINUE;
    };
    const auto number_of = [&](auto&& call) {
        calls = 0;
        try {
            call();
        } catch (const Unusual& unusual) {
            EXPECT_EQ(3, calls); // not asked again
            return unusual.number;
        }
        return 0;
    };
    EXPECT_EQ(42, number_of([&] { make(with_levels(), thrower); }));
    const hmf::Hierarchy hierarchy = make(with_levels());
    EXPECT_EQ(42, number_of([&] { hmf::solve_cut_system(hierarchy, {}, thrower); }));
    const hmf::Foliation start = hierarchy.initialize(hmf::loops(hierarchy, 0));
    EXPECT_EQ(42, number_of([&] { start.relax({}, thrower); }));
    EXPECT_EQ(HMF_OK, hmf::solve_cut_system(hierarchy).status);
}

TEST(Hpp, Parameterization) {
    const hmf::Hierarchy hierarchy = make();
    const hmf::Foliation foliation = hmf::solve_cut_system(hierarchy).foliation;
    const hmf::Parameterization map = hmf::parameterize(foliation);
    int sum = 0;
    for (int32_t cone : map.cone()) sum += 2 - cone;
    EXPECT_EQ(-4, sum);
    uint64_t seams = 0;
    for (uint8_t seam : map.seam()) seams += seam;
    EXPECT_EQ(map->seam_edge_count, seams);
    EXPECT_GE(map->dilatation_mean, 1);
    EXPECT_NEAR(foliation.energy(), map->area, 0.1 * map->area);

    // Both triangles of an edge agree through its transition, exactly.
    const hmf::LevelMesh finest = hierarchy.mesh(0);
    const hmf::Span<uint32_t> sides = finest.triangle_edges(), corners = finest.triangle_vertices();
    std::vector<int> seen(map.seam().size(), -1); // side of the first triangle
    for (size_t h = 0; h < sides.size(); ++h) {
        int& first = seen[sides[h]];
        if (first < 0) {
            first = static_cast<int>(h);
            continue;
        }
        const double* t = &map.transition()[3 * sides[h]];
        const size_t f = static_cast<size_t>(first), next_h = h - h % 3 + (h % 3 + 1) % 3,
                     next_f = f - f % 3 + (f % 3 + 1) % 3;
        ASSERT_EQ(corners[h], corners[next_f]);
        for (size_t k = 0; k < 2; ++k) {
            EXPECT_EQ(map.corner_uv()[2 * h + k], t[0] * map.corner_uv()[2 * next_f + k] + t[1 + k]);
            EXPECT_EQ(map.corner_uv()[2 * next_h + k], t[0] * map.corner_uv()[2 * f + k] + t[1 + k]);
        }
    }

    hmf::ParameterizeOptions options;
    options.seam_edges = {UINT32_MAX};
    EXPECT_EQ(HMF_ELEMENT_EDGE, error_of([&] { hmf::parameterize(foliation, options); }).element());
    EXPECT_THROW(hmf::parameterize(foliation, {}, [](double) -> hmf_progress { throw Unusual{1}; }), Unusual);
    EXPECT_EQ(HMF_ERROR_VALUE_NOT_HARMONIC,
              error_of([&] { hmf::parameterize(hierarchy.initialize(hmf::loops(hierarchy, 0))); }).status());
}

TEST(Hpp, Leaves) {
    const hmf::Hierarchy hierarchy = make();
    const hmf::Foliation foliation = hierarchy.solve(hmf::loops(hierarchy, 0, HMF_LOOPS_TUNNEL)).foliation;
    const hmf::Leaves critical = hmf::trace(foliation);
    ASSERT_GT(critical.lines().size(), 0u);
    for (const hmf::Line& line : critical.lines()) EXPECT_EQ(HMF_LINE_CRITICAL, line.kind);

    hmf::TraceOptions options;
    options.spacing = 0.25;
    options.point_triangles = {7, 8};
    options.point_barycentrics = {0.5, 0.25, 0.25, 0.25, 0.5, 0.25};
    const hmf::Leaves leaves = hmf::trace(foliation, options);
    ASSERT_EQ(leaves.lines().size() + 1, leaves.offsets().size());
    EXPECT_EQ(leaves->point_count * 3, leaves.points().size());
    EXPECT_EQ(leaves->point_count, leaves.point_edges().size());
    // Closed leaves: the length is that of the polyline.
    size_t levels = 0;
    for (size_t k = 0; k < leaves.lines().size(); ++k) {
        if (leaves.lines()[k].kind != HMF_LINE_LEVEL) continue;
        ++levels;
        ASSERT_EQ(1, leaves.lines()[k].closed);
        double length = 0;
        const uint64_t begin = leaves.offsets()[k], end = leaves.offsets()[k + 1];
        for (uint64_t i = begin; i < end; ++i) {
            const double *p = &leaves.points()[3 * i], *q = &leaves.points()[3 * (i + 1 < end ? i + 1 : begin)];
            length += std::sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1])
                                + (p[2] - q[2]) * (p[2] - q[2]));
        }
        EXPECT_NEAR(length, leaves.lines()[k].length, 1e-9 * length);
    }
    EXPECT_EQ(leaves.lines().size(), levels + 2);
    EXPECT_EQ(1u, leaves.lines()[levels + 1].source);
    options.leaves = HMF_LEAVES_CONJUGATE;
    const hmf::Leaves across = hmf::trace(foliation, options);
    for (const hmf::Line& line : across.lines())
        if (line.kind == HMF_LINE_LEVEL) { EXPECT_EQ(HMF_END_CRITICAL, line.end); }
    options.point_barycentrics.pop_back();
    EXPECT_EQ(HMF_ERROR_COUNT, error_of([&] { hmf::trace(foliation, options); }).status());
}

TEST(Hpp, Cylinders) {
    const hmf::Hierarchy hierarchy = make();
    hmf::Loops loops = hmf::loops(hierarchy, 0, HMF_LOOPS_TUNNEL);
    loops.weights = {1, 0.5};
    const hmf::Solution solution = hierarchy.solve(loops);
    const hmf::Cylinders cylinders = hmf::cylinders(solution.foliation, loops);
    ASSERT_EQ(2u, cylinders.list().size());
    ASSERT_EQ(2u, cylinders.twists().size());
    ASSERT_EQ(cylinders.corner_vertices().size(), cylinders.corner_offsets()[4]);
    EXPECT_EQ(cylinders.twists()[1], cylinders.corner_places()[cylinders.corner_offsets()[3]]);
    double area = 0;
    for (const hmf::Cylinder& cylinder : cylinders.list()) {
        ASSERT_LT(cylinder.loop, 2u);
        EXPECT_EQ(loops.weights[cylinder.loop], cylinder.height);
        area += cylinder.area;
    }
    EXPECT_NEAR(solution.report.energy, area, 1e-6 * area);
    // The middle leaves, with the heights as weights, give the same foliation.
    EXPECT_NEAR(solution.report.energy, hierarchy.solve(cylinders.leaves()).report.energy, 1e-9 * area);
    EXPECT_EQ(HMF_NONE, hmf::cylinders(solution.foliation).list()[0].loop);
    const hmf::Loops others = hmf::loops(hierarchy, 0, HMF_LOOPS_HANDLE);
    EXPECT_EQ(HMF_ERROR_VALUE_CLASS, error_of([&] { hmf::cylinders(solution.foliation, others); }).status());
}

TEST(Hpp, Atlas) {
    const hmf::Hierarchy hierarchy = make();
    const hmf::Foliation foliation = hmf::solve_cut_system(hierarchy).foliation;
    const hmf::Atlas atlas = hmf::atlas(foliation, 0.01);
    ASSERT_EQ(6 * atlas.triangle_chart().size(), atlas.corner_uv().size());
    for (const double x : atlas.corner_uv()) EXPECT_TRUE(x >= 0 && x <= 1) << x;
    for (const uint32_t c : atlas.triangle_chart()) EXPECT_LT(c, atlas->chart_count);
    EXPECT_EQ(HMF_ERROR_OPTIONS, error_of([&] { hmf::atlas(foliation, -1); }).status());
}

TEST(Hpp, Quads) {
    const hmf::Hierarchy hierarchy = make();
    const hmf::Foliation foliation = hmf::solve_cut_system(hierarchy).foliation;
    const hmf::QuadMesh mesh = hmf::quads(foliation);
    // Every edge has two quads, so that vertices - edges + quads = 2 - 2 genus.
    ASSERT_EQ(0u, mesh.positions().size() % 3);
    EXPECT_EQ(mesh.quads().size() / 4, mesh.positions().size() / 3 + 2);
    std::vector<int> degree(mesh.positions().size() / 3);
    for (uint32_t v : mesh.quads()) ++degree[v];
    const hmf::Singularities set = foliation.singularities();
    const hmf::Span<hmf::Singularity> zeros = set.list();
    for (size_t v = 0; v < degree.size(); ++v) EXPECT_EQ(v < zeros.size() ? 4 - 2 * zeros[v].index : 4, degree[v]);
    EXPECT_EQ(HMF_ERROR_OPTIONS, error_of([&] { hmf::quads(foliation, -1); }).status());
}

TEST(Hpp, StartsFromAFoliation) {
    const hmf::Hierarchy hierarchy = make(with_levels());
    const hmf::Solution first = hmf::solve_cut_system(hierarchy);
    const hmf::Foliation read = hierarchy.foliation(0, first.foliation.values());
    EXPECT_EQ(copy(first.foliation.values()), copy(read.values()));
    hmf::SolveOptions options;
    options.start = read.get();
    EXPECT_NEAR(first.report.energy, hierarchy.solve(options).report.energy, 1e-9 * first.report.energy);
    EXPECT_EQ(HMF_ERROR_OPTIONS, error_of([&] { hierarchy.solve(hmf::loops(hierarchy, 0), options); }).status());
}

TEST(Hpp, MollifyAcceptsTrianglesWithoutArea) {
    test::TriMesh m = mesh();
    for (size_t k = 0; k < 3; ++k) m.positions[3 * m.triangles[1] + k] = m.positions[3 * m.triangles[0] + k];
    EXPECT_EQ(HMF_ERROR_MESH_DEGENERATE, error_of([&] { hmf::Hierarchy(m.positions, m.triangles); }).status());
    hmf::BuildOptions options;
    options.mollify = 1e-5;
    EXPECT_EQ(2u, hmf::Hierarchy(m.positions, m.triangles, options).genus());
}

std::atomic<int64_t> live{0};

TEST(Hpp, AllocatorOfTheCallerGetsEverythingBack) {
    hmf::BuildOptions options = with_levels();
    options.allocate = [](void*, size_t size) {
        live += static_cast<int64_t>(size);
        return std::malloc(size);
    };
    options.release = [](void*, void* block, size_t size) {
        live -= static_cast<int64_t>(size);
        std::free(block);
    };
    EXPECT_GT(hmf::Hierarchy::memory_estimate(mesh().vertex_count(), mesh().triangle_count(), options), 0u);
    {
        const hmf::Hierarchy hierarchy = make(options);
        EXPECT_EQ(static_cast<int64_t>(hierarchy.memory()), live);
        hmf::solve_cut_system(hierarchy).foliation.to_level(1);
        EXPECT_EQ(static_cast<int64_t>(hierarchy.memory()), live);
        EXPECT_THROW(make(options, [](double) -> hmf_progress { throw Unusual{1}; }), Unusual);
        EXPECT_EQ(static_cast<int64_t>(hierarchy.memory()), live);
    }
    EXPECT_EQ(0, live);
}

TEST(Hpp, ThreadsShareAHierarchy) {
    const hmf::Hierarchy hierarchy = make(with_levels());
    const std::vector<double> expected = copy(hmf::solve_cut_system(hierarchy).foliation.values());
    std::vector<std::thread> threads;
    std::atomic<int> same{0};
    for (int i = 0; i < 3; ++i)
        threads.emplace_back([&] { same += copy(hmf::solve_cut_system(hierarchy).foliation.values()) == expected; });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(3, same);
}

// --- Several components ---------------------------------------------------------

// A torus, a sphere and another torus.
test::TriMesh three_parts() {
    test::TriMesh all = test::torus(12, 9, 3, 1);
    test::TriMesh sphere;
    sphere.positions = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    sphere.triangles = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    for (const test::TriMesh& part : {sphere, test::torus(10, 8, 3, 1)}) {
        const uint32_t first = static_cast<uint32_t>(all.vertex_count());
        all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
        for (const uint32_t v : part.triangles) all.triangles.push_back(first + v);
    }
    return all;
}

TEST(Hpp, ComponentsAreSolvedInOneCall) {
    const test::TriMesh all = three_parts(), last = test::torus(10, 8, 3, 1);
    const hmf::Components components(all.positions, all.triangles);
    ASSERT_EQ(components.size(), 3u);
    EXPECT_EQ(copy(components.triangles(2)), last.triangles);
    double reached = 0;
    const hmf::ComponentSolutions whole = components.solve({}, {}, [&](double fraction) {
        EXPECT_GE(fraction, reached);
        reached = fraction;
        return HMF_PROGRESS_CONTINUE;
    });
    EXPECT_NEAR(reached, 1, 1e-12);
    ASSERT_EQ(whole.components.size(), 3u);
    EXPECT_EQ(whole.components[0].status, HMF_OK);
    EXPECT_EQ(whole.components[1].status, HMF_ERROR_MESH_GENUS);
    EXPECT_FALSE(whole.components[1].solution);
    EXPECT_FALSE(whole.components[1].message.empty());
    for (const uint32_t e : components.whole_edges(1)) EXPECT_EQ(whole.values[e], 0);
    const std::vector<double> own =
        copy(hmf::solve_cut_system(hmf::Hierarchy(last.positions, last.triangles)).foliation.values());
    for (std::size_t e = 0; e < own.size(); ++e) EXPECT_EQ(whole.values[components.whole_edges(2)[e]], own[e]);
    // A sphere with marked vertices.
    hmf::BuildOptions options;
    const std::vector<uint32_t> marks = hmf::suggest_marks(all.positions, all.triangles);
    options.marked_vertices = marks;
    const hmf::Components marked(all.positions, all.triangles, options);
    EXPECT_EQ(marked.marked_vertices(1).size(), 4u);
    EXPECT_EQ(marked.solve().components[1].status, HMF_OK);
}

TEST(Hpp, LoopsGoToTheirComponents) {
    const test::TriMesh all = three_parts();
    const hmf::Components components(all.positions, all.triangles);
    hmf::Loops loops;
    std::vector<uint32_t> round;
    for (uint32_t j = 0; j < 8; ++j) round.push_back(12 * 9 + 6 + j);
    loops.add(round, 2);
    const std::vector<hmf::Loops> parts = components.split(loops);
    EXPECT_EQ(parts[0].size(), 0u);
    EXPECT_EQ(copy(parts[2][0]), (std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6, 7}));
    const hmf::ComponentSolutions whole = components.solve(loops);
    EXPECT_EQ(whole.components[0].status, HMF_ERROR_LOOP_COUNT);
    EXPECT_EQ(whole.components[2].status, HMF_OK);
    const test::TriMesh last = test::torus(10, 8, 3, 1);
    hmf::Loops own;
    own.add({0, 1, 2, 3, 4, 5, 6, 7}, 2);
    EXPECT_EQ(copy(whole.components[2].solution->foliation.values()),
              copy(hmf::Hierarchy(last.positions, last.triangles).solve(own).foliation.values()));
    loops.add({0, 12 * 9});
    EXPECT_EQ(error_of([&] { components.split(loops); }).status(), HMF_ERROR_LOOP_NOT_CLOSED);
    loops = hmf::Loops();
    loops.add({12 * 9 + 6 + 80});
    EXPECT_EQ(error_of([&] { components.split(loops); }).status(), HMF_ERROR_LOOP_INDEX);
}

} // namespace

} // namespace test_hpp
