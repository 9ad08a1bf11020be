// Overlaps of triangles in the plane, and what looking for them takes.
#include "src/applications/atlas/overlaps.hpp"
#include "support/make_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace test_overlaps {

namespace {

// Triangles in the plane, in one chart; each with a back, so that the mesh is closed, and with its own corners.
struct Flat {
    explicit Flat(const test::Triangles& t, uint64_t bytes = 0) : made(t), memory(nullptr, nullptr, nullptr, bytes) {
        const size_t sides = 2 * size_t{mesh.edge_count};
        if (!side.allocate(memory, mesh.face_count) || !layout.x.allocate(memory, sides)
            || !layout.y.allocate(memory, sides) || !layout.chart.allocate(memory, mesh.face_count))
            return;
        layout.chart_count = 1;
        for (uint32_t h = 0; h < sides; ++h) {
            side[mesh.face[h]] = h;
            layout.x[h] = static_cast<int64_t>(made.positions[3 * mesh.origin[h]]);
            layout.y[h] = static_cast<int64_t>(made.positions[3 * mesh.origin[h] + 1]);
        }
        for (uint32_t f = 0; f < mesh.face_count; ++f) layout.chart[f] = f % 2 == 0 ? 0 : hmf::NONE;
    }

    test::MadeMesh made;
    const hmf::Mesh mesh = made.mesh();
    hmf::Memory memory;
    hmf_error error{};
    hmf::Call call{memory, &error, nullptr, nullptr};
    hmf::Array<uint32_t> side;
    hmf::GridLayout layout;
    hmf::Array<uint8_t> bad;
};

struct Point {
    double x, y;
};
using Corners = std::vector<Point>;

double twice_area(const Corners& p) {
    double sum = 0;
    for (size_t i = 0; i < p.size(); ++i) {
        const Point &a = p[i], &b = p[(i + 1) % p.size()];
        sum += a.x * b.y - a.y * b.x;
    }
    return sum;
}

// What is left of a convex polygon on the left of each side of a triangle.
Corners cut(Corners polygon, const Corners& triangle) {
    for (size_t i = 0; i < 3; ++i) {
        const Point a = triangle[i], b = triangle[(i + 1) % 3];
        const auto left = [&](const Point& p) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); };
        Corners rest;
        for (size_t k = 0; k < polygon.size(); ++k) {
            const Point p = polygon[k], q = polygon[(k + 1) % polygon.size()];
            const double l = left(p), m = left(q);
            if (l >= 0) rest.push_back(p);
            if (l * m < 0) rest.push_back({p.x + (q.x - p.x) * l / (l - m), p.y + (q.y - p.y) * l / (l - m)});
        }
        polygon = rest;
    }
    return polygon;
}

} // namespace

// Triangles on a grid that is so coarse that many have common corners, common sides and upright sides. Of each two that
// overlap one is found, and each that is found overlaps another one.
TEST(Overlaps, AreThoseOfAllPairs) {
    uint32_t random = 1;
    const auto below = [&](uint32_t limit) { return (random = random * 1664525 + 1013904223) / 256 % limit; };
    size_t found = 0, kept = 0;
    for (int round = 0; round < 300; ++round) {
        const uint32_t count = 2 + below(30), wide = 3 + below(30);
        test::Triangles t;
        std::vector<Corners> corners;
        for (uint32_t k = 0; k < count; ++k) {
            Corners c(3);
            while (!(twice_area(c) > 0))
                for (Point& p : c) p = {double(below(wide)), double(below(wide))};
            for (const Point& p : c) t.positions.insert(t.positions.end(), {p.x, p.y, 0});
            t.triangles.insert(t.triangles.end(), {3 * k, 3 * k + 1, 3 * k + 2, 3 * k + 1, 3 * k, 3 * k + 2});
            corners.push_back(c);
        }
        Flat flat(t);
        ASSERT_TRUE(hmf::find_overlaps(flat.mesh, flat.side, flat.layout, 1, flat.bad, flat.call));
        for (uint32_t a = 0; a < count; ++a) {
            bool is_alone = true;
            for (uint32_t b = 0; b < count; ++b) {
                if (a == b || twice_area(cut(corners[a], corners[b])) < 1e-9) continue;
                is_alone = false;
                ASSERT_TRUE(flat.bad[2 * a] || flat.bad[2 * b]) << round;
            }
            ASSERT_FALSE(is_alone && flat.bad[2 * a]) << round;
            ++(flat.bad[2 * a] ? found : kept);
        }
    }
    EXPECT_GT(found, 500u);
    EXPECT_GT(kept, 500u);
}

// Needles along the diagonal, side by side: the box of each is nearly that of all, so that in cells as small as the
// triangles each would be in every cell. None overlaps; pushed together each second one does.
TEST(Overlaps, NeedlesTakeLittleMemory) {
    constexpr uint32_t COUNT = 1000;
    test::Triangles t;
    for (uint32_t k = 0; k < COUNT; ++k) {
        const double at = 8 * k, far = 1 << 20;
        t.positions.insert(t.positions.end(), {at, 0, 0, at + 4, 0, 0, at + far, far, 0});
        t.triangles.insert(t.triangles.end(), {3 * k, 3 * k + 1, 3 * k + 2, 3 * k + 1, 3 * k, 3 * k + 2});
    }
    Flat flat(t, 1 << 20);
    for (const bool together : {false, true}) {
        for (uint32_t h = 0; h < 2 * flat.mesh.edge_count; ++h)
            flat.layout.x[h] -= together && flat.mesh.origin[h] / 3 % 2 ? 6 : 0;
        ASSERT_TRUE(hmf::find_overlaps(flat.mesh, flat.side, flat.layout, 1, flat.bad, flat.call))
            << flat.error.message;
        EXPECT_EQ(std::count(flat.bad.begin(), flat.bad.end(), 1), together ? COUNT / 2 : 0);
    }
}

} // namespace test_overlaps
