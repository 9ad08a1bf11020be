// Results of the solver against oracles that do not depend on how it works:
// exact integers, uniqueness of the minimum, the harmonic 1-form on a torus,
// scaling, flux, lengths of closed paths.
#include "support/sample.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>

namespace test_solve {

using namespace test;

namespace {

constexpr double tight = 1e-12;
constexpr uint64_t many = 200000;

hmf_solve_options whitehead(double tolerance = tight) { return solve_options(HMF_METHOD_WHITEHEAD, tolerance, many); }
hmf_solve_options single_level(double tolerance = tight) {
    return solve_options(HMF_METHOD_SINGLE_LEVEL, tolerance, many);
}
hmf_solve_options newton() { return solve_options(HMF_METHOD_NEWTON, 1e-9); }

// The report says what the queries say: both of the foliation where it is solved.
void expect_report(const Hierarchy& hierarchy, const Solution& solution, const LevelMesh& mesh) {
    const long genus = static_cast<long>(hmf_hierarchy_describe(hierarchy.get())->genus);
    const hmf_report& report = solution.report;
    if (report.method == HMF_METHOD_NEWTON) EXPECT_EQ(report.converged, solution.status == HMF_OK);
    else EXPECT_EQ(report.converged, report.residual_max <= 1e-8);
    EXPECT_EQ(report.poles, 0u);
    EXPECT_EQ(static_cast<long>(report.zeros), 4 * genus - 4);
    EXPECT_EQ(report.index_sum, 4 - 4 * genus);
    EXPECT_EQ(report.bad_flips_left, 0u);
    EXPECT_NEAR(report.energy, energy(solution.foliation), 1e-12 * report.energy);
    const std::vector<double> residual = residuals(solution.foliation, mesh.vertex_count);
    EXPECT_NEAR(report.residual_max, *std::max_element(residual.begin(), residual.end()), 1e-12);
    EXPECT_NEAR(report.residual_mean,
                std::accumulate(residual.begin(), residual.end(), 0.0) / static_cast<double>(residual.size()), 1e-12);
}

// All loops have the same weight.
void expect_result(const Hierarchy& hierarchy, const Solution& solution, size_t level = 0, double weight = 1) {
    EXPECT_TRUE(solution.status == HMF_OK || solution.status == HMF_LIMIT_STALLED)
        << solution.status << ": " << solution.error.message;
    ASSERT_LT(solution.status, HMF_ERROR_NULL);
    const LevelMesh mesh = read_level(hierarchy, level);
    expect_foliation(mesh, solution.foliation);
    EXPECT_EQ(class_defect(mesh, solution.values, weight), "");
    expect_report(hierarchy, solution, mesh);
}

double relative(double a, double b) { return std::abs(a - b) / std::max(std::abs(a), std::abs(b)); }

// Meshes with loops of known class.
struct Sample {
    const char* name;
    TriMesh mesh;
    std::function<Loops(const Hierarchy&, size_t)> loops;
};

constexpr size_t around = 40, across = 20; // vertices of the tori

TriMesh sheared_torus(uint64_t seed = 7) { // Delaunay, without symmetry
    TorusOptions options;
    options.jitter = 0.25;
    options.seed = seed;
    return with_delaunay_flips(torus(around, across, 2, 1, options), 0, 100);
}

// Columns of vertices from the first to the second end of an edge of a torus.
long column_step(const LevelMesh& mesh, size_t e, size_t n, size_t m) {
    const long d =
        static_cast<long>(mesh.edge_vertices[2 * e + 1] / m) - static_cast<long>(mesh.edge_vertices[2 * e] / m);
    const long half = static_cast<long>(n) / 2;
    return d > half ? d - static_cast<long>(n) : d < -half ? d + static_cast<long>(n) : d;
}

TriMesh wild_torus() { // far from Delaunay
    TorusOptions options;
    options.random_diagonals = true;
    options.jitter = 0.4;
    options.stretch = 4;
    options.seed = 3;
    return torus(around, across, 2, 1, options);
}

Loops pretzel_loops(const Hierarchy& hierarchy, size_t level) {
    return plate_loops(hierarchy, level, hmf_hierarchy_describe(hierarchy.get())->genus);
}

Loops neck_loops(const Hierarchy& hierarchy, size_t level) {
    const LevelMesh mesh = read_level(hierarchy, level);
    Loops loops;
    loops.level = level;
    loops.add(section(
        mesh, [](const double* p) { return p[0] - 0.00137; }, [](const double* p) { return p[1]; }));
    loops.add(section(
        mesh, [](const double* p) { return p[0] - 9.00137; }, [](const double* p) { return p[1]; }));
    return loops;
}

std::vector<Sample> samples() {
    std::vector<Sample> all = {{"sheared torus", sheared_torus(), meridian},
                               {"wild torus", wild_torus(), meridian},
                               {"pretzel 2", pretzel(2, 2), pretzel_loops},
                               {"pretzel 3", pretzel(3, 2), pretzel_loops},
                               {"plate 2", subdivide(subdivide(plate(2))), pretzel_loops},
                               {"joined tori", joined_tori(28, 14, 9, 12), neck_loops},
                               {"finger", torus_with_finger(28, 14, 20, 8), [](const Hierarchy& h, size_t level) {
                                    Loops loops;
                                    loops.level = level;
                                    loops.add(section(
                                        read_level(h, level), [](const double* p) { return p[0] - 0.00137; },
                                        [](const double* p) { return p[1]; }));
                                    return loops;
                                }}};
    if (with_sanitizers) all = {all[1], all[2], all[5]}; // random diagonals, genus 2, necks
    return all;
}

// Caps and needles.  Gauss-Seidel needs about one sweep per unit of the largest
// weight there, so only methods that start from coarse levels come near.
std::vector<Sample> bad_samples() {
    return {{"5 degrees", with_bad_triangles(pretzel(2, 2), 60, 5, 5), pretzel_loops},
            {"1 degree", with_bad_triangles(pretzel(2, 2), 60, 1, 6), pretzel_loops},
            {"0.01 degree", with_bad_triangles(pretzel(2, 2), 60, 0.01, 7), pretzel_loops}};
}

constexpr uint64_t coarse_size = 250;

// The harmonic 1-form on level 0 of a torus mesh n x m with period 1 around the axis:
// |value| for each edge.
std::vector<double> harmonic_form(const LevelMesh& mesh, size_t n, size_t m) {
    const auto step = [&](size_t e) {
        return static_cast<double>(column_step(mesh, e, n, m)) / static_cast<double>(n);
    };
    const auto count = static_cast<Eigen::Index>(mesh.vertex_count - 1); // vertex 0 stays
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    for (size_t e = 0; e < mesh.edge_count; ++e) {
        const Eigen::Index i = static_cast<Eigen::Index>(mesh.edge_vertices[2 * e]) - 1,
                           j = static_cast<Eigen::Index>(mesh.edge_vertices[2 * e + 1]) - 1;
        const double w = mesh.weights[e];
        if (i >= 0) entries.emplace_back(i, i, w), right[i] += w * step(e);
        if (j >= 0) entries.emplace_back(j, j, w), right[j] -= w * step(e);
        if (i >= 0 && j >= 0) entries.emplace_back(i, j, -w), entries.emplace_back(j, i, -w);
    }
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    EXPECT_EQ(solver.info(), Eigen::Success);
    const Eigen::VectorXd f = solver.solve(right);
    std::vector<double> form(mesh.edge_count);
    for (size_t e = 0; e < mesh.edge_count; ++e) {
        const Eigen::Index i = static_cast<Eigen::Index>(mesh.edge_vertices[2 * e]) - 1,
                           j = static_cast<Eigen::Index>(mesh.edge_vertices[2 * e + 1]) - 1;
        form[e] = std::abs(step(e) + (j >= 0 ? f[j] : 0) - (i >= 0 ? f[i] : 0));
    }
    return form;
}

} // namespace

// --- The checks themselves ---------------------------------------------------

TEST(Oracles, CanFail) {
    const Hierarchy hierarchy(pretzel(2, 2), 0.5, coarse_size);
    ASSERT_TRUE(hierarchy);
    const LevelMesh mesh = read_level(hierarchy, 0);
    const Loops coarse = pretzel_loops(hierarchy, hierarchy.coarsest()), fine = pretzel_loops(hierarchy, 0);
    const Solution solution = solve(hierarchy, &coarse, whitehead(1e-6));
    ASSERT_EQ(closedness_defect(mesh, solution.values), "");
    ASSERT_EQ(class_defect(mesh, solution.values, 1), "");
    std::vector<double> other = solution.values; // another class, just as closed
    for (double& x : other) x *= 0.75;
    EXPECT_EQ(closedness_defect(mesh, other), "");
    EXPECT_NE(class_defect(mesh, other, 1), "");
    EXPECT_LT(shortest_crossing(mesh, fine, 0, other), 1);
    other = solution.values; // a hair too long for its triangle
    const uint32_t* sides = &mesh.triangle_edges[0];
    other[sides[0]] = other[sides[1]] + other[sides[2]] + std::ldexp(1.0, -46);
    EXPECT_NE(closedness_defect(mesh, other), "");
    Loops unequal = coarse;
    unequal.weights = {1, 1.25};
    const Solution two = solve(hierarchy, &unequal, whitehead(1e-6));
    EXPECT_NE(class_defect(mesh, two.values, 1), "");
    EXPECT_EQ(class_defect(mesh, two.values, 0.25), ""); // both weights are multiples
}

// --- Initial foliation -------------------------------------------------------

TEST(Initial, CountsCrossingsAndIsClosed) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        const Hierarchy hierarchy(sample.mesh, 0.5, coarse_size);
        ASSERT_TRUE(hierarchy);
        for (const size_t level : {hierarchy.coarsest(), size_t{0}}) {
            SCOPED_TRACE(level);
            const LevelMesh mesh = read_level(hierarchy, level);
            Loops loops = sample.loops(hierarchy, level);
            loops.weights.clear();
            for (size_t c = 0; c < loops.count(); ++c) loops.weights.push_back(1 + 0.75 * static_cast<double>(c));
            const Foliation foliation = initialize(hierarchy, loops);
            const std::vector<double> values = values_of(foliation);
            std::vector<double> expected(mesh.edge_count, 0);
            for (size_t c = 0; c < loops.count(); ++c)
                for (uint32_t e : crossed_edges(mesh, loops, c)) expected[e] += loops.weights[c];
            EXPECT_EQ(values, expected);
            expect_foliation(mesh, foliation);
            for (size_t c = 0; c < loops.count(); ++c)
                EXPECT_EQ(shortest_crossing(mesh, loops, c, values), loops.weights[c]);
        }
    }
}

TEST(Initial, LoopsOfTheLibraryAreACutSystem) {
    for (const size_t genus : {1, 2, 5, 12}) {
        SCOPED_TRACE(genus);
        const Hierarchy hierarchy(pretzel(genus, 2));
        ASSERT_TRUE(hierarchy);
        for (const size_t level : {hierarchy.coarsest(), size_t{0}}) {
            const LevelMesh mesh = read_level(hierarchy, level);
            const Loops loops = library_loops(hierarchy, level);
            ASSERT_EQ(loops.count(), genus);
            const Foliation foliation = initialize(hierarchy, loops);
            const std::vector<double> values = values_of(foliation);
            expect_foliation(mesh, foliation);
            // The vertices stay connected by edges that no loop crosses: one planar piece.
            std::vector<uint32_t> root(mesh.vertex_count);
            std::iota(root.begin(), root.end(), 0u);
            size_t pieces = mesh.vertex_count;
            for (size_t e = 0; e < mesh.edge_count; ++e) {
                if (values[e] != 0) continue;
                uint32_t a = mesh.edge_vertices[2 * e], b = mesh.edge_vertices[2 * e + 1];
                while (root[a] != a) a = root[a] = root[root[a]];
                while (root[b] != b) b = root[b] = root[root[b]];
                if (a != b) root[a] = b, --pieces;
            }
            EXPECT_EQ(pieces, 1u);
        }
    }
}

// A closed path of vertices is the same as the strip of triangles beside it.
TEST(Initial, VertexLoopsAndTriangleLoopsAgree) {
    const size_t n = around, m = across;
    const Hierarchy hierarchy(torus(n, m, 2, 1));
    ASSERT_TRUE(hierarchy);
    Loops path;
    path.kind = HMF_PATH_VERTICES;
    std::vector<uint32_t> column;
    for (uint32_t j = 0; j < m; ++j) column.push_back(static_cast<uint32_t>(5 * m) + j);
    path.add(column);
    const LevelMesh mesh = read_level(hierarchy, 0);
    expect_foliation(mesh, initialize(hierarchy, path));
    const Solution by_path = solve(hierarchy, &path, single_level());
    const Loops strip = meridian(hierarchy, 0);
    const Solution by_strip = solve(hierarchy, &strip, single_level());
    expect_result(hierarchy, by_path);
    EXPECT_LT(relative(by_path.report.energy, by_strip.report.energy), 1e-6);
}

// --- Results -----------------------------------------------------------------

TEST(Solve, EveryResultIsAFoliation) {
    for (const Sample& sample : samples())
        for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
            SCOPED_TRACE(testing::Message() << sample.name << " method " << method);
            const Hierarchy hierarchy(sample.mesh, 0.5, coarse_size);
            ASSERT_TRUE(hierarchy);
            const Loops loops = sample.loops(hierarchy, method == HMF_METHOD_SINGLE_LEVEL ? 0 : hierarchy.coarsest());
            expect_result(hierarchy, solve(hierarchy, &loops, solve_options(method, 0)));
        }
}

TEST(Solve, OwnLoopsOfTheLibrary) {
    for (const size_t genus : {1, 2, 4, 10, 20}) {
        SCOPED_TRACE(genus);
        const Hierarchy hierarchy(pretzel(genus, 2));
        ASSERT_TRUE(hierarchy);
        expect_result(hierarchy, solve(hierarchy, nullptr, whitehead(1e-6)));
    }
    const Hierarchy knot(trefoil(200, 12, 0.3));
    ASSERT_TRUE(knot);
    expect_result(knot, solve(knot, nullptr, whitehead(1e-6)));
}

TEST(Solve, StopLevelGivesAPreview) {
    const Hierarchy hierarchy(pretzel(2, 3), 0.5, 400);
    ASSERT_TRUE(hierarchy);
    const Loops loops = pretzel_loops(hierarchy, hierarchy.coarsest());
    for (size_t level = 0; level < hierarchy.levels(); ++level) {
        SCOPED_TRACE(level);
        hmf_solve_options options = whitehead(1e-6);
        options.stop_level = level;
        expect_result(hierarchy, solve(hierarchy, &loops, options), level);
    }
}

// The queries against the same things counted here.
TEST(Solve, EnergyAndResidualsByDefinition) {
    const Hierarchy hierarchy(pretzel(2, 3), 0.5, 400);
    ASSERT_TRUE(hierarchy);
    const Loops loops = pretzel_loops(hierarchy, hierarchy.coarsest());
    for (size_t level = 1; level < hierarchy.levels(); ++level) {
        SCOPED_TRACE(level);
        hmf_solve_options options = whitehead(1e-4); // leaves residuals to compare
        options.stop_level = level;
        const Solution solution = solve(hierarchy, &loops, options);
        const LevelMesh mesh = read_level(hierarchy, level);
        EXPECT_LT(relative(energy(mesh, solution.values), solution.report.energy), 1e-12);
        const std::vector<double> found = residuals(solution.foliation, mesh.vertex_count);
        const std::vector<double> expected = residuals(mesh, solution.values);
        size_t compared = 0;
        double largest = 0;
        for (size_t v = 0; v < mesh.vertex_count; ++v) {
            if (expected[v] < 0) continue;
            ++compared;
            largest = std::max(largest, expected[v]);
            ASSERT_NEAR(found[v], expected[v], 1e-9) << "vertex " << v;
        }
        EXPECT_GT(compared, mesh.vertex_count / 2);
        EXPECT_GT(largest, 0);
    }
}

TEST(Solve, ReportTellsTheStory) {
    const Hierarchy hierarchy(pretzel(2, 3), 0.5, 400);
    ASSERT_TRUE(hierarchy);
    const Loops loops = pretzel_loops(hierarchy, hierarchy.coarsest());
    const Solution solution = solve(hierarchy, &loops, whitehead(1e-6));
    ASSERT_EQ(solution.status, HMF_OK);
    const hmf_report& report = solution.report;
    EXPECT_EQ(report.method, HMF_METHOD_WHITEHEAD);
    EXPECT_EQ(report.level_count, hierarchy.levels());
    EXPECT_GT(report.peak_memory_bytes, 0u);
    uint64_t sweeps = 0;
    for (size_t k = 0; k < report.level_count; ++k) {
        const hmf_level_info& info = hmf_hierarchy_describe(hierarchy.get())->levels[k];
        EXPECT_EQ(report.levels[k].vertex_count, info.vertex_count);
        EXPECT_EQ(report.levels[k].edge_count, info.edge_count);
        EXPECT_EQ(report.levels[k].raised_count, info.raised_count);
        EXPECT_GT(report.levels[k].sweep_count, 0u);
        sweeps += report.levels[k].sweep_count;
    }
    ASSERT_GT(report.history_count, 0u);
    uint64_t recorded = 0;
    for (size_t i = 0; i < report.history_count; ++i) {
        recorded += report.history[i].kind == 1;
        if (i == 0) continue;
        EXPECT_GE(report.history[i].seconds, report.history[i - 1].seconds);
        EXPECT_LE(report.history[i].level, report.history[i - 1].level);
        if (report.history[i].kind == 1 && report.history[i].level == report.history[i - 1].level) {
            EXPECT_LE(report.history[i].energy, report.history[i - 1].energy * (1 + 1e-12));
        }
    }
    EXPECT_EQ(recorded, sweeps);
    EXPECT_LT(relative(report.history[report.history_count - 1].energy, report.energy), 1e-9);
}

// --- Uniqueness --------------------------------------------------------------

// The same curves, three hierarchies, with and without levels: one energy.
TEST(Unique, AcrossHierarchiesAndMethods) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        const Hierarchy fine(sample.mesh, 0.75, 350), coarse(sample.mesh, 0.25, 180);
        ASSERT_TRUE(fine && coarse);
        const Loops on_fine = sample.loops(fine, fine.coarsest()), on_coarse = sample.loops(coarse, coarse.coarsest()),
                    on_input = sample.loops(fine, 0);
        const Solution a = solve(fine, &on_fine, whitehead()), b = solve(coarse, &on_coarse, whitehead()),
                       c = solve(fine, &on_input, single_level());
        for (const Solution* s : {&a, &b, &c}) {
            expect_result(fine, *s);
            EXPECT_LT(relative(s->report.energy, a.report.energy), 1e-8);
        }
    }
}

TEST(Unique, NewtonAgreesWithWhitehead) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        const Hierarchy hierarchy(sample.mesh, 0.5, coarse_size);
        ASSERT_TRUE(hierarchy);
        const Loops loops = sample.loops(hierarchy, hierarchy.coarsest());
        const Solution exact = solve(hierarchy, &loops, newton());
        expect_result(hierarchy, exact);
        EXPECT_LT(exact.report.residual_max, 1e-6);
        const Solution paper = solve(hierarchy, &loops, whitehead());
        EXPECT_LT(relative(exact.report.energy, paper.report.energy), 1e-8);
        // The minimum is the minimum.
        EXPECT_LE(exact.report.energy, paper.report.energy * (1 + 1e-9));
    }
}

// Loops on the input are restricted to the coarsest level.
TEST(Unique, LoopsOfAnyLevel) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        const Hierarchy hierarchy(sample.mesh, 0.5, coarse_size);
        ASSERT_TRUE(hierarchy);
        const Loops coarse = sample.loops(hierarchy, hierarchy.coarsest());
        const Solution reference = solve(hierarchy, &coarse, whitehead(1e-10));
        for (size_t level = 0; level < hierarchy.coarsest(); ++level) {
            SCOPED_TRACE(level);
            const Loops loops = sample.loops(hierarchy, level);
            const Solution solution = solve(hierarchy, &loops, whitehead(1e-10));
            expect_result(hierarchy, solution);
            EXPECT_LT(relative(solution.report.energy, reference.report.energy), 1e-6);
        }
    }
}

TEST(Unique, CapsAndNeedles) {
    for (const Sample& sample : bad_samples()) {
        SCOPED_TRACE(sample.name);
        const Hierarchy hierarchy(sample.mesh, 0.5, coarse_size), other(sample.mesh, 0.75, 350);
        ASSERT_TRUE(hierarchy && other);
        const Loops loops = sample.loops(hierarchy, hierarchy.coarsest()),
                    other_loops = sample.loops(other, other.coarsest());
        const Solution paper = solve(hierarchy, &loops, solve_options(HMF_METHOD_WHITEHEAD, 1e-9, 20000));
        EXPECT_TRUE(paper.status == HMF_OK || paper.status == HMF_LIMIT_ITERATIONS);
        expect_foliation(read_level(hierarchy, 0), paper.foliation);
        EXPECT_EQ(class_defect(read_level(hierarchy, 0), paper.values, 1), "");
        const Solution exact = solve(hierarchy, &loops, newton()), again = solve(other, &other_loops, newton());
        expect_result(hierarchy, exact);
        expect_result(other, again);
        EXPECT_LT(relative(exact.report.energy, again.report.energy), 1e-7);
        EXPECT_LT(relative(exact.report.energy, paper.report.energy), 1e-3);
        EXPECT_LE(exact.report.energy, paper.report.energy * (1 + 1e-9));
    }
}

// The class survives interpolation: relaxing the interpolated initial foliation
// ends where the cascade ends.
TEST(Unique, InterpolatedInitialFoliation) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        const Hierarchy hierarchy(sample.mesh, 0.5, coarse_size);
        ASSERT_TRUE(hierarchy);
        const Loops loops = sample.loops(hierarchy, hierarchy.coarsest());
        const Foliation start = interpolate(initialize(hierarchy, loops), 0);
        expect_foliation(read_level(hierarchy, 0), start);
        const Solution relaxed = relax(start, whitehead());
        expect_result(hierarchy, relaxed);
        const Solution cascade = solve(hierarchy, &loops, whitehead());
        EXPECT_LT(relative(relaxed.report.energy, cascade.report.energy), 1e-8);
    }
}

TEST(Unique, RestrictionThereAndBack) {
    const Hierarchy hierarchy(pretzel(2, 2), 0.5, coarse_size);
    ASSERT_TRUE(hierarchy);
    const Loops loops = pretzel_loops(hierarchy, hierarchy.coarsest()), on_input = pretzel_loops(hierarchy, 0);
    const Foliation coarse = interpolate(initialize(hierarchy, on_input), hierarchy.coarsest());
    expect_foliation(read_level(hierarchy, hierarchy.coarsest()), coarse);
    const Solution a = relax(coarse, whitehead()), b = relax(initialize(hierarchy, loops), whitehead());
    EXPECT_LT(relative(a.report.energy, b.report.energy), 1e-8);
}

TEST(Unique, InterpolationToTheSameLevelChangesNothing) {
    const Hierarchy hierarchy(sheared_torus(), 0.5, coarse_size);
    ASSERT_TRUE(hierarchy);
    const Loops loops = meridian(hierarchy, hierarchy.coarsest());
    const Solution solution = solve(hierarchy, &loops, whitehead(1e-6));
    EXPECT_EQ(values_of(interpolate(solution.foliation, 0)), solution.values);
}

// The plane parts of a plate stay plane: any triangulation of the same surface
// has the same intrinsic Delaunay triangulation, hence the same energy.
TEST(Unique, AcrossTriangulationsOfOneSurface) {
    const TriMesh flat = subdivide(subdivide(plate(2)));
    const TriMesh flipped = with_random_flips(flat, 20 * flat.triangle_count(), 1 - 1e-12, 11);
    ASSERT_NE(flat.triangles, flipped.triangles);
    const Hierarchy first(flat, 0.5, coarse_size), second(flipped, 0.5, coarse_size);
    ASSERT_TRUE(first && second);
    const Loops a = pretzel_loops(first, 0), b = pretzel_loops(second, 0);
    const Solution x = solve(first, &a, single_level()), y = solve(second, &b, single_level());
    expect_result(first, x);
    expect_result(second, y);
    EXPECT_LT(relative(x.report.energy, y.report.energy), 1e-8);
}

// Flips that bend the surface a little change the energy a little.
TEST(Unique, FlippedTorusIsClose) {
    const TriMesh round = torus(around, across, 2, 1), flipped = with_random_flips(round, 20000, 0.9, 13);
    ASSERT_NE(round.triangles, flipped.triangles);
    const Hierarchy first(round, 0.5, coarse_size), second(flipped, 0.5, coarse_size);
    ASSERT_TRUE(first && second);
    const Loops a = meridian(first, first.coarsest()), b = meridian(second, second.coarsest());
    EXPECT_LT(
        relative(solve(first, &a, whitehead(1e-9)).report.energy, solve(second, &b, whitehead(1e-9)).report.energy),
        0.05);
}

// --- Genus 1 -----------------------------------------------------------------

TEST(GenusOne, EqualsTheHarmonicForm) {
    const size_t n = around, m = across;
    for (const TriMesh& torus_mesh : {sheared_torus(), sheared_torus(8)}) {
        const Hierarchy hierarchy(torus_mesh, 0.5, coarse_size);
        ASSERT_TRUE(hierarchy);
        const LevelMesh mesh = read_level(hierarchy, 0);
        for (double w : mesh.weights) ASSERT_GT(w, 0) << "this test needs a Delaunay mesh";
        Loops loops = meridian(hierarchy, hierarchy.coarsest());
        loops.weights = {2.5};
        const Solution solution = solve(hierarchy, &loops, whitehead(1e-14));
        expect_result(hierarchy, solution, 0, 2.5);
        const std::vector<double> form = harmonic_form(mesh, n, m);
        double worst = 0, best_energy = 0, largest = 0;
        for (size_t e = 0; e < mesh.edge_count; ++e) {
            worst = std::max(worst, std::abs(solution.values[e] - 2.5 * form[e]));
            largest = std::max(largest, 2.5 * form[e]);
            best_energy += mesh.weights[e] * 6.25 * form[e] * form[e];
        }
        EXPECT_LT(worst, 1e-4 * largest);
        EXPECT_LT(relative(solution.report.energy, best_energy), 1e-8);
        EXPECT_GE(solution.report.energy, best_energy * (1 - 1e-10)); // nothing is below the minimum
    }
}

// D(F) = w * flux of the conjugate through any curve parallel to the loop.
TEST(GenusOne, EnergyIsWeightTimesFlux) {
    const size_t n = around, m = across;
    const Hierarchy hierarchy(sheared_torus(), 0.5, coarse_size);
    ASSERT_TRUE(hierarchy);
    const LevelMesh mesh = read_level(hierarchy, 0);
    Loops loops = meridian(hierarchy, hierarchy.coarsest());
    loops.weights = {0.75};
    const Solution solution = solve(hierarchy, &loops, whitehead(1e-14));
    for (size_t column = 0; column < n; ++column) {
        double flux = 0; // through the curve between this column of vertices and the next
        for (size_t e = 0; e < mesh.edge_count; ++e) {
            const long d = column_step(mesh, e, n, m);
            const size_t a = mesh.edge_vertices[2 * e + (d < 0)] / m; // where the way up begins
            if ((column + n - a) % n < static_cast<size_t>(std::abs(d))) flux += mesh.weights[e] * solution.values[e];
        }
        EXPECT_LT(relative(0.75 * flux, solution.report.energy), 1e-5) << column;
    }
}

// --- Class -------------------------------------------------------------------

TEST(Class, NoPathAcrossALoopIsShorterThanItsWeight) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        const Hierarchy hierarchy(sample.mesh, 0.5, coarse_size);
        ASSERT_TRUE(hierarchy);
        Loops coarse = sample.loops(hierarchy, hierarchy.coarsest()), fine = sample.loops(hierarchy, 0);
        for (size_t c = 0; c < coarse.count(); ++c) coarse.weights.push_back(1 + 0.5 * static_cast<double>(c));
        const LevelMesh mesh = read_level(hierarchy, 0);
        const std::vector<double> start = values_of(interpolate(initialize(hierarchy, coarse), 0));
        const Solution solution = solve(hierarchy, &coarse, whitehead(1e-6));
        ASSERT_LT(solution.status, HMF_ERROR_NULL);
        for (size_t c = 0; c < fine.count(); ++c) {
            EXPECT_GE(shortest_crossing(mesh, fine, c, start), coarse.weights[c]);
            const double length = shortest_crossing(mesh, fine, c, solution.values);
            EXPECT_GE(length, coarse.weights[c]);
            EXPECT_LE(length, 1.5 * coarse.weights[c]); // not merely large values
        }
    }
}

// --- Scaling -----------------------------------------------------------------

TEST(Scaling, OfTheWeights) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        const Hierarchy hierarchy(sample.mesh, 0.5, coarse_size);
        ASSERT_TRUE(hierarchy);
        Loops loops = sample.loops(hierarchy, hierarchy.coarsest());
        const auto with = [&](double w) {
            loops.weights.assign(loops.count(), w);
            return solve(hierarchy, &loops, whitehead(1e-10));
        };
        const Solution one = with(1), two = with(2), eighth = with(0.125), three = with(3);
        std::vector<double> expected = one.values;
        for (double& x : expected) x *= 2;
        EXPECT_EQ(two.values, expected);
        for (double& x : expected) x /= 16;
        EXPECT_EQ(eighth.values, expected);
        EXPECT_LT(relative(three.report.energy, 9 * one.report.energy), 1e-6);
    }
}

TEST(Scaling, OfTheMesh) {
    const TriMesh mesh = pretzel(2, 2);
    const Hierarchy plain(mesh, 0.5, coarse_size), large(scaled(mesh, 64), 0.5, coarse_size);
    ASSERT_TRUE(plain && large);
    const Solution a = solve(plain, nullptr, whitehead(1e-8)), b = solve(large, nullptr, whitehead(1e-8));
    expect_result(plain, a);
    EXPECT_EQ(a.values, b.values);
}

TEST(Scaling, RotationKeepsTheEnergy) {
    const TriMesh mesh = pretzel(2, 2);
    const Matrix turn = rotation(1, 2, 3, 0.7), back = rotation(1, 2, 3, -0.7);
    const Hierarchy plain(mesh, 0.5, coarse_size), turned(transformed(mesh, turn), 0.5, coarse_size);
    ASSERT_TRUE(plain && turned);
    const Loops a = pretzel_loops(plain, plain.coarsest());
    Loops b;
    b.level = turned.coarsest();
    LevelMesh level = read_level(turned, b.level);
    TriMesh points;
    points.positions = level.positions;
    level.positions = transformed(points, back).positions;
    for (size_t k = 0; k < 2; ++k) {
        const double x = 2.0 * static_cast<double>(k) + 1.50137;
        b.add(section(
            level, [x](const double* p) { return p[0] - x; }, [](const double* p) { return p[1] - 1.5; }));
    }
    const Solution u = solve(plain, &a, whitehead()), v = solve(turned, &b, whitehead());
    expect_result(turned, v);
    EXPECT_LT(relative(u.report.energy, v.report.energy), 1e-8);
}

// --- Tolerance: of the residual ----------------------------------------------

TEST(Tolerance, ConvergedMeansTheResidual) {
    const Hierarchy hierarchy(pretzel(2, 2), 0.5, coarse_size);
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    for (const int32_t method : {HMF_METHOD_NEWTON, HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
        SCOPED_TRACE(method);
        const bool sweeps = method != HMF_METHOD_NEWTON;
        // The energy hardly changes any more, and the residual is large.
        hmf_solve_options options = solve_options(method, 1e-3, many);
        const Solution rough = solve(hierarchy, &loops, options);
        EXPECT_EQ(rough.status, HMF_OK) << rough.error.message;
        EXPECT_EQ(rough.report.converged, !sweeps);
        if (sweeps) { EXPECT_GT(rough.report.residual_max, 1e-6); }

        options.tolerance = 1e-6;
        const Solution fine = solve(hierarchy, &loops, options);
        EXPECT_EQ(fine.status, HMF_OK) << fine.error.message;
        EXPECT_EQ(fine.report.converged, 1);
        EXPECT_LE(fine.report.residual_max, 1e-6);
        EXPECT_LE(fine.report.energy, rough.report.energy * (1 + 1e-12));
        const hmf_history_entry& last = fine.report.history[fine.report.history_count - 1];
        EXPECT_TRUE(last.residual_max >= 0 && last.residual_max <= 1e-6);

        // It counts and not the status, if a limit comes first.
        options.iteration_limit = 2;
        const Solution few = solve(hierarchy, &loops, options);
        EXPECT_EQ(few.report.converged, few.report.residual_max <= 1e-6);
        if (sweeps) {
            EXPECT_EQ(few.status, HMF_LIMIT_ITERATIONS);
            EXPECT_EQ(few.report.converged, 0);
        }
    }
}

// Sweeps that cannot move by a unit any more say so.
TEST(Tolerance, BelowTheUnitSweepsStall) {
    const Hierarchy hierarchy(torus(12, 8, 3, 1));
    ASSERT_TRUE(hierarchy);
    hmf_solve_options options = solve_options(HMF_METHOD_WHITEHEAD, 0, many);
    options.tolerance = 1e-300;
    const Solution solution = solve(hierarchy, nullptr, options);
    EXPECT_TRUE(solution.status == HMF_LIMIT_STALLED || solution.report.residual_max == 0) << solution.status;
    EXPECT_EQ(solution.report.converged, solution.status == HMF_OK);
}

TEST(Tolerance, OutOfRange) {
    const Hierarchy hierarchy(torus(12, 8, 3, 1));
    ASSERT_TRUE(hierarchy);
    for (const double tolerance : {-1e-8, 1.0, std::nan("")}) {
        hmf_solve_options options = solve_options(HMF_METHOD_WHITEHEAD, 0);
        options.tolerance = tolerance;
        EXPECT_EQ(solve(hierarchy, nullptr, options).status, HMF_ERROR_OPTIONS) << tolerance;
        options = solve_options(HMF_METHOD_WHITEHEAD, tolerance);
        EXPECT_EQ(solve(hierarchy, nullptr, options).status, HMF_ERROR_OPTIONS) << tolerance;
    }
}

// A limit of steps ends the solve where it is; one that is not reached changes nothing.
TEST(StepLimit, EndsNewton) {
    const Hierarchy hierarchy(torus(60, 40, 3, 1));
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 1e-12);
    const Solution whole = solve(hierarchy, &loops, options);
    ASSERT_EQ(whole.status, HMF_OK) << whole.error.message;
    double before = 1e300;
    uint64_t ended = 0;
    for (options.step_limit = 1; options.step_limit <= 60; ++options.step_limit) {
        SCOPED_TRACE(options.step_limit);
        const Solution part = solve(hierarchy, &loops, options);
        EXPECT_LE(part.report.energy, before * (1 + 1e-12));
        EXPECT_EQ(part.report.class_state, HMF_CLASS_PROVEN);
        EXPECT_EQ(part.report.poles, 0u);
        before = part.report.energy;
        if (part.status == HMF_OK) {
            EXPECT_EQ(part.values, whole.values);
            break;
        }
        EXPECT_EQ(part.status, HMF_LIMIT_ITERATIONS);
        EXPECT_NE(std::string(part.error.message).find("step_limit"), std::string::npos) << part.error.message;
        EXPECT_GT(part.report.residual_max, 1e-12);
        ++ended;
    }
    EXPECT_GT(ended, 0u);
    EXPECT_LT(ended, 60u);
    // Sweeps have a limit of their own.
    options = solve_options(HMF_METHOD_WHITEHEAD, 1e-6, many);
    const Solution sweeps = solve(hierarchy, &loops, options);
    options.step_limit = 1;
    EXPECT_EQ(solve(hierarchy, &loops, options).values, sweeps.values);
}

// Without zeros one linear solve is exact wherever it starts: those of the levels between would be wasted.
TEST(LinearSolves, OfATorusAreOnTheLastLevel) {
    for (const bool is_torus : {true, false}) {
        const Hierarchy hierarchy(is_torus ? torus(60, 40, 2, 0.8) : pretzel(2, 3), 0.5, 100);
        ASSERT_GT(hierarchy.levels(), 3u);
        const Solution s = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
        ASSERT_EQ(s.status, HMF_OK);
        if (is_torus) EXPECT_EQ(s.report.levels[0].linear_solve_count, 1u);
        for (size_t k = 1; k + 1 < hierarchy.levels(); ++k)
            EXPECT_EQ(s.report.levels[k].linear_solve_count == 0, is_torus) << k;
    }
}

// --- Determinism -------------------------------------------------------------

TEST(Determinism, SameBitsTwiceAndFromManyThreads) {
    for (const Sample& sample : samples()) {
        SCOPED_TRACE(sample.name);
        const Hierarchy hierarchy(sample.mesh, 0.5, coarse_size);
        const Hierarchy again(sample.mesh, 0.5, coarse_size);
        ASSERT_TRUE(hierarchy && again);
        const Loops loops = library_loops(hierarchy, hierarchy.coarsest());
        EXPECT_EQ(loops.elements, library_loops(again, again.coarsest()).elements);
        const hmf_solve_options options = whitehead(1e-5);
        const Solution first = solve(hierarchy, &loops, options), second = solve(again, &loops, options);
        EXPECT_EQ(first.values, second.values);
        constexpr size_t count = 4;
        std::vector<Solution> results(count);
        std::vector<std::thread> threads;
        for (size_t i = 0; i < count; ++i)
            threads.emplace_back([&, i] { results[i] = solve(hierarchy, &loops, options); });
        for (std::thread& thread : threads) thread.join();
        for (const Solution& result : results) {
            EXPECT_EQ(result.status, first.status);
            EXPECT_EQ(result.values, first.values);
        }
    }
}

} // namespace test_solve
