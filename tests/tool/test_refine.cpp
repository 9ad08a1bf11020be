// Meshes of few triangles cut into more (bindings/readers): the surface stays as it is.
#include <refine.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "support/surface.hpp"

namespace test_refine {

using readers::TriangleMesh;

namespace {

TriangleMesh plain(const test::TriMesh& mesh) { return {mesh.positions, mesh.triangles}; }

double length(const TriangleMesh& mesh, uint32_t v, uint32_t w) {
    double square = 0;
    for (size_t k = 0; k < 3; ++k) square += std::pow(mesh.positions[3 * v + k] - mesh.positions[3 * w + k], 2);
    return std::sqrt(square);
}

struct Shape {
    double area = 0, volume = 0, longest = 0, shortest = HUGE_VAL;
    std::map<size_t, double> along; // length of the edges with so many triangles
};

Shape shape_of(const TriangleMesh& mesh) {
    Shape shape;
    std::map<std::pair<uint32_t, uint32_t>, size_t> edges;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const uint32_t* const v = &mesh.triangles[3 * t];
        const double* x[3];
        for (size_t s = 0; s < 3; ++s) {
            x[s] = &mesh.positions[3 * v[s]];
            ++edges[std::minmax(v[s], v[(s + 1) % 3])];
        }
        double normal[3], square = 0, height = 0;
        for (size_t k = 0; k < 3; ++k) {
            const size_t i = (k + 1) % 3, j = (k + 2) % 3;
            normal[k] = (x[1][i] - x[0][i]) * (x[2][j] - x[0][j]) - (x[1][j] - x[0][j]) * (x[2][i] - x[0][i]);
            square += normal[k] * normal[k];
            height += normal[k] * x[0][k];
        }
        shape.area += std::sqrt(square) / 2;
        shape.volume += height / 6;
    }
    for (const auto& [edge, triangles] : edges) {
        const double l = length(mesh, edge.first, edge.second);
        shape.along[triangles] += l;
        shape.longest = std::max(shape.longest, l);
        shape.shortest = std::min(shape.shortest, l);
    }
    return shape;
}

// Refined to so many triangles, with what has to stay.
TriangleMesh refined(const TriangleMesh& mesh, size_t triangles) {
    TriangleMesh fine = mesh;
    readers::refine(fine, triangles);
    EXPECT_GE(fine.triangle_count(), triangles);
    EXPECT_LE(fine.triangle_count(), triangles + 3);
    for (size_t i = 0; i < mesh.positions.size(); ++i) EXPECT_EQ(fine.positions[i], mesh.positions[i]);
    const Shape before = shape_of(mesh), after = shape_of(fine);
    EXPECT_NEAR(after.area, before.area, 1e-12 * before.area);
    EXPECT_NEAR(after.volume, before.volume, 1e-12 * before.area);
    return fine;
}

} // namespace

TEST(Refine, KeepsASurface) {
    const test::TriMesh plate = test::plate(2);
    const TriangleMesh fine = refined(plain(plate), 5000);
    EXPECT_EQ(test::mesh_defect({fine.positions, fine.triangles, 2}), "");
    // Longest edges first: none is left that is long beside the others.
    const Shape shape = shape_of(fine);
    EXPECT_LT(shape.longest, 4 * shape.shortest);
}

// Two triangles, and three at one edge: what was an edge of one or of three triangles still is.
TEST(Refine, BoundaryAndSheets) {
    const TriangleMesh square{{0, 0, 0, 3, 0, 0, 3, 1, 0, 0, 1, 0}, {0, 1, 2, 0, 2, 3}};
    const TriangleMesh fine = refined(square, 300);
    EXPECT_NEAR(shape_of(fine).along[1], 8, 1e-12);
    EXPECT_EQ(shape_of(fine).along.size(), 2u);
    const TriangleMesh sheets{{0, 0, 0, 0, 0, 5, 1, 0, 2, 0, 1, 2, -1, 0, 2}, {0, 1, 2, 0, 1, 3, 0, 1, 4}};
    EXPECT_NEAR(shape_of(refined(sheets, 100)).along[3], 5, 1e-12);
}

TEST(Refine, LeavesOthersAlone) {
    TriangleMesh mesh = plain(test::plate(2));
    const TriangleMesh before = mesh;
    readers::refine(mesh, mesh.triangle_count());
    EXPECT_EQ(mesh.positions, before.positions);
    EXPECT_EQ(mesh.triangles, before.triangles);
    TriangleMesh nothing;
    readers::refine(nothing, 10);
    EXPECT_TRUE(nothing.triangles.empty());
    TriangleMesh pillow{{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2, 0, 2, 1}};
    readers::refine(pillow, 10);
    EXPECT_EQ(pillow.triangle_count(), 2u);
    // A triangle that names a vertex twice, or has no area, is cut like any other.
    TriangleMesh flat{{0, 0, 0, 1, 0, 0, 2, 0, 0}, {0, 1, 2, 0, 0, 2}};
    readers::refine(flat, 40);
    EXPECT_GE(flat.triangle_count(), 40u);
}

} // namespace test_refine
