// The way along sharp edges.
#include "src/applications/quads/surface_lines.hpp"
#include "support/make_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace test_sharp_edges {

using hmf::Mesh;

// The lines of a plate are straight: who slides along one gets as far as wished, or to an end of it, which is a corner.
TEST(SharpEdges, SlidesAlongTheLine) {
    const int fine = 4;
    test::MadeMesh made(test::plate(2, 1, fine));
    const Mesh mesh = made.mesh();
    const double* const position = made.positions.data();
    std::vector<uint32_t> sharp, degree(mesh.vertex_count, 0), line(mesh.edge_count);
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (!hmf::is_sharp(mesh, position, 2 * e)) continue;
        sharp.push_back(2 * e);
        ++degree[mesh.origin[2 * e]];
        ++degree[mesh.target(2 * e)];
    }
    // 4 (5 + 3 + 1) around the plate, and 12 around each of two holes.
    ASSERT_EQ(sharp.size(), 60u * fine);
    EXPECT_EQ(std::count(degree.begin(), degree.end(), 3u), 24);
    // Lines: joined where two sharp edges meet, to the least number until nothing changes.
    std::iota(line.begin(), line.end(), 0u);
    for (bool changed = true; changed;) {
        changed = false;
        for (const uint32_t g : sharp)
            for (const uint32_t h : sharp)
                for (const uint32_t v : {mesh.origin[g], mesh.target(g)})
                    if (degree[v] == 2 && (v == mesh.origin[h] || v == mesh.target(h)) && line[h / 2] < line[g / 2])
                        line[g / 2] = line[h / 2], changed = true;
    }
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1, 1);
    size_t ends = 0, passed = 0;
    for (const uint32_t h : sharp) {
        const hmf::Point a = hmf::point(position, mesh.origin[h]), way = hmf::point(position, mesh.target(h)) - a;
        const hmf::Point p = a + 0.5 * (any(random) + 1) * way;
        const double length = 4 * any(random);
        hmf::Point there;
        const uint32_t found = hmf::slide_along_sharp_edges(mesh, position, h, p, length, there);
        EXPECT_EQ(line[found / 2], line[h / 2]);
        EXPECT_LT(length_of(there - hmf::nearest_on_edge(mesh, position, found, there)), 1e-12);
        // In the direction of the edge, or against it.
        EXPECT_GE(dot(there - p, way) * length, 0);
        const double moved = length_of(there - p);
        if (moved < std::fabs(length) - 1e-12) {
            ++ends;
            bool at_corner = false;
            for (const uint32_t v : {mesh.origin[found], mesh.target(found)})
                at_corner = at_corner || (degree[v] == 3 && square_of(hmf::point(position, v) - there) == 0);
            EXPECT_TRUE(at_corner);
        } else {
            EXPECT_NEAR(moved, std::fabs(length), 1e-12);
            passed += found / 2 != h / 2;
        }
    }
    EXPECT_GT(ends, 50u);
    EXPECT_GT(passed, 50u);
}

} // namespace test_sharp_edges
