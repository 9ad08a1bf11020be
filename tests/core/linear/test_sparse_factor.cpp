// The direct solvers: where the multigrid fails, and at its coarsest level.
#include <gtest/gtest.h>

#include <Eigen/Sparse>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "src/core/linear/sparse_factor.hpp"
#include "support/signed_system.hpp"

namespace test_sparse_factor {

using namespace linear;

namespace {

std::vector<double> solve_directly(const System& s, const std::vector<double>& b, size_t most_bytes) {
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    std::vector<double> x(s.n(), 1e300);
    {
        hmf::Call call(memory, nullptr, nullptr, nullptr);
        hmf::SparseFactor factor;
        EXPECT_TRUE(factor.build(s.matrix(), call));
        EXPECT_FALSE(factor.empty());
        EXPECT_LE(memory.used(), most_bytes);
        factor.solve(b.data(), x.data());
    }
    EXPECT_EQ(memory.used(), 0u);
    return x;
}

} // namespace

TEST(SparseFactor, TwistedTorusAsEigen) {
    Random random(3);
    for (const uint32_t w : {5u, 18u, 40u, 100u}) {
        const System s(w * w, twisted_torus(w, w, 6, random));
        const std::vector<double> b = noise(s.n(), random);
        // 40 entries a row.
        const std::vector<double> x = solve_directly(s, b, s.n() * 600);
        EXPECT_LE(s.residual(x, b), 1e-14) << w;
        expect_near(x, s.eigen(b), 1e-10);
    }
}

// Where single precision cannot tell the matrix from a singular one.
TEST(SparseFactor, RingsOfHeavyEdges) {
    Random random(5);
    for (const double heavy : {1e3, 1e6, 1e10}) {
        const System s = held_rings(40, 30, heavy, 1, random);
        // A right side of which the solution is known, and about 1.
        const std::vector<double> known = noise(s.n(), random);
        std::vector<double> y = known;
        y[0] = 0;
        const std::vector<double> b = s.times(y);
        // b is known to 1e-16 of the heavy edges, and the light ones hold what is not.
        expect_near(solve_directly(s, b, s.n() * 600), y, 2e-14 * heavy + 1e-11);
    }
}

TEST(SparseFactor, ComponentsAndRowsLeftOut) {
    Random random(7);
    std::vector<Edge> edges = twisted_torus(20, 20, 4, random);
    for (const Edge& e : torus(12, 15, random, true, 400)) edges.push_back(e);
    std::vector<bool> fixed(600, false);
    for (uint32_t k = 0; k < 30; ++k) fixed[random.below(580)] = true;
    fixed[450] = true;
    const System s(600, edges, fixed); // 580 to 599 have no edge
    std::vector<double> b = noise(s.n(), random);
    for (uint32_t i = 0; i < s.n(); ++i)
        if (s.diagonal[i] == 0) b[i] = 0;
    const std::vector<double> x = solve_directly(s, b, s.n() * 600);
    EXPECT_LE(s.residual(x, b), 1e-14);
    for (uint32_t i = 0; i < s.n(); ++i)
        if (s.diagonal[i] == 0) EXPECT_EQ(x[i], 0) << i;
}

// Rings around a hub: the layer in the middle has a third of the unknowns, the hub before it is one.
TEST(SparseFactor, WheelsWithManySpokes) {
    Random random(11);
    for (const uint32_t spokes : {300u, 6000u, 40000u}) {
        std::vector<Edge> edges;
        for (uint32_t wheel = 0; wheel < 2; ++wheel)
            for (uint32_t ring = 0; ring < 3; ++ring)
                for (uint32_t k = 0; k < spokes; ++k) {
                    const uint32_t first = 2 + (3 * wheel + ring) * spokes, v = first + k;
                    edges.push_back({v, first + (k + 1) % spokes, 1 + random.uniform(), -1});
                    edges.push_back({ring > 0 ? v - spokes : wheel, v, 1 + random.uniform(), random.sign()});
                }
        for (uint32_t k = 0; k < 4; ++k) edges.push_back({2 + 2 * spokes + k, 2 + 5 * spokes + k, 1, 1});
        const System s(2 + 6 * spokes, edges);
        const std::vector<double> b = noise(s.n(), random);
        EXPECT_LE(s.residual(solve_directly(s, b, s.n() * 600), b), 1e-13) << spokes;
    }
}

// All are neighbors: as many entries as n^2 / 2.
TEST(SparseFactor, TooManyEntries) {
    std::vector<Edge> edges;
    for (uint32_t i = 0; i < 500; ++i)
        for (uint32_t j = 0; j < i; ++j) edges.push_back({j, i, 1, -1});
    const System s(500, edges);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::SparseFactor factor;
    ASSERT_TRUE(factor.build(s.matrix(), call));
    EXPECT_TRUE(factor.empty());
}

TEST(SparseFactor, OneFailedAllocationIsAFailure) {
    Random random(23);
    const System s(400, twisted_torus(20, 20, 2, random));
    const std::vector<double> b = noise(s.n(), random);
    std::vector<double> x(s.n());
    size_t failed = 0;
    for (bool done = false; !done; ++failed) {
        ASSERT_LT(failed, 50u);
        size_t left = failed;
        hmf::Memory memory(allocate_but_one, release_any, &left, 0);
        hmf::Call call(memory, nullptr, nullptr, nullptr);
        hmf::SparseFactor factor;
        done = static_cast<bool>(factor.build(s.matrix(), call));
        if (done) factor.solve(b.data(), x.data());
        EXPECT_EQ(done, memory.failure() == HMF_OK) << failed;
    }
    EXPECT_GT(failed, 15u);
    EXPECT_LE(s.residual(x, b), 1e-14);
}

// A long way between two reports would be one without an answer to a cancellation.
TEST(SparseFactor, StopsWhenTold) {
    Random random(31);
    const System s(90000, twisted_torus(300, 300, 5, random));
    uint32_t stopped = 0;
    for (int n = 0; n < 60; n += 3) {
        Stop when{n, HMF_PROGRESS_CANCEL};
        hmf::Memory memory(nullptr, nullptr, nullptr, 0);
        hmf::Call call(memory, nullptr, stop, &when);
        hmf::SparseFactor factor;
        stopped += !factor.build(s.matrix(), call);
        EXPECT_EQ(call.cancelled(), factor.empty());
    }
    EXPECT_GT(stopped, 10u);
}

} // namespace test_sparse_factor
