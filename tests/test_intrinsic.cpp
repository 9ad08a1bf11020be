// Any closed mesh: after bad treatment of good meshes the intrinsic weights of
// level 0 are not negative, and the foliation is found to the tolerance.
#include "../src/foliation/whitehead.hpp"
#include "../src/hierarchy/hierarchy.hpp"
#include "../src/mesh/intrinsic.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace test;

namespace {

double relative(double a, double b) { return std::abs(a - b) / std::max(std::abs(a), std::abs(b)); }

TriMesh stretched(const TriMesh& mesh, double x, double y, double z) { return transformed(mesh, {x, 0, 0, 0, y, 0, 0, 0, z}); }

// Vertices of `count` random triangles, moved to the height `height` (of the
// edge's length) above a point of the edge opposite to them.
TriMesh with_vertices_at_edges(const TriMesh& mesh, size_t count, double height, uint64_t seed) {
    TriMesh result = mesh;
    Random random(seed);
    std::vector<bool> used(mesh.vertex_count(), false);
    for (size_t i = 0; i < count; ++i) {
        const size_t t = random.below(mesh.triangle_count()), s = random.below(3);
        const uint32_t v = mesh.triangles[3 * t + s], a = mesh.triangles[3 * t + (s + 1) % 3], b = mesh.triangles[3 * t + (s + 2) % 3];
        if (used[v] || used[a] || used[b]) continue;
        used[v] = used[a] = used[b] = true;
        const double at = 0.2 + 0.6 * random.unit();
        double foot[3], up[3], edge2 = 0, up2 = 0;
        for (size_t c = 0; c < 3; ++c) {
            const double pa = mesh.positions[3 * a + c], pb = mesh.positions[3 * b + c];
            foot[c] = pa + at * (pb - pa);
            up[c] = mesh.positions[3 * v + c] - foot[c];
            edge2 += (pb - pa) * (pb - pa);
            up2 += up[c] * up[c];
        }
        for (size_t c = 0; c < 3; ++c) result.positions[3 * v + c] = foot[c] + height * std::sqrt(edge2 / up2) * up[c];
    }
    return result;
}

// Random vertices pulled away from the origin of their coordinates: spikes.
TriMesh with_spikes(const TriMesh& mesh, size_t count, double factor, uint64_t seed) {
    TriMesh result = mesh;
    Random random(seed);
    for (size_t i = 0; i < count; ++i) {
        const size_t v = random.below(mesh.vertex_count());
        for (size_t c = 0; c < 3; ++c) result.positions[3 * v + c] = factor * mesh.positions[3 * v + c];
    }
    return result;
}

struct Kinds {
    size_t self_edges = 0, inside = 0, hosts = 0;
};

Kinds kinds(const Hierarchy& hierarchy) {
    const hmf::Mesh& mesh = hierarchy.get()->levels[0].mesh;
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Monogons monogons;
    EXPECT_TRUE(monogons.find(mesh, memory));
    Kinds count;
    for (const uint8_t kind : monogons.vertex) {
        count.self_edges += (kind & hmf::Monogons::SELF_EDGE) != 0;
        count.inside += (kind & hmf::Monogons::INSIDE) != 0;
        count.hosts += (kind & hmf::Monogons::HOST) != 0;
    }
    return count;
}

Kinds expect_solved(const TriMesh& mesh, const char* what) {
    SCOPED_TRACE(what);
    const Hierarchy hierarchy(mesh);
    if (!hierarchy) return {};
    const Kinds found = kinds(hierarchy);
    const LevelMesh level = read_level(hierarchy, 0);
    EXPECT_EQ(level.non_delaunay_count, 0u);
    EXPECT_EQ(hmf::check(hierarchy.get()->levels[0].mesh), nullptr);
    const Solution newton = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
    EXPECT_EQ(newton.status, HMF_OK) << newton.error.message;
    if (newton.status >= HMF_ERROR_NULL) return found;
    EXPECT_LE(newton.report.residual_max, 1e-8);
    EXPECT_EQ(newton.report.bad_flips_left, 0u);
    expect_foliation(hierarchy, level, newton.values);
    return found;
}

} // namespace

TEST(Intrinsic, Stretched) {
    for (const double factor : {30.0, 1000.0}) {
        SCOPED_TRACE(factor);
        expect_solved(stretched(pretzel(2, 2), factor, 1, 1), "pretzel x");
        expect_solved(stretched(pretzel(2, 2), 1, factor, 1), "pretzel y");
        expect_solved(stretched(pretzel(3, 2), 1, 1, factor), "pretzel z");
        expect_solved(stretched(torus(48, 12, 3, 1), factor, 1, 1), "torus x");
        expect_solved(stretched(torus(48, 12, 3, 1), 1, 1, factor), "torus z");
        expect_solved(stretched(trefoil(120, 8, 0.3), factor, 1, 1), "trefoil");
    }
}

TEST(Intrinsic, RandomFlips) {
    for (const uint64_t seed : {1, 2, 3}) {
        expect_solved(with_random_flips(pretzel(2, 2), 40000, -1, seed), "pretzel");
        expect_solved(with_random_flips(torus(24, 12, 3, 1), 20000, -1, seed), "torus");
    }
}

TEST(Intrinsic, VerticesAtEdges) {
    for (const double height : {1e-3, 1e-6, 1e-9}) {
        SCOPED_TRACE(height);
        for (const uint64_t seed : {1, 2, 3}) expect_solved(with_vertices_at_edges(pretzel(2, 2), 400, height, seed), "pretzel");
    }
}

TEST(Intrinsic, BadTriangles) {
    for (const double degrees : {0.1, 0.001}) {
        SCOPED_TRACE(degrees);
        for (const uint64_t seed : {1, 2}) expect_solved(with_bad_triangles(pretzel(2, 2), 300, degrees, seed), "pretzel");
    }
}

TEST(Intrinsic, Spikes) {
    for (const double factor : {2.0, 10.0, 1000.0}) {
        SCOPED_TRACE(factor);
        for (const uint64_t seed : {1, 2, 3}) expect_solved(with_spikes(pretzel(2, 2), 60, factor, seed), "pretzel");
    }
}
