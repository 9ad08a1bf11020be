// Quads over poles: a tube of quads whose ends are folded flat, and how many quads there are.
#include "src/applications/api/application_entry.hpp"
#include "src/applications/quads/graph_points.hpp"
#include "src/applications/quads/grid_sizes.hpp"
#include "src/applications/quads/quad_input.hpp"
#include "src/applications/quads/quad_mesh.hpp"
#include "src/applications/quads/quad_poles.hpp"
#include "src/applications/quads/quad_sizes.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

namespace test_quad_poles {

namespace {

using hmf::NONE;

// Rings of n vertices; the first and the last are folded, so that vertices i and n - i of it are one, and vertices 0
// and n / 2 have two quads each.
void make_pillow(uint32_t n, uint32_t rings, hmf::QuadMesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> number;
    const auto at = [&](uint32_t k, uint32_t i) {
        i %= n;
        if ((k == 0 || k + 1 == rings) && i > n / 2) i = n - i;
        const auto made = number.insert({{k, i}, static_cast<uint32_t>(number.size())});
        const uint32_t v = made.first->second;
        bool room = true;
        for (int c = 0; made.second && c < 3; ++c) room = mesh.positions.push(v) && room; // what belongs to a vertex
        if (made.second) room = mesh.sides.push(1000 + v) && mesh.held.push(0) && room;   // has its number
        EXPECT_TRUE(room);
        return v;
    };
    for (uint32_t k = 0; k + 1 < rings; ++k)
        for (uint32_t i = 0; i < n; ++i)
            for (const uint32_t v : {at(k, i), at(k, i + 1), at(k + 1, i + 1), at(k + 1, i)})
                EXPECT_TRUE(mesh.quads.push(v));
}

} // namespace

TEST(QuadsOverPoles, WhatBelongsToAVertexStaysTogether) {
    for (const uint32_t n : {8u, 12u}) {
        hmf::Memory memory(nullptr, nullptr, nullptr, 0);
        hmf::Call call(memory, nullptr, nullptr, nullptr);
        hmf::QuadMesh mesh;
        mesh.start(memory);
        make_pillow(n, 6, mesh);
        const uint32_t before = mesh.vertex_count();
        size_t left = 99;
        ASSERT_TRUE(hmf::quads_over_poles(mesh, left, call));
        EXPECT_EQ(left, 0u);
        // Each pole goes, and two quads become one.
        EXPECT_EQ(mesh.vertex_count(), before - 4);
        EXPECT_EQ(mesh.positions.size(), 3 * size_t{mesh.vertex_count()});
        EXPECT_EQ(mesh.held.size(), mesh.vertex_count());
        std::set<uint32_t> seen;
        size_t held = 0;
        for (uint32_t v = 0; v < mesh.vertex_count(); ++v) {
            const uint32_t was = mesh.sides[v] - 1000;
            for (size_t c = 0; c < 3; ++c) EXPECT_EQ(mesh.positions[3 * size_t{v} + c], was) << v;
            EXPECT_TRUE(seen.insert(was).second) << was;
            held += mesh.held[v];
        }
        EXPECT_EQ(held, 4u); // one at each tip
        // Still closed: each side once, and once the other way; a sphere.
        std::set<std::pair<uint32_t, uint32_t>> sides;
        std::map<uint32_t, int> uses;
        for (size_t q = 0; q < mesh.quad_count(); ++q)
            for (size_t k = 0; k < 4; ++k) {
                const uint32_t a = mesh.quads[4 * q + k], b = mesh.quads[4 * q + (k + 1) % 4];
                ASSERT_LT(a, mesh.vertex_count());
                EXPECT_TRUE(sides.insert({a, b}).second);
                ++uses[a];
            }
        for (const auto& side : sides) EXPECT_TRUE(sides.count({side.second, side.first}));
        for (const auto& use : uses) EXPECT_GE(use.second, 3) << use.first;
        EXPECT_EQ(mesh.vertex_count(), mesh.quad_count() + 2);
    }
}

// The number of quads, one over each pole, is known from the sizes before they are made: so a wished number can be had.
TEST(QuadsOverPoles, NumberIsKnownBefore) {
    size_t poles = 0, plain = 0;
    for (const size_t genus : {0, 1, 2}) {
        const test::TriMesh mesh = genus == 1 ? test::torus(24, 12, 2, 0.8) : test::pretzel(genus, 1);
        for (size_t marks = genus == 0 ? 4 : 1; marks < 8; marks += 2) {
            std::vector<uint32_t> at;
            for (size_t i = 0; i < marks; ++i) at.push_back(static_cast<uint32_t>(i * (mesh.vertex_count() / marks)));
            const test::SolvedSurface surface(mesh, at);
            ASSERT_TRUE(surface.solution.foliation);
            hmf::Memory memory(nullptr, nullptr, nullptr, 0);
            hmf::Call call(memory, nullptr, nullptr, nullptr);
            hmf::Leaves leaves;
            ASSERT_EQ(leaves.load(*surface.solution.foliation, call), HMF_OK);
            hmf::Foliation& f = leaves.state.foliation;
            const hmf::CriticalGraph& graph = leaves.cylinders.graph;
            const double* const position = leaves.state.hierarchy->levels[0].position;
            hmf::State solved;
            hmf::FlatConeMetric flat;
            ASSERT_EQ(hmf::load_solved_in_unit_of_values(*surface.solution.foliation, solved, call), HMF_OK);
            ASSERT_EQ(hmf::flat_cone_metric(solved, hmf::HARMONIC_TOLERANCE, flat, call), HMF_OK);
            const hmf::Conjugate conjugate(f, flat, 1);
            const hmf::QuadInput in{f, position, leaves.cylinders, graph, nullptr, conjugate};
            double area = 0;
            ASSERT_EQ(hmf::flat_area(in, area, call), HMF_OK);
            std::vector<int> prongs(graph.zeros.size(), 0);
            for (const hmf::Sector& s : graph.sectors) ++prongs[s.zero];
            for (const int count : prongs) ++(count == 1 ? poles : plain);
            for (const double number : {100, 400, 1000}) {
                hmf::GridSizes grid;
                hmf::QuadMesh quads, none;
                hmf::GraphPoints points(in, grid, none, call);
                hmf::Array<double> length;
                hmf::QuadSizes sizes;
                hmf::QuadWish wish;
                wish.number = number;
                ASSERT_TRUE(grid.allocate(in, memory) && points.measure(length));
                const double ring = graph.zeros.empty() ? points.length(0) : 0;
                ASSERT_EQ(sizes.start(leaves.cylinders, length, ring, wish.merge, call), HMF_OK);
                ASSERT_EQ(sizes.of_step(std::sqrt(area / number), call), HMF_OK);
                ASSERT_EQ(hmf::make_quads(f, conjugate, position, leaves.cylinders, nullptr, wish, quads, call),
                          HMF_OK);
                EXPECT_EQ(sizes.quad_count(), static_cast<int64_t>(quads.quad_count()))
                    << genus << " " << marks << " " << number;
            }
        }
    }
    EXPECT_GT(poles, 20u);
    EXPECT_GT(plain, 5u);
}

} // namespace test_quad_poles
