// What the direct method is made of, on a torus with a known height.
// The signs of the twisted model can be combed there: the matrix is the ordinary
// Laplacian up to the orientation of each unknown.  An extremum goes back to
// its nearest neighbor.  A move takes along what it would leave behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
#include <random>
#include <vector>

#include "src/core/base/disjoint_sets.hpp"
#include "src/core/foliation/whitehead.hpp"
#include "src/applications/parameterize/flat_cone_metric.hpp"
#include "src/applications/parameterize/parameterization.hpp"
#include "src/applications/parameterize/seams.hpp"
#include "src/core/extreme/fraction.hpp"
#include "src/core/solve/twisted_model.hpp"
#include "support/check_mesh.hpp"
#include "support/make_mesh.hpp"

namespace test_newton_parts {

using namespace hmf;

namespace {

constexpr uint32_t around = 12;

// Closed values on torus_triangles(around, along.size()): the differences of a height that
// rises by 100 from column to column and by `along` within one.  All vertices
// are regular; equal heights of neighbors give clusters.
struct Combed {
    test::MadeMesh made;
    Memory memory{nullptr, nullptr, nullptr, 0};
    Foliation f;
    std::vector<int64_t> height, value;

    explicit Combed(const std::vector<int64_t>& along) :
        made(test::torus_triangles(around, static_cast<uint32_t>(along.size()))) {
        f.mesh = made.mesh();
        for (uint32_t v = 0; v < f.mesh.vertex_count; ++v)
            height.push_back(100 * (v / static_cast<uint32_t>(along.size())) + along[v % along.size()]);
        EXPECT_TRUE(f.allocate_scratch(f.mesh.vertex_count, memory));
        value = values();
        f.value = value.data();
    }
    int64_t rise(uint32_t h) const { // from the start of h to its end
        constexpr int64_t period = 100 * around;
        const int64_t d = height[f.mesh.target(h)] - height[f.mesh.origin[h]];
        return d > period / 2 ? d - period : d < -period / 2 ? d + period : d;
    }
    std::vector<int64_t> values() const {
        std::vector<int64_t> all(f.mesh.edge_count);
        for (uint32_t e = 0; e < f.mesh.edge_count; ++e) all[e] = std::llabs(rise(2 * e));
        return all;
    }
    SingularityCount count() { return count_singularities(f); }
};

void expect_combed(Combed& combed) {
    Foliation& f = combed.f;
    Memory& memory = combed.memory;
    std::vector<double> weight(f.mesh.edge_count);
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) weight[e] = 1 + 0.25 * (e % 7);
    Rings rings;
    ASSERT_TRUE(rings.build(f.mesh, weight.data(), memory));
    Star star;
    ASSERT_TRUE(star.allocate(memory, rings.max_degree));
    Call call(memory, nullptr, nullptr, nullptr);
    TwistedModel model;
    ASSERT_TRUE(model.allocate(f.mesh, memory));
    ASSERT_TRUE(model.linearize(f, rings, weight.data(), star, call));
    // Energy and residual come from the same pass.
    EXPECT_NEAR(model.energy, energy(f, weight.data()), 1e-12 * model.energy);
    const ResidualResult residual = residuals(f, rings, weight.data(), star, nullptr, call);
    EXPECT_NEAR(model.residual_max, residual.max, 1e-12);
    EXPECT_NEAR(model.residual_sum / model.count, residual.mean, 1e-12);
    double largest_row = 0;
    for (uint32_t k = 0; k < model.count; ++k)
        largest_row = std::max(largest_row, std::abs(model.right[k]) * static_cast<double>(model.row_scale[k]));
    EXPECT_NEAR(largest_row, residual.max, 1e-6 * residual.max);
    EXPECT_TRUE(model.is_exact());
    model.assemble(f, rings, weight.data(), call);
    ASSERT_EQ(model.count, f.mesh.vertex_count);
    for (uint32_t v = 0; v < model.count; ++v) ASSERT_EQ(model.is_fixed[v], 0) << "vertex " << v << " is regular";

    // A vertex whose pull points up has the orientation +1; the others follow.
    std::vector<int> orientation(model.count, 0);
    std::vector<double> sum(model.count, 0), pull(model.count, 0);
    for (uint32_t h = 0; h < 2 * f.mesh.edge_count; ++h) {
        const uint32_t k = f.mesh.origin[h];
        sum[k] += weight[edge_of(h)];
        pull[k] += weight[edge_of(h)] * static_cast<double>(combed.rise(h));
    }
    std::vector<uint32_t> queue{0};
    orientation[0] = 1;
    for (size_t i = 0; i < queue.size(); ++i) {
        const uint32_t k = queue[i];
        for (uint32_t j = model.offset[k]; j < model.offset[k + 1]; ++j) {
            const uint32_t other = model.column[j];
            const int o = model.entry[j] < 0 ? orientation[k] : -orientation[k];
            if (orientation[other] == 0) {
                orientation[other] = o;
                queue.push_back(other);
            }
            ASSERT_EQ(orientation[other], o) << "the signs do not fit round " << k << " and " << other;
        }
    }
    ASSERT_EQ(queue.size(), model.count);
    // The right side has the same orientation, up to one sign for all.
    int global = 0;
    for (uint32_t k = 0; k < model.count; ++k) {
        EXPECT_EQ(model.diagonal[k], sum[k]);
        ASSERT_NEAR(std::abs(model.right[k]), std::abs(pull[k]), 1e-9 * (1 + std::abs(pull[k])));
        if (std::abs(pull[k]) < 1e-6) continue;
        const int s = (model.right[k] * pull[k] > 0 ? 1 : -1) * orientation[k];
        if (global == 0) global = s;
        EXPECT_EQ(s, global) << k;
    }
    EXPECT_NE(global, 0);
}

bool keeps_class(const Foliation& f, const Rings& rings, const TwistedModel& model, const std::vector<double>& part,
                 Memory& memory) {
    bool keeps = false;
    EXPECT_TRUE(hmf::keeps_class(f, rings, model, part.data(), memory, keeps));
    return keeps;
}

void expect_combed(const std::vector<int64_t>& along) {
    Combed combed(along);
    expect_combed(combed);
}

} // namespace

namespace {

// The model of a combed torus, whose edges weigh 1 to 1 + 6 step.
struct CombedModel : Combed {
    std::vector<double> weight;
    Call call{memory, nullptr, nullptr, nullptr};
    Rings rings;
    Star star;
    TwistedModel model;
    explicit CombedModel(const std::vector<int64_t>& along, double step = 0.25) : Combed(along) {
        for (uint32_t e = 0; e < f.mesh.edge_count; ++e) weight.push_back(1 + step * (e % 7));
        EXPECT_TRUE(rings.build(f.mesh, weight.data(), memory) && star.allocate(memory, rings.max_degree)
                    && model.allocate(f.mesh, memory) && model.linearize(f, rings, weight.data(), star, call));
        model.assemble(f, rings, weight.data(), call);
    }
    double rest(uint32_t v) const {
        double sum = model.right[v] - model.diagonal[v] * model.d[v];
        for (uint32_t t = model.offset[v]; t < model.offset[v + 1]; ++t)
            sum -= model.entry[t] * model.d[model.column[t]];
        return sum;
    }
};

} // namespace

// Those that go together are one unknown, whose row is the sum of theirs; what is held elsewhere counts.
TEST(DirectSolver, GroupsAndHeldUnknowns) {
    CombedModel combed({0, 7, 7, 7, 5, 13, 2, 9});
    const Foliation& f = combed.f;
    TwistedModel& model = combed.model;
    std::vector<uint32_t> with(model.count);
    std::iota(with.begin(), with.end(), 0u);
    // Edges of value 0 between vertices that have the same height.
    uint32_t joined = 0;
    for (uint32_t v = 0; v < model.count; ++v)
        for (const uint32_t h : f.mesh.around(v))
            if (const uint32_t u = f.mesh.target(h); u < v && f.at(h) == 0 && with[u] == u && with[v] == v) {
                with[v] = u;
                ++joined;
            }
    ASSERT_GT(joined, 5u);
    Array<uint32_t> number;
    ASSERT_TRUE(number.allocate_filled(combed.memory, model.count, 0u));
    for (uint32_t v = 0; v < model.count; ++v) model.d[v] = 0;
    const uint32_t held = model.count - 1;
    for (uint32_t v = 0; v < model.count; ++v)
        if (with[v] == with[held]) number[v] = NONE, model.d[v] = 2.5;
    DirectSolver part;
    ASSERT_TRUE(part.extract(model.system(), number, combed.call, with.data()));
    ASSERT_TRUE(part.solve(model.system(), combed.call));
    std::vector<double> rest(model.count, 0);
    double size = 0;
    for (uint32_t v = 0; v < model.count; ++v) {
        rest[with[v]] += combed.rest(v);
        EXPECT_EQ(model.d[v], model.d[with[v]]);
        size = std::max(size, std::abs(model.right[v]));
    }
    for (uint32_t v = 0; v < model.count; ++v) {
        if (with[v] == with[held]) EXPECT_EQ(model.d[v], 2.5);
        else EXPECT_NEAR(rest[v], 0, 1e-9 * size) << v;
    }
}

// Where nothing is held one vertex is, so that the others do not go far.
TEST(DirectSolver, NothingIsHeld) {
    CombedModel combed({0, 7, 3, 11, 5, 13, 2, 9}, 0); // the last pivot is rounded to above 0
    TwistedModel& model = combed.model;
    Array<uint32_t> number;
    ASSERT_TRUE(number.allocate_filled(combed.memory, model.count, 0u));
    DirectSolver part;
    ASSERT_TRUE(part.extract(model.system(), number, combed.call) && part.solve(model.system(), combed.call));
    double rest = 0, size = 0, largest = 0;
    for (uint32_t v = 0; v < model.count; ++v) {
        rest = std::max(rest, std::abs(combed.rest(v)));
        size = std::max(size, std::abs(model.right[v]));
        largest = std::max(largest, std::abs(model.d[v]));
    }
    EXPECT_EQ(std::count(model.d.data(), model.d.data() + model.count, 0.0), 1);
    EXPECT_LE(rest, 1e-11 * size);
    EXPECT_LE(largest, 20.0 * model.count);
}

// Its rows hold where the others stay at 0, and nothing else moves.
TEST(DirectSolver, RowsOfSomeUnknowns) {
    CombedModel combed({0, 7, 3, 11, 5, 13, 2, 9});
    TwistedModel& model = combed.model;
    model.is_fixed[20] = 1;
    Array<uint32_t> number;
    ASSERT_TRUE(number.allocate_filled(combed.memory, model.count, NONE));
    for (uint32_t v = 10; v < 50; ++v) number[v] = v % 3;
    DirectSolver part;
    ASSERT_TRUE(part.extract(model.system(), number, combed.call) && part.solve(model.system(), combed.call));
    double size = 0;
    for (uint32_t v = 0; v < model.count; ++v) size = std::max(size, std::abs(model.right[v]));
    for (uint32_t v = 0; v < model.count; ++v) {
        if (v < 10 || v >= 50 || v == 20) EXPECT_EQ(model.d[v], 0) << v;
        else EXPECT_NEAR(combed.rest(v), 0, 1e-12 * size) << v;
    }
}

TEST(TwistedModel, RegularVertices) { expect_combed({0, 7, 3, 11, 5, 13, 2, 9}); }
TEST(TwistedModel, ClustersOfTwo) { expect_combed({0, 0, 7, 7, 13, 13, 5, 5}); }
TEST(TwistedModel, LongClusters) { expect_combed({0, 0, 0, 0, 0, 13, 4, 4}); }

// More sides than a word has bits.
TEST(TwistedModel, HubOfManySides) {
    std::vector<int64_t> along;
    for (int64_t k = 0; k < 60; ++k) along.push_back(37 * k % 101 % 60);
    Combed combed(along);
    Mesh& mesh = combed.f.mesh;
    const uint32_t hub = 6 * 60 + 30;
    const auto is_near = [](uint32_t v) { return v / 60 >= 4 && v / 60 <= 8; };
    uint32_t degree = 6;
    bool changed = true;
    while (degree < 150 && changed) {
        changed = false;
        uint32_t h = mesh.out[hub];
        for (uint32_t t = degree; t-- > 0; h = mesh.rotate_ccw(h)) {
            const uint32_t across = mesh.next[h], other = mesh.target(mesh.next[twin(across)]);
            if (other == hub || !is_near(other)) continue;
            flip(mesh, edge_of(across));
            combed.value = combed.values();
            combed.f.value = combed.value.data();
            const SingularityCount count = combed.count();
            if (count.zeros + count.poles + count.broken_triangles == 0) {
                ++degree;
                changed = true;
            } else {
                unflip(mesh, edge_of(across));
            }
        }
    }
    combed.value = combed.values();
    combed.f.value = combed.value.data();
    ASSERT_EQ(check(mesh), nullptr);
    ASSERT_GT(degree, 100u);
    expect_combed(combed);
}

// The minimum between bounds, from a start at which all bounds are active:
// those that do not hold are left.  Against projected Gauss-Seidel.
TEST(TwistedModel, MinimumBetweenBounds) {
    std::vector<int64_t> along;
    for (int64_t k = 0; k < 60; ++k) along.push_back(37 * k % 101 % 60);
    Combed combed(along);
    const std::vector<double> weight(combed.f.mesh.edge_count, 1);
    Rings rings;
    ASSERT_TRUE(rings.build(combed.f.mesh, weight.data(), combed.memory));
    Star star;
    ASSERT_TRUE(star.allocate(combed.memory, rings.max_degree));
    Call call(combed.memory, nullptr, nullptr, nullptr);
    TwistedModel model;
    ASSERT_TRUE(model.allocate(combed.f.mesh, combed.memory));
    ASSERT_TRUE(model.linearize(combed.f, rings, weight.data(), star, call));
    model.assemble(combed.f, rings, weight.data(), call);
    for (uint32_t k = 0; k < model.count; k += 7) {
        model.lower[k] = k % 2 ? -2 : -40;
        model.upper[k] = k % 3 ? 1 : 50;
        model.bounded.add(k);
        model.d[k] = static_cast<double>(model.upper[k]);
    }
    Array<uint32_t> patch, distance;
    patch.start(combed.memory);
    ASSERT_TRUE(patch.reserve(model.count) && distance.allocate(combed.memory, model.count));
    SignedMultigrid multigrid;
    ASSERT_TRUE(multigrid.setup(model.matrix(), call));
    bool any_released = false, settled = false;
    for (uint32_t pass = 0; pass < 20 && !settled; ++pass) {
        model.fix_active();
        LinearOptions options;
        options.fixed = model.at_bounds.data();
        options.fixed_count = model.at_bounds.size();
        ASSERT_TRUE(
            multigrid.solve(model.matrix(), model.right.data(), model.d.data(), 1e-10, 100, call, options).converged);
        const bool released = model.release();
        any_released |= released;
        settled = model.project(combed.f, rings, patch, distance) == 0 && !released;
    }
    EXPECT_TRUE(settled);
    EXPECT_TRUE(any_released);
    EXPECT_GT(model.at_bounds.size(), 5u);
    EXPECT_LT(model.at_bounds.size(), model.bounded.size() - 5);
    const std::vector<double> found(model.d.begin(), model.d.end());
    for (double& x : model.d) x = 0;
    for (uint32_t sweep = 0; sweep < 20000; ++sweep)
        for (uint32_t k = 0; k < model.count; ++k) model.d[k] = model.relaxed(k);
    for (uint32_t k = 0; k < model.count; ++k) ASSERT_NEAR(found[k], model.d[k], 1e-5) << k;
}

// One vertex is above or below all its neighbors; it is pulled back to the nearest.
TEST(SettleExtremum, ReturnsToTheNearestNeighbor) {
    for (const std::vector<int64_t>& along :
         {std::vector<int64_t>{0, 7, 3, 11, 5, 13, 2, 9}, std::vector<int64_t>{0, 0, 7, 7, 13, 13, 5, 5}})
        for (const int side : {1, -1})
            for (uint32_t v = 30; v < 50; ++v) {
                Combed combed(along);
                Foliation& f = combed.f;
                int64_t nearest = -side * 100000;
                const uint32_t first = f.mesh.out[v];
                uint32_t h = first;
                do {
                    const int64_t there = combed.height[f.mesh.target(h)];
                    nearest = side > 0 ? std::max(nearest, there) : std::min(nearest, there);
                    h = f.mesh.rotate_ccw(h);
                } while (h != first);
                ASSERT_EQ(combed.count().poles, 0u);
                combed.height[v] = nearest + side * 40;
                combed.value = combed.values();
                f.value = combed.value.data();
                ASSERT_EQ(combed.count().poles, 2u); // of order two
                ASSERT_TRUE(remove_extremum(f, v));
                EXPECT_EQ(combed.count().poles, 0u);
                EXPECT_EQ(combed.count().broken_triangles, 0u);
                combed.height[v] = nearest;
                EXPECT_EQ(combed.value, combed.values());
            }
}

namespace {

// v is moved; x, which has the same height and nothing below but v, goes along.
void expect_taken_along(Combed& combed, uint32_t v, uint32_t x) {
    Foliation& f = combed.f;
    combed.value = combed.values();
    f.value = combed.value.data();
    ASSERT_EQ(combed.count().poles, 0u);
    ASSERT_EQ(combed.count().broken_triangles, 0u);
    std::vector<double> weight(f.mesh.edge_count, 1);
    for (uint32_t h = 0; h < 2 * f.mesh.edge_count; ++h)
        if (f.mesh.origin[h] == v && f.mesh.target(h) != x)
            weight[edge_of(h)] = 12; // so that the first move is the best
    Rings rings;
    Star star;
    ASSERT_TRUE(rings.build(f.mesh, weight.data(), combed.memory) && star.allocate(combed.memory, rings.max_degree));
    const double before = energy(f, weight.data());
    SweepResult result;
    EXPECT_TRUE(relax_vertex(f, rings, weight.data(), v, star, result));
    EXPECT_EQ(result.blocked, 0u);
    EXPECT_LT(result.energy_change, -1);
    EXPECT_NEAR(energy(f, weight.data()) - before, result.energy_change, 1e-9 * before);
    EXPECT_EQ(combed.count().poles, 0u);
    // The values are those of heights in which the two went up by the same.
    int64_t mu = 0;
    for (uint32_t h = 0; h < 2 * f.mesh.edge_count; ++h)
        if (f.mesh.origin[h] == v && f.mesh.target(h) != x && combed.rise(h) < 0) mu = f.at(h) + combed.rise(h);
    EXPECT_GT(mu, 0);
    combed.height[v] += mu;
    combed.height[x] += mu;
    EXPECT_EQ(combed.value, combed.values());
}

} // namespace

TEST(Move, TakesANeighborAlong) {
    const std::vector<int64_t> along = {0, 70, 3, 60, 5, 80, 2, 90};
    for (const uint32_t v : {34u, 36u, 38u}) { // lower than the vertex before
        Combed combed(along);
        const uint32_t x = v + static_cast<uint32_t>(along.size());
        combed.height[x] = combed.height[v];
        expect_taken_along(combed, v, x);
    }
}

// x between two edges from v to q has degree 2: alone it would never move, or
// only a part of the way to q.
TEST(Move, TakesAVertexOfDegreeTwoAlong) {
    Combed combed({0, 70, 3, 60, 5, 80, 2, 90});
    Mesh& mesh = combed.f.mesh;
    const uint32_t x = 44, v = x - 8; // with v, the next above and its neighbors around it
    for (uint32_t turn = 0, h = mesh.out[x], degree = 6; degree > 2 && turn < 100; ++turn, h = mesh.out[x]) {
        h = mesh.rotate_ccw(h);
        mesh.out[x] = h;
        if (mesh.target(h) == v || mesh.target(h) == x + 8) continue;
        mesh.out[x] = mesh.rotate_ccw(h);
        flip(mesh, edge_of(h));
        --degree;
    }
    ASSERT_EQ(check(mesh), nullptr);
    const uint32_t first = mesh.out[x], second = mesh.rotate_ccw(first);
    ASSERT_EQ(mesh.rotate_ccw(second), first);
    ASSERT_TRUE((mesh.target(first) == v && mesh.target(second) == x + 8)
                || (mesh.target(first) == x + 8 && mesh.target(second) == v));
    combed.height[x] = combed.height[v];
    expect_taken_along(combed, v, x);
}

// A layout of many times 2^52 stays where doubles are exact; where it is pushed back there is a translation by 2^52.
TEST(Layout, TooWideIsPushedBack) {
    constexpr uint32_t n = 64, m = 8;
    constexpr int64_t wide = int64_t{1} << 49, back = int64_t{1} << 52;
    test::MadeMesh made(test::torus_triangles(n, m));
    const Mesh mesh = made.mesh();
    Memory memory(nullptr, nullptr, nullptr, 0);
    Call call(memory, nullptr, nullptr, nullptr);
    SignBundle bundle;
    TwistedForm du, dv;
    const std::vector<double> length(mesh.edge_count, 1);
    std::vector<uint8_t> is_cone(mesh.vertex_count, 0);
    ASSERT_TRUE(bundle.turn.allocate_filled(memory, mesh.edge_count, int8_t{1}));
    ASSERT_TRUE(du.value.allocate(memory, mesh.edge_count));
    ASSERT_TRUE(dv.value.allocate(memory, mesh.edge_count));
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const uint32_t a = mesh.origin[2 * e], b = mesh.origin[2 * e + 1];
        du.value[e] = ((b / m - a / m + n + 1) % n - int64_t{1}) * wide;
        dv.value[e] = ((b % m - a % m + m + 1) % m - int64_t{1}) * wide;
    }
    Seams seams;
    Layout layout;
    Stars stars;
    ASSERT_TRUE(stars.build(mesh, call));
    ASSERT_TRUE(cut_through_cones(mesh, stars, length.data(), is_cone.data(), 0, seams, call));
    ASSERT_TRUE(layout.build(mesh, bundle, du, dv, seams, call));
    std::vector<uint8_t> tree(seams.trunk.begin(), seams.trunk.end());
    for (const uint32_t h : seams.hanging) tree[edge_of(h)] = 1;
    uint32_t pushed = 0;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        ASSERT_LT(std::abs(layout.at[h].u), 2 * back);
        ASSERT_LT(std::abs(layout.at[h].v), 2 * back);
        ASSERT_EQ(layout.at[mesh.next[h]].u - layout.at[h].u, du.at(bundle, h));
        ASSERT_EQ(layout.at[mesh.next[h]].v - layout.at[h].v, dv.at(bundle, h));
        if (!tree[edge_of(h)]) continue;
        const int64_t shift = layout.at[twin(h)].u - layout.at[mesh.next[h]].u;
        ASSERT_TRUE(shift == 0 || shift == back || shift == -back);
        pushed += shift != 0;
    }
    EXPECT_GT(pushed, 0u);
}

// Trunk and what hangs on it are a spanning tree of the faces that crosses no seam, the root is on the trunk, and a
// face comes before that on which it hangs.
TEST(Seams, TreeOfTheFaces) {
    for (const uint32_t cones : {0u, 1u, 5u}) {
        test::MadeMesh made(test::plate(2, 2, 2));
        const Mesh mesh = made.mesh();
        Memory memory(nullptr, nullptr, nullptr, 0);
        Call call(memory, nullptr, nullptr, nullptr);
        const std::vector<double> length(mesh.edge_count, 1);
        std::vector<uint8_t> is_cone(mesh.vertex_count, 0);
        for (uint32_t i = 0; i < cones; ++i) is_cone[(7 + 31 * i) % mesh.vertex_count] = 1;
        Seams seams;
        Stars stars;
        ASSERT_TRUE(stars.build(mesh, call));
        const uint32_t root = mesh.edge_count;
        ASSERT_TRUE(cut_through_cones(mesh, stars, length.data(), is_cone.data(), root, seams, call));
        EXPECT_EQ(seams.root, root);
        enum : uint8_t { on_trunk, hangs };
        std::vector<uint8_t> face(mesh.face_count, on_trunk);
        std::vector<uint32_t> component(mesh.face_count);
        for (uint32_t f = 0; f < mesh.face_count; ++f) component[f] = f;
        size_t edges = 0;
        for (const uint32_t h : seams.hanging) {
            ASSERT_EQ(face[mesh.face[h]], on_trunk);
            face[mesh.face[h]] = hangs;
            ASSERT_NE(face[mesh.face[twin(h)]], hangs) << "a face hangs on one that was taken before";
            ASSERT_FALSE(seams.on[edge_of(h)]);
            ASSERT_TRUE(unite(component.data(), mesh.face[h], mesh.face[twin(h)]));
            ++edges;
        }
        EXPECT_EQ(face[mesh.face[root]], on_trunk);
        for (uint32_t e = 0; e < mesh.edge_count; ++e) {
            if (!seams.trunk[e]) continue;
            ASSERT_FALSE(seams.on[e]);
            ASSERT_EQ(face[mesh.face[2 * e]], on_trunk);
            ASSERT_EQ(face[mesh.face[2 * e + 1]], on_trunk);
            ASSERT_TRUE(unite(component.data(), mesh.face[2 * e], mesh.face[2 * e + 1]));
            ++edges;
        }
        EXPECT_EQ(edges, mesh.face_count - 1u);
    }
}

// On the cut graph, and wherever the two sides differ.
TEST(Seams, AreWhereTheMapGoesOnDifferently) {
    Memory memory(nullptr, nullptr, nullptr, 0);
    Parameterization p;
    ASSERT_TRUE(p.seams.on.allocate_filled(memory, 2, uint8_t{0}));
    p.seams.on[1] = 1;
    for (const int8_t sign : {int8_t{1}, int8_t{-1}})
        for (const int64_t u : {-5, 0, 1})
            for (const int64_t v : {-1, 0, 7}) {
                EXPECT_EQ(p.is_seam(0, {sign, u, v}), sign != 1 || u != 0 || v != 0);
                EXPECT_TRUE(p.is_seam(1, {sign, u, v}));
            }
    SeamSum sum{2, 0.5};
    sum += {3, 0.25};
    EXPECT_EQ(sum.count, 5u);
    EXPECT_EQ(sum.length, 0.75);
}

// Two triangles on the same vertices: what is left would be no surface.
TEST(Collapse, NotBetweenTrianglesOnTheSameVertices) {
    test::Triangles pillow;
    pillow.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    pillow.triangles = {0, 1, 2, 0, 2, 1};
    test::MadeMesh made(pillow);
    const Mesh mesh = made.mesh();
    std::vector<uint8_t> marks(mesh.vertex_count, 0);
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) EXPECT_FALSE(can_collapse(mesh, h, marks.data())) << h;
}

// A sphere of which nothing is left but a point: who has what of the curvature is not known, together it is that of a
// sphere.
TEST(ConeAngles, OfASurfaceThatIsAPoint) {
    test::MadeMesh made(test::Triangles{{1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1},
                                        {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 1, 0, 5, 2, 1, 5, 3, 2, 5, 0, 3, 5}});
    const hmf::Mesh mesh = made.mesh();
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::FlatConeMetric flat;
    hmf::VertexCharts charts;
    ASSERT_TRUE(flat.bundle.turn.allocate_filled(memory, mesh.edge_count, int8_t{1})
                && flat.du.value.allocate_filled(memory, mesh.edge_count, 0)
                && flat.dv.value.allocate_filled(memory, mesh.edge_count, 0) && charts.build(mesh, flat.bundle, call));
    std::vector<int32_t> cone(mesh.vertex_count, 0);
    ASSERT_TRUE(hmf::cone_angles(mesh, flat, charts, cone.data(), call));
    int32_t missing = 0;
    for (const int32_t c : cone) {
        EXPECT_TRUE(c == 0 || c == 2) << c;
        missing += 2 - c;
    }
    EXPECT_EQ(missing, 4);
}

// A vertex as high as its six neighbors.  The seven get fractions at random: the class is kept where none of them
// becomes as high as all that it was higher than, or one with an edge that opens an extremum, as their heights tell.
TEST(Fractions, KeepTheClassWhereHeightsDo) {
    Combed combed({0, 7, 3, 11, 5, 13, 2, 9});
    const Mesh& mesh = combed.f.mesh;
    const uint32_t center = mesh.vertex_count - 1; // the last one: its sides are the last of all
    std::vector<uint32_t> disk{center};
    for (const uint32_t h : mesh.around(center)) disk.push_back(mesh.target(h));
    for (const uint32_t v : disk) combed.height[v] = combed.height[center];
    combed.value = combed.values();
    Foliation& f = combed.f;
    f.value = combed.value.data();
    Memory& memory = combed.memory;
    std::vector<double> weight(mesh.edge_count, 1.0);
    Rings rings;
    Star star;
    Call call(memory, nullptr, nullptr, nullptr);
    TwistedModel model;
    ASSERT_TRUE(rings.build(mesh, weight.data(), memory) && star.allocate(memory, rings.max_degree)
                && model.allocate(mesh, memory) && model.linearize(f, rings, weight.data(), star, call));
    int up = 0; // the sign of edges that leave the disk upward
    for (const uint32_t v : disk) {
        ASSERT_EQ(model.is_fixed[v], 0);
        for (const uint32_t h : mesh.around(v))
            if (combed.rise(h) > 0) up = model.sign[h];
    }
    ASSERT_NE(up, 0);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-0.9, 0.9);
    size_t kept = 0, lost = 0;
    for (int round = 0; round < 300; ++round) {
        std::vector<double> raised(mesh.vertex_count, 0), part(mesh.vertex_count, 0);
        for (const uint32_t v : disk) raised[v] = place(random), part[v] = up * raised[v];
        if (round % 2) raised[center] = part[center] = 0;
        // Some go together, and stay one: what they have is asked for, not what each of them has.
        if (round % 3 == 0)
            for (size_t k = 1; k < disk.size(); ++k)
                if (k == 1 || k % 3 != 1) raised[disk[k]] = raised[disk[k - 1]], part[disk[k]] = part[disk[k - 1]];
        std::map<double, std::pair<bool, bool>> ways; // higher and lower, by height: no two others have the same
        for (const uint32_t v : disk)
            for (const uint32_t h : mesh.around(v)) {
                const double there = static_cast<double>(combed.rise(h)) + raised[mesh.target(h)] - raised[v];
                ways[raised[v]].first |= there > 0;
                ways[raised[v]].second |= there < 0;
            }
        bool expected = true;
        for (const auto& [height, way] : ways) expected = expected && way.first && way.second;
        EXPECT_EQ(keeps_class(f, rings, model, part, memory), expected) << round;
        ++(expected ? kept : lost);
    }
    EXPECT_GT(kept, 20u);
    EXPECT_GT(lost, 20u);
}

// Neighbors of the same column pass each other.  The class is kept where each vertex that passes another keeps one
// that it is higher and one that it is lower than, all the way: so none is an extremum on it.
TEST(Fractions, KeepTheClassWhereVerticesPass) {
    Combed combed({0, 7, 3, 11, 5, 13, 2, 9});
    const Mesh& mesh = combed.f.mesh;
    Memory& memory = combed.memory;
    std::vector<double> weight(mesh.edge_count, 1.0);
    Rings rings;
    Star star;
    Call call(memory, nullptr, nullptr, nullptr);
    TwistedModel model;
    ASSERT_TRUE(rings.build(mesh, weight.data(), memory) && star.allocate(memory, rings.max_degree)
                && model.allocate(mesh, memory) && model.linearize(combed.f, rings, weight.data(), star, call));
    std::vector<int> up(mesh.vertex_count, 0); // the sign of edges that leave a vertex upward
    for (uint32_t v = 0; v < mesh.vertex_count; ++v)
        for (const uint32_t h : mesh.around(v))
            if (combed.rise(h) > 0) up[v] = model.sign[h];
    std::mt19937 random(11);
    size_t passed = 0, lost = 0;
    for (int round = 0; round < 400; ++round) {
        std::uniform_real_distribution<double> place(-2.0 - 0.3 * round, 2.0 + 0.3 * round);
        std::vector<double> raised(mesh.vertex_count, 0), part(mesh.vertex_count, 0);
        for (uint32_t v = 40; v < 64; ++v) {
            raised[v] = round % 4 ? place(random) : std::floor(place(random)); // some come as high as a neighbor
            part[v] = up[v] * raised[v];
        }
        bool expected = true, pass = false;
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
            bool higher = false, lower = false, passes = false;
            for (const uint32_t h : mesh.around(v)) {
                const double here = static_cast<double>(combed.rise(h)),
                             there = here + raised[mesh.target(h)] - raised[v];
                higher = higher || (here > 0 && there > 0);
                lower = lower || (here < 0 && there < 0);
                passes = passes || (here != 0 && here * there <= 0);
            }
            expected = expected && (!passes || (higher && lower));
            pass = pass || passes;
        }
        EXPECT_EQ(keeps_class(combed.f, rings, model, part, memory), expected) << round;
        passed += expected && pass;
        lost += !expected;
    }
    EXPECT_GT(passed, 20u);
    EXPECT_GT(lost, 20u);
    // None may pass a fixed one, nor a zero, on the way.
    std::vector<double> part(mesh.vertex_count, 0);
    uint32_t side = mesh.out[48];
    while (combed.rise(side) != 7) side = mesh.rotate_ccw(side);
    part[48] = 8 * up[48];
    EXPECT_TRUE(keeps_class(combed.f, rings, model, part, memory));
    ASSERT_TRUE(model.fixed_zeros.push(mesh.target(side)));
    EXPECT_FALSE(keeps_class(combed.f, rings, model, part, memory));
    part[48] = 7 * up[48]; // it may come to it
    EXPECT_TRUE(keeps_class(combed.f, rings, model, part, memory));
    part[48] = 8 * up[48];
    model.fixed_zeros.clear();
    model.is_fixed[mesh.target(side)] = 1;
    EXPECT_FALSE(keeps_class(combed.f, rings, model, part, memory));
}

} // namespace test_newton_parts
