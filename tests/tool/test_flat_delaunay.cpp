// Flips inside the flat parts of a mesh (bindings/readers): better triangles, the same surface.
#include <flat_delaunay.hpp>
#include <refine.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <utility>

#include <Eigen/Geometry>

#include "support/surface.hpp"

namespace test_flat_delaunay {

using Eigen::Vector3d;
using readers::TriangleMesh;

namespace {

Vector3d at(const TriangleMesh& mesh, uint32_t v) { return Vector3d(&mesh.positions[3 * size_t{v}]); }

// Length of the edges between two triangles that are not coplanar or of one triangle, area and volume: what flips keep.
struct Shape {
    double area = 0, volume = 0, creases = 0, boundary = 0;
    size_t not_delaunay = 0; // edges between coplanar triangles
};

Shape shape_of(const TriangleMesh& mesh) {
    Shape shape;
    std::map<std::pair<uint32_t, uint32_t>, std::vector<std::pair<Vector3d, double>>> edges; // normal, opposite angle
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const uint32_t* const v = &mesh.triangles[3 * t];
        const Vector3d a = at(mesh, v[0]), b = at(mesh, v[1]), c = at(mesh, v[2]), n = (b - a).cross(c - a);
        shape.area += n.norm() / 2;
        shape.volume += n.dot(a) / 6;
        for (size_t s = 0; s < 3; ++s) {
            const Vector3d o = at(mesh, v[(s + 2) % 3]), p = at(mesh, v[s]) - o, q = at(mesh, v[(s + 1) % 3]) - o;
            edges[std::minmax(v[s], v[(s + 1) % 3])].push_back(
                {n.normalized(), std::atan2(p.cross(q).norm(), p.dot(q))});
        }
    }
    for (const auto& [edge, sides] : edges) {
        const double length = (at(mesh, edge.first) - at(mesh, edge.second)).norm();
        if (sides.size() == 1) shape.boundary += length;
        else if (sides[0].first.dot(sides[1].first) < 1 - 1e-9) shape.creases += length;
        else if (sides[0].second + sides[1].second > M_PI + 1e-6) ++shape.not_delaunay;
    }
    return shape;
}

void expect_same_surface(const TriangleMesh& mesh, const TriangleMesh& before) {
    EXPECT_EQ(mesh.positions, before.positions);
    EXPECT_EQ(mesh.triangle_count(), before.triangle_count());
    const Shape a = shape_of(mesh), b = shape_of(before);
    EXPECT_NEAR(a.area, b.area, 1e-9 * b.area);
    EXPECT_NEAR(a.volume, b.volume, 1e-9 * b.area);
    EXPECT_NEAR(a.creases, b.creases, 1e-9 * (1 + b.creases));
    EXPECT_NEAR(a.boundary, b.boundary, 1e-9 * (1 + b.boundary));
}

// A flat polygon on a bent curve, as a fan from one corner: what ear clipping gives at worst.
TriangleMesh fan(uint32_t corners) {
    TriangleMesh mesh;
    for (uint32_t k = 0; k < corners; ++k) {
        const double angle = 2 * M_PI * k / corners;
        mesh.positions.insert(mesh.positions.end(), {3 * std::cos(angle), std::sin(angle), 0.5 * std::cos(angle)});
    }
    for (uint32_t k = 1; k + 1 < corners; ++k) mesh.triangles.insert(mesh.triangles.end(), {0, k, k + 1});
    return mesh;
}

// A plate with two holes, sheared: flat parts and creases as before, long triangles.
TriangleMesh long_triangles() {
    const test::TriMesh plate = test::plate(2);
    TriangleMesh mesh{plate.positions, plate.triangles};
    readers::refine(mesh, 3 * mesh.triangle_count());
    for (size_t v = 0; v < mesh.vertex_count(); ++v) mesh.positions[3 * v] += 5 * mesh.positions[3 * v + 1];
    return mesh;
}

} // namespace

TEST(FlatDelaunay, AFanBecomesDelaunay) {
    for (const uint32_t corners : {5u, 30u, 200u}) {
        TriangleMesh mesh = fan(corners);
        const TriangleMesh before = mesh;
        EXPECT_GT(shape_of(mesh).not_delaunay, 0u);
        EXPECT_GT(readers::make_flat_parts_delaunay(mesh), 0u);
        EXPECT_EQ(shape_of(mesh).not_delaunay, 0u);
        expect_same_surface(mesh, before);
        EXPECT_EQ(readers::make_flat_parts_delaunay(mesh), 0u); // nothing is left to do
    }
}

// Creases and holes stay where they are, and the surface stays a manifold.
TEST(FlatDelaunay, KeepsCreases) {
    TriangleMesh mesh = long_triangles();
    const TriangleMesh before = mesh;
    EXPECT_GT(shape_of(mesh).not_delaunay, 0u);
    readers::make_flat_parts_delaunay(mesh);
    expect_same_surface(mesh, before);
    EXPECT_EQ(shape_of(mesh).not_delaunay, 0u);
    EXPECT_EQ(test::mesh_defect({mesh.positions, mesh.triangles, 2}), "");
}

// A bent surface has no flat parts.
TEST(FlatDelaunay, LeavesCurvedSurfacesAlone) {
    const test::TriMesh torus = test::torus(12, 9, 3, 1);
    TriangleMesh mesh{torus.positions, torus.triangles};
    std::mt19937 random(1);
    for (double& x : mesh.positions) x += std::uniform_real_distribution<>(-0.05, 0.05)(random);
    const TriangleMesh before = mesh;
    EXPECT_EQ(readers::make_flat_parts_delaunay(mesh), 0u);
    EXPECT_EQ(mesh.triangles, before.triangles);
}

// Edges of three triangles, of a boundary, folded ones and triangles without area stay.
TEST(FlatDelaunay, LeavesWhatIsNoFlatSurface) {
    TriangleMesh nothing;
    EXPECT_EQ(readers::make_flat_parts_delaunay(nothing), 0u);
    const std::vector<double> kite = {0, 0, 0, 4, 0, 0, 2, .5, 0, 2, -.5, 0, 2, 0, 1};
    TriangleMesh flat{kite, {0, 1, 2, 1, 0, 3}}, sheets{kite, {0, 1, 2, 1, 0, 3, 0, 1, 4}},
        folded{{0, 0, 0, 4, 0, 0, 2, .5, 0, 2, .25, 0}, {0, 1, 2, 1, 0, 3}},
        line{{0, 0, 0, 1, 0, 0, 2, 0, 0}, {0, 1, 2}};
    EXPECT_EQ(readers::make_flat_parts_delaunay(flat), 1u);
    EXPECT_EQ(readers::make_flat_parts_delaunay(sheets), 0u);
    EXPECT_EQ(readers::make_flat_parts_delaunay(folded), 0u);
    EXPECT_EQ(readers::make_flat_parts_delaunay(line), 0u);
}

} // namespace test_flat_delaunay
