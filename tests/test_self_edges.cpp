// Edges of value 0 from a vertex to itself, round handles: which of them open when the vertex moves.
#include <gtest/gtest.h>

#include <vector>

#include "../src/foliation/whitehead.hpp"

using namespace hmf;

namespace {

// Two vertices, eight triangles, genus 2.  Side 2e of a triangle runs along edge e, 2e + 1 against it.
enum Edge : uint32_t { e1, e2, e3, d1, d2, p, q, f, a, b, c, g, edges };
constexpr uint32_t with(Edge e) { return 2 * e; }
constexpr uint32_t against(Edge e) { return 2 * e + 1; }

// At v a triangle of value 0 with all its corners, a pair of pants.  Beyond e1 a
// cylinder of height 30 leads to u, at which a handle of value 0 hangs.  A cylinder
// of height 20 leads from e2 to e3.
constexpr uint32_t v = 0, u = 1;
constexpr uint32_t triangles[8][3] = {
    {with(e1), with(e2), with(e3)},                                             // pants
    {against(e1), with(p), against(q)},   {with(f), against(p), with(q)},       // to u
    {against(e2), with(d1), against(d2)}, {against(e3), against(d1), with(d2)}, // round the handle
    {against(f), with(a), against(c)},    {with(c), with(b), against(g)},       // at u
    {with(g), against(a), against(b)}};

struct Pants {
    std::vector<uint32_t> origin, next, face, out{with(e1), with(f)};
    std::vector<int64_t> value;
    std::vector<double> weight;
    Memory memory{nullptr, nullptr, nullptr, 0};
    Foliation foliation;
    Rings rings;
    Star star;

    Pants() : origin(2 * edges), next(2 * edges), face(2 * edges), value(edges, 0), weight(edges, 1) {
        for (uint32_t t = 0; t < 8; ++t)
            for (uint32_t s = 0; s < 3; ++s) {
                next[triangles[t][s]] = triangles[t][(s + 1) % 3];
                face[triangles[t][s]] = t;
            }
        for (uint32_t h = 0; h < 2 * edges; ++h) origin[h] = h >= with(f) || h == against(p) || h == against(q) ? u : v;
        value[p] = value[q] = 30;
        value[d1] = value[d2] = 20;
        Mesh& mesh = foliation.mesh;
        mesh.vertex_count = 2;
        mesh.edge_count = edges;
        mesh.face_count = 8;
        mesh.origin = origin.data();
        mesh.next = next.data();
        mesh.face = face.data();
        mesh.out = out.data();
        foliation.value = value.data();
        EXPECT_EQ(check(mesh), nullptr);
        EXPECT_TRUE(foliation.allocate_scratch(2, memory));
    }
    void prepare() {
        ASSERT_TRUE(rings.build(foliation.mesh, weight.data(), memory) && star.allocate(memory, rings.max_degree));
    }
    void expect_foliation() {
        const SingularityCount count = count_singularities(foliation);
        EXPECT_EQ(count.poles, 0u);
        EXPECT_EQ(count.broken_triangles, 0u);
        EXPECT_EQ(count.index_sum, -4);
    }
    const Rings::Side* side(uint32_t vertex) { return &rings.side[rings.offset[vertex]]; }
    void read(uint32_t vertex) {
        read_star(foliation, side(vertex), rings.offset[vertex + 1] - rings.offset[vertex], weight.data(), star);
    }
    // The direction that this half-edge of v leaves in, whatever pulls.
    void choose(uint32_t half_edge) {
        read(v);
        for (uint32_t t = 0; t < star.degree; ++t)
            if (side(v)[t].half_edge == half_edge) star.best = star.group[t];
    }
    // Into the direction of the largest pull.
    void move(uint32_t vertex, int64_t mu) {
        read(vertex);
        ASSERT_TRUE(plan_move(foliation, side(vertex), star));
        EXPECT_TRUE(foliation.pushed.empty());
        ASSERT_GE(room_for_move(foliation, side(vertex), star), mu);
        apply_move(foliation, side(vertex), star, mu);
        expect_foliation();
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
    pants.move(v, 5);
    const std::vector<int64_t> after{0, 10, 10, 30, 30, 25, 25, 0, 0, 0, 0, 0};
    EXPECT_EQ(pants.value, after);
}

// The same into the cylinder of the handle, whose other end v leaves.
TEST(SelfEdges, IntoAHandle) {
    Pants pants;
    pants.prepare();
    pants.choose(with(d1));
    ASSERT_TRUE(plan_move(pants.foliation, pants.side(v), pants.star));
    apply_move(pants.foliation, pants.side(v), pants.star, 5);
    const std::vector<int64_t> after{10, 0, 10, 20, 20, 35, 35, 0, 0, 0, 0, 0};
    EXPECT_EQ(pants.value, after);
    pants.expect_foliation();
}

// Cut along a, b, c or g the handle stays in one piece; f bounds an annulus without a triangle.
TEST(SelfEdges, RoundAHandle) {
    Pants pants;
    pants.prepare();
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
    ASSERT_TRUE(plan_move(pants.foliation, pants.side(v), pants.star));
    EXPECT_TRUE(pants.foliation.pushed.empty());
    apply_move(pants.foliation, pants.side(v), pants.star, 5);
    const std::vector<int64_t> after{10, 0, 10, 20, 20, 5, 5, 0, 0, 0, 0, 0};
    EXPECT_EQ(pants.value, after);
    pants.expect_foliation();
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
