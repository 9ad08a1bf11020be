// Relaxed quads on a sharp edge: an edge of a box with a row of squares on each of its two faces.
//
//     o---o---o---o      on top, held
//     |   |   |   |
//     x--x-----x--x      on the edge: they slide along it until they are even
//     |   |   |   |
//     o---o---o---o      on the side, held
#include "src/applications/quads/corner_energy.hpp"
#include "src/applications/quads/fit_quads.hpp"
#include "src/applications/quads/optimize_quads.hpp"
#include "src/applications/quads/quad_figures.hpp"
#include "src/applications/quads/quad_mesh.hpp"
#include "src/applications/quads/quad_shape.hpp"
#include "src/applications/quads/surface_lines.hpp"
#include "src/applications/quads/surface_search.hpp"
#include "src/applications/quads/surface_walk.hpp"
#include "support/make_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace test_relax_quads {

namespace {

using hmf::Mesh;

constexpr uint32_t COLUMNS = 7;

hmf::SurfaceSearch search_of(const Mesh& mesh, const double* position, hmf::Memory& memory) {
    hmf::SurfaceSearch surface;
    EXPECT_TRUE(surface.build(mesh, position, memory));
    return surface;
}

void optimize(const Mesh& mesh, const double* position, hmf::QuadMesh& quads, hmf::Call& call) {
    const hmf::SurfaceSearch surface = search_of(mesh, position, call.memory);
    hmf::QuadOptimizer optimizer(mesh, position, surface, quads, call);
    ASSERT_EQ(optimizer.start(), HMF_OK);
    ASSERT_EQ(optimizer.untangle(), HMF_OK);
    ASSERT_EQ(optimizer.shape(400), HMF_OK);
}

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
        for (uint32_t v = COLUMNS; v < 2 * COLUMNS; ++v) {
            const hmf::Point p{quads.positions[3 * v], 0, 1}, from = hmf::point(position, mesh.origin[side[1]]);
            const double ahead = hmf::point(position, mesh.target(side[1])).x - from.x;
            hmf::Point there;
            const uint32_t h = hmf::slide_along_sharp_edges(mesh, position, side[1], from,
                                                            (p.x - from.x) / (ahead > 0 ? 1 : -1), there);
            quads.put(v, p, h);
        }
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
    optimize(mesh, made.positions.data(), quads, call);
    for (uint32_t i = 0; i < COLUMNS; ++i) {
        EXPECT_TRUE(is_on_the_edge(COLUMNS + i));
        EXPECT_NEAR(quads.positions[3 * (COLUMNS + i)], even(i), 0.03);
    }
}

// A cube of six quads that cut one corner off by less than half a side: their vertex goes there.
TEST(ReachTips, ACornerIsTaken) {
    constexpr uint32_t SIDES[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 2, 6, 4},
                                      {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}};
    test::Triangles cube;
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::QuadMesh quads;
    quads.start(memory);
    for (uint32_t v = 0; v < 8; ++v) {
        const hmf::Point p{v & 4u ? 1.0 : 0.0, v & 2u ? 1.0 : 0.0, v & 1u ? 1.0 : 0.0};
        cube.positions.insert(cube.positions.end(), {p.x, p.y, p.z});
        ASSERT_TRUE(quads.add_vertex(v == 0 ? hmf::Point{0.3, 0.3, 0} : p, 0, v == 0 ? uint8_t{0} : hmf::AT_TIP));
    }
    for (const auto& q : SIDES) {
        cube.triangles.insert(cube.triangles.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
        ASSERT_TRUE(quads.add_quad(q[0], q[1], q[2], q[3]));
    }
    test::MadeMesh made(cube);
    size_t moved = 0;
    const hmf::SurfaceSearch surface = search_of(made.mesh(), made.positions.data(), memory);
    ASSERT_EQ(hmf::reach_tips(made.mesh(), made.positions.data(), surface, quads, moved, call), HMF_OK);
    EXPECT_EQ(moved, 1u);
    EXPECT_EQ(quads.held[0], hmf::AT_TIP);
    EXPECT_EQ(square_of(at(quads, 0)), 0);
}

TEST(CornerEnergy, SlopesAreThoseOfTheValue) {
    constexpr double H = 1e-6;
    for (const double eps : {1.0, 0.1})
        for (const double s : {0.5, 2.0})
            for (const double a : {-1.5, -0.1, 0.3, 1.0})
                for (const double c : {-0.7, 0.2}) {
                    const hmf::CornerEnergy e = hmf::corner_energy(s, a, c, eps);
                    const auto slope = [&](double ds, double da, double dc) {
                        return (hmf::corner_energy(s + H * ds, a + H * da, c + H * dc, eps).value
                                - hmf::corner_energy(s - H * ds, a - H * da, c - H * dc, eps).value)
                             / (2 * H);
                    };
                    const double tolerance = 1e-5 * (1 + e.value * e.value);
                    EXPECT_NEAR(e.by_s, slope(1, 0, 0), tolerance);
                    EXPECT_NEAR(e.by_a + e.by_c * e.cot_a, slope(0, 1, 0), tolerance);
                    EXPECT_NEAR(e.by_c * e.cot_c, slope(0, 0, 1), tolerance);
                }
}

// The least of all corners is a square of the area wished.
TEST(CornerEnergy, ASquareIsLeast) {
    const double least = hmf::corner_energy(1, 1, 0, 0).value;
    EXPECT_DOUBLE_EQ(least, 1 + hmf::SIZE);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-2, 2);
    for (int k = 0; k < 1000; ++k) {
        const double e[2] = {any(random), any(random)}, b[2] = {any(random), any(random)};
        const double a = e[0] * b[1] - e[1] * b[0], c = e[0] * b[0] + e[1] * b[1];
        if (a > 0)
            EXPECT_GE(hmf::corner_energy(0.5 * (e[0] * e[0] + e[1] * e[1] + b[0] * b[0] + b[1] * b[1]), a, c, 0).value,
                      least);
    }
}

// A grid in a plane, held at its rim, in disorder inside: squares are the least.
TEST(OptimizeQuads, DisorderBecomesSquares) {
    constexpr uint32_t N = 10;
    test::MadeMesh made(
        test::Triangles{{-40, -40, 0, 80, -40, 0, -40, 80, 0, 0, 0, -40}, {0, 1, 2, 1, 0, 3, 2, 1, 3, 0, 2, 3}});
    const Mesh mesh = made.mesh();
    const double* const position = made.positions.data();
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    const hmf::SurfaceSearch surface = search_of(mesh, position, memory);
    const uint32_t side = half_edge_at(mesh, position, false, -1, 0);
    for (const double most : {0.3, 1.5}) { // with few inverted quads, with many
        std::mt19937 random(5);
        std::uniform_real_distribution<double> off(-most, most);
        hmf::QuadMesh quads;
        quads.start(memory);
        bool room = true;
        for (uint32_t i = 0; i <= N; ++i)
            for (uint32_t j = 0; j <= N; ++j) {
                const bool rim = i == 0 || j == 0 || i == N || j == N;
                const hmf::Point p{i + (rim ? 0 : off(random)), j + (rim ? 0 : off(random)), 0};
                room = room && quads.add_vertex(p, side, rim ? hmf::AT_CORNER : uint8_t{0});
            }
        for (uint32_t i = 0; i < N; ++i)
            for (uint32_t j = 0; j < N; ++j) {
                const uint32_t a = i * (N + 1) + j, b = a + N + 1;
                room = room && quads.add_quad(a, b, b + 1, a + 1);
            }
        ASSERT_TRUE(room);
        uint64_t inverted = 0;
        ASSERT_TRUE(hmf::count_inverted(surface, quads, inverted, call));
        if (most > 1) EXPECT_GT(inverted, N * N / 2);
        optimize(mesh, position, quads, call);
        ASSERT_TRUE(hmf::count_inverted(surface, quads, inverted, call));
        EXPECT_EQ(inverted, 0u);
        for (uint32_t v = 0; v < quads.vertex_count(); ++v) {
            EXPECT_NEAR(quads.positions[3 * v], v / (N + 1), 0.1);
            EXPECT_NEAR(quads.positions[3 * v + 1], v % (N + 1), 0.1);
        }
    }
}

namespace {

double worst_of(const double (&corners)[4][3], double unit) {
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::QuadMesh quads;
    quads.start(memory);
    bool room = true;
    for (uint32_t k = 0; k < 4; ++k) {
        const hmf::Point p{corners[k][0] * unit, corners[k][1] * unit, corners[k][2] * unit};
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

// Random points, directions and distances, against all triangles.  Some of the triangles are no part of the surface.
TEST(SurfaceSearch, FindsWhatAllTrianglesShow) {
    test::MadeMesh made(test::plate(2, 1, 2));
    Mesh mesh = made.mesh();
    const double* const position = made.positions.data();
    std::vector<uint32_t> face(mesh.face, mesh.face + 2 * mesh.edge_count);
    for (uint32_t& f : face)
        if (f % 7 == 3) f = hmf::NONE;
    mesh.face = face.data();
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    const hmf::SurfaceSearch surface = search_of(mesh, position, memory);
    std::mt19937 random(17);
    std::uniform_real_distribution<double> any(-1, 1);
    size_t behind = 0;
    for (int k = 0; k < 2000; ++k) {
        const hmf::Point n{any(random), any(random), any(random)},
            p = hmf::point(position, random() % mesh.vertex_count) + hmf::Point{any(random), any(random), any(random)};
        const double room = 0.3 * (any(random) + 1);
        double nearest = HUGE_VAL, agrees = HUGE_VAL;
        for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
            if (face[h] == hmf::NONE) continue;
            const double square = hmf::nearest_in_face(mesh, position, h, p).square;
            nearest = std::min(nearest, square);
            if (dot(hmf::normal_at(mesh, position, h), n) > 0) agrees = std::min(agrees, square);
        }
        if (std::fabs(agrees - nearest - room * room) < 1e-9) continue;
        EXPECT_EQ(surface.is_behind(p, n, room), agrees > nearest + room * room) << k;
        behind += agrees > nearest + room * room;
    }
    EXPECT_GT(behind, 300u);
    EXPECT_LT(behind, 1700u);
}

// A quad whose corners lie on the upper side of a plate, which is thin beside it: seen from below it is folded, and it
// is not while one side of the plate is as near as the other one.
TEST(QuadShape, AQuadUnderThePlateIsFolded) {
    test::MadeMesh made(test::plate(0, 1, 2));
    const Mesh mesh = made.mesh();
    const double* const position = made.positions.data();
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    const hmf::SurfaceSearch surface = search_of(mesh, position, memory);
    double low = HUGE_VAL, high = -HUGE_VAL, x = 0, y = 0;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        low = std::min(low, position[3 * v + 2]);
        high = std::max(high, position[3 * v + 2]);
        x += position[3 * v] / mesh.vertex_count;
        y += position[3 * v + 1] / mesh.vertex_count;
    }
    const auto is_folded = [&](double z) {
        hmf::QuadMesh quads;
        quads.start(memory);
        const double half = 0.1 * (high - low), corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
        for (const auto& c : corner) {
            const hmf::Point p{x + c[0] * half, y + c[1] * half, z};
            EXPECT_TRUE(quads.add_vertex(p, 0, 0) && quads.quads.push(quads.vertex_count() - 1));
        }
        return !(hmf::worst_corner(quads, 0, &surface) > 0);
    };
    EXPECT_FALSE(is_folded(high));
    EXPECT_FALSE(is_folded(0.6 * high + 0.4 * low));
    EXPECT_FALSE(is_folded(0.5 * high + 0.5 * low));
    EXPECT_TRUE(is_folded(0.4 * high + 0.6 * low));
    EXPECT_TRUE(is_folded(low));
}

namespace {

// A grid in a plane of which a patch lies face down: each of its quads seen by itself is a square.
class PatchFaceDown : public ::testing::Test {
protected:
    static constexpr uint32_t N = 32, LOW = 14, HIGH = 17;

    PatchFaceDown() :
        made(test::Triangles{{-40, -40, 0, 80, -40, 0, -40, 80, 0, 0, 0, -40}, {0, 1, 2, 1, 0, 3, 2, 1, 3, 0, 2, 3}}),
        mesh(made.mesh()), position(made.positions.data()), memory(nullptr, nullptr, nullptr, 0),
        call(memory, nullptr, nullptr, nullptr), surface(search_of(mesh, position, memory)) {
        quads.start(memory);
        const uint32_t side = half_edge_at(mesh, position, false, -1, 0);
        bool room = true;
        for (uint32_t i = 0; i <= N; ++i)
            for (uint32_t j = 0; j <= N; ++j) {
                const bool patch = i >= LOW && i <= HIGH && j >= LOW && j <= HIGH;
                const bool rim = i == 0 || j == 0 || i == N || j == N;
                const hmf::Point p{double(patch ? LOW + HIGH - i : i), double(j), 0};
                room = room && quads.add_vertex(p, side, rim);
            }
        for (uint32_t i = 0; i < N; ++i)
            for (uint32_t j = 0; j < N; ++j) {
                const uint32_t a = i * (N + 1) + j, b = a + N + 1;
                room = room && quads.add_quad(a, b, b + 1, a + 1);
            }
        EXPECT_TRUE(room);
    }

    test::MadeMesh made;
    Mesh mesh;
    const double* position;
    hmf::Memory memory;
    hmf::Call call;
    hmf::SurfaceSearch surface;
    hmf::QuadMesh quads;
};

} // namespace

TEST_F(PatchFaceDown, IsTurned) {
    const auto inwards = [&] {
        size_t count = 0;
        for (size_t q = 0; q < quads.quad_count(); ++q) count += !(hmf::worst_corner(quads, q, &surface) > 0);
        return count;
    };
    const size_t before = inwards();
    EXPECT_GE(before, (HIGH - LOW) * (HIGH - LOW));
    hmf::QuadFigures figures;
    ASSERT_EQ(hmf::quad_figures(mesh, position, quads, figures, call), HMF_OK);
    EXPECT_EQ(figures.inverted, before);
    EXPECT_GT(figures.area, N * N + 2 * (HIGH - LOW) * (HIGH - LOW) - 1e-9);
    optimize(mesh, position, quads, call);
    EXPECT_EQ(inwards(), 0u);
    ASSERT_EQ(hmf::quad_figures(mesh, position, quads, figures, call), HMF_OK);
    EXPECT_EQ(figures.inverted, 0u);
    EXPECT_NEAR(figures.area, N * N, 1e-9);
    EXPECT_NEAR(figures.distance, std::sqrt(40.0 * 40 + 48 * 48), 1e-9); // of the corner of the surface
    EXPECT_EQ(quads.positions[0], 0);                                    // what is held stays
}

// The optimizer remembers which quads are folded: what it knows after each stage is what a new one finds.
TEST_F(PatchFaceDown, FoldedQuadsAreKnown) {
    hmf::QuadOptimizer optimizer(mesh, position, surface, quads, call);
    ASSERT_EQ(optimizer.start(), HMF_OK);
    const auto expect_known = [&](const char* stage, bool any) {
        hmf::QuadOptimizer other(mesh, position, surface, quads, call);
        ASSERT_EQ(other.start(), HMF_OK);
        size_t folded = 0;
        for (size_t q = 0; q < quads.quad_count(); ++q) {
            EXPECT_EQ(optimizer.is_folded(q), other.is_folded(q)) << stage << ": " << q;
            folded += other.is_folded(q);
        }
        EXPECT_EQ(folded > 0, any) << stage;
    };
    expect_known("start", true);
    ASSERT_EQ(optimizer.shape(3), HMF_OK); // some of the patch turns over: steps that fold no more quads are allowed
    expect_known("shape", true);
    ASSERT_EQ(optimizer.untangle(), HMF_OK);
    expect_known("untangle", false);
    const uint32_t v = N / 2 * (N + 1) + N / 2;
    quads.put(v, at(quads, v) + hmf::Point{3, 0, 0}, quads.sides[v]);
    optimizer.look_again();
    expect_known("moved from outside", true);
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
        hmf::Point p;
        double least = HUGE_VAL;
        for (const uint32_t c : corner) p = p + 0.2 * (random() % 5) * hmf::point(position, c);
        const auto square_to = [&](uint32_t h) { return square_of(p - hmf::nearest_on_edge(mesh, position, h, p)); };
        for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
            const bool is_at =
                std::count(corner, corner + 3, mesh.origin[h]) + std::count(corner, corner + 3, mesh.target(h));
            if (is_at && face[h] != hmf::NONE && face[h ^ 1u] == hmf::NONE) least = std::min(least, square_to(h));
        }
        const uint32_t rim = hmf::rim_near(mesh, position, side, p);
        ++(rim == hmf::NONE ? none : found);
        if (rim == hmf::NONE) {
            EXPECT_EQ(least, HUGE_VAL) << side;
            continue;
        }
        EXPECT_NE(face[rim], hmf::NONE);
        EXPECT_EQ(face[rim ^ 1u], hmf::NONE);
        EXPECT_EQ(square_to(rim), least) << side;
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
            const hmf::Point p{double(j > 0 ? i : i == 5 ? 6 : i == 6 ? 5 : i), j - 40.0, 0};
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
    optimize(mesh, position, quads, call);
    hmf::QuadFigures figures;
    ASSERT_EQ(hmf::quad_figures(mesh, position, quads, figures, call), HMF_OK);
    EXPECT_EQ(figures.inverted, 0u);
    for (uint32_t i = 0; i <= N; ++i) {
        EXPECT_EQ(quads.positions[3 * i * (N + 1) + 1], -40);
        if (i > 0) EXPECT_GT(quads.positions[3 * i * (N + 1)], quads.positions[3 * (i - 1) * (N + 1)]);
    }
}

// The outer vertices of a grid lie anywhere along the boundary of a triangle, some of them at one place: then each
// corner of it has a vertex, those of one quad where they are near, and all come in order once around.
TEST_F(OnATriangle, CornersOfTheBoundaryAreTaken) {
    constexpr uint32_t N = 7;
    const double side_length[3] = {120, std::sqrt(2.0) * 120, 120}, whole = 240 + side_length[1];
    const double corner[3][2] = {{-40, -40}, {80, -40}, {-40, 80}};
    const auto point_at = [&](double s) {
        int k = 0;
        s -= std::floor(s / whole) * whole;
        for (; k < 2 && s > side_length[k]; ++k) s -= side_length[k];
        const double *const a = corner[k], *const b = corner[(k + 1) % 3], t = s / side_length[k];
        return hmf::Point{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), 0};
    };
    bool room = true;
    std::vector<uint32_t> loop;
    for (uint32_t i = 0; i <= N; ++i)
        for (uint32_t j = 0; j <= N; ++j) {
            const bool rim = i == 0 || j == 0 || i == N || j == N;
            const uint32_t along = j == 0 ? i : i == N ? N + j : j == N ? 3 * N - i : 4 * N - j; // counterclockwise
            const hmf::Point p = rim ? point_at(whole * (along / 3 * 3 + 0.4) / (4 * N)) : hmf::Point{};
            const uint32_t at = rim ? hmf::rim_near(mesh, position, side, p) : side;
            ASSERT_NE(at, hmf::NONE);
            room = room && quads.add_vertex(p, at, rim ? hmf::AT_BOUNDARY : uint8_t{0});
        }
    for (uint32_t i = 0; i < N; ++i)
        for (uint32_t j = 0; j < N; ++j) {
            const uint32_t a = i * (N + 1) + j, b = a + N + 1;
            room = room && quads.add_quad(a, b, b + 1, a + 1);
        }
    ASSERT_TRUE(room);
    ASSERT_EQ(hmf::place_on_boundary(mesh, position, quads, call), HMF_OK);
    for (uint32_t i = 0; i < N; ++i) loop.push_back(i * (N + 1));
    for (uint32_t j = 0; j < N; ++j) loop.push_back(N * (N + 1) + j);
    for (uint32_t i = N; i > 0; --i) loop.push_back(i * (N + 1) + N);
    for (uint32_t j = N; j > 0; --j) loop.push_back(j);
    size_t taken = 0;
    double around = 0;
    for (size_t k = 0; k < loop.size(); ++k) {
        const uint32_t v = loop[k], w = loop[(k + 1) % loop.size()];
        const double *const p = &quads.positions[3 * v], *const q = &quads.positions[3 * w];
        const double length = std::hypot(q[0] - p[0], q[1] - p[1]);
        EXPECT_GT(length, 0.1) << k;
        around += length;
        for (const auto& c : corner)
            if (std::hypot(p[0] - c[0], p[1] - c[1]) < 1e-9) {
                ++taken;
                EXPECT_EQ(quads.held[v], hmf::AT_CORNER);
            }
    }
    EXPECT_EQ(taken, 3u);
    EXPECT_NEAR(around, whole, 1e-6);
}

} // namespace test_relax_quads
