// Surfaces with boundary: closed forms, the linear problem, loops of the library, random arcs.
#include "src/core/api/foliation_object.hpp"
#include "src/core/curves/double_loops.hpp"
#include "src/applications/loops/surface_loops.hpp"
#include "support/boundary.hpp"
#include "support/sample.hpp"

#include <gtest/gtest.h>

#include <Eigen/Sparse>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>

namespace test_boundary {

using namespace test;

namespace {

const double pi = std::acos(-1.0);

// Energy of the function that is harmonic on the caller's triangles and has the values 0 and 1 where fixed tells.
double linear_energy(const LevelMesh& mesh, const std::map<uint32_t, double>& fixed) {
    std::vector<int> unknown(mesh.vertex_count, -1);
    int n = 0;
    for (size_t v = 0; v < mesh.vertex_count; ++v)
        if (!fixed.count(uint32_t(v))) unknown[v] = n++;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (size_t e = 0; e < mesh.edge_count; ++e)
        for (size_t k = 0; k < 2; ++k) {
            const uint32_t v = mesh.edge_vertices[2 * e + k], w = mesh.edge_vertices[2 * e + 1 - k];
            if (unknown[v] < 0) continue;
            entries.emplace_back(unknown[v], unknown[v], mesh.weights[e]);
            if (unknown[w] >= 0) entries.emplace_back(unknown[v], unknown[w], -mesh.weights[e]);
            else right[unknown[v]] += mesh.weights[e] * fixed.at(w);
        }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    const Eigen::VectorXd x = solver.solve(right);
    double sum = 0;
    for (size_t e = 0; e < mesh.edge_count; ++e) {
        double u[2];
        for (size_t k = 0; k < 2; ++k) {
            const uint32_t v = mesh.edge_vertices[2 * e + k];
            u[k] = unknown[v] < 0 ? fixed.at(v) : x[unknown[v]];
        }
        sum += mesh.weights[e] * (u[0] - u[1]) * (u[0] - u[1]);
    }
    return sum;
}

// A shortest path between two vertices of the boundary whose other vertices lie inside and are free.
Path shortest_arc(const LevelMesh& level, const std::vector<char>& on_boundary, const std::vector<char>& taken,
                  uint32_t from, uint32_t to) {
    std::vector<std::vector<uint32_t>> neighbors(level.vertex_count);
    for (size_t e = 0; e < level.edge_count; ++e)
        for (size_t k = 0; k < 2; ++k)
            neighbors[level.edge_vertices[2 * e + k]].push_back(level.edge_vertices[2 * e + 1 - k]);
    std::vector<uint32_t> before(level.vertex_count, HMF_NONE);
    Path queue{from};
    before[from] = from;
    for (size_t i = 0; i < queue.size(); ++i)
        for (const uint32_t w : neighbors[queue[i]]) {
            if (before[w] != HMF_NONE || taken[w] || (on_boundary[w] && (w != to || queue[i] == from))) continue;
            before[w] = queue[i];
            queue.push_back(w);
        }
    if (before[to] == HMF_NONE || from == to) return {};
    Path path{to};
    while (path.back() != from) path.push_back(before[path.back()]);
    return path;
}

// Arcs between random vertices of the boundary, as far as they go together.
Curves random_arcs(const Hierarchy& hierarchy, size_t wished, Random& random) {
    const LevelMesh level = read_level(hierarchy, 0);
    std::vector<char> on_boundary(level.vertex_count, 0), taken(level.vertex_count, 0);
    const std::vector<int> triangles = triangles_of_edges(level);
    Path boundary;
    for (size_t e = 0; e < level.edge_count; ++e)
        for (size_t k = 0; k < 2 && triangles[e] == 1; ++k) {
            const uint32_t v = level.edge_vertices[2 * e + k];
            if (!on_boundary[v]) boundary.push_back(v);
            on_boundary[v] = 1;
        }
    Curves curves;
    for (size_t tries = 0; tries < 12 && curves.arcs.size() < wished; ++tries) {
        const Path path = shortest_arc(level, on_boundary, taken, boundary[random.below(boundary.size())],
                                       boundary[random.below(boundary.size())]);
        if (path.size() < 3 || taken[path.front()] || taken[path.back()]) continue;
        Curves more = curves;
        more.add(path, true, 1 + double(random.below(4)) / 4);
        const hmf_loop_set set = more.view();
        hmf_foliation* raw = nullptr;
        const hmf_status status = hmf_foliation_from_loops(hierarchy.get(), &set, nullptr, &raw, nullptr);
        hmf_foliation_destroy(raw);
        if (status != HMF_OK) {
            EXPECT_TRUE(status == HMF_ERROR_LOOP_TRIVIAL || status == HMF_ERROR_LOOP_PARALLEL
                        || status == HMF_ERROR_LOOP_CROSSING)
                << status;
            continue;
        }
        curves = more;
        for (const uint32_t v : path) taken[v] = 1;
    }
    return curves;
}

} // namespace

TEST(Boundary, LevelZeroIsTheCallersMesh) {
    const TriMesh mesh = annulus(12, 4, 3, 0.3, 1);
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    EXPECT_EQ(hmf_hierarchy_describe(hierarchy.get())->genus, 0u);
    const LevelMesh level = read_level(hierarchy, 0);
    EXPECT_EQ(level.vertex_count, mesh.vertex_count());
    EXPECT_EQ(level.triangle_vertices, mesh.triangles);
    EXPECT_EQ(level.positions, mesh.positions);
    EXPECT_EQ(level.vertex_count + level.triangle_count, level.edge_count); // Euler characteristic 0
    std::map<std::set<uint32_t>, uint32_t> first;
    for (size_t c = 0; c < mesh.triangles.size(); ++c) {
        const std::set<uint32_t> ends{mesh.triangles[c], mesh.triangles[c - c % 3 + (c + 1) % 3]};
        const uint32_t e = first.insert({ends, uint32_t(first.size())}).first->second;
        EXPECT_EQ(level.triangle_edges[c], e);
        EXPECT_EQ((std::set<uint32_t>{level.edge_vertices[2 * e], level.edge_vertices[2 * e + 1]}), ends);
    }
}

// A power of two changes the unit and nothing else, however large it is.
TEST(Boundary, WeightsScaleTheValues) {
    const Hierarchy hierarchy(annulus(40, 12, 3, 0.5, 5));
    ASSERT_TRUE(hierarchy);
    for (const bool arc : {false, true}) {
        Path path;
        for (size_t k = 0; k < (arc ? 13u : 40u); ++k) path.push_back(uint32_t(arc ? k : k * 13));
        std::vector<double> expected;
        for (const int exponent : {0, 1, 30, -30, 300, -300}) {
            Curves curves;
            curves.add(path, arc, std::ldexp(1, exponent));
            const Solution s = solve_curves(hierarchy, curves);
            ASSERT_EQ(s.status, HMF_OK) << s.error.message;
            std::vector<double> values = s.values;
            for (double& x : values) x = std::ldexp(x, -exponent);
            if (expected.empty()) expected = values;
            EXPECT_EQ(values, expected) << exponent;
        }
    }
}

TEST(Boundary, AnnulusRoundAndAcross) {
    const double R = 3;
    for (const double jitter : {0.0, 0.5}) {
        const size_t n = 40, m = 12;
        const TriMesh mesh = annulus(n, m, R, jitter, 5);
        const Hierarchy hierarchy(mesh);
        ASSERT_TRUE(hierarchy);
        const LevelMesh level = read_level(hierarchy, 0);
        std::map<uint32_t, double> fixed;
        Path inner, outer, middle;
        for (size_t i = 0; i < n; ++i) {
            inner.push_back(uint32_t(i * (m + 1)));
            outer.push_back(uint32_t(i * (m + 1) + m));
            middle.push_back(uint32_t(i * (m + 1) + m / 2));
            fixed[inner.back()] = 0;
            fixed[outer.back()] = 1;
        }
        const double linear = linear_energy(level, fixed);
        for (const Path& round : {inner, outer, middle}) {
            Curves curves;
            curves.add(round, false);
            const Solution s = solve_curves(hierarchy, curves);
            expect_result(hierarchy, s, 2);
            // Diagonals of the regular mesh have the weight 0, which is raised to the floor of 1e-9.
            EXPECT_NEAR(s.report.energy, linear, jitter == 0 ? 1e-8 : 0.02) << jitter;
            EXPECT_LE(s.report.energy, linear + 1e-8);
            EXPECT_NEAR(s.report.energy, 2 * pi / std::log(R), 0.1);
        }
        Curves across;
        Path arc;
        for (size_t j = 0; j <= m; ++j) arc.push_back(uint32_t(j));
        across.add(arc, true);
        const Solution s = solve_curves(hierarchy, across);
        expect_result(hierarchy, s, 2);
        EXPECT_NEAR(s.report.energy, std::log(R) / (2 * pi), 0.003);
        EXPECT_NEAR(energy(s.foliation), s.report.energy, 1e-12);
    }
}

TEST(Boundary, RectangleIsExact) {
    const double a = 3, b = 1.25;
    const size_t n = 24, m = 10;
    for (const double jitter : {0.0, 0.6}) {
        const TriMesh mesh = rectangle(n, m, a, b, jitter, 7);
        const Path corners = {0, uint32_t(m), uint32_t(n * (m + 1)), uint32_t(n * (m + 1) + m)};
        const Hierarchy hierarchy(mesh, with_marks(corners));
        ASSERT_TRUE(hierarchy);
        Path along, across; // from side to side
        for (size_t i = 0; i <= n; ++i) along.push_back(uint32_t(i * (m + 1) + m / 2));
        for (size_t j = 0; j <= m; ++j) across.push_back(uint32_t(n / 2 * (m + 1) + j));
        for (int way = 0; way < 2; ++way) {
            Curves curves;
            curves.add(way == 0 ? along : across, true);
            const Solution s = solve_curves(hierarchy, curves);
            expect_result(hierarchy, s, 1, 0, 4);
            EXPECT_NEAR(s.report.energy, way == 0 ? a / b : b / a, jitter == 0 ? 1e-8 : 1e-12); // the floor of weights
            const LevelMesh level = read_level(hierarchy, 0);
            for (size_t e = 0; e < level.edge_count; ++e) {
                const size_t c = way == 0 ? 1 : 0;
                const double d = level.positions[3 * level.edge_vertices[2 * e] + c]
                               - level.positions[3 * level.edge_vertices[2 * e + 1] + c];
                EXPECT_NEAR(s.values[e], std::fabs(d) / (way == 0 ? b : a), 1e-9);
            }
        }
    }
}

TEST(Boundary, RandomHolesWithLoopsOfTheLibrary) {
    size_t solved = 0;
    for (uint64_t seed = 1; seed <= 24; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const TriMesh base = seed % 3 == 0 ? pretzel(2, 2) : torus(24, 12, 3, 1, {true, 1, 0.3, seed});
        const TriMesh mesh = with_holes(base, 1 + seed % 5, 1 + seed % 3, seed);
        if (!is_sound(mesh)) continue; // bad luck
        const Hierarchy hierarchy(mesh);
        for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
            const auto set = loops_of(hierarchy, kind);
            ASSERT_TRUE(set);
            const Solution s = solve(hierarchy, *set);
            ASSERT_TRUE(s.foliation) << s.error.message;
            expect_result(hierarchy, s, boundary_count(mesh));
            const auto cylinders = make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* e) {
                return hmf_cylinders(s.foliation.get(), set.get(), nullptr, out, e);
            });
            ASSERT_TRUE(cylinders);
            ASSERT_EQ(cylinders->count, set->count);
            for (size_t c = 0; c < set->count; ++c) EXPECT_EQ(cylinders->list[c].height, 1); // exactly
            const int64_t genus = int64_t(hmf_hierarchy_describe(hierarchy.get())->genus), b = boundary_count(mesh);
            EXPECT_EQ(int64_t(set->count), kind == HMF_LOOPS_CUT ? genus + b : 3 * genus - 3 + 2 * b);
        }
        ++solved;
    }
    EXPECT_GE(solved, 12u);
}

// From a coarser level it is far from symmetric: made so or left, in a time that the size of the mesh bounds.
TEST(Boundary, InterpolatedFromACoarserLevel) {
    const TriMesh mesh = with_holes(torus(96, 48, 3, 1, {true, 1, 0.3, 3}), 3, 1, 4);
    const Hierarchy hierarchy(mesh);
    ASSERT_GE(hmf_hierarchy_describe(hierarchy.get())->level_count, 2u);
    const Solution s = solve(hierarchy, nullptr, solve_options(0, 0));
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    hmf_foliation *coarse = nullptr, *fine = nullptr;
    ASSERT_EQ(hmf_interpolate(s.foliation.get(), 1, nullptr, &coarse, nullptr), HMF_OK);
    const Foliation owned(coarse);
    ASSERT_EQ(hmf_interpolate(coarse, 0, nullptr, &fine, nullptr), HMF_OK);
    const Foliation back(fine);
    EXPECT_EQ(closedness_defect(read_level(hierarchy, 0), values_of(back)), "");
    EXPECT_EQ(fine->poles, 0u);
    hmf_foliation* raw = nullptr;
    ASSERT_EQ(hmf_relax(fine, nullptr, nullptr, &raw, nullptr), HMF_OK);
    const Foliation relaxed(raw);
    EXPECT_NEAR(hmf_foliation_report(raw)->energy, s.report.energy, 1e-9 * s.report.energy);
}

TEST(Boundary, RandomArcs) {
    size_t solved = 0, made = 0, refused = 0;
    for (uint64_t seed = 1; seed <= sample<uint64_t>(24, 8); ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Random random(seed);
        const TriMesh base =
            seed % 3 == 0 ? torus(24, 12, 3, 1, {true, 1, 0.3, seed}) : rectangle(24, 16, 3, 2, 0.6, seed);
        const TriMesh mesh = with_holes(base, 1 + seed % 4, 1 + seed % 2, seed);
        if (!is_sound(mesh)) continue;
        const Hierarchy hierarchy(mesh);
        const Curves curves = random_arcs(hierarchy, 1 + seed % 5, random);
        if (curves.arcs.empty()) continue;
        const Solution s = solve_curves(hierarchy, curves);
        expect_result(hierarchy, s, boundary_count(mesh));
        ++solved;
        const hmf_loop_set set = curves.view();
        const auto cylinders = make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* e) {
            return hmf_cylinders(s.foliation.get(), &set, nullptr, out, e);
        });
        ASSERT_TRUE(cylinders);
        for (size_t c = 0; c < cylinders->count; ++c)
            EXPECT_EQ(cylinders->list[c].height, curves.loops.weights[cylinders->list[c].loop]);
        for (const bool merge : {false, true}) {
            hmf_quad_mesh* raw = nullptr;
            hmf_error error{};
            const hmf_quad_options options = quad_options(800, merge, merge ? 10 : 0);
            const hmf_status status = hmf_quads(s.foliation.get(), &options, nullptr, &raw, &error);
            const Owned<hmf_quad_mesh> quads(raw);
            if (status == HMF_ERROR_UNSUPPORTED) { // a handle that no arc crosses
                ++refused;
                continue;
            }
            ASSERT_EQ(status, HMF_OK) << error.message;
            expect_quads_conform(mesh, *quads, int64_t(hmf_hierarchy_describe(hierarchy.get())->genus));
            ++made;
        }
    }
    EXPECT_GE(solved, sample(12u, 4u));
    EXPECT_GE(made, 3 * refused);
}

// Moves of single vertices get to the minimum of Newton's method as well.
TEST(Boundary, MethodsAgree) {
    const TriMesh mesh = with_holes(torus(24, 12, 3, 1, {true, 1, 0.3, 3}), 2, 2, 3);
    const Hierarchy hierarchy(mesh);
    const Solution newton = solve(hierarchy, nullptr, solve_options(0, 0));
    expect_result(hierarchy, newton, boundary_count(mesh));
    for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
        const Solution s = solve(hierarchy, nullptr, solve_options(method, 1e-9));
        ASSERT_EQ(s.status, HMF_OK) << s.error.message;
        EXPECT_EQ(closedness_defect(read_level(hierarchy, 0), s.values), "");
        EXPECT_EQ(s.report.poles, 0u);
        EXPECT_EQ(s.report.class_state, newton.report.class_state);
        EXPECT_EQ(s.report.index_sum, newton.report.index_sum);
        EXPECT_GE(s.report.energy, newton.report.energy * (1 - 1e-12));
        EXPECT_LE(s.report.energy, newton.report.energy * 1.001);
        expect_symmetric(s);
    }
}

// The loops of the library tell which of them go around a boundary, as one finds by cutting the double along all.
TEST(Boundary, LoopsRoundABoundaryAreKnown) {
    size_t round = 0, others = 0;
    const auto compare = [&](const Hierarchy& hierarchy) {
        ASSERT_TRUE(hierarchy);
        for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
            hmf_error error{};
            hmf::Memory memory(nullptr, nullptr, nullptr, 0);
            hmf::Call call(memory, &error, nullptr, nullptr);
            hmf::FoundLoops found;
            ASSERT_EQ(hmf::surface_loops(*hierarchy.get(), kind, call, found), HMF_OK) << error.message;
            const hmf_loop_set given = found.set();
            hmf::WeightedLoops known, searched;
            ASSERT_EQ(hmf::double_loops(*hierarchy.get(), given, found.is_round.data(), call, known), HMF_OK)
                << error.message;
            ASSERT_EQ(hmf::double_loops(*hierarchy.get(), given, nullptr, call, searched), HMF_OK) << error.message;
            ASSERT_EQ(known.factor.size(), searched.factor.size());
            for (size_t c = 0; c < known.factor.size(); ++c) {
                EXPECT_EQ(known.factor[c], searched.factor[c]) << c;
                ++(known.factor[c] == 2 ? round : others);
            }
        }
    };
    for (uint64_t seed = 1; seed <= 12; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const TriMesh base = seed % 3 == 0 ? pretzel(2, 2) : torus(24, 12, 3, 1, {true, 1, 0.3, seed});
        const TriMesh mesh = with_holes(base, 1 + seed % 5, 1 + seed % 3, seed);
        if (!is_sound(mesh)) continue;
        compare(Hierarchy(mesh));
        // The first vertex lies inside or on a boundary, the others somewhere.
        compare(Hierarchy(mesh, with_marks({0, 17, uint32_t(mesh.vertex_count() - 1)})));
    }
    compare(Hierarchy(annulus(40, 8, 3, 0.3, 1)));
    compare(Hierarchy(annulus(40, 8, 3, 0.3, 1), with_marks({0})));
    compare(Hierarchy(annulus(40, 8, 3, 0.3, 1), with_marks({0, 8, 13})));
    const TriMesh plate = rectangle(12, 10, 3, 2, 0.3, 1);
    compare(Hierarchy(plate, with_marks({0, 10, 11 * 12, 11 * 12 + 10})));
    compare(Hierarchy(plate, with_marks({25, 60, 93})));
    compare(Hierarchy(plate, with_marks({0, 25, 60, 93})));
    EXPECT_GT(round, 20u);
    EXPECT_GT(others, 20u);
}

} // namespace test_boundary
