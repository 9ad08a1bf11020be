// Surfaces with boundary: solutions on the parts of a surface that is cut along a leaf.
#include "support/boundary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace test_boundary_cuts {

using namespace test;

namespace {

// Two rectangles a x b, one on the other, glued along their sides: flat, with four cone points at the corners.
TriMesh flat_pillow(size_t n, size_t m, double a, double b, uint64_t seed) {
    TriMesh mesh = rectangle(n, m, a, b, 0.6, seed);
    const size_t count = mesh.triangles.size() / 3;
    const uint32_t vertices = uint32_t(mesh.vertex_count());
    std::vector<uint32_t> behind(vertices);
    uint32_t next = vertices;
    for (uint32_t v = 0; v < vertices; ++v) {
        const size_t i = v / (m + 1), j = v % (m + 1);
        behind[v] = i == 0 || j == 0 || i == n || j == m ? v : next++;
        if (behind[v] != v)
            for (size_t c = 0; c < 3; ++c) mesh.positions.push_back(mesh.positions[3 * size_t{v} + c]);
    }
    // No triangle with two sides on the edge of the rectangle: at the corners the diagonal ends there.
    const auto corner = [&](size_t i, size_t j) { return uint32_t(i * (m + 1) + j); };
    for (size_t t = 0; t + 1 < count; t += 2) {
        const size_t cell = t / 2, i = cell / m, j = cell % m;
        const uint32_t p = corner(i, j), q = corner(i, j + 1), r = corner(i + 1, j), s = corner(i + 1, j + 1);
        const bool rising = (i == 0 && j == 0) || (i == n - 1 && j == m - 1);
        const bool falling = (i == 0 && j == m - 1) || (i == n - 1 && j == 0);
        if (!rising && !falling) continue;
        const Path cut = rising ? Path{p, r, s, p, s, q} : Path{p, r, q, r, s, q};
        std::copy(cut.begin(), cut.end(), mesh.triangles.begin() + long(3 * t));
    }
    for (size_t t = 0; t < count; ++t) {
        const uint32_t* c = &mesh.triangles[3 * t];
        const Path back{behind[c[0]], behind[c[2]], behind[c[1]]};
        mesh.triangles.insert(mesh.triangles.end(), back.begin(), back.end());
    }
    return mesh;
}

// The mesh cut open along a closed leaf that crosses no edge twice; rims: the new vertices on either side.
TriMesh cut_along(const TriMesh& mesh, const LevelMesh& level, const hmf_lines& lines, size_t line, bool& simple) {
    TriMesh out = mesh;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> at; // of an edge and one of its ends
    simple = lines.lines[line].closed == 1;
    for (uint64_t p = lines.offsets[line]; p < lines.offsets[line + 1]; ++p) {
        const uint32_t e = lines.point_edges[p];
        for (size_t k = 0; k < 2; ++k) {
            const auto added = at.insert({{e, level.edge_vertices[2 * e + k]}, uint32_t(out.vertex_count())});
            simple = simple && added.second;
            for (size_t c = 0; c < 3; ++c) out.positions.push_back(lines.points[3 * p + c]);
        }
    }
    out.triangles.clear();
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const uint32_t *v = &mesh.triangles[3 * t], *e = &level.triangle_edges[3 * t];
        size_t tip = 3; // the corner that is cut off
        for (size_t s = 0; s < 3; ++s)
            if (at.count({e[s], v[s]}) && at.count({e[(s + 2) % 3], v[s]})) tip = s;
        if (tip == 3) {
            out.triangles.insert(out.triangles.end(), v, v + 3);
            continue;
        }
        const uint32_t a = v[tip], b = v[(tip + 1) % 3], c = v[(tip + 2) % 3], ab = e[tip], ca = e[(tip + 2) % 3];
        const Path parts{a, at.at({ab, a}), at.at({ca, a}), at.at({ab, b}), b, c, at.at({ab, b}), c, at.at({ca, c})};
        out.triangles.insert(out.triangles.end(), parts.begin(), parts.end());
    }
    return out;
}

// The part that a vertex belongs to; number: of each of its vertices in the mesh.
TriMesh part_of(const TriMesh& mesh, uint32_t vertex, Path& number) {
    std::vector<char> inside(mesh.vertex_count(), 0);
    inside[vertex] = 1;
    for (bool grown = true; grown;) {
        grown = false;
        for (size_t t = 0; t < mesh.triangle_count(); ++t) {
            const uint32_t* v = &mesh.triangles[3 * t];
            const int n = inside[v[0]] + inside[v[1]] + inside[v[2]];
            if (n == 0 || n == 3) continue;
            inside[v[0]] = inside[v[1]] = inside[v[2]] = 1;
            grown = true;
        }
    }
    TriMesh out;
    std::vector<uint32_t> to(mesh.vertex_count(), HMF_NONE);
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (size_t s = 0; s < 3 && inside[mesh.triangles[3 * t]]; ++s) {
            const uint32_t v = mesh.triangles[3 * t + s];
            if (to[v] == HMF_NONE) {
                to[v] = uint32_t(number.size());
                number.push_back(v);
                for (size_t c = 0; c < 3; ++c) out.positions.push_back(mesh.positions[3 * size_t{v} + c]);
            }
            out.triangles.push_back(to[v]);
        }
    return out;
}

// One of the boundary curves.
Path boundary_curve(const TriMesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> sides;
    for (size_t c = 0; c < mesh.triangles.size(); ++c)
        ++sides[{mesh.triangles[c], mesh.triangles[c - c % 3 + (c + 1) % 3]}];
    std::map<uint32_t, uint32_t> next;
    for (const auto& s : sides)
        if (!sides.count({s.first.second, s.first.first})) next[s.first.first] = s.first.second;
    Path curve;
    for (uint32_t v = next.begin()->first; curve.empty() || v != curve.front(); v = next.at(v)) curve.push_back(v);
    return curve;
}

} // namespace

// Cut along a leaf of its solution, a flat surface falls into parts whose solutions are its own.
TEST(Boundary, CutAlongALeafIsExactOnAPillow) {
    const double a = 3, b = 1.25;
    const size_t n = 20, m = 9;
    const TriMesh mesh = flat_pillow(n, m, a, b, 3);
    const Path corners = {0, uint32_t(m), uint32_t(n * (m + 1)), uint32_t(n * (m + 1) + m)};
    const Hierarchy hierarchy(mesh, with_marks(corners));
    ASSERT_TRUE(hierarchy);
    const LevelMesh level = read_level(hierarchy, 0);
    Curves curves; // around the rectangle, half-way up: there and back
    Path round;
    for (size_t i = 0; i <= n; ++i) round.push_back(uint32_t(i * (m + 1) + m / 2));
    for (size_t i = n - 1; i >= 1; --i)
        for (uint32_t v = uint32_t((n + 1) * (m + 1)); v < mesh.vertex_count(); ++v)
            if (std::equal(&mesh.positions[3 * size_t{v}], &mesh.positions[3 * size_t{v}] + 3,
                           &mesh.positions[3 * (i * (m + 1) + m / 2)]))
                round.push_back(v);
    curves.add(round, false);
    const Solution s = solve(hierarchy, curves.loops.view());
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    const double whole = s.report.energy;
    ASSERT_NEAR(whole, 2 * a / b, 1e-9);
    const auto lines = levels(s, 1.0 / 3);
    ASSERT_TRUE(lines);
    ASSERT_EQ(lines->line_count, 3u);
    for (size_t line = 0; line < 3; ++line) {
        bool simple = false;
        const TriMesh open = cut_along(mesh, level, *lines, line, simple);
        ASSERT_TRUE(simple);
        double sum = 0, heights = 0;
        for (const uint32_t from : {corners[0], corners[1]}) {
            Path number, marks;
            const TriMesh part = part_of(open, from, number);
            for (size_t v = 0; v < number.size(); ++v)
                if (std::count(corners.begin(), corners.end(), number[v])) marks.push_back(uint32_t(v));
            ASSERT_EQ(marks.size(), 2u);
            const Hierarchy half(part, with_marks(marks));
            ASSERT_TRUE(half);
            EXPECT_EQ(hmf_hierarchy_describe(half.get())->boundary_count, 1u);
            const Path rim = boundary_curve(part);
            double height =
                std::fabs(part.positions[3 * size_t{marks[0]} + 1] - part.positions[3 * size_t{rim[0]} + 1]) / b;
            Curves along;
            along.add(rim, false, height);
            const Solution found = solve_curves(half, along);
            expect_result(half, found, 1, 2, 0);
            EXPECT_NEAR(found.report.energy, height * whole, 1e-8);
            sum += found.report.energy;
            heights += height;
        }
        EXPECT_NEAR(heights, 1, 1e-9);
        EXPECT_NEAR(sum, whole, 1e-8);
    }
}

// On a curved one up to discretization.
TEST(Boundary, CutAlongALeafOfATorus) {
    const TriMesh mesh = torus(48, 24, 3, 1, {true, 1, 0.2, 5});
    const Hierarchy hierarchy(mesh);
    const LevelMesh level = read_level(hierarchy, 0);
    Solution s = solve(hierarchy, nullptr, solve_options(0, 0));
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    const auto lines = levels(s, 1);
    ASSERT_TRUE(lines);
    bool simple = false;
    TriMesh open = cut_along(mesh, level, *lines, 0, simple);
    open.genus = 0;
    ASSERT_TRUE(simple);
    const Hierarchy annulus(open);
    ASSERT_TRUE(annulus);
    EXPECT_EQ(hmf_hierarchy_describe(annulus.get())->boundary_count, 2u);
    Curves along;
    along.add(boundary_curve(open), false);
    const Solution found = solve_curves(annulus, along);
    expect_result(annulus, found, 2);
    EXPECT_NEAR(found.report.energy, s.report.energy, 0.01 * s.report.energy);
}

} // namespace test_boundary_cuts
