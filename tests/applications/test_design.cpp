// Unevenness and the even design: exact scales, derivatives against
// differences, and designs that are solved on the whole mesh.
#include "src/applications/design/marked_trial.hpp"
#include "support/read_obj.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace test_design {

using namespace test;

namespace {

std::vector<double> scale_of(const Foliation& foliation, size_t triangles, double* unevenness) {
    const auto scale = make<hmf_scale>(
        [&](hmf_scale** out, hmf_error* error) { return hmf_conformal_scale(foliation.get(), nullptr, out, error); });
    EXPECT_EQ(scale->triangle_count, triangles);
    if (unevenness) *unevenness = scale->unevenness;
    return {scale->log_scale, scale->log_scale + triangles};
}

double area_of(const TriMesh& mesh, size_t triangle) {
    const double* p[3];
    for (size_t c = 0; c < 3; ++c) p[c] = &mesh.positions[3 * mesh.triangles[3 * triangle + c]];
    double square = 0;
    for (size_t c = 0; c < 3; ++c) {
        const size_t x = (c + 1) % 3, y = (c + 2) % 3;
        const double cross = (p[1][x] - p[0][x]) * (p[2][y] - p[0][y]) - (p[1][y] - p[0][y]) * (p[2][x] - p[0][x]);
        square += cross * cross;
    }
    return std::sqrt(square) / 2;
}

// A regular tetrahedron: with its corners, 0 to 3, marked it is flat.
TriMesh tetrahedron(size_t refinements) {
    TriMesh mesh;
    mesh.positions = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1};
    mesh.triangles = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
    for (size_t r = 0; r < refinements; ++r) mesh = subdivide(mesh);
    return mesh;
}

hmf_hierarchy_options with_marks(const uint32_t* marks, size_t count) {
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    options.marked_vertices = marks;
    options.marked_count = count;
    return options;
}

Owned<hmf_design> design(const TriMesh& mesh, const hmf_design_options* options = nullptr) {
    return make<hmf_design>([&](hmf_design** out, hmf_error* error) {
        return hmf_even_design(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                               options, nullptr, out, error);
    });
}

hmf_design_options design_options(uint64_t solves, int32_t no_poles, const hmf_hierarchy_options* build) {
    hmf_design_options options{};
    options.struct_size = sizeof options;
    options.solve_limit = solves;
    options.no_poles = no_poles;
    options.build = build;
    return options;
}

// The design as it is solved on the whole mesh.
Solution solve_design(const TriMesh& mesh, const hmf_design& design) {
    const Hierarchy hierarchy(mesh, with_marks(design.marked_vertices, design.marked_count));
    Solution solution;
    hmf_foliation* out = nullptr;
    solution.status = hmf_solve(hierarchy.get(), design.loops, nullptr, nullptr, &out, &solution.error);
    solution.foliation.reset(out);
    if (out) solution.report = *hmf_foliation_report(out);
    return solution;
}

std::vector<uint32_t> marks_of(const hmf_design& design) {
    return std::vector<uint32_t>(design.marked_vertices, design.marked_vertices + design.marked_count);
}

// A surface of genus 2 without marked vertices, for trials of the search.
class Trials : public testing::Test {
protected:
    Trials() {
        EXPECT_TRUE(mesh.position.allocate(like.memory, pretzel_.positions.size()));
        EXPECT_TRUE(mesh.triangles.allocate(like.memory, pretzel_.triangles.size()));
        std::copy(pretzel_.positions.begin(), pretzel_.positions.end(), mesh.position.begin());
        std::copy(pretzel_.triangles.begin(), pretzel_.triangles.end(), mesh.triangles.begin());
        marks.start(like.memory);
    }

private:
    const TriMesh pretzel_ = pretzel(2, 3);

protected:
    hmf_hierarchy like{nullptr, nullptr, nullptr, 0};
    hmf_error error{};
    hmf::Call call{like.memory, &error, nullptr, nullptr};
    hmf::TrialMesh mesh;
    hmf::Array<uint32_t> marks;
    const double fraction = 0;
};

} // namespace

TEST(Scale, NaturalLogarithm) {
    for (double x = 1e-300; x < 1e300; x *= 1.37)
        EXPECT_NEAR(hmf::natural_log(x), std::log(x), 4e-15 * std::max(1.0, std::fabs(std::log(x)))) << x;
    EXPECT_EQ(hmf::natural_log(1), 0);
}

// On a flat surface the scale is the same everywhere: the root of energy / area.
TEST(Scale, FlatPillow) {
    const TriMesh mesh = tetrahedron(4);
    const uint32_t marks[4] = {0, 1, 2, 3};
    const Hierarchy hierarchy(mesh, with_marks(marks, 4));
    const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
    ASSERT_EQ(solution.status, HMF_OK);
    double unevenness = -1, area = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) area += area_of(mesh, t);
    const double expected = 0.5 * std::log(solution.report.energy / area);
    for (const double s : scale_of(solution.foliation, mesh.triangle_count(), &unevenness))
        EXPECT_NEAR(s, expected, 1e-7);
    EXPECT_LT(unevenness, 1e-8);
}

// A triangle that is flat up to rounding has no area to speak of and any density: the unevenness is that of the same
// torus with an exactly flat one.
TEST(Scale, FlatTrianglesMeasureNothing) {
    hmf_hierarchy_options build{};
    build.struct_size = sizeof build;
    build.mollify = 0.005;
    for (const size_t t : {3u, 100u, 211u}) {
        double unevenness[2] = {-1, -2};
        for (const size_t k : {0, 1}) {
            TriMesh mesh = torus(24, 12, 2, 1, {true, 1, 0.2, 3});
            flatten(mesh, t, k == 1);
            const Hierarchy hierarchy(mesh, build);
            const Solution solution = solve(hierarchy, nullptr, solve_options(0, 0));
            ASSERT_TRUE(solution.foliation);
            scale_of(solution.foliation, mesh.triangle_count(), &unevenness[k]);
        }
        EXPECT_GT(unevenness[0], 0.1);
        EXPECT_NEAR(unevenness[1], unevenness[0], 1e-6) << t;
    }
}

// The energy is the integral of the squared scale, and the unevenness the
// deviation of what is given.
TEST(Scale, EnergyAndDeviation) {
    const TriMesh mesh = torus(60, 24, 3, 1);
    const Hierarchy hierarchy(mesh);
    const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
    double unevenness = -1, integral = 0, whole = 0, mean = 0, square = 0;
    const std::vector<double> scale = scale_of(solution.foliation, mesh.triangle_count(), &unevenness);
    for (size_t t = 0; t < scale.size(); ++t) {
        const double area = area_of(mesh, t);
        whole += area;
        integral += area * std::exp(2 * scale[t]);
        mean += area * scale[t];
    }
    mean /= whole;
    for (size_t t = 0; t < scale.size(); ++t)
        square += area_of(mesh, t) * (scale[t] - mean) * (scale[t] - mean) / whole;
    EXPECT_NEAR(integral, solution.report.energy, 1e-8 * integral); // weights of 0 are raised
    EXPECT_NEAR(unevenness, std::sqrt(square), 1e-10);
    EXPECT_GT(unevenness, 0.05);
    hmf_error error{};
    EXPECT_EQ(hmf_conformal_scale(solution.foliation.get(), nullptr, nullptr, &error), HMF_ERROR_NULL);
}

// A trial finds its loops once: it hands them out, and takes those that are given.
TEST_F(Trials, ShareLoops) {
    hmf::Loops found, two;
    double unevenness = 0;
    {
        hmf::MarkedTrial first(like, call, fraction);
        ASSERT_EQ(first.start(mesh, marks, HMF_LOOPS_PANTS, found), HMF_OK);
        ASSERT_EQ(first.solve(), HMF_OK);
        unevenness = first.unevenness();
    }
    ASSERT_EQ(found.count(), 3u);
    hmf::MarkedTrial again(like, call, fraction);
    ASSERT_EQ(again.start(mesh, marks, HMF_LOOPS_PANTS, found), HMF_OK);
    ASSERT_EQ(again.solve(), HMF_OK);
    EXPECT_EQ(again.unevenness(), unevenness);
    ASSERT_TRUE(two.copy_from(found, like.memory));
    two.keep_first(2);
    hmf::MarkedTrial fewer(like, call, fraction);
    ASSERT_EQ(fewer.start(mesh, marks, HMF_LOOPS_PANTS, two), HMF_OK);
    EXPECT_EQ(fewer.weights.size(), 2u);
}

// Derivatives by the logarithms of the weights: together they are 1, as the
// scale grows with all weights; each as differences say.
TEST_F(Trials, DerivativesByWeights) {
    hmf::MarkedTrial trial(like, call, fraction);
    hmf::Loops loops;
    ASSERT_EQ(trial.start(mesh, marks, HMF_LOOPS_PANTS, loops), HMF_OK);
    ASSERT_TRUE(trial.usable());
    ASSERT_EQ(trial.weights.size(), 3u);
    for (double& w : trial.weights) w = 1;
    ASSERT_EQ(trial.solve(), HMF_OK);
    bool known = false;
    ASSERT_EQ(trial.derive(known), HMF_OK);
    ASSERT_TRUE(known);
    const size_t faces = trial.scale().area.size();
    double off = 0, covered = 0;
    std::vector<std::vector<double>> derivative(3, std::vector<double>(faces));
    std::vector<char> has(faces);
    for (size_t t = 0; t < faces; ++t) {
        has[t] = trial.has_derivative(t);
        double sum = 0;
        for (size_t c = 0; c < 3; ++c) sum += derivative[c][t] = trial.derivative(c, t);
        if (!has[t]) continue;
        off += trial.scale().area[t] * std::fabs(sum - 1);
        covered += trial.scale().area[t];
    }
    EXPECT_GT(covered, 0.9);
    EXPECT_LT(off, 0.04);
    for (size_t c = 0; c < 3; ++c) {
        std::vector<double> at[2];
        const double step = 0.02;
        for (int side = 0; side < 2; ++side) {
            trial.weights[c] = std::exp(side ? step : -step);
            ASSERT_EQ(trial.solve(), HMF_OK);
            at[side].assign(trial.scale().log_scale.begin(), trial.scale().log_scale.end());
            for (double& x : at[side]) x += side ? step : 0; // it is that of the largest weight 1
        }
        trial.weights[c] = 1;
        double difference = 0, size = 0;
        for (size_t t = 0; t < faces; ++t) {
            if (!has[t]) continue;
            difference +=
                trial.scale().area[t] * std::fabs((at[1][t] - at[0][t]) / (2 * step) - derivative[c][t]) / covered;
            size += trial.scale().area[t] * std::fabs(derivative[c][t]) / covered;
        }
        EXPECT_GT(size, 0.1);
        EXPECT_LT(difference, 0.15 * size) << c;
    }
}

// A finger that no loop goes around: without a pole its scale decays.
TEST(EvenDesign, ALimbGetsPoles) {
    const TriMesh mesh = torus_with_finger(40, 20, 30, 4);
    const auto made = design(mesh);
    ASSERT_TRUE(made);
    EXPECT_GE(made->marked_count, 1u);
    EXPECT_LT(made->unevenness, 0.5 * made->unevenness_before);
    const Solution solution = solve_design(mesh, *made);
    ASSERT_EQ(solution.status, HMF_OK) << solution.error.message;
    double unevenness = -1;
    scale_of(solution.foliation, mesh.triangle_count(), &unevenness);
    EXPECT_NEAR(unevenness, made->unevenness, 0.25 * made->unevenness);
    for (uint64_t c = 0; c < made->loops->count; ++c) {
        EXPECT_EQ(made->loops->weights[c], std::floor(made->loops->weights[c]));
        EXPECT_GE(made->loops->weights[c], 1);
    }
    // No poles: the weights alone.
    const hmf_design_options none = design_options(0, 1, nullptr);
    const auto plain = design(mesh, &none);
    ASSERT_TRUE(plain);
    EXPECT_EQ(plain->marked_count, 0u);
    EXPECT_GT(plain->unevenness, made->unevenness);
    // Twice the same, and in other units.
    TriMesh large = mesh;
    for (double& x : large.positions) x *= 1024;
    for (const TriMesh* other : {static_cast<const TriMesh*>(&mesh), static_cast<const TriMesh*>(&large)}) {
        const auto again = design(*other);
        ASSERT_TRUE(again);
        EXPECT_EQ(marks_of(*again), marks_of(*made));
        ASSERT_EQ(again->loops->count, made->loops->count);
        EXPECT_TRUE(
            std::equal(made->loops->offsets, made->loops->offsets + made->loops->count + 1, again->loops->offsets));
        EXPECT_TRUE(std::equal(made->loops->elements, made->loops->elements + made->loops->offsets[made->loops->count],
                               again->loops->elements));
        EXPECT_TRUE(std::equal(made->loops->weights, made->loops->weights + made->loops->count, again->loops->weights));
        EXPECT_EQ(again->unevenness, made->unevenness);
    }
}

// A cow: poles at all of its new tips at once gain nothing, at half of them a lot. One after the other gets .39.
TEST(EvenDesign, HalfOfTheTips) {
    const char* const folder = std::getenv("HMF_SURFACES");
    if (!folder) GTEST_SKIP() << "skipped: set HMF_SURFACES to a folder with spot_5.9k.obj";
    TriMesh mesh;
    ASSERT_TRUE(read_obj(folder + std::string("/spot_5.9k.obj"), mesh));
    const auto made = design(mesh);
    ASSERT_TRUE(made);
    EXPECT_LT(made->unevenness, 0.38);
}

// It is uneven still when the work is done: the search begins again with shallower tips, if no limit is given.
TEST(EvenDesign, OnceMoreWithShallowerTips) {
    const char* const folder = std::getenv("HMF_SURFACES");
    if (!folder) GTEST_SKIP() << "skipped: set HMF_SURFACES to a folder with spot_5.9k.obj";
    TriMesh mesh;
    ASSERT_TRUE(read_obj(folder + std::string("/spot_5.9k.obj"), mesh));
    const hmf_design_options options = design_options(120, 0, nullptr); // by default as well, for so few edges
    const auto once = design(mesh, &options), twice = design(mesh);
    ASSERT_TRUE(once && twice);
    EXPECT_GT(once->unevenness, 0.28);
    EXPECT_GT(twice->solves, once->solves + 20);
    EXPECT_LT(twice->unevenness, once->unevenness - 0.01);
}

// Weights alone, where the scale of equal weights is uneven.
TEST(EvenDesign, HandlesNeedNoPoles) {
    const TriMesh mesh = pretzel(3, 3);
    const hmf_design_options options = design_options(0, 1, nullptr);
    const auto made = design(mesh, &options);
    ASSERT_TRUE(made);
    EXPECT_LE(made->loops->count, 6u);
    EXPECT_LT(made->unevenness, made->unevenness_before);
    EXPECT_EQ(solve_design(mesh, *made).report.class_state, HMF_CLASS_PROVEN);
}

// A small torus behind a large one: with equal weights the scale is as uneven as their sizes, with the weights of
// the search it is not.  With a hole the search is another one.
TEST(EvenDesign, WeightsFollowTheSizeOfHandles) {
    TriMesh mesh = joined_tori(40, 20, 9, 8);
    for (size_t v = 0; v < mesh.vertex_count(); ++v) { // about a similarity at each place, by 1 to 1/6
        double* x = &mesh.positions[3 * v];
        const double size = std::exp(-0.2 * x[0]);
        x[0] = -5 * size;
        x[1] *= size;
        x[2] *= size;
    }
    for (const bool hole : {false, true}) {
        SCOPED_TRACE(hole);
        if (hole) mesh.triangles.resize(mesh.triangles.size() - 3);
        const hmf_design_options options = design_options(0, 1, nullptr);
        const auto made = design(mesh, &options);
        ASSERT_TRUE(made);
        EXPECT_LT(made->unevenness, 0.9 * made->unevenness_before);
        const double* w = made->loops->weights;
        ASSERT_GE(made->loops->count, 2u);
        EXPECT_GT(*std::min_element(w, w + made->loops->count), 0);
        EXPECT_GT(*std::max_element(w, w + made->loops->count), 1.5 * *std::min_element(w, w + made->loops->count));
    }
}

TEST(EvenDesign, MarkedVerticesStay) {
    const TriMesh mesh = torus_with_finger(40, 20, 30, 4);
    const uint32_t marks[3] = {5, 77, 400};
    const hmf_hierarchy_options build = with_marks(marks, 3);
    const hmf_design_options options = design_options(0, 0, &build);
    const auto made = design(mesh, &options);
    ASSERT_TRUE(made);
    const std::vector<uint32_t> all = marks_of(*made);
    for (const uint32_t m : marks) EXPECT_EQ(std::count(all.begin(), all.end(), m), 1);
    EXPECT_EQ(solve_design(mesh, *made).status, HMF_OK);
}

// Small meshes and flat ones: always something that can be solved.
TEST(EvenDesign, SmallSpheres) {
    for (size_t refinements = 0; refinements < 5; ++refinements) {
        const TriMesh mesh = tetrahedron(refinements);
        const auto made = design(mesh);
        ASSERT_TRUE(made) << refinements;
        EXPECT_GE(made->marked_count, 4u);
        const Solution solution = solve_design(mesh, *made);
        EXPECT_EQ(solution.status, HMF_OK) << solution.error.message;
    }
    const auto box = design(subdivide(plate(0)));
    ASSERT_TRUE(box);
    EXPECT_GE(box->marked_count, 4u);
}

// A flat L with jags as long as an edge: one pole at each convex corner, none at the other one.
TEST(EvenDesign, ConvexCornersOfTheBoundary) {
    const uint32_t n = 24;
    TriMesh mesh;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> number;
    const auto vertex = [&](uint32_t i, uint32_t j) {
        const auto made = number.insert({{i, j}, static_cast<uint32_t>(number.size())});
        const bool jag = j == 0 && i % 4 == 2;
        if (made.second) mesh.positions.insert(mesh.positions.end(), {1.0 * i, jag ? -0.9 : j, 0.0});
        return made.first->second;
    };
    for (uint32_t i = 0; i < n; ++i)
        for (uint32_t j = 0; j < (i < n / 3 ? n : n / 3); ++j) {
            const uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
            mesh.triangles.insert(mesh.triangles.end(), {a, b, c, a, c, d});
        }
    const auto made = design(mesh);
    ASSERT_TRUE(made);
    const std::vector<uint32_t> marks = marks_of(*made);
    const std::set<uint32_t> corners = {vertex(0, 0), vertex(n, 0), vertex(n, n / 3), vertex(n / 3, n), vertex(0, n)};
    EXPECT_EQ(std::set<uint32_t>(marks.begin(), marks.end()), corners);
    EXPECT_EQ(solve_design(mesh, *made).status, HMF_OK);
}

// Without other poles a design is one for a hierarchy that exists, on spheres as well.
TEST(EvenDesign, SpheresWithGivenMarks) {
    for (const TriMesh& mesh : {tetrahedron(1), tetrahedron(4), subdivide(subdivide(plate(0)))})
        for (const bool more : {false, true}) {
            std::vector<uint32_t> marks = suggested_marks(mesh);
            for (uint32_t v = 0; more && marks.size() < 6; ++v)
                if (std::count(marks.begin(), marks.end(), v) == 0) marks.push_back(v);
            const hmf_hierarchy_options build = with_marks(marks.data(), marks.size());
            const hmf_design_options options = design_options(0, 1, &build);
            const auto made = design(mesh, &options);
            ASSERT_TRUE(made);
            std::vector<uint32_t> found = marks_of(*made);
            std::sort(found.begin(), found.end());
            std::sort(marks.begin(), marks.end());
            EXPECT_EQ(found, marks);
            EXPECT_EQ(solve_design(mesh, *made).status, HMF_OK);
        }
}

} // namespace test_design
