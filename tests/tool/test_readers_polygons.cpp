// Faces with many corners (bindings/readers/triangulate.cpp): the triangles of a polygon cover it once, whatever its
// shape and its place in space.
//
// The oracle does not triangulate: a polygon of n corners has n - 2 triangles with positive areas that add up to its
// own, and each side of them is a side of the polygon or belongs to two triangles.
#include <mesh_formats.hpp>

#include <cmath>
#include <map>
#include <set>

#include "support/polygons.hpp"

namespace test_readers_polygons {

using namespace test;

namespace {

double area_of(const Plane& p) {
    double sum = 0;
    for (size_t i = 0; i < p.size(); ++i) {
        const auto &a = p[i], &b = p[(i + 1) % p.size()];
        sum += (a[0] - p[0][0]) * (b[1] - p[0][1]) - (a[1] - p[0][1]) * (b[0] - p[0][0]);
    }
    return sum / 2;
}

void expect_cover(const Plane& p, double least_area = 0) {
    const double whole = area_of(p);
    for (int turned = 0; turned < 4; ++turned) {
        SCOPED_TRACE(turned);
        const TriangleMesh mesh = read_face(p, turned);
        ASSERT_EQ(mesh.triangle_count(), p.size() - 2);
        double sum = 0;
        std::map<std::pair<uint32_t, uint32_t>, int> sides;
        for (size_t t = 0; t < mesh.triangle_count(); ++t) {
            const uint32_t* const c = &mesh.triangles[3 * t];
            const double area = area_of({p[c[0]], p[c[1]], p[c[2]]});
            // A mirrored place does not turn the face: its corners have the same order.
            EXPECT_GT(area, least_area) << c[0] << " " << c[1] << " " << c[2];
            sum += area;
            for (int s = 0; s < 3; ++s) ++sides[{c[s], c[(s + 1) % 3]}];
        }
        EXPECT_NEAR(sum, whole, 1e-9 * whole);
        const uint32_t n = static_cast<uint32_t>(p.size());
        for (const auto& [side, times] : sides) {
            EXPECT_EQ(times, 1);
            const bool of_polygon = side.second == (side.first + 1) % n;
            EXPECT_EQ(sides.count({side.second, side.first}), of_polygon ? 0u : 1u) << side.first << " " << side.second;
        }
    }
}

Plane rotated(const Plane& p, size_t by) {
    Plane q = p;
    std::rotate(q.begin(), q.begin() + static_cast<std::ptrdiff_t>(by), q.end());
    return q;
}

} // namespace

TEST(Polygons, SmallConvexOnesAreFans) {
    for (size_t n = 4; n <= 8; ++n) {
        std::vector<uint32_t> fan;
        for (uint32_t i = 2; i < n; ++i) fan.insert(fan.end(), {0, i - 1, i});
        for (int turned = 0; turned < 4; ++turned) EXPECT_EQ(read_face(regular(n), turned).triangles, fan);
    }
}

TEST(Polygons, Concave) {
    const Plane dart = {{0, 0}, {4, 1}, {1, 1}, {1, 4}}, bracket = {{4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}, {0, 0}};
    for (const Plane& p : {dart, bracket})
        for (size_t by = 0; by < p.size(); ++by) expect_cover(rotated(p, by));
    test::Random random(5);
    for (int round = 0; round < 200; ++round) expect_cover(star(4 + random.bits() % 60, random));
    for (const size_t n : {3, 10, 100}) {
        expect_cover(comb(n));
        expect_cover(spiral(n));
    }
}

// Faces whose sides have corners where smaller faces meet them.
TEST(Polygons, CornersOnSides) {
    const Plane triangle = {{0, 0}, {8, 0}, {0, 8}}, square = {{0, 0}, {8, 0}, {8, 8}, {0, 8}};
    const Plane bracket = {{32, 0}, {32, 8}, {8, 8}, {8, 32}, {0, 32}, {0, 0}};
    const Plane plus = {{8, 0},   {16, 0}, {16, 8}, {24, 8}, {24, 16}, {16, 16},
                        {16, 24}, {8, 24}, {8, 16}, {0, 16}, {0, 8},   {8, 8}};
    for (const Plane& p : {triangle, square, bracket, plus, comb(5)})
        for (const int halvings : {1, 2, 4})
            for (size_t by = 0; by < 5; ++by) expect_cover(rotated(with_flat_corners(p, halvings), by), 1e-3);
    // On one side only: all diagonals leave the corner opposite to it.
    expect_cover({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {0, 4}});
    expect_cover({{4, 0}, {0, 4}, {0, 0}, {1, 0}, {2, 0}, {3, 0}});
    // Rounded to seven digits, as in many files, corners are beside the sides.
    for (size_t by = 0; by < 6; ++by) {
        Plane p = rotated(with_flat_corners({{0, 0}, {1, 0.3}, {0.7, 1.3}, {-0.3, 1}}, 3), by);
        for (auto& [x, y] : p) {
            x = std::round(1e7 * x) / 1e7;
            y = std::round(1e7 * y) / 1e7;
        }
        expect_cover(p, 1e-4);
    }
}

// A hole is part of the polygon by a cut that it runs through twice.
TEST(Polygons, Bridges) {
    const std::string vertices = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 2 1 0\nv 2 2 0\nv 1 2 0\n";
    for (const char* face : {"f 1 2 3 4 1 5 8 7 6 5\n", "f 5 8 7 6 5 1 2 3 4 1\n"}) {
        const TriangleMesh mesh = read_mesh(vertices + face, Format::obj);
        double sum = 0;
        for (size_t t = 0; t < mesh.triangle_count(); ++t) {
            Plane p;
            for (size_t c = 0; c < 3; ++c) {
                const double* const x = &mesh.positions[size_t{3} * mesh.triangles[3 * t + c]];
                p.push_back({x[0], x[1]});
            }
            EXPECT_GT(area_of(p), 0.1);
            sum += area_of(p);
        }
        EXPECT_DOUBLE_EQ(sum, 8);
    }
}

// What is no polygon in a plane still gives triangles with all corners.
TEST(Polygons, Defects) {
    test::Random random(9);
    for (int round = 0; round < 500; ++round) {
        const size_t n = 4 + random.bits() % 20;
        std::string obj, face = "f";
        for (size_t i = 0; i < n; ++i) {
            const auto number = [&] { return std::to_string(random.bits() % 5); };
            obj += "v " + number() + " " + number() + " " + number() + "\n";
            face += " " + std::to_string(round % 2 ? i + 1 : 1 + random.bits() % n);
        }
        const TriangleMesh mesh = read_mesh(obj + face + "\n", Format::obj);
        EXPECT_EQ(mesh.triangle_count(), n - 2);
    }
    // A corner twice in a row: the other triangles have area.
    const TriangleMesh mesh = read_mesh("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 2 3 4\n", Format::obj);
    EXPECT_EQ(std::vector<uint32_t>(mesh.triangles.begin(), mesh.triangles.begin() + 3),
              (std::vector<uint32_t>{1, 1, 1}));
    EXPECT_EQ(std::set<uint32_t>(mesh.triangles.begin() + 3, mesh.triangles.end()), (std::set<uint32_t>{0, 1, 2, 3}));
    // Coordinates whose products overflow, or vanish.
    for (const double scale : {1e200, 1e-200}) {
        Plane p = {{0, 0}, {4, 1}, {1, 1}, {1, 4}};
        for (auto& [x, y] : p) {
            x *= scale;
            y *= scale;
        }
        EXPECT_EQ(read_face(p, 0).triangles, read_face({{0, 0}, {4, 1}, {1, 1}, {1, 4}}, 0).triangles);
    }
}

// Its work: tests/work.
TEST(Polygons, ManyCorners) {
    test::Random random(11);
    const Plane circle = regular(4000), grid = with_flat_corners({{0, 0}, {1 << 11, 0}, {1 << 11, 1}, {0, 1}}, 10);
    for (const Plane& p : {circle, star(4000, random), comb(2000), spiral(2000), grid})
        EXPECT_EQ(read_face(p, 2).triangle_count(), p.size() - 2);
    // No corner has many triangles.
    std::vector<int> degree(circle.size());
    for (const uint32_t v : read_face(circle, 0).triangles) ++degree[v];
    EXPECT_LT(*std::max_element(degree.begin(), degree.end()), 64);
}

} // namespace test_readers_polygons
