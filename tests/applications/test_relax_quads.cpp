// Relaxed quads on a sharp edge: an edge of a box with a row of squares on each of its two faces.
//
//     o---o---o---o      on top, held
//     |   |   |   |
//     x--x-----x--x      on the edge: they slide along it until they are even
//     |   |   |   |
//     o---o---o---o      on the side, held
#include "src/quads/boundary_walk.hpp"
#include "src/quads/fit_quads.hpp"
#include "src/quads/line_walk.hpp"
#include "src/quads/quad_figures.hpp"
#include "src/quads/quad_mesh.hpp"
#include "src/quads/quad_shape.hpp"
#include "src/quads/relax_quads.hpp"
#include "src/quads/sharp_edges.hpp"
#include "src/quads/snap_quads.hpp"
#include "src/quads/square_corners.hpp"
#include "src/quads/surface_walk.hpp"
#include "src/quads/unfold_quads.hpp"
#include "support/make_mesh.hpp"
#include "support/meter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace test_relax_quads {

namespace {

using hmf::Mesh;

constexpr uint32_t COLUMNS = 7;

// A half-edge of a triangle, or of a sharp edge, all of whose corners have these y and z.
uint32_t half_edge_at(const Mesh& mesh, const double* position, bool sharp, double y, double z) {
    const auto lies = [&](uint32_t v) {
        return (y < 0 || position[3 * v + 1] == y) && (z < 0 || position[3 * v + 2] == z);
    };
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h)
        if (lies(mesh.origin[h]) && lies(mesh.target(h))
            && (sharp ? hmf::is_sharp(mesh, position, h) : lies(mesh.origin[mesh.prev(h)])))
            return h;
    return hmf::NONE;
}

class OnAnEdge : public ::testing::Test {
protected:
    OnAnEdge() :
        memory(nullptr, nullptr, nullptr, 0), call(memory, nullptr, nullptr, nullptr), made(test::plate(2, 1, 2)) {
        mesh = made.mesh();
        const double* const position = made.positions.data();
        const uint32_t side[3] = {half_edge_at(mesh, position, false, -1, 1), half_edge_at(mesh, position, true, 0, 1),
                                  half_edge_at(mesh, position, false, 0, -1)};
        std::mt19937 random(3);
        std::uniform_real_distribution<double> off(-0.15, 0.15);
        quads.start(memory);
        bool room = true;
        for (uint32_t row = 0; row < 3; ++row)
            for (uint32_t i = 0; i < COLUMNS; ++i) {
                const bool slides = row == 1 && i > 0 && i + 1 < COLUMNS;
                room = room && quads.positions.push(even(i) + (slides ? off(random) : 0))
                    && quads.positions.push(row == 0 ? 0.5 : 0) && quads.positions.push(row == 2 ? 0.5 : 1)
                    && quads.sides.push(side[row]) && quads.held.push(slides ? hmf::ON_CREASE : uint8_t{1});
            }
        for (uint32_t row = 0; row < 2; ++row)
            for (uint32_t i = 0; i + 1 < COLUMNS; ++i)
                for (const uint32_t v :
                     {(row + 1) * COLUMNS + i, (row + 1) * COLUMNS + i + 1, row * COLUMNS + i + 1, row * COLUMNS + i})
                    room = room && quads.quads.push(v);
        EXPECT_TRUE(room);
    }

    static double even(uint32_t column) { return 1 + 0.5 * column; }
    bool is_on_the_edge(uint32_t v) const { return quads.positions[3 * v + 1] == 0 && quads.positions[3 * v + 2] == 1; }

    hmf::Memory memory;
    hmf::Call call;
    test::MadeMesh made;
    Mesh mesh;
    hmf::QuadMesh quads;
};

} // namespace

TEST_F(OnAnEdge, VerticesSlide) {
    ASSERT_EQ(hmf::relax_quads(mesh, made.positions.data(), 200, hmf::Untangle::all, false, quads, call), HMF_OK);
    for (uint32_t i = 0; i < COLUMNS; ++i) {
        EXPECT_TRUE(is_on_the_edge(COLUMNS + i));
        EXPECT_NEAR(quads.positions[3 * (COLUMNS + i)], even(i), 1e-6);
    }
}

// Where the quads are slanted against the edge by 45 degrees, their vertices stay on it; at 76 degrees they leave it.
TEST_F(OnAnEdge, SlantedQuadsLeaveIt) {
    for (const double shift : {0.5, 2.0}) {
        for (uint32_t i = 0; i < COLUMNS; ++i) {
            quads.positions[3 * i] = even(i) + shift;
            quads.positions[3 * (COLUMNS + i)] = even(i);
        }
        uint64_t inverted = 0;
        ASSERT_EQ(hmf::fit_quads(mesh, made.positions.data(), nullptr, 0, 0, quads, inverted, call), HMF_OK);
        EXPECT_EQ(std::count(quads.held.begin(), quads.held.end(), hmf::ON_CREASE), shift < 1 ? COLUMNS - 2 : 0);
    }
}

// With most corners off by 45 degrees, vertices leave the edge that keeps them so; in a row of squares they stay.
TEST_F(OnAnEdge, SquareCornersComeFirst) {
    for (const double shift : {0.0, 0.5}) {
        for (uint32_t i = 0; i < COLUMNS; ++i) {
            quads.positions[3 * i] = even(i) + shift;
            quads.positions[3 * (COLUMNS + i)] = even(i);
        }
        ASSERT_EQ(hmf::square_corners(mesh, made.positions.data(), 8, 0, quads, call), HMF_OK);
        const auto sliding = std::count(quads.held.begin(), quads.held.end(), hmf::ON_CREASE);
        if (shift > 0) EXPECT_LT(sliding, COLUMNS - 2);
        else EXPECT_EQ(sliding, COLUMNS - 2);
        for (uint32_t i = 0; i < COLUMNS && !(shift > 0); ++i) EXPECT_TRUE(is_on_the_edge(COLUMNS + i));
    }
}

// A free row goes to the edge, where the quads cover more of both faces: without that it stays where they are as high
// as each other, .16 from it.
TEST_F(OnAnEdge, RowsBesideItGoThere) {
    for (uint32_t i = 0; i < COLUMNS; ++i) {
        quads.positions[3 * i + 1] = 0.7;
        if (quads.held[COLUMNS + i] != hmf::ON_CREASE) continue;
        quads.held[COLUMNS + i] = 0;
        quads.positions[3 * (COLUMNS + i) + 1] = 0.2;
        quads.sides[COLUMNS + i] = quads.sides[i];
    }
    ASSERT_EQ(hmf::relax_quads(mesh, made.positions.data(), 200, hmf::Untangle::all, false, quads, call), HMF_OK);
    for (uint32_t i = 2; i + 2 < COLUMNS; ++i) EXPECT_TRUE(is_on_the_edge(COLUMNS + i));
}

// A row between two that are held in disorder is untangled, and each vertex knows the triangle that it is on.
TEST_F(OnAnEdge, UntangledVerticesKnowTheirTriangle) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> off(-0.4, 0.4);
    const double* const position = made.positions.data();
    std::vector<uint32_t> before(3 * COLUMNS);
    const std::vector<uint32_t> start(quads.sides.begin(), quads.sides.end());
    size_t elsewhere = 0;
    for (int round = 0; round < 50; ++round) {
        for (uint32_t v = 0; v < 3 * COLUMNS; ++v) {
            const uint32_t row = v / COLUMNS, i = v % COLUMNS;
            const double p[3] = {even(i) + off(random), row == 2 ? 0 : 0.5 + off(random),
                                 row == 2 ? 0.5 + off(random) : 1};
            quads.held[v] = row == 1 && i > 0 && i + 1 < COLUMNS ? uint8_t{0} : hmf::AT_CORNER;
            before[v] = quads.sides[v] =
                hmf::walk_to_nearest(mesh, position, start[row == 2 ? v : i], p, &quads.positions[size_t{3} * v]);
        }
        ASSERT_EQ(hmf::relax_quads(mesh, position, 0, hmf::Untangle::all, false, quads, call), HMF_OK);
        for (uint32_t v = COLUMNS + 1; v + 1 < 2 * COLUMNS; ++v) {
            const double* const p = &quads.positions[size_t{3} * v];
            const uint32_t h = quads.sides[v], corner[3] = {mesh.origin[h], mesh.target(h), mesh.origin[mesh.prev(h)]};
            elsewhere += h != before[v];
            for (size_t k = 0; k < 3; ++k) {
                const auto at = [&](size_t c) { return position[3 * corner[c] + k]; };
                EXPECT_GE(p[k], std::min({at(0), at(1), at(2)}) - 1e-12) << round << ", vertex " << v;
                EXPECT_LE(p[k], std::max({at(0), at(1), at(2)}) + 1e-12) << round << ", vertex " << v;
            }
        }
    }
    EXPECT_GT(elsewhere, 50u);
}

// Two vertices of a row are within reach of a corner of the plate, the first one nearer: that one goes there.
TEST_F(OnAnEdge, TheNearestTakesACorner) {
    const double x[4] = {-1.2, -0.2, 0.3, 1.3};
    const uint32_t side = half_edge_at(mesh, made.positions.data(), false, -1, 1);
    hmf::QuadMesh patch;
    patch.start(memory);
    bool room = true;
    for (int row = 0; row < 3; ++row)
        for (uint32_t i = 0; i < 4; ++i)
            room = room && patch.positions.push(x[i]) && patch.positions.push(row - 1) && patch.positions.push(1)
                && patch.sides.push(side) && patch.held.push(row != 1 || i == 0 || i == 3);
    for (uint32_t row = 0; row < 2; ++row)
        for (uint32_t i = 0; i < 3; ++i)
            for (const uint32_t v : {4 * row + i, 4 * row + i + 1, 4 * row + i + 5, 4 * row + i + 4})
                room = room && patch.quads.push(v);
    ASSERT_TRUE(room);
    size_t snapped = 0;
    ASSERT_EQ(hmf::snap_to_sharp_edges(mesh, made.positions.data(), nullptr, patch, snapped, call), HMF_OK);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(patch.positions[3 * 5 + k], k == 2 ? 1 : 0);
    EXPECT_EQ(patch.held[5], hmf::AT_SHARP_CORNER);
    EXPECT_NE(patch.held[6], hmf::AT_SHARP_CORNER);
}

// The middle of a side on the edge slides along it as well.
TEST_F(OnAnEdge, FinerQuadsStay) {
    ASSERT_EQ(hmf::refine_quads(mesh, made.positions.data(), quads, call), HMF_OK);
    size_t sliding = 0;
    for (uint32_t v = 0; v < quads.vertex_count(); ++v) {
        if (quads.held[v] != hmf::ON_CREASE) continue;
        ++sliding;
        EXPECT_TRUE(is_on_the_edge(v));
        EXPECT_TRUE(hmf::is_sharp(mesh, made.positions.data(), quads.sides[v]));
    }
    EXPECT_EQ(sliding, (COLUMNS - 2) + (COLUMNS - 3)); // where both ends slide
}

// A grid in a plane, held at its rim and displaced most in the middle: steps that go on with a part of the one before
// get further than as many that each begin at rest.
TEST(RelaxQuads, StepsGoOn) {
    constexpr int N = 16, STEPS = 40;
    test::MadeMesh made(
        test::Triangles{{-40, -40, 0, 80, -40, 0, -40, 80, 0, 0, 0, -40}, {0, 1, 2, 1, 0, 3, 2, 1, 3, 0, 2, 3}});
    const Mesh mesh = made.mesh();
    const double* const position = made.positions.data();
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    const auto off_after = [&](int calls, int steps) {
        hmf::QuadMesh quads;
        quads.start(memory);
        const uint32_t side = half_edge_at(mesh, position, false, -1, 0);
        const double turn = 3.141592653589793 / N;
        bool room = true;
        for (int i = 0; i <= N; ++i)
            for (int j = 0; j <= N; ++j) {
                const bool rim = i == 0 || j == 0 || i == N || j == N;
                room = room && quads.positions.push(i + 0.8 * std::sin(turn * i) * std::sin(turn * j))
                    && quads.positions.push(j) && quads.positions.push(0) && quads.sides.push(side)
                    && quads.held.push(rim);
            }
        for (uint32_t i = 0; i < N; ++i)
            for (uint32_t j = 0; j < N; ++j)
                for (const uint32_t v :
                     {i * (N + 1) + j, (i + 1) * (N + 1) + j, (i + 1) * (N + 1) + j + 1, i * (N + 1) + j + 1})
                    room = room && quads.quads.push(v);
        EXPECT_TRUE(room);
        for (int k = 0; k < calls; ++k)
            EXPECT_EQ(hmf::relax_quads(mesh, position, steps, hmf::Untangle::all, false, quads, call), HMF_OK);
        double most = 0;
        for (uint32_t i = 0; i <= N; ++i)
            for (uint32_t j = 0; j <= N; ++j)
                most = std::max(most, std::fabs(quads.positions[3 * (i * (N + 1) + j)] - i));
        return most;
    };
    EXPECT_GT(off_after(0, 0), 0.79);
    EXPECT_LT(off_after(1, STEPS), off_after(STEPS, 1) / 3);
}

// A grid in a plane, held at its rim, in disorder inside: squares are the least, and what is held at a tip in the
// middle comes near its place, for more corners are off than are allowed.
TEST(SquareCorners, DisorderBecomesSquares) {
    test::MadeMesh made(
        test::Triangles{{-40, -40, 0, 80, -40, 0, -40, 80, 0, 0, 0, -40}, {0, 1, 2, 1, 0, 3, 2, 1, 3, 0, 2, 3}});
    const Mesh mesh = made.mesh();
    const double* const position = made.positions.data();
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    const uint32_t side = half_edge_at(mesh, position, false, -1, 0);
    for (const double tip : {0.0, 0.9}) {
        const uint32_t N = tip > 0 ? 2 : 10, MIDDLE = N / 2 * (N + 1) + N / 2;
        std::mt19937 random(5);
        std::uniform_real_distribution<double> off(-0.3, 0.3);
        hmf::QuadMesh quads;
        quads.start(memory);
        bool room = true;
        for (uint32_t i = 0; i <= N; ++i)
            for (uint32_t j = 0; j <= N; ++j) {
                const bool rim = i == 0 || j == 0 || i == N || j == N, at_tip = tip > 0 && i * (N + 1) + j == MIDDLE;
                const double p[3] = {i
                                         + (rim      ? 0
                                            : at_tip ? tip
                                                     : off(random)),
                                     j + (rim || at_tip ? 0 : off(random)), 0};
                room = room && quads.add_vertex(p, side, rim ? hmf::AT_CORNER : at_tip ? hmf::AT_TIP : uint8_t{0});
            }
        for (uint32_t i = 0; i < N; ++i)
            for (uint32_t j = 0; j < N; ++j) {
                const uint32_t a = i * (N + 1) + j, b = a + N + 1;
                room = room && quads.add_quad(a, b, b + 1, a + 1);
            }
        ASSERT_TRUE(room);
        hmf::QuadFigures figures;
        const auto most_off = [&] {
            double most = 0;
            for (uint32_t v = 0; v < quads.vertex_count(); ++v)
                for (uint32_t k = 0; k < 2; ++k) {
                    const uint32_t even = k == 0 ? v / (N + 1) : v % (N + 1);
                    most = std::max(most, std::fabs(quads.positions[3 * v + k] - even));
                }
            return most;
        };
        EXPECT_GT(most_off(), 0.29);
        ASSERT_EQ(hmf::square_corners(mesh, position, 400, 0, quads, call), HMF_OK);
        ASSERT_EQ(hmf::quad_figures(mesh, position, nullptr, quads, figures, call), HMF_OK);
        EXPECT_EQ(figures.inverted, 0u);
        if (tip > 0) EXPECT_LT(quads.positions[3 * MIDDLE] - N / 2, 0.6);
        else EXPECT_LT(most_off(), 0.02);
        // And good ones are left alone, if that is asked for.
        const double before = quads.positions[3 * MIDDLE];
        ASSERT_EQ(hmf::square_corners(mesh, position, 10, 0.9, quads, call), HMF_OK);
        EXPECT_EQ(quads.positions[3 * MIDDLE], before);
    }
}

namespace {

double worst_of(const double (&corners)[4][3], double unit) {
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::QuadMesh quads;
    quads.start(memory);
    bool room = true;
    for (uint32_t k = 0; k < 4; ++k) {
        const double p[3] = {corners[k][0] * unit, corners[k][1] * unit, corners[k][2] * unit};
        room = room && quads.add_vertex(p, 0, 0) && quads.quads.push(k);
    }
    EXPECT_TRUE(room);
    return hmf::worst_corner(quads, 0);
}

} // namespace

// A rectangle has good corners by their sines however low it is, until two of its corners are one place.
TEST(QuadShape, AQuadWithoutASideIsBad) {
    for (const double unit : {1.0, 0x1p100, 0x1p-100}) {
        const auto worst = [&](double side) {
            return worst_of({{0, 0, 0}, {1, 0, 0}, {1, side, 0}, {0, side, 0}}, unit);
        };
        EXPECT_NEAR(worst(1), 1, 1e-12);
        EXPECT_NEAR(worst(1e-3), 1, 1e-12);
        EXPECT_EQ(worst(1e-8), -1);
        EXPECT_EQ(worst(0), -1);
    }
}

// A square folded along a diagonal, until two opposite corners meet; and one with a corner that gets straight.
TEST(QuadShape, AFoldedQuadIsBad) {
    for (const double unit : {1.0, 0x1p100, 0x1p-100}) {
        const auto folded = [&](double apart) {
            return worst_of({{1, 0, apart}, {0, 1, 0}, {1, 0, -apart}, {0, -1, 0}}, unit);
        };
        EXPECT_GT(folded(0.01), 0);
        EXPECT_EQ(folded(1e-4), -1);
        EXPECT_EQ(folded(0), -1);
        const auto bent = [&](double y) { return worst_of({{-1, 0, 0}, {0, y, 0}, {1, 0, 0}, {0, 1, 0}}, unit); };
        EXPECT_GT(bent(-1e-4), 1e-4);
        EXPECT_EQ(bent(-1e-7), 0);
        EXPECT_EQ(bent(0), 0);
        EXPECT_LT(bent(0.1), -0.1);
    }
}

// A grid in a plane of which a patch lies face down: each of its quads seen by itself is a square, so that
// relaxing them as they lie keeps it; unfolded, all look up.
TEST(UnfoldQuads, PatchFaceDownIsTurned) {
    constexpr uint32_t N = 32, LOW = 14, HIGH = 17;
    test::MadeMesh made(
        test::Triangles{{-40, -40, 0, 80, -40, 0, -40, 80, 0, 0, 0, -40}, {0, 1, 2, 1, 0, 3, 2, 1, 3, 0, 2, 3}});
    const Mesh mesh = made.mesh();
    const double* const position = made.positions.data();
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::QuadMesh quads;
    quads.start(memory);
    const uint32_t side = half_edge_at(mesh, position, false, -1, 0);
    bool room = true;
    for (uint32_t i = 0; i <= N; ++i)
        for (uint32_t j = 0; j <= N; ++j) {
            const bool patch = i >= LOW && i <= HIGH && j >= LOW && j <= HIGH;
            const bool rim = i == 0 || j == 0 || i == N || j == N;
            room = room && quads.positions.push(patch ? LOW + HIGH - i : i) && quads.positions.push(j)
                && quads.positions.push(0) && quads.sides.push(side) && quads.held.push(rim);
        }
    for (uint32_t i = 0; i < N; ++i)
        for (uint32_t j = 0; j < N; ++j)
            for (const uint32_t v :
                 {i * (N + 1) + j, (i + 1) * (N + 1) + j, (i + 1) * (N + 1) + j + 1, i * (N + 1) + j + 1})
                room = room && quads.quads.push(v);
    ASSERT_TRUE(room);
    const auto inwards = [&] {
        size_t count = 0;
        for (size_t q = 0; q < quads.quad_count(); ++q)
            count += !(hmf::worst_corner_from_outside(mesh, position, quads, q) > 0);
        return count;
    };
    const size_t before = inwards();
    EXPECT_GE(before, (HIGH - LOW) * (HIGH - LOW));
    hmf::QuadFigures figures;
    ASSERT_EQ(hmf::quad_figures(mesh, position, nullptr, quads, figures, call), HMF_OK);
    EXPECT_EQ(figures.inverted, before);
    EXPECT_GT(figures.area, N * N + 2 * (HIGH - LOW) * (HIGH - LOW) - 1e-9);
    hmf::Unfolded unfolded;
    ASSERT_EQ(hmf::unfold_quads(mesh, position, hmf::Unfold::on_surface, quads, unfolded, call), HMF_OK);
    EXPECT_TRUE(unfolded.better);
    EXPECT_EQ(inwards(), 0u);
    ASSERT_EQ(hmf::quad_figures(mesh, position, nullptr, quads, figures, call), HMF_OK);
    EXPECT_EQ(figures.inverted, 0u);
    EXPECT_NEAR(figures.area, N * N, 1e-9);
    EXPECT_NEAR(figures.distance, std::sqrt(40.0 * 40 + 48 * 48), 1e-9); // of the corner of the surface
    EXPECT_EQ(quads.positions[0], 0);                                    // what is held stays
}

namespace {

// The surface is one triangle with a side at y = -40.
class OnATriangle : public ::testing::Test {
protected:
    OnATriangle() :
        made(test::Triangles{{-40, -40, 0, 80, -40, 0, -40, 80, 0, 0, 0, -40}, {0, 1, 2, 1, 0, 3, 2, 1, 3, 0, 2, 3}}),
        mesh(made.mesh()), position(made.positions.data()), side(half_edge_at(mesh, position, false, -1, 0)),
        face(mesh.face, mesh.face + 2 * mesh.edge_count), memory(nullptr, nullptr, nullptr, 0),
        call(memory, nullptr, nullptr, nullptr) {
        for (uint32_t& f : face)
            if (f != mesh.face[side]) f = hmf::NONE;
        mesh.face = face.data();
        quads.start(memory);
    }

    test::MadeMesh made;
    Mesh mesh;
    const double* position;
    uint32_t side;
    std::vector<uint32_t> face;
    hmf::Memory memory;
    hmf::Call call;
    hmf::QuadMesh quads;
};

} // namespace

// Random triangles are missing.  Against all edges of the boundary that end at a corner of the triangle.
TEST(Boundary, NearestEdgeAtATriangle) {
    test::MadeMesh made(test::plate(2, 1, 2));
    Mesh mesh = made.mesh();
    const double* const position = made.positions.data();
    std::vector<uint32_t> face(mesh.face, mesh.face + 2 * mesh.edge_count);
    std::mt19937 random(11);
    std::vector<bool> missing(mesh.face_count);
    for (uint32_t f = 0; f < mesh.face_count; ++f) missing[f] = random() % 8 == 0;
    for (uint32_t& f : face)
        if (missing[f]) f = hmf::NONE;
    mesh.face = face.data();
    size_t found = 0, none = 0;
    for (uint32_t side = 0; side < 2 * mesh.edge_count; ++side) {
        if (face[side] == hmf::NONE) continue;
        const uint32_t corner[3] = {mesh.origin[side], mesh.target(side), mesh.origin[mesh.prev(side)]};
        double p[3], nearest[3], t = 0, least = HUGE_VAL;
        for (int k = 0; k < 3; ++k) {
            const double share[3] = {0.2 * (random() % 5), 0.1, 0.3};
            p[k] = 0;
            for (int c = 0; c < 3; ++c) p[k] += share[c] * position[3 * corner[c] + static_cast<uint32_t>(k)];
        }
        for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
            const bool is_at =
                std::count(corner, corner + 3, mesh.origin[h]) + std::count(corner, corner + 3, mesh.target(h));
            if (is_at && face[h] != hmf::NONE && face[h ^ 1u] == hmf::NONE)
                least = std::min(least, hmf::nearest_on_edge(mesh, position, h, p, nearest, t));
        }
        const uint32_t rim = hmf::rim_near(mesh, position, side, p);
        ++(rim == hmf::NONE ? none : found);
        if (rim == hmf::NONE) {
            EXPECT_EQ(least, HUGE_VAL) << side;
            continue;
        }
        EXPECT_NE(face[rim], hmf::NONE);
        EXPECT_EQ(face[rim ^ 1u], hmf::NONE);
        EXPECT_EQ(hmf::nearest_on_edge(mesh, position, rim, p, nearest, t), least) << side;
    }
    EXPECT_GT(found, 50u);
    EXPECT_GT(none, 20u);
}

// Two vertices of a straight boundary in the wrong order: they change places by sliding along it, all else stays.
TEST_F(OnATriangle, VerticesSlideAlongTheBoundary) {
    constexpr uint32_t N = 12;
    bool room = true;
    for (uint32_t i = 0; i <= N; ++i)
        for (uint32_t j = 0; j <= N; ++j) {
            const bool rim = i == 0 || j == N || i == N, slides = !rim && j == 0;
            const double x = j > 0 ? i : i == 5 ? 6 : i == 6 ? 5 : i, p[3] = {x, j - 40.0, 0};
            const uint32_t at = slides ? hmf::rim_near(mesh, position, side, p) : side;
            ASSERT_NE(at, hmf::NONE);
            room = room && quads.add_vertex(p, at, slides ? hmf::AT_BOUNDARY : uint8_t{rim});
        }
    for (uint32_t i = 0; i < N; ++i)
        for (uint32_t j = 0; j < N; ++j) {
            const uint32_t a = i * (N + 1) + j, b = a + N + 1;
            room = room && quads.add_quad(a, b, b + 1, a + 1);
        }
    ASSERT_TRUE(room);
    hmf::Unfolded unfolded;
    ASSERT_EQ(hmf::unfold_quads(mesh, position, hmf::Unfold::on_surface, quads, unfolded, call), HMF_OK);
    EXPECT_TRUE(unfolded.better);
    hmf::QuadFigures figures;
    ASSERT_EQ(hmf::quad_figures(mesh, position, nullptr, quads, figures, call), HMF_OK);
    EXPECT_EQ(figures.inverted, 0u);
    for (uint32_t i = 0; i <= N; ++i) {
        EXPECT_EQ(quads.positions[3 * i * (N + 1) + 1], -40);
        if (i > 0) EXPECT_GT(quads.positions[3 * i * (N + 1)], quads.positions[3 * (i - 1) * (N + 1)]);
    }
}

// Four quads stick out of the surface, and their middle must follow: it does so as a last resort, and no farther than
// it must.  What is not needed for that stays on the surface.
TEST_F(OnATriangle, VerticesLeaveItAsALastResort) {
    constexpr uint32_t N = 14, LOW = 3; // the middle of those four is (6, LOW)
    bool room = true;
    for (uint32_t i = 0; i <= N; ++i)
        for (uint32_t j = 0; j <= N; ++j) {
            const bool sticks_out = i >= 5 && i <= 7 && j >= LOW - 1 && j <= LOW + 1 && !(i == 6 && j == LOW);
            const bool rim = i == 0 || j == 0 || i == N || j == N;
            const double p[3] = {1.0 * i, -40.0 + j - (sticks_out ? LOW + 2.0 : 0.0), 0};
            room = room && quads.add_vertex(p, side, rim || sticks_out ? hmf::AT_CORNER : uint8_t{0});
        }
    for (uint32_t i = 5; i < 7; ++i)
        for (uint32_t j = LOW - 1; j < LOW + 1; ++j) {
            const uint32_t a = i * (N + 1) + j, b = a + N + 1;
            room = room && quads.add_quad(a, b, b + 1, a + 1);
        }
    ASSERT_TRUE(room);
    const auto height = [&] { return quads.positions[3 * (6 * (N + 1) + LOW) + 1]; };
    hmf::QuadFigures figures;
    hmf::Unfolded unfolded;
    ASSERT_EQ(hmf::unfold_quads(mesh, position, hmf::Unfold::on_surface, quads, unfolded, call), HMF_OK);
    ASSERT_EQ(hmf::quad_figures(mesh, position, nullptr, quads, figures, call), HMF_OK);
    EXPECT_EQ(figures.inverted, 2u);
    EXPECT_GE(height(), -40);
    ASSERT_EQ(hmf::unfold_quads(mesh, position, hmf::Unfold::off_surface, quads, unfolded, call), HMF_OK);
    ASSERT_EQ(hmf::quad_figures(mesh, position, nullptr, quads, figures, call), HMF_OK);
    EXPECT_TRUE(unfolded.better);
    EXPECT_EQ(figures.inverted, 0u);
    EXPECT_LT(height(), -41);
    EXPECT_GT(height(), -41.5);
}

// There and back again; and each allocation that fails is told, as what was not kept cannot be given back.
TEST(QuadPlaces, AreKeptOrNot) {
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::QuadMesh quads;
    quads.start(memory);
    const double p[3] = {1, 2, 3}, q[3] = {4, 5, 6};
    ASSERT_TRUE(quads.add_vertex(p, 7, 1) && quads.add_vertex(q, 8, 0));
    size_t kept = 0;
    for (uint64_t fail = 0; fail < 4; ++fail) {
        test::Meter meter;
        meter.fail = fail;
        hmf::Memory measured(test::Meter::take, test::Meter::give, &meter, 0);
        hmf::QuadPlaces places;
        if (!places.keep(quads, measured)) continue;
        ++kept;
        quads.put(0, q, 9);
        places.give_back(quads);
        EXPECT_EQ(quads.positions[0], 1);
        EXPECT_EQ(quads.positions[5], 6);
        EXPECT_EQ(quads.sides[0], 7u);
        EXPECT_EQ(quads.held[0], 1);
        quads.start(memory); // what was given back belongs to the other memory
        ASSERT_TRUE(quads.add_vertex(p, 7, 1) && quads.add_vertex(q, 8, 0));
    }
    EXPECT_EQ(kept, 1u); // three allocations, of which one failed each time but the first
}

} // namespace test_relax_quads
