// Parts of a unit: where a residual above the tolerance is the rounding to one (src/core/extreme/fraction.hpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/core/api/foliation_object.hpp"
#include "src/core/extreme/fraction.hpp"
#include "src/core/solve/solve.hpp"
#include "src/core/solve/twisted_model.hpp"
#include "support/small_surface.hpp"
#include "support/surface.hpp"

namespace test_fractions {

using namespace test;

namespace {

TriMesh stretched(const TriMesh& mesh, double factor) { return transformed(mesh, {factor, 0, 0, 0, 1, 0, 0, 0, 1}); }

// The integers of a solution, and what the stages make of them.
struct Loaded {
    hmf_error error{};
    hmf::Memory memory{nullptr, nullptr, nullptr, 0};
    hmf::Call call{memory, &error, nullptr, nullptr};
    hmf::State state;
    const double* weight;
    hmf::Rings rings;
    hmf::Star star;
    hmf::TwistedModel model;

    Loaded(const Hierarchy& hierarchy, const Solution& s) : weight(hierarchy.get()->levels[0].weight) {
        double unit = 1;
        EXPECT_FALSE(hmf::load_solved(*s.foliation, state, unit, call));
        const hmf::Mesh& mesh = state.foliation.mesh;
        EXPECT_TRUE(rings.build(mesh, weight, memory) && star.allocate(memory, rings.max_degree)
                    && model.allocate(mesh, memory) && model.linearize(state.foliation, rings, weight, star, call));
    }
};

struct Moved {
    size_t regular = 0, zeros = 0;
};

// With two bits more parts are integers, up to an eighth of a unit.  Those are a foliation in the class.  The residuals
// of the call are those of the solve.
Moved expect_foliation_with_parts(const Hierarchy& hierarchy, const Solution& s, size_t vertex_count) {
    Moved moved;
    const std::vector<double> of_call = residuals(s.foliation, vertex_count);
    EXPECT_DOUBLE_EQ(*std::max_element(of_call.begin(), of_call.end()), s.report.residual_max);
    const double* const part = s.foliation->fraction;
    if (!part) return moved;
    Loaded loaded(hierarchy, s);
    hmf::State& state = loaded.state;
    hmf::Call& call = loaded.call;
    hmf::Foliation& f = state.foliation;
    const hmf::Mesh& mesh = f.mesh;
    const double* const weight = loaded.weight;
    const hmf::Rings& rings = loaded.rings;
    hmf::Star& star = loaded.star;
    hmf::TwistedModel& model = loaded.model;
    star.budget = hmf::NONE;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        if (part[v] == 0) continue;
        ++(model.is_fixed[v] ? moved.zeros : moved.regular);
        if (!model.is_fixed[v]) continue;
        EXPECT_TRUE(part[v] > 0 && part[v] < 1) << part[v];
        const hmf::Rings::Side* side = &rings.side[rings.offset[v]];
        const uint32_t degree = rings.offset[v + 1] - rings.offset[v];
        hmf::read_star(f, side, degree, weight, star);
        EXPECT_TRUE(hmf::plan_move(f, side, star));
        for (uint32_t t = 0; t < degree; ++t) model.sign[side[t].half_edge] = static_cast<int8_t>(-star.step[t]);
    }
    hmf::ClassGuard guard;
    EXPECT_EQ(guard.start(state, 1, nullptr, hmf::Array<int64_t>(), call), HMF_OK);
    EXPECT_TRUE(guard.started);
    const hmf::SingularityCount before = hmf::count_singularities(f);
    constexpr int64_t finer = 4; // more the certificate has no room for
    const auto place = [&](uint32_t h) {
        return model.sign[h] * static_cast<int64_t>(std::floor(finer * part[mesh.origin[h]] + 0.5));
    };
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        EXPECT_LE(f.value[e], hmf::LARGEST_INNER_VALUE);
        f.value[e] = std::abs(finer * f.value[e] - place(2 * e) - place(2 * e + 1));
    }
    const hmf::SingularityCount after = hmf::count_singularities(f);
    EXPECT_EQ(after.broken_triangles, 0u);
    EXPECT_EQ(after.poles, 0u);
    EXPECT_EQ(after.index_sum, before.index_sum);
    // A value is rounded by a unit at most, and what one side pulls more than all others by its weights.
    std::vector<double> rounded(mesh.vertex_count);
    hmf::residuals(f, rings, weight, star, rounded.data(), call);
    double total = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) total += weight[e] * static_cast<double>(f.value[e]);
    const double floor = hmf::pull_floor(total, mesh.vertex_count);
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        double pull = 0;
        for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t) {
            const uint32_t e = hmf::edge_of(rings.side[t].half_edge);
            pull += weight[e] * static_cast<double>(f.value[e]);
        }
        EXPECT_LE(rounded[v], 1.001 * (s.report.residual_max + rings.weight_sum[v] / std::max(floor, pull))) << v;
    }
    EXPECT_EQ(guard.certify(state, 1.0 / finer, call), HMF_OK);
    EXPECT_EQ(guard.result.state, hmf::ClassState::proven);
    return moved;
}

Moved solved_with_parts(const TriMesh& mesh) {
    const Hierarchy hierarchy(mesh);
    EXPECT_TRUE(hierarchy);
    if (!hierarchy) return {};
    const Loops loops = library_loops(hierarchy, 0);
    const Solution s = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
    EXPECT_EQ(s.status, HMF_OK) << s.report.residual_max;
    EXPECT_EQ(s.report.class_state, HMF_CLASS_PROVEN);
    return expect_foliation_with_parts(hierarchy, s, mesh.vertex_count());
}

hmf::ResidualResult find_parts(SmallSurface& surface, double goal, hmf::Array<double>& part) {
    hmf::Call call(surface.memory, nullptr, nullptr, nullptr);
    hmf::State state;
    hmf::Foliation& f = state.foliation;
    f.mesh = surface.foliation.mesh;
    f.value = surface.value.data();
    EXPECT_TRUE(f.allocate_scratch(f.mesh.vertex_count, surface.memory));
    hmf::Level level;
    level.weight = surface.weight.data();
    const hmf::SolveOptions options;
    hmf::SolveLog log(false, call, 1);
    hmf::LevelWork work{state, level, options, call, log, nullptr, {}, {}, {}, {}};
    EXPECT_TRUE(work.rings.build(f.mesh, level.weight, surface.memory)
                && work.star.allocate(surface.memory, work.rings.max_degree));
    hmf::ResidualResult found;
    EXPECT_EQ(hmf::find_fractions(work, goal, part, found), HMF_OK);
    return found;
}

// Vertices 1 and 2 are at one zero, joined by edge x; all else that could move is marked.
struct PulledTorus : HexagonTorus {
    // Spokes 1 and 2 pull vertices 1 and 2 into one direction, by so much more than what the others have against it.
    PulledTorus(double at_1, double at_2, double weight_of_x) : HexagonTorus(1) {
        weight[0] = weight[6] = 0.5; // both from one corner
        weight[1] = 3 + at_1 / 30;
        weight[2] = 3 + at_2 / 30;
        weight[5] = 3;
        weight[x] = weight_of_x;
        weight[y] = 0.1;
        prepare();
        expect_foliation();
    }
    hmf::ResidualResult find(double goal, hmf::Array<double>& part) { return find_parts(*this, goal, part); }
    // Of the integers, after vertex 1 has gone by so much.
    double residual_after(double part) {
        constexpr int64_t finer = int64_t{1} << 40;
        for (int64_t& x : value) x *= finer;
        choose(with(1));
        move(1, static_cast<int64_t>(part * finer));
        hmf::Call call(memory, nullptr, nullptr, nullptr);
        return hmf::residuals(foliation, rings, weight.data(), star, nullptr, call).max;
    }
};

} // namespace

// Four vertices at the cap of the weights, near a pole of light edges: together they go by some units past a fifth
// one, which no edge of any weight minds.
TEST(Fractions, RegularVerticesPassOthers) {
    size_t moved = 0;
    for (const uint64_t seed : {1, 16, 21, 23, 24, 42, 49, 55}) {
        SCOPED_TRACE(seed);
        for (const bool first : {false, true}) {
            const TriMesh torus = test::torus(6, 4, 3, 1);
            const TriMesh mesh = first ? with_bad_triangles(stretched(torus, 1e4), 2, 0.1, seed)
                                       : stretched(with_bad_triangles(torus, 2, 0.1, seed), 1e4);
            moved += solved_with_parts(mesh).regular;
        }
    }
    EXPECT_GT(moved, 20u);
}

// At a zero less than a unit is missing.
TEST(Fractions, ZerosGoByLessThanAUnit) {
    struct Case {
        TriMesh mesh;
        double factor;
        uint64_t rotation;
    };
    size_t moved = 0;
    for (const Case& c : {Case{plate(2), 6e4, 43},
                          {plate(2), 6e4, 239},
                          {plate(2), 6e4, 248},
                          {plate(3), 2e4, 60},
                          {plate(3), 6e4, 61},
                          {plate(3), 6e4, 248},
                          {plate(3), 6e4, 366},
                          {pretzel(2, 0), 6e4, 61},
                          {pretzel(2, 0), 6e4, 74}}) {
        SCOPED_TRACE(c.rotation);
        Random random(c.rotation);
        const TriMesh mesh = stretched(transformed(c.mesh, random_rotation(random)), c.factor);
        moved += solved_with_parts(mesh).zeros;
    }
    EXPECT_GE(moved, 5u);
}

// Regular vertices go by whole units, too few to reverse an edge or to pass a branch point.  With any weights what is
// told of the parts is what the integers have afterwards, also at zeros beside them.
TEST(Fractions, ResidualsAreThoseOfTheIntegersAfterwards) {
    const Hierarchy hierarchy(plate(20));
    const Loops loops = library_loops(hierarchy, 0);
    const Solution s = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
    ASSERT_EQ(s.status, HMF_OK);
    Loaded loaded(hierarchy, s);
    hmf::Foliation& f = loaded.state.foliation;
    const hmf::Mesh& mesh = f.mesh;
    const hmf::Rings& rings = loaded.rings;
    const hmf::TwistedModel& model = loaded.model;
    const uint32_t n = mesh.vertex_count;
    std::vector<double> part(n, 0), told(n), after(n), scale[2];
    Random random(3);
    std::vector<double> weight(mesh.edge_count);
    for (double& w : weight) w = 1 + 9 * random.unit();
    ASSERT_TRUE(loaded.rings.build(mesh, weight.data(), loaded.memory));
    for (uint32_t v = 0; v < n; ++v) {
        int64_t room = model.is_fixed[v] ? 0 : INT64_MAX;
        for (const uint32_t h : mesh.around(v)) {
            room = std::min(room, f.at(h));
            for (const uint32_t corner : {h, mesh.next[h], mesh.prev(h)})
                if (const int64_t c = f.corner2(corner)) room = std::min(room, c);
        }
        part[v] = std::floor(0.1 * static_cast<double>(room) * (2 * random.unit() - 1));
    }
    const auto scales = [&] { // what residuals are relative to
        double total = 0;
        for (uint32_t e = 0; e < mesh.edge_count; ++e) total += weight[e] * static_cast<double>(f.value[e]);
        std::vector<double> all(n, 0);
        for (uint32_t v = 0; v < n; ++v) {
            for (const uint32_t h : mesh.around(v)) all[v] += weight[h / 2] * static_cast<double>(f.at(h));
            all[v] = std::max(all[v], hmf::pull_floor(total, n));
        }
        return all;
    };
    hmf::ResidualResult unused;
    ASSERT_EQ(hmf::residuals_with_fractions(f, rings, weight.data(), part.data(), loaded.star, told.data(), loaded.call,
                                            unused),
              HMF_OK);
    scale[0] = scales();
    const auto place = [&](uint32_t h) { return model.sign[h] * static_cast<int64_t>(part[mesh.origin[h]]); };
    for (uint32_t e = 0; e < mesh.edge_count; ++e) f.value[e] = std::abs(f.value[e] - place(2 * e) - place(2 * e + 1));
    scale[1] = scales();
    hmf::residuals(f, rings, weight.data(), loaded.star, after.data(), loaded.call);
    size_t zeros = 0;
    for (uint32_t v = 0; v < n; ++v) {
        EXPECT_NEAR(told[v] * scale[model.is_fixed[v] ? 1 : 0][v] / scale[1][v], after[v], 1e-6) << v;
        zeros += model.is_fixed[v] && after[v] > 1e-3;
    }
    EXPECT_GT(zeros, 3u);
}

namespace {
// Vertex 1 goes, vertex 2 at the other end of the heavy edge does not, and that is enough.
void expect_only_the_first_goes(double at_2) {
    constexpr double goal = 0.012;
    PulledTorus torus(3, at_2, 1000);
    hmf::Array<double> part; // in the memory of the torus
    const double found = torus.find(goal, part).max;
    EXPECT_LE(found, goal);
    ASSERT_EQ(part.size(), 3u);
    EXPECT_GT(part[1], 0);
    EXPECT_EQ(part[2], 0);
    EXPECT_GT(PulledTorus(3, at_2, 1000).residual_after(0), goal);
    EXPECT_LE(PulledTorus(3, at_2, 1000).residual_after(part[1]), 1.001 * found);
}
} // namespace

// Vertex 1 pulls with 3 of about 180 more than it should.  All the way it hands that on to vertex 2.
TEST(Fractions, HalfTheWayAlongAHeavyEdge) { expect_only_the_first_goes(0); }

// Vertex 2 has a residual as well, but only one vertex of a cluster goes.
TEST(Fractions, OneOfACluster) { expect_only_the_first_goes(0.6); }

// A whole unit it does not go, as then there may be something in the way.
TEST(Fractions, NotByAUnit) {
    constexpr double goal = 0.012;
    for (const double pull : {60, 6}) {
        PulledTorus torus(pull, 0, 0.1);
        hmf::Array<double> part;
        EXPECT_EQ(torus.find(goal, part).max > goal, pull == 60);
    }
}

// Vertex 1 would be left as a pole where vertex 2 goes alone.
TEST(Fractions, NotWhereOthersGoAlong) {
    constexpr uint32_t e = Polygon::others(2), x = e + 1, y = e + 2, a = e + 3;
    for (const bool marked : {false, true}) {
        SCOPED_TRACE(marked);
        TriangleSides more{{with(e), with(x), with(y)}};
        add_handle(more, against(e), a);
        Polygon surface({against(y), against(x)}, {2, 1}, more, {2, 2, 2, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2}, 3,
                        marked ? 2 : 1);
        surface.weight[1] = surface.weight[x] = surface.weight[y] = 1e-6;
        for (uint32_t k = 0; k < 4; ++k) surface.weight[a + k] = 100;
        surface.prepare();
        surface.expect_foliation();
        constexpr double goal = 0.012;
        hmf::Array<double> part;
        const double found = find_parts(surface, goal, part).max;
        if (marked) EXPECT_LE(found, goal);
        else EXPECT_GT(found, goal);
    }
}

} // namespace test_fractions
