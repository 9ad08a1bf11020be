// Values from outside as the start of a solve: the same minimum, with no more
// linear solves than from loops.
#include "src/core/solve/state.hpp"
#include "support/boundary.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace test_reuse {

using namespace test;

namespace {

double relative(double a, double b) { return std::abs(a - b) / std::max(std::abs(a), std::abs(b)); }

uint64_t linear_solve_count(const Solution& solution) {
    uint64_t sum = 0;
    for (uint64_t i = 0; i < solution.report.level_count; ++i) sum += solution.report.levels[i].linear_solve_count;
    return sum;
}

Solution from_loops(const Hierarchy& hierarchy, const Loops& loops) {
    return solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
}

Solution from_start(const Hierarchy& hierarchy, const Foliation& start, int32_t method = HMF_METHOD_NEWTON) {
    hmf_solve_options options = solve_options(method, 0);
    options.start = start.get();
    return solve(hierarchy, nullptr, options);
}

TriMesh jittered(const TriMesh& mesh, double size, uint64_t seed) {
    TriMesh result = mesh;
    Random random(seed);
    for (double& x : result.positions) x += size * (random.unit() - 0.5);
    return result;
}

// Half-edges of all levels, and of the caller's triangulation.
std::vector<uint32_t> half_edges(const hmf_hierarchy& h) {
    std::vector<uint32_t> all;
    const auto add = [&](const hmf::Mesh& mesh) {
        for (const uint32_t* array : {mesh.origin, mesh.next, mesh.face})
            all.insert(all.end(), array, array + size_t{2} * mesh.edge_count);
        all.insert(all.end(), mesh.out, mesh.out + mesh.vertex_count);
    };
    add(h.input);
    for (size_t k = 0; k < h.level_count; ++k) add(h.levels[k].mesh);
    return all;
}

} // namespace

// A solve works on the half-edges of the hierarchy where it does not change them.
TEST(Reuse, HierarchyIsNotWritten) {
    const TriMesh meshes[] = {pretzel(2, 3), with_bad_triangles(pretzel(2, 3), 300, 0.01, 4),
                              with_random_flips(pretzel(2, 3), 80000, -1, 3), with_holes(pretzel(2, 2), 3, 2, 5)};
    for (const TriMesh& mesh : meshes) {
        const Hierarchy hierarchy(mesh, 0.5, 150);
        ASSERT_TRUE(hierarchy);
        const hmf_hierarchy& h = *hierarchy.get();
        const std::vector<uint32_t> before = half_edges(h);
        const Solution solved = from_loops(hierarchy, library_loops(hierarchy, 0));
        ASSERT_EQ(solved.status, HMF_OK) << solved.error.message;
        EXPECT_TRUE(half_edges(h) == before) << "solve";
        EXPECT_EQ(relax(solved.foliation, solve_options(HMF_METHOD_WHITEHEAD, 1e-12, 3)).report.poles, 0u);
        for (size_t level = hierarchy.levels(); level-- > 0;) EXPECT_TRUE(interpolate(solved.foliation, level));
        EXPECT_TRUE(half_edges(h) == before) << "relax, interpolate";
        hmf_error error{};
        hmf_parameterization* flat = nullptr;
        ASSERT_EQ(hmf_parameterize(solved.foliation.get(), nullptr, nullptr, &flat, &error), HMF_OK) << error.message;
        hmf_free(flat);
        EXPECT_TRUE(half_edges(h) == before) << "parameterize";
    }
}

// The log backwards from the coarsest level gives the half-edges of each level, array by array: the ground on which a
// solve, loops and classes take them from the hierarchy.
TEST(Reuse, ReplayGivesTheHalfEdgesOfTheHierarchy) {
    const TriMesh meshes[] = {pretzel(2, 3), with_bad_triangles(pretzel(2, 3), 300, 0.01, 4),
                              with_random_flips(pretzel(2, 3), 80000, -1, 3), with_holes(pretzel(2, 2), 3, 2, 5)};
    for (const TriMesh& mesh : meshes) {
        const Hierarchy hierarchy(mesh, 0.5, 150);
        ASSERT_TRUE(hierarchy);
        const hmf_hierarchy& h = *hierarchy.get();
        ASSERT_GT(h.level_count, 1u);
        hmf::Memory memory(nullptr, nullptr, nullptr, 0);
        hmf::MeshCopy copy;
        ASSERT_TRUE(copy.allocate(h.input, memory));
        hmf::Mesh found = copy.of(h.levels[h.level_count - 1].mesh);
        const auto expect_equal = [&](const hmf::Mesh& wanted) {
            const size_t bytes = size_t{2} * wanted.edge_count * sizeof(uint32_t);
            EXPECT_EQ(std::memcmp(found.origin, wanted.origin, bytes), 0);
            EXPECT_EQ(std::memcmp(found.next, wanted.next, bytes), 0);
            EXPECT_EQ(std::memcmp(found.face, wanted.face, bytes), 0);
        };
        for (size_t level = h.level_count - 1; level-- > 0;) {
            const hmf::Level& finer = h.levels[level];
            for (size_t i = finer.flip_end; i-- > finer.flip_begin;) hmf::unflip(found, h.flips[i]);
            for (size_t i = finer.collapse_end; i-- > finer.collapse_begin;) hmf::split(found, h.collapses[i]);
            const hmf::Mesh& wanted = level == 0 ? h.input : finer.mesh;
            expect_equal(wanted);
            EXPECT_EQ(std::memcmp(found.out, wanted.out, wanted.vertex_count * sizeof(uint32_t)), 0);
        }
        for (size_t i = 0; i < h.intrinsic_flip_count; ++i) hmf::flip(found, h.intrinsic_flips[i]);
        expect_equal(h.levels[0].mesh);
    }
}

// Down to the coarsest level and back a state has copies only while it needs them.
TEST(Reuse, AStateSharesTheHalfEdgesOfItsLevel) {
    const Hierarchy hierarchy(with_random_flips(pretzel(2, 3), 80000, -1, 3), 0.5, 150);
    ASSERT_TRUE(hierarchy);
    const hmf_hierarchy& h = *hierarchy.get();
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    hmf::State state;
    ASSERT_TRUE(state.allocate(h, 0, memory));
    state.load(0, hmf::Triangulation::input);
    EXPECT_FALSE(state.is_own());
    for (uint32_t e = 0; e < h.input.edge_count; ++e) state.foliation.value[e] = 0;
    ASSERT_TRUE(state.go_to(h.level_count - 1, call));
    EXPECT_TRUE(state.is_own());
    ASSERT_TRUE(state.go_to(0, call));
    EXPECT_FALSE(state.is_own());
    EXPECT_EQ(state.foliation.mesh.next, h.input.next);
    EXPECT_EQ(std::memcmp(state.foliation.mesh.out, h.input.out, h.input.vertex_count * sizeof(uint32_t)), 0);
    ASSERT_GT(h.intrinsic_flip_count, 0u);
    ASSERT_TRUE(state.to_intrinsic(call));
    EXPECT_EQ(state.foliation.mesh.next, h.levels[0].mesh.next);
    ASSERT_TRUE(state.to_input(call));
    EXPECT_TRUE(state.is_own());
    const size_t bytes = size_t{2} * h.input.edge_count * sizeof(uint32_t);
    EXPECT_EQ(std::memcmp(state.foliation.mesh.next, h.input.next, bytes), 0);
}

TEST(Reuse, OwnResult) {
    const Hierarchy hierarchy(pretzel(3, 3));
    ASSERT_TRUE(hierarchy);
    ASSERT_GT(hierarchy.levels(), 2u);
    const Loops loops = library_loops(hierarchy, 0);
    const Solution scratch = from_loops(hierarchy, loops);
    ASSERT_EQ(scratch.status, HMF_OK) << scratch.error.message;
    const Solution again = from_start(hierarchy, scratch.foliation);
    ASSERT_EQ(again.status, HMF_OK) << again.error.message;
    EXPECT_LT(relative(again.report.energy, scratch.report.energy), 1e-10);
    EXPECT_LE(linear_solve_count(again), linear_solve_count(scratch));
    expect_foliation(read_level(hierarchy, 0), again.foliation);
}

// Frames of an animation: the same triangles, other positions.
TEST(Reuse, ResultOfAnotherGeometry) {
    const TriMesh mesh = pretzel(3, 3);
    for (const uint64_t seed : {1, 2, 3}) {
        SCOPED_TRACE(seed);
        const Hierarchy first(mesh),
            second(transformed(jittered(mesh, 0.02, seed),
                               {1.3, 0.1 * static_cast<double>(seed), 0, 0, 1, 0, 0, 0.2, 0.8}));
        ASSERT_TRUE(first && second);
        const Loops loops = library_loops(first, 0);
        const Solution before = from_loops(first, loops);
        ASSERT_EQ(before.status, HMF_OK) << before.error.message;
        const Solution scratch = from_loops(second, loops), reused = from_start(second, before.foliation);
        ASSERT_EQ(scratch.status, HMF_OK) << scratch.error.message;
        ASSERT_EQ(reused.status, HMF_OK) << reused.error.message;
        EXPECT_LT(relative(reused.report.energy, scratch.report.energy), 1e-10);
        EXPECT_LE(linear_solve_count(reused), linear_solve_count(scratch) + 1);
        EXPECT_GT(relative(before.report.energy, scratch.report.energy), 1e-3);
    }
}

// Far from the minimum: the initial foliation of loops on the input mesh.
TEST(Reuse, InitialFoliation) {
    const Hierarchy hierarchy(with_random_flips(pretzel(2, 3), 20000, 0.8, 5));
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    const Solution scratch = from_loops(hierarchy, loops);
    ASSERT_EQ(scratch.status, HMF_OK) << scratch.error.message;
    const Solution reused = from_start(hierarchy, initialize(hierarchy, loops));
    ASSERT_EQ(reused.status, HMF_OK) << reused.error.message;
    EXPECT_LT(relative(reused.report.energy, scratch.report.energy), 1e-10);
    EXPECT_EQ(linear_solve_count(reused), linear_solve_count(scratch)); // it is what the loops give
}

TEST(Reuse, OfAnyLevelWithAnyMethod) {
    const Hierarchy hierarchy(pretzel(2, 3));
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    const Solution scratch = from_loops(hierarchy, loops);
    ASSERT_EQ(scratch.status, HMF_OK);
    for (size_t level = 0; level < hierarchy.levels(); ++level)
        for (const int32_t method : {HMF_METHOD_NEWTON, HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
            SCOPED_TRACE(testing::Message() << "level " << level << " method " << method);
            const Solution reused = from_start(hierarchy, interpolate(scratch.foliation, level), method);
            ASSERT_LT(reused.status, HMF_CANCELLED) << reused.error.message;
            EXPECT_LT(relative(reused.report.energy, scratch.report.energy),
                      method == HMF_METHOD_NEWTON ? 1e-10 : 2e-3);
        }
}

// Up and down the levels, with some moves on the way: restriction,
// interpolation and moves keep the class, so the minimum is the same.
TEST(Reuse, RandomWalksOverTheLevels) {
    const TriMesh meshes[] = {pretzel(3, 3), with_random_flips(pretzel(2, 3), 80000, -1, 6),
                              with_bad_triangles(pretzel(2, 3), 200, 0.01, 7)};
    for (size_t m = 0; m < 3; ++m) {
        const Hierarchy hierarchy(meshes[m], 0.6, 150);
        ASSERT_TRUE(hierarchy);
        ASSERT_GT(hierarchy.levels(), 3u);
        const Loops loops = library_loops(hierarchy, hierarchy.coarsest());
        const Solution scratch = from_loops(hierarchy, loops);
        ASSERT_EQ(scratch.status, HMF_OK) << scratch.error.message;
        for (const uint64_t seed : {1, 2, 3, 4}) {
            SCOPED_TRACE(testing::Message() << "mesh " << m << " seed " << seed);
            Random random(seed);
            Foliation foliation = initialize(hierarchy, loops);
            for (size_t step = 0; step < 12; ++step) {
                const size_t next = step == 11 ? 0 : random.below(hierarchy.levels());
                foliation = interpolate(foliation, next);
                const LevelMesh mesh = read_level(hierarchy, next);
                expect_foliation(mesh, foliation);
                if (random.below(2) == 0) continue;
                Solution moved = relax(foliation, solve_options(HMF_METHOD_WHITEHEAD, 1e-12, 1 + random.below(4)));
                ASSERT_LT(moved.status, HMF_CANCELLED) << moved.error.message;
                foliation = std::move(moved.foliation);
                expect_foliation(mesh, foliation);
            }
            const Solution relaxed = relax(foliation, solve_options(HMF_METHOD_NEWTON, 0));
            EXPECT_EQ(relaxed.status, HMF_OK) << relaxed.error.message;
            EXPECT_LT(relative(relaxed.report.energy, scratch.report.energy), 1e-10);
        }
    }
}

// The values of the caller's edges, read again.  The values are the same; energy
// and residuals are those of the foliation, to the bit, unless a vertex had to
// be moved on the way to them; the minimum of the class is the same in any case.
TEST(Reuse, RoundTripOfTheInputMesh) {
    size_t exact = 0, moved = 0;
    const TriMesh meshes[] = {
        pretzel(2, 3), with_random_flips(pretzel(2, 3), 6000, 0.9, 1), with_random_flips(pretzel(3, 2), 3000, 0.95, 2),
        with_random_flips(pretzel(2, 3), 80000, -1, 3), with_bad_triangles(pretzel(2, 3), 300, 0.01, 4)};
    for (const TriMesh& mesh : meshes) {
        const Hierarchy hierarchy(mesh);
        ASSERT_TRUE(hierarchy);
        const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
        ASSERT_EQ(solution.status, HMF_OK) << solution.error.message;
        EXPECT_EQ(energy(solution.foliation), solution.report.energy);
        const Foliation read = create(hierarchy, 0, solution.values);
        ASSERT_TRUE(read);
        EXPECT_EQ(values_of(read), solution.values);
        EXPECT_EQ(hmf_foliation_report(read.get()), nullptr);
        expect_foliation(read_level(hierarchy, 0), read);
        const double there = energy(read);
        const std::vector<double> residual = residuals(read, mesh.vertex_count());
        const double residual_max = *std::max_element(residual.begin(), residual.end());
        if (solution.report.bad_flips == 0) {
            EXPECT_EQ(there, solution.report.energy);
            EXPECT_EQ(residual_max, solution.report.residual_max);
            ++exact;
        } else {
            EXPECT_GE(there, solution.report.energy * (1 - 1e-14));
            ++moved;
        }
        const Solution again = relax(read, solve_options(HMF_METHOD_NEWTON, 0));
        ASSERT_EQ(again.status, HMF_OK) << again.error.message;
        EXPECT_LT(relative(again.report.energy, solution.report.energy), 1e-12);
    }
    EXPECT_GT(exact, 0u);
    EXPECT_GT(moved, 0u);
}

// Passing values on and on costs no bits.
TEST(Reuse, AgainAndAgain) {
    const Hierarchy hierarchy(with_random_flips(pretzel(2, 2), 3000, 0.9, 8), 0.5, 200);
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    const Solution first = from_loops(hierarchy, loops);
    ASSERT_EQ(first.status, HMF_OK) << first.error.message;
    Foliation last = create(hierarchy, 0, first.values);
    double energy_now = 0;
    for (int round = 0; round < 12; ++round) {
        const Solution solved = from_start(hierarchy, last);
        ASSERT_EQ(solved.status, HMF_OK) << "round " << round << ": " << solved.error.message;
        Solution relaxed = relax(solved.foliation, solve_options(HMF_METHOD_NEWTON, 0));
        ASSERT_EQ(relaxed.status, HMF_OK) << "round " << round << ": " << relaxed.error.message;
        energy_now = solved.report.energy;
        last = create(hierarchy, 0, relaxed.values);
    }
    EXPECT_LT(relative(energy_now, first.report.energy), 1e-10);
    expect_foliation(read_level(hierarchy, 0), last);
}

// Values times a power of two, and through text.
TEST(Reuse, ValuesFromElsewhere) {
    const Hierarchy hierarchy(with_random_flips(pretzel(2, 2), 3000, 0.9, 8));
    ASSERT_TRUE(hierarchy);
    const Solution solution = from_loops(hierarchy, library_loops(hierarchy, 0));
    std::vector<double> values = solution.values;
    for (double& x : values) x = std::strtod(std::to_string(x).c_str(), nullptr);
    hmf_foliation* none = nullptr;
    EXPECT_EQ(hmf_foliation_from_values(hierarchy.get(), 0, values.data(), values.size(), nullptr, &none, nullptr),
              HMF_ERROR_VALUE_NOT_CLOSED); // rounded
    for (size_t e = 0; e < values.size(); ++e) {
        char text[40];
        std::snprintf(text, sizeof text, "%.17g", solution.values[e]);
        values[e] = 1024 * std::strtod(text, nullptr);
    }
    const Foliation read = create(hierarchy, 0, values);
    EXPECT_EQ(values_of(read), values);
    EXPECT_LT(relative(energy(read), 1048576 * energy(create(hierarchy, 0, solution.values))), 1e-15);
}

// In a triangle with three odd sides the middle lies between two integers: the unit is halved, if there is a bit left.
TEST(Reuse, OddSums) {
    const Hierarchy hierarchy(torus(20, 10, 2, 1));
    ASSERT_TRUE(hierarchy);
    const std::vector<double> odd(hierarchy.edges(0), std::ldexp(1, 44) + 1);
    const Foliation foliation = create(hierarchy, 0, odd);
    ASSERT_TRUE(foliation);
    EXPECT_EQ(values_of(foliation), odd);
    EXPECT_EQ(hmf_foliation_unit(foliation.get()), 0.5);
    const std::vector<double> full(hierarchy.edges(0), std::ldexp(1, 52) + 1);
    hmf_foliation* none = nullptr;
    EXPECT_EQ(hmf_foliation_from_values(hierarchy.get(), 0, full.data(), full.size(), nullptr, &none, nullptr),
              HMF_ERROR_VALUE_NOT_CLOSED);
    EXPECT_EQ(none, nullptr);
}

TEST(Reuse, Errors) {
    const Hierarchy hierarchy(pretzel(2, 2), 0.5, 100), other(pretzel(3, 2), 0.5, 100);
    ASSERT_TRUE(hierarchy && other);
    const Loops loops = library_loops(hierarchy, 0);
    const Foliation start = initialize(hierarchy, loops);
    hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 0);
    options.start = start.get();
    EXPECT_EQ(solve(hierarchy, &loops, options).status, HMF_ERROR_OPTIONS);
    // Of other triangles: it has not as many edges, or is not closed there.
    EXPECT_GE(solve(other, nullptr, options).status, HMF_ERROR_NULL);
    TriMesh turned = pretzel(2, 2);
    std::rotate(turned.triangles.begin(), turned.triangles.begin() + 3 * 100, turned.triangles.end());
    const Hierarchy renumbered(turned, 0.5, 100);
    EXPECT_GE(solve(renumbered, nullptr, options).status, HMF_ERROR_NULL);
    // Only level 0 is the same in another hierarchy.
    const Hierarchy twin(pretzel(2, 2), 0.6, 100);
    const Foliation coarse = interpolate(start, 1);
    options.start = coarse.get();
    EXPECT_EQ(solve(hierarchy, nullptr, options).status, HMF_OK);
    EXPECT_EQ(solve(twin, nullptr, options).status, HMF_ERROR_LEVEL);
    // The small loop around a vertex makes a pole there.
    const LevelMesh mesh = read_level(hierarchy, 0);
    std::vector<double> values(mesh.edge_count, 0);
    for (size_t i = 0; i < 2 * mesh.edge_count; ++i) values[i / 2] += mesh.edge_vertices[i] % 50 == 0;
    const Foliation poles = create(hierarchy, 0, values);
    options.start = poles.get();
    EXPECT_EQ(solve(hierarchy, nullptr, options).status, HMF_ERROR_VALUE_POLE);
}

} // namespace test_reuse
