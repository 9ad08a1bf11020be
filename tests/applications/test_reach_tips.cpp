// A spike on a square, and four quads that cut it off:
//
//     r---r---r      r: held, on the rim of the square
//     | \ | / |
//     r---x---r      x: below the spike; it goes to its tip, if no side gets too long
//     | / | \ |
//     r---r---r
#include "src/applications/quads/fit_quads.hpp"
#include "src/applications/quads/surface_search.hpp"
#include "support/make_mesh.hpp"

#include <gtest/gtest.h>

namespace test_reach_tips {

namespace {

constexpr double RIM[8][2] = {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}};

class Spike {
public:
    // The sides of the quads are 1 long.
    explicit Spike(double height) :
        memory_(nullptr, nullptr, nullptr, 0), call_(memory_, nullptr, nullptr, nullptr), made_(surface(height)) {
        const hmf::Mesh mesh = made_.mesh();
        quads_.start(memory_);
        bool room = true;
        for (uint32_t v = 0; v < 9; ++v) {
            uint32_t side = 0; // of a triangle of the spike at this vertex, below the middle at the first one
            while (mesh.origin[side] != v % 8 || mesh.origin[mesh.prev(side)] == 9 || mesh.target(side) == 9) ++side;
            const hmf::Point p{v < 8 ? RIM[v][0] : 0, v < 8 ? RIM[v][1] : 0, 0};
            room = room && quads_.add_vertex(p, side, v < 8 ? hmf::AT_TIP : uint8_t{0});
        }
        for (uint32_t i = 0; i < 8; i += 2) room = room && quads_.add_quad(i, i + 1, 8u, (i + 7) % 8);
        EXPECT_TRUE(room);
    }

    // Whether the vertex in the middle moves.
    bool reach() {
        size_t moved = 0;
        hmf::SurfaceSearch surface;
        EXPECT_TRUE(surface.build(made_.mesh(), made_.positions.data(), call_.memory));
        EXPECT_EQ(hmf::reach_tips(made_.mesh(), made_.positions.data(), surface, quads_, moved, call_), HMF_OK);
        return moved == 1;
    }
    double height() const { return quads_.positions[3 * 8 + 2]; }
    uint8_t held() const { return quads_.held[8]; }

private:
    static test::Triangles surface(double height) {
        test::Triangles t;
        for (const auto& p : RIM) t.positions.insert(t.positions.end(), {p[0], p[1], 0});
        t.positions.insert(t.positions.end(), {0, 0, height, 0, 0, -0.1});
        for (uint32_t i = 0; i < 8; ++i) {
            const uint32_t j = (i + 1) % 8;
            t.triangles.insert(t.triangles.end(), {i, j, 8, j, i, 9});
        }
        return t;
    }

    hmf::Memory memory_;
    hmf::Call call_;
    test::MadeMesh made_;
    hmf::QuadMesh quads_;
};

// Whether the vertex in the middle goes to a tip of this height at once.
bool reaches(double height) {
    Spike spike(height);
    spike.reach();
    const bool there = spike.held() == hmf::AT_TIP;
    EXPECT_EQ(spike.height() == height, there);
    return there;
}

} // namespace

// With the height the corners at the tip get sharp, from some height on too sharp.
TEST(ReachTips, FarTipsAreReachedOnTheWay) {
    EXPECT_TRUE(reaches(1));
    EXPECT_TRUE(reaches(4));
    Spike spike(5);
    ASSERT_TRUE(spike.reach());
    EXPECT_EQ(spike.held(), hmf::ON_WAY_TO_TIP);
}

} // namespace test_reach_tips
