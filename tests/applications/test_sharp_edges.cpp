// The way along sharp edges, against all edges of the line at once.
#include "src/applications/quads/sharp_edges.hpp"
#include "support/make_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace test_sharp_edges {

namespace {

using hmf::Mesh;

double square_distance_to_edge(const double* position, const Mesh& mesh, uint32_t h, const double* p) {
    const double *const a = position + 3 * mesh.origin[h], *const b = position + 3 * mesh.target(h);
    double along = 0, length = 0, square = 0;
    for (int k = 0; k < 3; ++k) along += (p[k] - a[k]) * (b[k] - a[k]), length += (b[k] - a[k]) * (b[k] - a[k]);
    const double t = std::min(1.0, std::max(0.0, along / length));
    for (int k = 0; k < 3; ++k) square += std::pow(p[k] - a[k] - t * (b[k] - a[k]), 2);
    return square;
}

} // namespace

// The lines of a plate are straight, so the nearest point of the whole line is found, and none beyond its corners.
TEST(SharpEdges, TheNearestPointOfTheLine) {
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
    std::uniform_real_distribution<double> place(-1, 6);
    for (const uint32_t h : sharp) {
        const double p[3] = {place(random), place(random), place(random)};
        double nearest[3];
        const uint32_t found = hmf::walk_along_sharp_edges(mesh, position, h, p, nearest);
        EXPECT_EQ(line[found / 2], line[h / 2]);
        EXPECT_LT(square_distance_to_edge(position, mesh, found, nearest), 1e-24);
        double least = HUGE_VAL, square = 0;
        for (const uint32_t g : sharp)
            if (line[g / 2] == line[h / 2]) least = std::min(least, square_distance_to_edge(position, mesh, g, p));
        for (int k = 0; k < 3; ++k) square += (nearest[k] - p[k]) * (nearest[k] - p[k]);
        EXPECT_NEAR(square, least, 1e-12);
    }
}

} // namespace test_sharp_edges
