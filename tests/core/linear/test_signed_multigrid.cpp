// The linear solver against Eigen, and on everything that is not a nice mesh.
#include <gtest/gtest.h>

#include <Eigen/Sparse>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <set>
#include <vector>

#include "src/core/linear/signed_multigrid.hpp"
#include "support/signed_system.hpp"
#include "support/adversarial_scheduler.hpp"

namespace test_signed_multigrid {

using namespace linear;

namespace {

struct Outcome {
    hmf::LinearResult result;
    std::vector<double> x;
};

Outcome solve(const System& s, const std::vector<double>& b, double tolerance = 1e-10, uint32_t limit = 300,
              const hmf_control& control = {}) {
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, control);
    Outcome run;
    run.x.assign(s.n(), 0);
    {
        hmf::SignedMultigrid multigrid;
        EXPECT_TRUE(multigrid.setup(s.matrix(), call));
        run.result = multigrid.solve(s.matrix(), b.data(), run.x.data(), tolerance, limit, call);
    }
    EXPECT_EQ(memory.used(), 0u);
    return run;
}

} // namespace

TEST(SignedMultigrid, TwistedTorusAsEigen) {
    Random random(1);
    for (uint32_t w : {5u, 15u, 18u, 40u, 100u}) {
        const System s(w * w, twisted_torus(w, w, 6, random));
        const std::vector<double> b = noise(s.n(), random);
        const Outcome run = solve(s, b);
        EXPECT_TRUE(run.result.converged) << w;
        EXPECT_LE(s.residual(run.x, b), 1.001e-10);
        EXPECT_NEAR(s.residual(run.x, b), run.result.residual, 1e-12);
        expect_near(run.x, s.eigen(b), 1e-7);
    }
}

TEST(SignedMultigrid, FixedUnknownsAsEigen) {
    Random random(2);
    std::vector<bool> fixed(80 * 80, false);
    for (uint32_t k = 0; k < 40; ++k) fixed[random.below(6400)] = true;
    const System s(6400, twisted_torus(80, 80, 10, random), fixed);
    std::vector<double> b = noise(6400, random);
    for (uint32_t i = 0; i < 6400; ++i)
        if (fixed[i]) b[i] = 0;
    const Outcome run = solve(s, b);
    EXPECT_TRUE(run.result.converged);
    EXPECT_LE(s.residual(run.x, b), 1.001e-10);
    for (uint32_t i = 0; i < 6400; ++i)
        if (fixed[i]) { EXPECT_EQ(run.x[i], 0); }
}

TEST(SignedMultigrid, FewIterationsThatHardlyGrow) {
    Random random(3);
    uint32_t before = 0;
    for (uint32_t w : {50u, 100u, 200u, 400u}) {
        const System s(w * w, twisted_torus(w, w, 20, random));
        const Outcome run = solve(s, noise(s.n(), random), 1e-8);
        EXPECT_TRUE(run.result.converged);
        EXPECT_LE(run.result.iterations, 18u) << w;
        if (before) { EXPECT_LE(run.result.iterations, before + 4) << w; }
        before = run.result.iterations;
    }
}

TEST(SignedMultigrid, SingularWithConsistentRightSide) {
    Random random(4);
    for (uint32_t w : {4u, 16u, 60u, 150u}) {
        const System s(w * w, torus(w, w, random));
        const std::vector<double> truth = noise(s.n(), random);
        const std::vector<double> b = s.times(truth);
        const Outcome run = solve(s, b);
        EXPECT_TRUE(run.result.converged) << w;
        EXPECT_LE(run.result.iterations, 25u) << w;
        EXPECT_LE(s.residual(run.x, b), 1.001e-10);
        for (double v : run.x) EXPECT_LT(std::abs(v), 1e3);
    }
}

TEST(SignedMultigrid, ComponentsTinyRowsAndEmptyRows) {
    Random random(5);
    std::vector<Edge> edges = twisted_torus(50, 50, 5, random);          // 0 .. 2499
    for (Edge e : torus(40, 40, random, true, 2500)) edges.push_back(e); // singular, 2500 .. 4099
    for (Edge e : torus(30, 30, random, true, 4100)) {                   // singular, tiny, 4100 .. 4999
        e.weight *= 1e-9;
        edges.push_back(e);
    }
    for (uint32_t i = 5000; i < 5200; i += 2) edges.push_back({i, i + 1, 1 + random.uniform(), random.sign()}); // pairs
    for (uint32_t i = 5300; i < 5600; i += 3) { // frustrated triangles
        edges.push_back({i, i + 1, 1, 1});
        edges.push_back({i + 1, i + 2, 1, 1});
        edges.push_back({i, i + 2, 1, 1});
    }
    const System s(5700, edges); // 5200 .. 5299, 5600 .. are empty
    const std::vector<double> b = s.times(noise(s.n(), random));
    const Outcome run = solve(s, b);
    EXPECT_TRUE(run.result.converged);
    EXPECT_LE(run.result.iterations, 40u);
    EXPECT_LE(s.residual(run.x, b), 1.001e-10);
    for (uint32_t i = 5200; i < 5300; ++i) EXPECT_EQ(run.x[i], 0);
}

// Coarse unknowns that are left out, for such an island is near the kernel, but
// have neighbors that are not.
TEST(SignedMultigrid, HeavyIslandsThatHardlyTouchTheRest) {
    Random random(17);
    std::vector<Edge> edges = twisted_torus(100, 100, 8, random);
    const auto island = [](uint32_t i) {
        return i % 100 % 10 < 2 && i / 100 % 10 < 2 ? i / 1000 * 10 + i % 100 / 10 : 100;
    };
    for (Edge& e : edges) {
        if (island(e.i) != island(e.j)) e.weight = 1e-9;
        else if (island(e.i) < 100) e.weight = 1e6;
    }
    const System s(10000, edges);
    const std::vector<double> b = s.times(noise(s.n(), random));
    const Outcome run = solve(s, b, 1e-8);
    EXPECT_TRUE(run.result.converged);
    EXPECT_LE(run.result.iterations, 25u);
    EXPECT_LE(s.residual(run.x, b), 1.001e-8);
}

TEST(SignedMultigrid, HubsAndDominantRows) {
    Random random(7);
    std::vector<Edge> edges;
    for (uint32_t i = 1; i < 20000; ++i) edges.push_back({0, i, 0.5 + random.uniform(), random.sign()});
    for (uint32_t i = 1; i < 19999; ++i) edges.push_back({i, i + 1, 0.5 + random.uniform(), -1});
    const System fan(20000, edges);
    std::vector<double> b = noise(20000, random);
    EXPECT_TRUE(solve(fan, b, 1e-8).result.converged);

    System dominant(10000, twisted_torus(100, 100, 3, random));
    for (uint32_t i = 0; i < 10000; ++i)
        if (i % 3) dominant.diagonal[i] += 1e4;
    b.resize(10000);
    EXPECT_TRUE(solve(dominant, b, 1e-8).result.converged);
}

TEST(SignedMultigrid, RepeatedColumnsAddUp) {
    Random random(8);
    std::vector<Edge> edges = twisted_torus(40, 40, 4, random);
    const size_t single = edges.size();
    for (size_t k = 0; k < single; k += 2) {
        Edge e = edges[k];
        if (k % 8 == 0) e.sign = -e.sign; // two edges between the same vertices, one turned
        edges.push_back(e);
    }
    const System s(1600, edges);
    const std::vector<double> b = noise(1600, random);
    const Outcome run = solve(s, b);
    EXPECT_TRUE(run.result.converged);
    expect_near(run.x, s.eigen(b), 1e-7);
}

TEST(SignedMultigrid, SmallestSystems) {
    Random random(9);
    const System none(0, {});
    EXPECT_TRUE(solve(none, {}).result.converged);
    const System empty(1, {});
    EXPECT_TRUE(solve(empty, {0.0}).result.converged);
    const System pair(2, {{0, 1, 2.0, 1}});
    const Outcome run = solve(pair, {3.0, 3.0});
    EXPECT_TRUE(run.result.converged);
    EXPECT_NEAR(run.x[0] + run.x[1], 1.5, 1e-9);
    const System zeros(1000, {});
    EXPECT_TRUE(solve(zeros, std::vector<double>(1000, 0.0)).result.converged);
}

TEST(SignedMultigrid, StartAndRightSide) {
    Random random(10);
    const System s(2500, twisted_torus(50, 50, 5, random));
    const std::vector<double> b = noise(2500, random);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::SignedMultigrid multigrid;
    ASSERT_TRUE(multigrid.setup(s.matrix(), call));
    std::vector<double> x(2500, 0);
    EXPECT_GT(multigrid.solve(s.matrix(), b.data(), x.data(), 1e-10, 100, call).iterations, 0u);
    EXPECT_EQ(multigrid.solve(s.matrix(), b.data(), x.data(), 1e-9, 100, call).iterations, 0u);
    // Another right side needs no new setup; zero gives zero.
    const std::vector<double> zero(2500, 0);
    EXPECT_TRUE(multigrid.solve(s.matrix(), zero.data(), x.data(), 1e-9, 100, call).converged);
    EXPECT_EQ(x, zero);
    EXPECT_EQ(multigrid.solve(s.matrix(), b.data(), x.data(), 1e-9, 2, call).iterations, 2u);
}

TEST(SignedMultigrid, RowsDecideWhenToStop) {
    Random random(15);
    const System s(10000, twisted_torus(100, 100, 8, random));
    const std::vector<double> b = noise(s.n(), random);
    std::vector<float> row_scale(s.n());
    for (uint32_t i = 0; i < s.n(); ++i)
        row_scale[i] = static_cast<float>(i % 7 == 0 ? 0 : (0.5 + random.uniform()) / s.diagonal[i]);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::SignedMultigrid multigrid;
    ASSERT_TRUE(multigrid.setup(s.matrix(), call));
    uint32_t before = 0;
    for (double tolerance : {1e-2, 1e-4, 1e-8}) {
        std::vector<double> x(s.n(), 0);
        const hmf::LinearResult result =
            multigrid.solve(s.matrix(), b.data(), x.data(), 1e-14, 100, call, {row_scale.data(), tolerance});
        EXPECT_TRUE(result.converged);
        EXPECT_GT(result.residual, 1e-13);
        EXPECT_GT(result.iterations, before);
        before = result.iterations;
        const std::vector<double> y = s.times(x);
        double largest = 0;
        for (uint32_t i = 0; i < s.n(); ++i)
            largest = std::max(largest, std::abs(b[i] - y[i]) * static_cast<double>(row_scale[i]));
        EXPECT_LE(largest, tolerance);
        EXPECT_NEAR(largest, result.row_residual, 1e-12);
    }
    // The other rule holds as well, and the limit.
    std::vector<double> x(s.n(), 0);
    EXPECT_LE(multigrid.solve(s.matrix(), b.data(), x.data(), 1e-2, 100, call, {row_scale.data(), 1e-12}).residual,
              1e-2);
    x.assign(s.n(), 0);
    const hmf::LinearResult cut =
        multigrid.solve(s.matrix(), b.data(), x.data(), 1e-14, 3, call, {row_scale.data(), 1e-12});
    EXPECT_FALSE(cut.converged);
    EXPECT_GT(cut.row_residual, 1e-12);
}

TEST(SignedMultigrid, FixedUnknownsKeepTheirValues) {
    Random random(16);
    const System s(10000, twisted_torus(100, 100, 8, random));
    const std::vector<double> b = noise(s.n(), random);
    std::vector<double> x(s.n(), 0);
    std::vector<uint32_t> fixed;
    for (uint32_t i = 17; i < s.n(); i += 1 + i / 2) fixed.push_back(i);
    fixed.push_back(18); // a neighbor of the first
    for (uint32_t i : fixed) x[i] = 3 * random.uniform();
    const std::vector<double> start = x;
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::SignedMultigrid multigrid;
    ASSERT_TRUE(multigrid.setup(s.matrix(), call));
    hmf::LinearOptions options;
    options.fixed = fixed.data();
    options.fixed_count = fixed.size();
    const hmf::LinearResult result = multigrid.solve(s.matrix(), b.data(), x.data(), 1e-10, 100, call, options);
    EXPECT_TRUE(result.converged);
    EXPECT_LT(result.iterations, 40u);
    const std::vector<double> y = s.times(x);
    const std::set<uint32_t> is_fixed(fixed.begin(), fixed.end());
    for (uint32_t i = 0; i < s.n(); ++i) {
        if (is_fixed.count(i)) EXPECT_EQ(x[i], start[i]);
        else ASSERT_NEAR(y[i], b[i], 1e-7);
    }
}

TEST(SignedMultigrid, KeepsWhenSomeSignsChange) {
    Random random(11);
    std::vector<Edge> edges = twisted_torus(100, 100, 5, random);
    const System before(10000, edges);
    twist(edges, 100, 30, 20, 23);
    twist(edges, 100, 60, 70, 72);
    const System after(10000, edges);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::SignedMultigrid multigrid;
    ASSERT_TRUE(multigrid.setup(before.matrix(), call));
    const std::vector<double> b = noise(10000, random);
    std::vector<double> x(10000, 0);
    const std::vector<uint8_t> changed(10000, 1);
    multigrid.refresh(after.matrix(), changed.data(), call.parallel);
    const hmf::LinearResult result = multigrid.solve(after.matrix(), b.data(), x.data(), 1e-8, 100, call);
    EXPECT_TRUE(result.converged);
    EXPECT_LE(result.iterations, 40u);
    EXPECT_LE(after.residual(x, b), 1.001e-8);
}

// A setup that does not fit is given up at the limit.
TEST(SignedMultigrid, EndsAtTheLimitWithoutConvergence) {
    Random random(12);
    std::vector<Edge> edges = twisted_torus(60, 60, 5, random);
    const System before(3600, edges);
    // Half of the unknowns change their signs: the same problem in other coordinates.
    std::vector<int> turn(3600);
    for (int& t : turn) t = random.sign();
    for (Edge& e : edges) e.sign *= turn[e.i] * turn[e.j];
    const System turned(3600, edges);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::SignedMultigrid multigrid;
    ASSERT_TRUE(multigrid.setup(before.matrix(), call));
    const std::vector<double> b = noise(3600, random);
    std::vector<double> x(3600, 0);
    EXPECT_TRUE(multigrid.solve(before.matrix(), b.data(), x.data(), 1e-6, 16, call).converged);
    x.assign(3600, 0);
    const std::vector<uint8_t> changed(3600, 1);
    multigrid.refresh(turned.matrix(), changed.data(), call.parallel);
    const hmf::LinearResult result = multigrid.solve(turned.matrix(), b.data(), x.data(), 1e-6, 16, call);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.iterations, 16u);
}

TEST(SignedMultigrid, SameBitsEveryTime) {
    Random random(12);
    const System s(22500, twisted_torus(150, 150, 12, random));
    const std::vector<double> b = noise(22500, random);
    const Outcome first = solve(s, b), second = solve(s, b);
    EXPECT_EQ(first.x, second.x);
    EXPECT_EQ(first.result.iterations, second.result.iterations);
    EXPECT_EQ(first.result.residual, second.result.residual);
    // And on every machine and with every compiler.
    uint64_t hash = 1469598103934665603u;
    for (double v : first.x) {
        uint64_t bits;
        std::memcpy(&bits, &v, sizeof bits);
        hash = (hash ^ bits) * 1099511628211u;
    }
    EXPECT_EQ(hash, 0x3e6f0c6d5cf234b9u);
}

// Matrices of several parts on the first two levels.
TEST(SignedMultigrid, SameBitsWithThreads) {
    Random random(18);
    for (uint32_t round = 0; round < 2; ++round) {
        const uint32_t w = 240 + random.below(100), h = 300 + random.below(100);
        std::vector<Edge> edges = twisted_torus(w, h, 12, random);
        if (round == 1)
            for (Edge& e : edges) e.weight = std::pow(10, -3 + 4 * random.uniform());
        const System s(w * h, edges);
        const std::vector<double> b = noise(s.n(), random);
        const auto run = [&](const hmf_control& control, bool again) {
            hmf::Memory memory(nullptr, nullptr, nullptr, 0);
            hmf::Call call(memory, nullptr, control);
            hmf::SignedMultigrid multigrid;
            EXPECT_TRUE(multigrid.setup(s.matrix(), call));
            if (again) multigrid.refresh(s.matrix(), std::vector<uint8_t>(s.n(), 1).data(), call.parallel);
            std::vector<double> x(s.n(), 0);
            EXPECT_EQ(multigrid.solve(s.matrix(), b.data(), x.data(), 1e-10, 3, call).iterations, 3u);
            return x;
        };
        const std::vector<double> expected = run({}, false);
        EXPECT_EQ(run({}, true), expected);
        for (const uint32_t workers : {2, 7}) {
            test::AdversarialScheduler host(workers, random.next());
            EXPECT_EQ(run(host.lend(), workers == 2), expected) << round << ", " << workers;
            EXPECT_EQ(host.violations, 0u);
            EXPECT_GT(host.calls, 0u);
        }
    }
}

// As if the other matrix had been there from the beginning: rows that did not change keep what is theirs.
TEST(SweepMatrix, RefreshOfChangedRows) {
    Random random(20);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    for (const uint32_t w : {12u, 90u, 300u}) {
        std::vector<Edge> edges = twisted_torus(w, w, w / 10, random);
        for (uint32_t i = 1; i < w * w && w > 12; i += 7) edges.push_back({0, i, random.uniform(), random.sign()});
        const System before(w * w, edges);
        std::vector<uint8_t> changed(w * w, 0);
        for (Edge& e : edges) {
            if (random.below(20)) continue;
            e.sign = -e.sign;
            changed[e.i] = changed[e.j] = 1;
        }
        const System after(w * w, edges);
        const std::vector<float> scale(w * w, 0.25f), b(w * w, 1);
        const auto swept = [&](const hmf::SweepMatrix& matrix) {
            std::vector<float> x(w * w, 0), rest(w * w, 0);
            matrix.forward(b.data(), x.data(), {});
            matrix.find_rest(x.data(), rest.data(), {});
            x.insert(x.end(), rest.begin(), rest.end());
            return x;
        };
        hmf::SweepMatrix expected, refreshed;
        ASSERT_TRUE(expected.build(after.matrix(), scale.data(), w < 200, {}, memory));
        ASSERT_TRUE(refreshed.build(before.matrix(), scale.data(), w < 200, {}, memory));
        EXPECT_NE(swept(refreshed), swept(expected));
        refreshed.refresh(after.matrix(), scale.data(), changed.data(), {});
        EXPECT_EQ(swept(refreshed), swept(expected)) << w;
    }
}

namespace {

// A matrix of several parts with a hub, scaled to unit diagonal, and its vectors by their numbers.
struct Swept {
    System s;
    std::vector<float> scale;
    hmf::SweepMatrix matrix;
    Random& random;

    Swept(uint32_t w, bool renumber, Random& r) : s(w * w, with_hub(w, r)), scale(s.n()), random(r) {
        for (uint32_t i = 0; i < s.n(); ++i) scale[i] = static_cast<float>(1 / std::sqrt(s.diagonal[i]));
        EXPECT_TRUE(matrix.build(s.matrix(), scale.data(), renumber, {}, memory_));
    }
    static std::vector<Edge> with_hub(uint32_t w, Random& random) {
        std::vector<Edge> edges = twisted_torus(w, w, w / 10, random);
        for (uint32_t i = 1; i < w * w && w > 100; i += 7) edges.push_back({0, i, random.uniform(), random.sign()});
        return edges;
    }
    std::vector<float> vector() {
        std::vector<float> v(s.n());
        for (float& x : v) x = static_cast<float>(2 * random.uniform() - 1);
        return v;
    }
    std::vector<double> times(const std::vector<float>& x) const {
        std::vector<double> y(s.n()), out(s.n());
        for (uint32_t i = 0; i < s.n(); ++i)
            y[i] = static_cast<double>(x[matrix.number(i)]) * static_cast<double>(scale[i]);
        y = s.times(y);
        for (uint32_t i = 0; i < s.n(); ++i) out[matrix.number(i)] = y[i] * static_cast<double>(scale[i]);
        return out;
    }

private:
    hmf::Memory memory_{nullptr, nullptr, nullptr, 0};
};

template <class X, class Y>
double dot(const X& x, const Y& y) {
    double sum = 0;
    for (size_t i = 0; i < x.size(); ++i) sum += static_cast<double>(x[i]) * static_cast<double>(y[i]);
    return sum;
}

} // namespace

// In whatever order the rows are swept: what is left is that of the matrix, and a
// sweep backward is the transpose of one forward.
TEST(SweepMatrix, SweepsOfSeveralParts) {
    Random random(19);
    for (const uint32_t w : {3u, 90u, 170u, 300u})
        for (const bool renumber : {false, true}) {
            Swept swept(w, renumber, random);
            const hmf::SweepMatrix& matrix = swept.matrix;
            const uint32_t n = swept.s.n();
            std::set<uint32_t> numbers;
            for (uint32_t i = 0; i < n; ++i) numbers.insert(matrix.number(i));
            EXPECT_EQ(numbers.size(), n);
            EXPECT_EQ(*numbers.rbegin(), n - 1);
            const std::vector<float> u = swept.vector(), v = swept.vector();
            std::vector<float> x(n, 0), rest(n), y(n, 0);
            matrix.forward(u.data(), x.data(), {});
            matrix.find_rest(x.data(), rest.data(), {});
            const std::vector<double> ax = swept.times(x);
            for (uint32_t i = 0; i < n; ++i)
                ASSERT_NEAR(static_cast<double>(rest[i]), static_cast<double>(u[i]) - ax[i], 1e-4) << w << ", " << i;
            matrix.backward(v.data(), y.data(), {});
            EXPECT_NEAR(dot(x, v), dot(u, y), 1e-6 * std::sqrt(dot(x, x) * dot(v, v))) << w;
        }
}

// What a step takes from the sweeps is what products with the matrix would give; held rows rest.
TEST(SweepMatrix, StepsWithoutAProduct) {
    Random random(22);
    for (const uint32_t w : {3u, 90u, 170u})
        for (const bool held : {false, true}) {
            Swept swept(w, held, random);
            const hmf::SweepMatrix& matrix = swept.matrix;
            const uint32_t n = swept.s.n();
            const std::vector<float> g = swept.vector(), p = swept.vector();
            std::vector<float> x = swept.vector(), y = swept.vector(), q = swept.vector(), row_scale(n, 0.5f);
            std::vector<float> difference(n), rest = g, direction = p, product = q, solution = y;
            for (uint32_t k = 0; held && k < n; k += 5) row_scale[k] = -1;
            for (uint32_t k = 0; held && k < n; k += 5) direction[k] = product[k] = 0;
            hmf::StepVectors v;
            v.product = product.data();
            v.direction = direction.data();
            v.solution = solution.data();
            v.difference = difference.data();
            v.row_scale = held ? row_scale.data() : nullptr;
            std::vector<hmf::StepSums> of_segments(matrix.segments());
            v.sums = of_segments.data();
            std::vector<float> z = x;
            const hmf::StepSums sums = matrix.backward_to_step(rest.data(), z.data(), v, {});
            if (!held) {
                std::vector<float> same = x;
                matrix.backward(g.data(), same.data(), {});
                EXPECT_EQ(z, same);
            }
            const std::vector<double> az = swept.times(z);
            const double size = dot(z, z);
            EXPECT_NEAR(sums.zr, dot(z, g), 1e-5 * size);
            EXPECT_NEAR(sums.zAz, dot(z, az), 1e-5 * size);
            EXPECT_NEAR(sums.zq, dot(z, product), 1e-5 * size);
            const std::vector<float> before = direction, q_before = product;
            x = z;
            const hmf::ResidualNorms norms = matrix.step_forward(0.5f, 0.25f, rest.data(), x.data(), v, {});
            double squares = 0, largest = 0;
            for (uint32_t k = 0; k < n; ++k) {
                const bool rests = held && k % 5 == 0;
                const double expected = rests ? 0 : az[k] + 0.25 * static_cast<double>(q_before[k]);
                ASSERT_NEAR(static_cast<double>(product[k]), expected, 1e-4) << w << ", " << k;
                ASSERT_EQ(direction[k], z[k] + 0.25f * before[k]);
                ASSERT_EQ(rests, z[k] == 0);
                ASSERT_EQ(solution[k], y[k] + 0.5f * direction[k]);
                ASSERT_NEAR(rest[k], g[k] - 0.5f * product[k], 1e-6f);
                squares += static_cast<double>(rest[k]) * static_cast<double>(rest[k]);
                if (!rests) largest = std::max(largest, 0.5 * std::abs(static_cast<double>(rest[k])));
            }
            EXPECT_NEAR(norms.squares, squares, 1e-5 * squares);
            EXPECT_NEAR(norms.largest_row, held ? largest : 0, 1e-6);
            std::vector<float> forward(n, 0);
            matrix.forward(rest.data(), forward.data(), {}, v.row_scale);
            EXPECT_EQ(x, forward);
            for (uint32_t k = 0; k < n; ++k) ASSERT_EQ(x[k] == 0, held && k % 5 == 0);
        }
}

namespace {
struct Failing {
    size_t left;
    size_t open;
};
void* allocate(void* user, size_t size) {
    Failing& f = *static_cast<Failing*>(user);
    if (f.left == 0) return nullptr;
    --f.left;
    ++f.open;
    return std::malloc(size);
}
void release(void* user, void* block, size_t) {
    --static_cast<Failing*>(user)->open;
    std::free(block);
}
} // namespace

TEST(SignedMultigrid, EveryAllocationMayFail) {
    Random random(13);
    const System s(2500, twisted_torus(50, 50, 5, random));
    bool done = false;
    for (size_t n = 0; n < 500 && !done; ++n) {
        Failing failing{n, 0};
        {
            hmf::Memory memory(allocate, release, &failing, 0);
            hmf::Call call(memory, nullptr, nullptr, nullptr);
            hmf::SignedMultigrid multigrid;
            done = static_cast<bool>(multigrid.setup(s.matrix(), call));
            if (!done) { EXPECT_EQ(memory.failure(), HMF_ERROR_MEMORY); }
        }
        EXPECT_EQ(failing.open, 0u);
    }
    EXPECT_TRUE(done);
}

TEST(SweepMatrix, OneFailedAllocationIsAFailure) {
    Random random(21);
    for (const uint32_t w : {20u, 150u}) { // of one part, and of two
        const System s(w * w, twisted_torus(w, w, w / 10, random));
        const std::vector<float> scale(s.n(), 0.25f);
        size_t failed = 0;
        for (bool done = false; !done; ++failed) {
            ASSERT_LT(failed, 50u);
            size_t left = failed;
            hmf::Memory memory(allocate_but_one, release_any, &left, 0);
            hmf::SweepMatrix matrix;
            done = static_cast<bool>(matrix.build(s.matrix(), scale.data(), w > 100, {}, memory));
            EXPECT_EQ(done, memory.failure() == HMF_OK) << failed;
        }
        EXPECT_GT(failed, 4u);
    }
}

TEST(SignedMultigrid, StopsWhenTold) {
    Random random(14);
    const System s(2500, twisted_torus(50, 50, 5, random));
    const std::vector<double> b = noise(2500, random);
    for (int32_t answer : {HMF_PROGRESS_CANCEL, HMF_PROGRESS_FINISH}) {
        bool converged = false;
        uint32_t in_setup = 0, in_solve = 0;
        for (int n = 0; n < 100 && !converged; ++n) {
            Stop when{n, answer};
            hmf::Memory memory(nullptr, nullptr, nullptr, 0);
            hmf::Call call(memory, nullptr, stop, &when);
            hmf::SignedMultigrid multigrid;
            if (!multigrid.setup(s.matrix(), call)) {
                EXPECT_TRUE(call.cancelled() || call.finishing());
                EXPECT_EQ(memory.failure(), HMF_OK);
                ++in_setup;
                continue;
            }
            std::vector<double> x(2500, 0);
            converged = multigrid.solve(s.matrix(), b.data(), x.data(), 1e-8, 100, call).converged;
            EXPECT_EQ(call.cancelled(), !converged && answer == HMF_PROGRESS_CANCEL);
            EXPECT_EQ(call.finishing(), !converged && answer == HMF_PROGRESS_FINISH);
            for (double v : x) EXPECT_TRUE(std::isfinite(v));
            ++in_solve;
        }
        EXPECT_TRUE(converged);
        EXPECT_GT(in_setup, 3u);
        EXPECT_GT(in_solve, 3u);
    }
}

} // namespace test_signed_multigrid
