// Nearest points: of a triangle against many of its points, on a surface against all triangles at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "src/applications/quads/surface_walk.hpp"
#include "support/make_mesh.hpp"
#include "support/meshes.hpp"

namespace test_surface_walk {

namespace {

double square_distance(const double* p, const double* q) {
    double square = 0;
    for (int k = 0; k < 3; ++k) square += (p[k] - q[k]) * (p[k] - q[k]);
    return square;
}

} // namespace

TEST(SurfaceWalk, NearestPointOfATriangle) {
    test::Random random(3);
    size_t met[7] = {};
    for (int n = 0; n < 3000; ++n) {
        double corner[3][3], p[3];
        for (auto& x : corner)
            for (double& c : x) c = random.unit();
        for (double& c : p) c = 3 * random.unit() - 1;
        const hmf::NearestPoint found = hmf::nearest_in_triangle(hmf::point(p, 0), hmf::point(corner[0], 0),
                                                                 hmf::point(corner[1], 0), hmf::point(corner[2], 0));
        const int on = found.on;
        const double square = found.square, nearest[3] = {found.at.x, found.at.y, found.at.z};
        ASSERT_TRUE(on >= 0 && on <= 6);
        ++met[on];
        EXPECT_NEAR(square, square_distance(p, nearest), 1e-12);
        // No point of the triangle is nearer, and one of them is that point.
        constexpr int fine = 24;
        double closest = HUGE_VAL;
        for (int i = 0; i <= fine; ++i)
            for (int j = 0; i + j <= fine; ++j) {
                double q[3];
                for (int k = 0; k < 3; ++k)
                    q[k] = (corner[0][k] * (fine - i - j) + corner[1][k] * i + corner[2][k] * j) / fine;
                ASSERT_GE(square_distance(p, q), square - 1e-12);
                closest = std::min(closest, square_distance(nearest, q));
            }
        EXPECT_LT(closest, 3.0 / (fine * fine));
        // On the side or the corner that is told.
        if (on >= 4) { EXPECT_EQ(square_distance(nearest, corner[on - 4]), 0); }
        if (on >= 1 && on <= 3) {
            const double *a = corner[on - 1], *b = corner[on % 3];
            EXPECT_NEAR(std::sqrt(square_distance(nearest, a)) + std::sqrt(square_distance(nearest, b)),
                        std::sqrt(square_distance(a, b)), 1e-9);
        }
    }
    for (const size_t count : met) EXPECT_GT(count, 20u);
}

TEST(SurfaceWalk, NearestPointOfASurface) {
    constexpr uint32_t n = 30, m = 16;
    const test::Triangles torus = test::torus_triangles(n, m);
    test::MadeMesh made(torus);
    const hmf::Mesh mesh = made.mesh();
    const double* const position = made.positions.data();
    const auto nearest_of_face = [&](uint32_t h, const hmf::Point& p) {
        return hmf::nearest_in_face(mesh, position, h, p);
    };
    test::Random random(4);
    size_t found = 0;
    for (int k = 0; k < 2000; ++k) {
        const uint32_t x = uint32_t(random.below(n)), y = uint32_t(random.below(m));
        const hmf::Point p = hmf::point(position, x * m + y)
                           + 0.3 * hmf::Point{random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5};
        // From up to three cells away.
        const uint32_t from = (x + uint32_t(random.below(4))) % n * m + (y + uint32_t(random.below(4))) % m;
        hmf::Point nearest;
        const uint32_t side = hmf::walk_to_nearest(mesh, position, mesh.out[from], p, nearest);
        double best = HUGE_VAL;
        for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) best = std::min(best, nearest_of_face(h, p).square);
        // Where the surface is hollow the walk may end at a fold.
        found += square_of(p - nearest) < best + 1e-12;
        EXPECT_LE(square_of(p - nearest), nearest_of_face(mesh.out[from], p).square + 1e-12);
        EXPECT_LT(square_of(nearest - nearest_of_face(side, p).at), 1e-24);
    }
    EXPECT_GT(found, 1900u);
}

} // namespace test_surface_walk
