// The ladder of the linear solvers: each rung is reached, and what it gives solves the system.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "src/core/linear/linear_solver.hpp"
#include "support/signed_system.hpp"

namespace test_linear_solver {

using namespace linear;

namespace {

// A system and all that a caller holds beside it.
struct Equations {
    explicit Equations(const System& system) :
        s(system), x(s.n(), 0), is_fixed(s.n(), 0), changed(s.n(), 0), row_scale(s.n(), 1) {}
    hmf::LinearSystem view(const std::vector<double>& b) {
        return {s.matrix(), b.data(), x.data(), is_fixed.data(), row_scale.data(), false};
    }
    const System& s;
    std::vector<double> x;
    std::vector<uint8_t> is_fixed, changed;
    std::vector<float> row_scale;
};

void expect_solved(const System& s, const std::vector<double>& b, double tolerance) {
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    {
        hmf::Call call(memory, nullptr, nullptr, nullptr);
        Equations e(s);
        hmf::LinearSolver solver;
        ASSERT_TRUE(solver.solve(e.view(b), e.changed.data(), tolerance, {}, call));
        EXPECT_LE(s.residual(e.x, b), 1.001 * tolerance);
    }
    EXPECT_EQ(memory.used(), 0u);
}

} // namespace

// Each ring has a wave of its own with a small eigenvalue.
TEST(LinearSolver, RingsOfHeavyEdges) {
    Random random(17);
    for (const double heavy : {1e2, 1e4, 1e5}) {
        const System s = held_rings(60, 40, heavy, 1, random);
        std::vector<double> b = noise(s.n(), random);
        b[0] = 0;
        expect_solved(s, b, 1e-6);
    }
}

TEST(LinearSolver, ExtremeWeights) {
    Random random(6);
    for (uint32_t kind = 0; kind < 4; ++kind) {
        std::vector<Edge> edges = twisted_torus(100, 100, 8, random);
        for (Edge& e : edges) {
            if (kind == 0 && random.below(10) == 0) e.weight = 1e-9; // raised to the floor
            if (kind == 1 && random.below(30) == 0) e.weight = 1e6;  // needles
            if (kind == 2) e.weight = std::pow(10, -9 + 15 * random.uniform());
            if (kind == 3 && (e.i / 100 / 20 % 2) != (e.j / 100 / 20 % 2)) e.weight = 1e-9; // bands that hardly touch
        }
        const System s(10000, edges);
        expect_solved(s, s.times(noise(s.n(), random)), 1e-8);
    }
}

TEST(LinearSolver, Chain) {
    Random random(7);
    std::vector<Edge> edges;
    for (uint32_t i = 0; i + 1 < 20000; ++i) edges.push_back({i, i + 1, 1, random.sign()});
    System chain(20000, edges);
    chain.diagonal[0] += 1;
    expect_solved(chain, noise(20000, random), 1e-8);
}

// Rows that change keep the setup, and the solution is that of the new matrix.
TEST(LinearSolver, MatricesThatChange) {
    Random random(41);
    std::vector<Edge> edges = twisted_torus(60, 60, 5, random);
    const System before(3600, edges);
    twist(edges, 60, 30, 20, 23);
    const System after(3600, edges);
    for (Edge& e : edges) e.weight *= 1 + random.uniform();
    const System other(3600, edges);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    const std::vector<double> b = noise(3600, random);
    hmf::LinearSolver solver;
    const System* last = &before;
    for (const System* s : {&before, &after, &other}) {
        Equations e(*s);
        for (uint32_t i = 0; i < s->n(); ++i)
            for (uint32_t t = s->matrix().offset[i]; t < s->matrix().offset[i + 1]; ++t)
                e.changed[i] |= s->matrix().entry[t] != last->matrix().entry[t];
        ASSERT_TRUE(solver.solve(e.view(b), e.changed.data(), 1e-10, {}, call));
        EXPECT_LE(s->residual(e.x, b), 1.001e-10);
        EXPECT_EQ(e.changed, std::vector<uint8_t>(s->n(), 0));
        last = s;
    }
}

// The multigrid gives none of these digits.
TEST(LinearSolver, DirectWhereSinglePrecisionFails) {
    Random random(43);
    const System s = held_rings(40, 30, 1e10, 1, random);
    std::vector<double> known = noise(s.n(), random);
    known[0] = 0;
    const std::vector<double> b = s.times(known);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    Equations e(s);
    e.is_fixed[0] = 1;
    hmf::LinearSolver solver;
    ASSERT_TRUE(solver.solve(e.view(b), e.changed.data(), 1e-14, {}, call));
    expect_near(e.x, known, 2e-4);
    // Held unknowns keep their values on this rung too.
    const std::vector<uint32_t> held{17, 18, 500};
    hmf::LinearOptions options;
    options.fixed = held.data();
    options.fixed_count = held.size();
    for (double& x : e.x) x = 0;
    for (const uint32_t i : held) e.x[i] = known[i];
    ASSERT_TRUE(solver.solve(e.view(b), e.changed.data(), 1e-14, options, call));
    expect_near(e.x, known, 2e-4);
    for (const uint32_t i : held) EXPECT_EQ(e.x[i], known[i]);
}

// All are neighbors: the factor would be too large.
TEST(DirectSolver, MultigridWhereTheFactorIsTooLarge) {
    Random random(47);
    std::vector<Edge> edges;
    for (uint32_t i = 0; i < 500; ++i)
        for (uint32_t j = 0; j < i; ++j) edges.push_back({j, i, 1 + random.uniform(), random.sign()});
    const System s(500, edges);
    const std::vector<double> b = noise(s.n(), random);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    Equations e(s);
    hmf::Array<uint32_t> number;
    ASSERT_TRUE(number.allocate_filled(memory, s.n(), 0u));
    hmf::DirectSolver solver;
    ASSERT_TRUE(solver.extract(e.view(b), number, call) && solver.solve(e.view(b), call));
    EXPECT_LE(s.residual(e.x, b), 1e-11);
}

} // namespace test_linear_solver
