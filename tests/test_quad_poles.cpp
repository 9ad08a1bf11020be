// Quads over poles, by themselves: a tube of quads whose ends are folded flat.
#include "../src/quads/quad_poles.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

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
