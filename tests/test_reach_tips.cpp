// A spike on a square, and four quads that cut it off:
//
//     r---r---r      r: held, on the rim of the square
//     | \ | / |
//     r---x---r      x: below the spike; it goes to its tip, if no side gets too long
//     | / | \ |
//     r---r---r
#include "../src/quads/reach_tips.hpp"
#include "support/make_mesh.hpp"

#include <gtest/gtest.h>

namespace {

constexpr double RIM[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}};

// Whether the vertex in the middle goes to a tip of this height; the sides of the quads are 1 long.
bool reaches(double height) {
    test::Triangles t;
    for (const auto& p : RIM) t.positions.insert(t.positions.end(), {p[0], p[1], 0});
    t.positions.insert(t.positions.end(), {0, 0, height, 0, 0, -0.1});
    for (uint32_t i = 0; i < 8; ++i) t.triangles.insert(t.triangles.end(), {i, (i + 1) % 8, 8, (i + 1) % 8, i, 9});
    test::MadeMesh made(t);
    const hmf::Mesh mesh = made.mesh();
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::QuadMesh quads;
    quads.start(memory);
    bool room = true;
    for (uint32_t v = 0; v < 9; ++v) {
        uint32_t side = 0; // of a triangle of the spike at this vertex
        while (mesh.origin[side] != v || mesh.origin[mesh.prev(side)] == 9 || mesh.target(side) == 9) ++side;
        for (int k = 0; k < 3; ++k) room = room && quads.positions.push(v < 8 && k < 2 ? RIM[v][k] : 0);
        room = room && quads.sides.push(side) && quads.held.push(v < 8);
    }
    for (uint32_t i = 0; i < 8; i += 2)
        for (const uint32_t v : {i, i + 1, 8u, (i + 7) % 8}) room = room && quads.quads.push(v);
    EXPECT_TRUE(room);
    size_t moved = 0;
    EXPECT_EQ(hmf::reach_tips(mesh, made.positions.data(), nullptr, quads, moved, call), HMF_OK);
    EXPECT_EQ(quads.positions[3 * 8 + 2], moved ? height : 0);
    return moved == 1;
}

} // namespace

// The sides get root(1 + height^2) long; from 2 on that is too long, although no corner is too sharp.
TEST(ReachTips, NoSideGetsTwiceAsLong) {
    EXPECT_FALSE(reaches(0.4)); // not far enough
    EXPECT_TRUE(reaches(1.2));
    EXPECT_TRUE(reaches(1.7));
    EXPECT_FALSE(reaches(1.8));
    EXPECT_FALSE(reaches(2.1));
}
