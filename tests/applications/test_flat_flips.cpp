// Flips inside the flat parts of a surface before leaves are followed: better triangles, the same foliation.
#include "src/applications/quads/flat_flips.hpp"
#include "src/applications/quads/quad_shape.hpp"
#include "support/check_mesh.hpp"
#include "support/boundary.hpp"
#include "support/make_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace test_flat_flips {

namespace {

// What flips keep, and edges between coplanar triangles that are not Delaunay.
struct Shape {
    double area = 0, volume = 0, creases = 0;
    size_t not_delaunay = 0;
};

Shape shape_of(const hmf::Mesh& mesh, const double* position) {
    Shape shape;
    const auto at = [&](uint32_t v) { return hmf::point(position, v); };
    const auto length = [](const hmf::Point& p) { return std::sqrt(dot(p, p)); };
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        const hmf::Point a = at(mesh.origin[h]), b = at(mesh.target(h)), c = at(mesh.origin[mesh.prev(h)]),
                         n = cross(b - a, c - a);
        shape.area += length(n) / 6; // each triangle three times
        shape.volume += dot(n, a) / 18;
        if (h % 2) continue;
        const hmf::Point d = at(mesh.origin[mesh.prev(h ^ 1u)]), other = cross(d - a, b - a);
        if (dot(n, other) < (1 - 1e-9) * length(n) * length(other)) shape.creases += length(b - a);
        else if (std::atan2(length(n), dot(a - c, b - c)) + std::atan2(length(other), dot(a - d, b - d)) > M_PI + 1e-6)
            ++shape.not_delaunay;
    }
    return shape;
}

// A rectangle with a jittered grid, whose cells have the one diagonal or the other.
test::TriMesh with_other_diagonals(test::TriMesh mesh) {
    const auto turn = [&](uint32_t a, uint32_t b, uint32_t c) {
        const double *const p = &mesh.positions[3 * a], *const q = &mesh.positions[3 * b],
                            *const r = &mesh.positions[3 * c];
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    };
    std::mt19937 random(3);
    for (size_t t = 0; t + 1 < mesh.triangle_count(); t += 2) {
        uint32_t *const one = &mesh.triangles[3 * t], *const two = one + 3;
        for (size_t i = 0; i < 3; ++i)
            for (size_t j = 0; j < 3; ++j) {
                const uint32_t a = one[i], b = one[(i + 1) % 3], c = one[(i + 2) % 3], d = two[(j + 2) % 3];
                if (a != two[(j + 1) % 3] || b != two[j] || random() % 2 || !(turn(c, a, d) > 0)
                    || !(turn(d, b, c) > 0))
                    continue;
                const uint32_t now[6] = {c, a, d, d, b, c};
                std::copy(now, now + 6, one);
                i = j = 3;
            }
    }
    return mesh;
}

} // namespace

// A plate with two holes, sheared: long triangles on its faces.  The heights of its vertices are a foliation that is
// linear on each face, so every new edge has the difference of its ends.
TEST(FlatFlips, FacesBecomeDelaunay) {
    test::Triangles plate = test::plate(2, 1, 2);
    for (size_t v = 0; v < plate.vertex_count(); ++v) plate.positions[3 * v] += 5 * plate.positions[3 * v + 1];
    test::MadeMesh made(plate);
    const double* const position = made.positions.data();
    const auto height = [&](uint32_t v) {
        return std::llround(4 * (1009 * position[3 * v] + 31337 * position[3 * v + 1] + 777 * position[3 * v + 2]));
    };
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::Foliation f;
    f.mesh = made.mesh();
    std::vector<int64_t> value(f.mesh.edge_count);
    const auto difference = [&](uint32_t e) {
        return std::llabs(height(f.mesh.origin[2 * e]) - height(f.mesh.origin[2 * e + 1]));
    };
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) value[e] = difference(e);
    f.value = value.data();
    ASSERT_TRUE(f.allocate_scratch(f.mesh.vertex_count, memory));
    const Shape before = shape_of(f.mesh, position);
    EXPECT_GT(before.not_delaunay, 10u);
    ASSERT_EQ(hmf::flip_flat_parts(f, position, nullptr, call), HMF_OK);
    EXPECT_EQ(check(f.mesh), nullptr);
    const Shape after = shape_of(f.mesh, position);
    EXPECT_EQ(after.not_delaunay, 0u);
    EXPECT_NEAR(after.area, before.area, 1e-9 * before.area);
    EXPECT_NEAR(after.volume, before.volume, 1e-9 * before.area);
    EXPECT_NEAR(after.creases, before.creases, 1e-9 * before.creases);
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) EXPECT_EQ(value[e], difference(e)) << e;
}

// A flip across a bend would move the surface: a jittered torus, where many edges are not Delaunay, keeps its edges.
TEST(FlatFlips, CurvedSurfacesStay) {
    const test::TriMesh torus = test::torus(24, 12, 3, 1, {true, 2, 0.4, 5});
    test::Triangles triangles;
    triangles.positions = torus.positions;
    triangles.triangles = torus.triangles;
    test::MadeMesh made(triangles);
    const double* const position = made.positions.data();
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::Foliation f;
    f.mesh = made.mesh();
    std::vector<int64_t> value(f.mesh.edge_count);
    const auto height = [&](uint32_t v) { return std::llround(1009 * position[3 * v] + 31337 * position[3 * v + 1]); };
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e)
        value[e] = std::llabs(height(f.mesh.origin[2 * e]) - height(f.mesh.origin[2 * e + 1]));
    f.value = value.data();
    ASSERT_TRUE(f.allocate_scratch(f.mesh.vertex_count, memory));
    const std::vector<uint32_t> before(f.mesh.origin, f.mesh.origin + 2 * f.mesh.edge_count);
    ASSERT_EQ(hmf::flip_flat_parts(f, position, nullptr, call), HMF_OK);
    EXPECT_EQ(before, std::vector<uint32_t>(f.mesh.origin, f.mesh.origin + 2 * f.mesh.edge_count));
}

// Quads do not depend on the diagonals of a flat surface with boundary, which is solved on its double.
TEST(FlatFlips, QuadsDoNotDependOnDiagonals) {
    const size_t n = 12, m = 6;
    const test::TriMesh mesh = test::rectangle(n, m, 3, 1.25, 0.5, 7), other = with_other_diagonals(mesh);
    EXPECT_NE(mesh.triangles, other.triangles);
    hmf_quad_options options{};
    options.struct_size = sizeof options;
    options.count = 200;
    for (const uint64_t relax : {0, 40}) {
        options.relax = relax;
        test::Owned<hmf_quad_mesh> quads[2];
        for (const size_t k : {0, 1}) {
            const test::Path corners = {0, uint32_t(m), uint32_t(n * (m + 1)), uint32_t(n * (m + 1) + m)};
            const test::Hierarchy hierarchy(k == 0 ? mesh : other, test::with_marks(corners));
            test::Curves curves;
            test::Path along;
            for (size_t i = 0; i <= n; ++i) along.push_back(uint32_t(i * (m + 1) + m / 2));
            curves.add(along, true);
            quads[k] = test::quads_of(test::solve_curves(hierarchy, curves), options);
            ASSERT_TRUE(quads[k]);
            EXPECT_EQ(quads[k]->inverted_count, 0u);
        }
        ASSERT_EQ(quads[0]->vertex_count, quads[1]->vertex_count);
        for (size_t i = 0; i < 3 * quads[0]->vertex_count; ++i)
            EXPECT_NEAR(quads[0]->positions[i], quads[1]->positions[i], relax > 0 ? 1e-3 : 1e-5) << relax << ", " << i;
    }
}

} // namespace test_flat_flips
