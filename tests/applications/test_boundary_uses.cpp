// Surfaces with boundary: leaves, cylinders and quads.
#include "src/core/hierarchy/hierarchy.hpp"
#include "support/boundary.hpp"
#include "support/read_obj.hpp"
#include "support/sample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>

namespace test_boundary_uses {

using namespace test;

// Straight lines from side to side, and circles.
TEST(Boundary, LeavesEndAtTheBoundary) {
    const size_t n = 24, m = 10;
    const TriMesh mesh = rectangle(n, m, 3, 1.25, 0.5, 7);
    const Path corners = {0, uint32_t(m), uint32_t(n * (m + 1)), uint32_t(n * (m + 1) + m)};
    const Hierarchy hierarchy(mesh, with_marks(corners));
    Curves curves;
    Path along;
    for (size_t i = 0; i <= n; ++i) along.push_back(uint32_t(i * (m + 1) + m / 2));
    curves.add(along, true);
    const Solution s = solve_curves(hierarchy, curves);
    for (const int32_t way : {HMF_LEAVES_FOLIATION, HMF_LEAVES_CONJUGATE}) {
        const auto lines = levels(s, 0.125, way);
        ASSERT_TRUE(lines);
        EXPECT_GE(lines->line_count, 8u);
        for (size_t k = 0; k < lines->line_count; ++k) {
            const hmf_line& line = lines->lines[k];
            EXPECT_FALSE(line.closed);
            if (way == HMF_LEAVES_FOLIATION) {
                EXPECT_EQ(line.begin, HMF_END_BOUNDARY);
                EXPECT_EQ(line.end, HMF_END_BOUNDARY);
            }
            EXPECT_NEAR(line.length, way == HMF_LEAVES_FOLIATION ? 3 : 1.25, 1e-6);
            const size_t c = way == HMF_LEAVES_FOLIATION ? 1 : 0;
            for (uint64_t p = lines->offsets[k]; p < lines->offsets[k + 1]; ++p)
                EXPECT_NEAR(lines->points[3 * p + c], lines->points[3 * lines->offsets[k] + c], 1e-6);
        }
    }
    const hmf_loop_set set = curves.view();
    const auto cylinders = make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* error) {
        return hmf_cylinders(s.foliation.get(), &set, nullptr, out, error);
    });
    ASSERT_TRUE(cylinders);
    ASSERT_EQ(cylinders->count, 1u);
    EXPECT_EQ(cylinders->list[0].loop, 0u);
    EXPECT_EQ(cylinders->list[0].height, 1);
    EXPECT_NEAR(cylinders->list[0].circumference, 3 / 1.25, 1e-6);
    EXPECT_NEAR(cylinders->list[0].area, s.report.energy, 1e-6);
    // Its leaf in the middle is an arc of the same class.
    EXPECT_EQ(cylinders->leaves->arcs[0], 1);
    const Solution again = solve(hierarchy, *cylinders->leaves);
    ASSERT_TRUE(again.foliation) << again.error.message;
    EXPECT_NEAR(again.report.energy, s.report.energy, 1e-9);
}

TEST(Boundary, CylindersOfTheSurface) {
    const TriMesh mesh = with_holes(torus(32, 16, 3, 1, {true, 1, 0.3, 3}), 3, 2, 4);
    const Hierarchy hierarchy(mesh);
    const auto set = loops_of(hierarchy, HMF_LOOPS_PANTS);
    ASSERT_TRUE(set);
    const Solution s = solve(hierarchy, *set);
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    const auto cylinders = make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* error) {
        return hmf_cylinders(s.foliation.get(), set.get(), nullptr, out, error);
    });
    ASSERT_TRUE(cylinders);
    ASSERT_EQ(cylinders->count, set->count);
    std::set<uint32_t> loops;
    double area = 0, sum = 0;
    for (size_t c = 0; c < cylinders->count; ++c) {
        loops.insert(cylinders->list[c].loop);
        EXPECT_EQ(cylinders->list[c].height, 1);
        area += cylinders->list[c].area;
        sum += cylinders->list[c].height * cylinders->list[c].circumference;
    }
    EXPECT_EQ(loops.size(), set->count);
    EXPECT_NEAR(area / s.report.energy, 1, 1e-6);
    EXPECT_NEAR(sum / s.report.energy, 1, 1e-6);
    const Solution again = solve(hierarchy, *cylinders->leaves);
    ASSERT_TRUE(again.foliation) << again.error.message;
    EXPECT_NEAR(again.report.energy / s.report.energy, 1, 1e-9);
}

TEST(Boundary, QuadsOfARectangleAreAGrid) {
    const double a = 3, b = 1.25;
    const size_t n = 24, m = 10;
    const TriMesh mesh = rectangle(n, m, a, b, 0.6, 7);
    const Path corners = {0, uint32_t(m), uint32_t(n * (m + 1)), uint32_t(n * (m + 1) + m)};
    const Hierarchy hierarchy(mesh, with_marks(corners));
    ASSERT_TRUE(hierarchy);
    for (int way = 0; way < 2; ++way) {
        Curves curves;
        Path path;
        if (way == 0)
            for (size_t i = 0; i <= n; ++i) path.push_back(uint32_t(i * (m + 1) + m / 2));
        else
            for (size_t j = 0; j <= m; ++j) path.push_back(uint32_t(n / 2 * (m + 1) + j));
        curves.add(path, true);
        const Solution s = solve_curves(hierarchy, curves);
        for (const uint64_t relax : {0, 5}) {
            const auto quads = quads_of(s, quad_options(240, false, relax));
            ASSERT_TRUE(quads);
            expect_quads_conform(mesh, *quads, 0);
            EXPECT_EQ(quads->irregular_count, 4u); // the corners
            EXPECT_EQ(quads->inverted_count, 0u);
            EXPECT_NEAR(double(quads->quad_count), 240, 24);
            // Rows and columns at equal distances.
            std::set<int64_t> xs, ys;
            for (size_t v = 0; v < quads->vertex_count; ++v) {
                xs.insert(std::llround(quads->positions[3 * v] * 1e6));
                ys.insert(std::llround(quads->positions[3 * v + 1] * 1e6));
            }
            EXPECT_EQ((xs.size() - 1) * (ys.size() - 1), quads->quad_count);
            EXPECT_EQ(xs.size() * ys.size(), quads->vertex_count);
            for (const auto* lines : {&xs, &ys}) {
                const double step = double(*lines->rbegin() - *lines->begin()) / double(lines->size() - 1);
                double k = 0;
                for (const int64_t x : *lines) EXPECT_NEAR(double(x), step * k++, 2);
            }
        }
    }
}

TEST(Boundary, QuadsOfAnAnnulusBothWays) {
    const TriMesh mesh = annulus(40, 12, 3, 0.5, 5);
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    for (int way = 0; way < 2; ++way) {
        Curves curves;
        Path path;
        for (size_t k = 0; k < (way == 0 ? 40u : 13u); ++k) path.push_back(uint32_t(way == 0 ? k * 13 : k));
        curves.add(path, way == 1);
        const Solution s = solve_curves(hierarchy, curves);
        ASSERT_EQ(s.status, HMF_OK);
        for (const uint64_t count : {60u, 100u, 150u, 400u, 1000u, 2000u}) {
            const auto quads = quads_of(s, quad_options(count));
            ASSERT_TRUE(quads);
            expect_quads_conform(mesh, *quads, 0);
            EXPECT_EQ(quads->irregular_count, 0u);
            EXPECT_EQ(quads->inverted_count, 0u);
            // The rows are as many as that asks for; around the boundary at least as many as the rings need.
            EXPECT_NEAR(double(quads->quad_count), double(count), (way == 0 ? 0.1 : 0.015) * double(count));
        }
    }
}

TEST(Boundary, QuadsOfSurfacesWithHoles) {
    for (uint64_t seed = 1; seed <= sample<uint64_t>(12, 4); ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const TriMesh base = seed % 3 == 0 ? pretzel(2, 2) : torus(24, 12, 3, 1, {true, 1, 0.3, seed});
        const TriMesh mesh = with_holes(base, 1 + seed % 5, 1 + seed % 3, seed);
        if (!is_sound(mesh)) continue; // bad luck
        const Hierarchy hierarchy(mesh);
        ASSERT_TRUE(hierarchy);
        for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
            const auto set = loops_of(hierarchy, kind);
            ASSERT_TRUE(set);
            const Solution s = solve(hierarchy, *set);
            ASSERT_TRUE(s.foliation) << s.error.message;
            for (const bool merge : {false, true}) {
                const auto quads = quads_of(s, quad_options(1500, merge, merge ? 10 : 0));
                ASSERT_TRUE(quads);
                expect_quads_conform(mesh, *quads, int64_t(hmf_hierarchy_describe(hierarchy.get())->genus));
            }
        }
    }
}

// A torus of acute triangles: rows of n vertices, each shifted by half a step against the one before; m is even.
static TriMesh acute_torus(size_t n, size_t m) {
    TriMesh mesh;
    const double turn = 6.283185307179586;
    for (size_t j = 0; j < m; ++j)
        for (size_t i = 0; i < n; ++i) {
            const double a = turn * (double(i) + 0.5 * double(j % 2)) / double(n), b = turn * double(j) / double(m);
            const double r = 3 + std::cos(b);
            mesh.positions.insert(mesh.positions.end(), {r * std::cos(a), r * std::sin(a), std::sin(b)});
        }
    const auto at = [&](size_t i, size_t j) { return uint32_t(j % m * n + i % n); };
    for (size_t j = 0; j < m; ++j)
        for (size_t i = 0; i < n; ++i) {
            const size_t k = i + j % 2; // above, to the right
            mesh.triangles.insert(mesh.triangles.end(), {at(i, j), at(i + 1, j), at(k, j + 1)});
            mesh.triangles.insert(mesh.triangles.end(), {at(i, j), at(k, j + 1), at(k + n - 1, j + 1)});
        }
    mesh.genus = 1;
    return mesh;
}

// Where a boundary is a leaf, its edges are zero in the double, and u goes on from the front to the back.
TEST(Boundary, TheMapIsAsLargeAsTheEnergy) {
    size_t as_given = 0;
    for (uint64_t seed = 1; seed <= 24; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const TriMesh mesh = with_holes(acute_torus(64 + 4 * (seed % 5), 24), 1 + seed % 4, 1 + seed % 3, seed);
        if (!is_sound(mesh)) continue;
        const Hierarchy hierarchy(mesh);
        const auto set = loops_of(hierarchy, HMF_LOOPS_CUT);
        ASSERT_TRUE(set);
        const Solution s = solve(hierarchy, *set);
        ASSERT_EQ(s.status, HMF_OK) << s.error.message;
        const auto map = make<hmf_parameterization>([&](hmf_parameterization** out, hmf_error* error) {
            return hmf_parameterize(s.foliation.get(), nullptr, nullptr, out, error);
        });
        ASSERT_TRUE(map);
        EXPECT_NEAR(map->area / s.report.energy, 1, 0.01);
        EXPECT_LT(map->dilatation_median, 1.3);
        as_given += hierarchy.get()->intrinsic_flip_count == 0; // then the map is of the symmetric values themselves
    }
    EXPECT_GE(as_given, 12u);
}

// A square plate with a round hole: n round, m from the hole outwards, which are the last of each ray.
static TriMesh square_with_hole(size_t n, size_t m) {
    TriMesh mesh;
    for (size_t i = 0; i < n; ++i) {
        const double a = 6.283185307179586 * (double(i) / double(n) + 0.125);
        const double c = std::cos(a), s = std::sin(a), outer = 1 / std::max(std::fabs(c), std::fabs(s));
        for (size_t j = 0; j <= m; ++j) {
            const double r = 0.4 + (outer - 0.4) * double(j) / double(m);
            mesh.positions.insert(mesh.positions.end(), {r * c, r * s, 0});
        }
    }
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < m; ++j) {
            const uint32_t a = uint32_t(i * (m + 1) + j), b = uint32_t((i + 1) % n * (m + 1) + j);
            mesh.triangles.insert(mesh.triangles.end(), {a, a + 1, b + 1, a, b + 1, b});
        }
    mesh.genus = 0;
    return mesh;
}

// Corners that nobody marks are vertices of the quads all the same.
TEST(Boundary, QuadsTakeTheCornersOfABoundary) {
    const size_t n = 96, m = 16;
    const TriMesh mesh = square_with_hole(n, m);
    const SolvedSurface solved(mesh);
    ASSERT_EQ(solved.solution.status, HMF_OK) << solved.solution.error.message;
    for (const uint64_t count : {200, 400, 1500, 6000}) {
        SCOPED_TRACE(testing::Message() << count << " quads");
        const auto quads = quads_of(solved.solution, quad_options(count, true, 40));
        ASSERT_TRUE(quads);
        expect_quads_conform(mesh, *quads, 0);
        EXPECT_EQ(quads->inverted_count, 0u);
        EXPECT_EQ(quads->irregular_count, 0u);
        for (size_t side = 0; side < 4; ++side) {
            const double* corner = &mesh.positions[3 * (side * n / 4 * (m + 1) + m)];
            bool is_vertex = false;
            for (size_t v = 0; v < quads->vertex_count; ++v)
                is_vertex = is_vertex || std::equal(corner, corner + 3, quads->positions + 3 * v);
            EXPECT_TRUE(is_vertex) << corner[0] << " " << corner[1];
        }
    }
}

// Columns go straight across rows, also where the path across a cylinder runs along thin triangles at a boundary: a row
// was turned by half its length there. With the even design, whose loops leave one of three boundaries without rows.
TEST(Boundary, RowsAreNotTurnedAgainstEachOther) {
    const char* folder = std::getenv("HMF_SURFACES");
    TriMesh mesh;
    if (!folder || !read_obj(std::string(folder) + "/aqua-center_9.7k.obj", mesh))
        GTEST_SKIP() << "skipped: set HMF_SURFACES to a folder with aqua-center_9.7k.obj";
    hmf_design_options options{};
    options.struct_size = sizeof options;
    options.no_poles = 1;
    const auto design = make<hmf_design>([&](hmf_design** out, hmf_error* error) {
        return hmf_even_design(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                               &options, nullptr, out, error);
    });
    ASSERT_TRUE(design);
    const Hierarchy hierarchy(mesh);
    const Solution s = solve(hierarchy, *design->loops);
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    const auto quads = quads_of(s, quad_options(5000, true));
    ASSERT_TRUE(quads);
    EXPECT_LE(quads->inverted_count, 20u);
}

} // namespace test_boundary_uses
