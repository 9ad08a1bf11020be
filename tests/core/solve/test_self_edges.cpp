// Edges of value 0 from a vertex to itself, around handles: which of them open when the vertex moves.
#include <gtest/gtest.h>

#include <vector>

#include "support/small_surface.hpp"

namespace test_self_edges {

using namespace hmf;
using test::against;
using test::with;

namespace {

// Two vertices, eight triangles, genus 2.
enum Edge : uint32_t { e1, e2, e3, d1, d2, p, q, f, a, b, c, g, edges };

// At v a triangle of value 0 with all its corners, a pair of pants.  Beyond e1 a
// cylinder of height 30 leads to u, at which a handle of value 0 hangs.  A cylinder
// of height 20 leads from e2 to e3.
constexpr uint32_t v = 0, u = 1;

struct Pants : test::SmallSurface {
    Pants() : SmallSurface(triangles(), start(), 2) {
        value[p] = value[q] = 30;
        value[d1] = value[d2] = 20;
    }

private:
    static test::TriangleSides triangles() {
        test::TriangleSides all{{with(e1), with(e2), with(e3)},       // pants
                                {against(e1), with(p), against(q)},   // to u
                                {with(f), against(p), with(q)},       //
                                {against(e2), with(d1), against(d2)}, // around the handle
                                {against(e3), against(d1), with(d2)}};
        test::add_handle(all, against(f), a); // at u
        return all;
    }
    static std::vector<uint32_t> start() {
        std::vector<uint32_t> all(2 * edges);
        for (uint32_t h = 0; h < 2 * edges; ++h) all[h] = h >= with(f) || h == against(p) || h == against(q) ? u : v;
        return all;
    }
};

} // namespace

// Beyond e1 v goes one way, seen from both ends: it stays closed.  It is the only one of the three that does, but
// each of the others is in a triangle with it.
TEST(SelfEdges, OneOfThreeRoundPants) {
    Pants pants;
    pants.weight[p] = pants.weight[q] = 10;
    pants.prepare();
    pants.expect_foliation();
    pants.read(v);
    pants.move(v, 5);
    const std::vector<int64_t> after{0, 10, 10, 30, 30, 25, 25, 0, 0, 0, 0, 0};
    EXPECT_EQ(pants.value, after);
}

// The same into the cylinder of the handle, whose other end v leaves.
TEST(SelfEdges, IntoAHandle) {
    Pants pants;
    pants.prepare();
    pants.choose(with(d1));
    pants.move(v, 5);
    const std::vector<int64_t> after{10, 0, 10, 20, 20, 35, 35, 0, 0, 0, 0, 0};
    EXPECT_EQ(pants.value, after);
}

// Cut along a, b, c or g the handle stays in one piece; f bounds an annulus without a triangle.
TEST(SelfEdges, RoundAHandle) {
    Pants pants;
    pants.prepare();
    pants.read(u);
    pants.move(u, 5);
    const std::vector<int64_t> after{0, 0, 0, 20, 20, 25, 25, 0, 10, 10, 10, 10};
    EXPECT_EQ(pants.value, after);
}

// Nothing between v and u: what hangs on v beyond e1 is a handle.  Where that is too much to be looked at, v waits.
TEST(SelfEdges, WithAHandleBehind) {
    Pants pants;
    pants.value[p] = pants.value[q] = 0;
    pants.prepare();
    pants.expect_foliation();
    pants.choose(with(d1));
    pants.star.budget = 0;
    EXPECT_FALSE(plan_move(pants.foliation, pants.side(v), pants.star));
    pants.star.budget = NONE;
    pants.move(v, 5);
    const std::vector<int64_t> after{10, 0, 10, 20, 20, 5, 5, 0, 0, 0, 0, 0};
    EXPECT_EQ(pants.value, after);
}

// Cut along e the torus hangs together by the edge x, and is no annulus.
TEST(SelfEdges, CrossedByAnother) {
    constexpr uint32_t e = test::Polygon::others(4), x = e + 1;
    test::Polygon torus({with(e), with(x), against(e), against(x)}, {1, 1, 1, 1}, {}, {1, 1, 1, 1}, 2);
    torus.prepare();
    torus.choose(with(1));
    torus.move(1, 5);
    const std::vector<int64_t> after{35, 25, 35, 35, 35, 0, 0, 0, 0, 0, 10, 10};
    EXPECT_EQ(torus.value, after);
}

// Or by edges x and y, which come back to vertex 1 on the other side of e.
TEST(SelfEdges, CrossedByAPath) {
    test::HexagonTorus torus;
    torus.prepare();
    torus.choose(with(1));
    torus.move(1, 5);
    const std::vector<int64_t> after{35, 25, 30, 35, 35, 30, 35, 0, 0, 0, 0, 0, 10, 5, 5};
    EXPECT_EQ(torus.value, after);
}

// An annulus from e to the polygon, with vertex 1 in it.  Marked, it is none; else it goes along, and e stays closed.
TEST(SelfEdges, RoundAMarkedVertex) {
    constexpr uint32_t e = test::Polygon::others(2), x = e + 1, y = e + 2, a = e + 3;
    for (const bool marked : {false, true}) {
        test::TriangleSides more{{with(e), with(x), with(y)}};
        test::add_handle(more, against(e), a);
        test::Polygon surface({against(y), against(x)}, {2, 1}, more, {2, 2, 2, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2}, 3,
                              marked ? 2 : 0);
        surface.prepare();
        surface.expect_foliation();
        surface.choose(with(0));
        ASSERT_TRUE(plan_move(surface.foliation, surface.side(2), surface.star));
        EXPECT_EQ(surface.foliation.pushed.size(), marked ? 0u : 1u);
        apply_move(surface.foliation, surface.side(2), surface.star, 5);
        surface.expect_foliation();
        std::vector<int64_t> after{25, 25, 25, 0, 0, 0, 0, 0, 0, 0, 0, 10, 10, 10, 10};
        if (marked) after[1] = 30, after[e] = 10, after[x] = after[y] = 5;
        EXPECT_EQ(surface.value, after);
    }
}

// The same of two triangles and three vertices.
TEST(SelfEdges, RoundTwoTriangles) {
    constexpr uint32_t e = test::Polygon::others(3), x = e + 1, y = e + 2, p = e + 3, q = e + 4, a = e + 5;
    test::TriangleSides more{{with(e), with(x), with(y)}, {against(y), with(p), with(q)}};
    test::add_handle(more, against(e), a);
    test::Polygon surface({against(q), against(p), against(x)}, {2, 3, 1}, more,
                          {2, 2, 2, 1, 1, 2, 1, 3, 3, 2, 2, 2, 2, 2, 2, 2, 2, 2}, 4);
    surface.prepare();
    surface.expect_foliation();
    surface.choose(with(0));
    ASSERT_TRUE(plan_move(surface.foliation, surface.side(2), surface.star));
    EXPECT_EQ(surface.foliation.pushed.size(), 2u);
    apply_move(surface.foliation, surface.side(2), surface.star, 5);
    surface.expect_foliation();
    const std::vector<int64_t> after{25, 25, 25, 25, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 10, 10, 10, 10};
    EXPECT_EQ(surface.value, after);
}

TEST(SelfEdges, RelaxToTheMinimum) {
    Pants pants;
    pants.weight[p] = pants.weight[q] = 10;
    pants.prepare();
    for (int64_t& x : pants.value) x <<= 30;
    SweepResult result;
    for (int sweep = 0; sweep < 300; ++sweep)
        for (const uint32_t vertex : {u, v})
            relax_vertex(pants.foliation, pants.rings, pants.weight.data(), vertex, pants.star, result);
    EXPECT_EQ(result.blocked, 0u);
    EXPECT_GT(pants.value[e2], 0);
    Call call(pants.memory, nullptr, nullptr, nullptr);
    EXPECT_LT(residuals(pants.foliation, pants.rings, pants.weight.data(), pants.star, nullptr, call).max, 1e-8);
    pants.expect_foliation();
}

} // namespace test_self_edges
