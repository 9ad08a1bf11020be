// Any closed mesh: after bad treatment of good meshes the intrinsic weights of
// level 0 are not negative, and the foliation is found to the tolerance.
#include "src/core/foliation/whitehead.hpp"
#include "src/core/hierarchy/hierarchy.hpp"
#include "src/core/mesh/intrinsic.hpp"
#include "src/core/mesh/weights.hpp"
#include "support/check_mesh.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_intrinsic {

using namespace test;

namespace {

double relative(double a, double b) { return std::abs(a - b) / std::max(std::abs(a), std::abs(b)); }

TriMesh stretched(const TriMesh& mesh, double x, double y, double z) {
    return transformed(mesh, {x, 0, 0, 0, y, 0, 0, 0, z});
}

// Vertices of `count` random triangles, moved to the height `height` (of the
// edge's length) above a point of the edge opposite to them.
TriMesh with_vertices_at_edges(const TriMesh& mesh, size_t count, double height, uint64_t seed) {
    TriMesh result = mesh;
    Random random(seed);
    std::vector<bool> used(mesh.vertex_count(), false);
    for (size_t i = 0; i < count; ++i) {
        const size_t t = random.below(mesh.triangle_count()), s = random.below(3);
        const uint32_t v = mesh.triangles[3 * t + s], a = mesh.triangles[3 * t + (s + 1) % 3],
                       b = mesh.triangles[3 * t + (s + 2) % 3];
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

Kinds expect_solved(const TriMesh& mesh, const char* what, int32_t kind = HMF_LOOPS_CUT) {
    SCOPED_TRACE(what);
    const Hierarchy hierarchy(mesh);
    if (!hierarchy) return {};
    const Kinds found = kinds(hierarchy);
    const LevelMesh level = read_level(hierarchy, 0);
    EXPECT_EQ(level.raised_count, 0u);
    EXPECT_EQ(hmf::check(hierarchy.get()->levels[0].mesh), nullptr);
    const Loops loops = library_loops(hierarchy, hierarchy.coarsest(), kind);
    const Solution newton = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
    EXPECT_EQ(newton.status, HMF_OK) << newton.error.message;
    if (newton.status >= HMF_ERROR_NULL) return found;
    EXPECT_LE(newton.report.residual_max, 1e-8);
    EXPECT_EQ(newton.report.bad_flips_left, 0u);
    expect_foliation(level, newton.foliation);
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

// Small meshes with clusters that hang on a vertex between its edges to itself.
TEST(Intrinsic, ZeroEdgesToItself) {
    expect_solved(with_random_flips(stretched(plate(2), 7, 1, 4), 2000, -1, 1441), "boundary in several places");
    expect_solved(with_random_flips(stretched(plate(2), 6, 1, 1), 2000, -1, 1510), "closed corners");
    expect_solved(with_random_flips(stretched(plate(2), 5, 1, 1), 2000, -1, 2615), "one boundary");
    for (size_t holes = 2; holes <= 4; ++holes) {
        // Loops of a cut system are as short as 1e-4 of the object; their residual stalls at 1e-7.
        expect_solved(stretched(pretzel(holes, 1), 1e4, 1, 1), "long neck", HMF_LOOPS_TUNNEL);
        expect_solved(stretched(pretzel(holes, 1), 1, 1e4, 1), "limbs inside", HMF_LOOPS_TUNNEL);
    }
}

TEST(Intrinsic, VerticesAtEdges) {
    for (const double height : {1e-3, 1e-6, 1e-9}) {
        SCOPED_TRACE(height);
        for (const uint64_t seed : {1, 2, 3})
            expect_solved(with_vertices_at_edges(pretzel(2, 2), 400, height, seed), "pretzel");
    }
}

TEST(Intrinsic, BadTriangles) {
    for (const double degrees : {0.1, 0.001}) {
        SCOPED_TRACE(degrees);
        for (const uint64_t seed : {1, 2})
            expect_solved(with_bad_triangles(pretzel(2, 2), 300, degrees, seed), "pretzel");
    }
}

TEST(Intrinsic, Spikes) {
    for (const double factor : {2.0, 10.0, 1000.0}) {
        SCOPED_TRACE(factor);
        for (const uint64_t seed : {1, 2, 3}) expect_solved(with_spikes(pretzel(2, 2), 60, factor, seed), "pretzel");
    }
}

// The treatments above make what they are for.
TEST(Intrinsic, TreatmentsGiveSelfEdgesAndMonogons) {
    EXPECT_GT(kinds(Hierarchy(stretched(trefoil(120, 8, 0.3), 1000, 1, 1))).self_edges, 300u);
    EXPECT_GT(kinds(Hierarchy(with_spikes(pretzel(2, 2), 60, 10, 1))).inside, 30u);
    const Kinds both = kinds(Hierarchy(stretched(pretzel(3, 2), 1, 1, 1000)));
    EXPECT_GT(both.self_edges, 10u);
    EXPECT_GT(both.hosts, 5u);
}

// Whitehead moves with edges from a vertex to itself keep the class: Newton's
// method finds the same minimum from where they stop.
TEST(Intrinsic, MovesKeepTheClass) {
    const TriMesh meshes[] = {
        stretched(pretzel(2, 2), 1, 60, 1),    stretched(torus(48, 12, 3, 1), 1000, 1, 1),
        with_spikes(pretzel(2, 2), 60, 10, 1), with_random_flips(pretzel(2, 2), 40000, -1, 4),
        stretched(pretzel(2, 1), 1e4, 1, 1),   with_random_flips(stretched(plate(2), 7, 1, 4), 2000, -1, 1441)};
    for (const TriMesh& mesh : meshes) {
        const Hierarchy hierarchy(mesh);
        ASSERT_TRUE(hierarchy);
        const Kinds found = kinds(hierarchy);
        EXPECT_GT(found.self_edges + found.hosts, 0u);
        const Loops loops = library_loops(hierarchy, 0);
        const Solution newton = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
        ASSERT_EQ(newton.status, HMF_OK) << newton.error.message;
        for (const uint64_t sweeps : {1, 3, 20, 300}) {
            SCOPED_TRACE(sweeps);
            const Solution moves = solve(hierarchy, &loops, solve_options(HMF_METHOD_SINGLE_LEVEL, 1e-9, sweeps));
            ASSERT_LT(moves.status, HMF_ERROR_NULL) << moves.error.message;
            expect_foliation(read_level(hierarchy, 0), moves.foliation);
            EXPECT_GE(moves.report.energy, newton.report.energy * (1 - 1e-10));
            const Solution again = relax(moves.foliation, solve_options(HMF_METHOD_NEWTON, 0));
            EXPECT_EQ(again.status, HMF_OK) << again.error.message;
            EXPECT_LT(relative(again.report.energy, newton.report.energy), 1e-10);
        }
    }
}

// One surface, two triangulations with the same vertices and the same metric.
TEST(Intrinsic, EnergyDependsOnTheMetricOnly) {
    for (const size_t holes : {size_t{1}, size_t{2}, size_t{3}}) {
        const TriMesh flat = subdivide(subdivide(plate(holes)));
        const Hierarchy reference(with_delaunay_flips(flat, 0, 100));
        ASSERT_TRUE(reference);
        const Loops loops = plate_loops(reference, 0, holes);
        const Solution expected = solve(reference, &loops, solve_options(HMF_METHOD_NEWTON, 1e-9));
        ASSERT_EQ(expected.status, HMF_OK) << expected.error.message;
        for (const uint64_t seed : {1, 2, 3}) {
            const TriMesh bad = with_random_flips(flat, 60000, 1 - 1e-12, seed);
            const Hierarchy hierarchy(bad);
            ASSERT_TRUE(hierarchy);
            EXPECT_GT(hierarchy.get()->intrinsic_flip_count, 100u);
            EXPECT_EQ(read_level(hierarchy, 0).raised_count, 0u);
            const Loops own = plate_loops(hierarchy, 0, holes);
            const Solution solution = solve(hierarchy, &own, solve_options(HMF_METHOD_NEWTON, 1e-9));
            EXPECT_EQ(solution.status, HMF_OK) << solution.error.message;
            EXPECT_LT(relative(solution.report.energy, expected.report.energy), 1e-9)
                << "holes " << holes << " seed " << seed;
        }
    }
}

// --- mollify -----------------------------------------------------------------

namespace {

hmf_hierarchy_options mollified(double margin) {
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    options.mollify = margin;
    return options;
}

hmf_status build_status(const TriMesh& mesh, const hmf_hierarchy_options& options) {
    hmf_hierarchy* hierarchy = nullptr;
    const hmf_status status = hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                                   mesh.triangle_count(), &options, nullptr, &hierarchy, nullptr);
    hmf_hierarchy_destroy(hierarchy);
    return status;
}

} // namespace

TEST(Mollify, TrianglesWithoutAreaAndEdgesWithoutLength) {
    // A subdivided cube with holes, so that points on edges are exact.
    TriMesh mesh = subdivide(subdivide(plate(2)));
    const auto move = [&](uint32_t v, uint32_t to, uint32_t and_to) {
        for (size_t c = 0; c < 3; ++c)
            mesh.positions[3 * v + c] = 0.5 * (mesh.positions[3 * to + c] + mesh.positions[3 * and_to + c]);
    };
    std::vector<bool> used(mesh.vertex_count(), false);
    Random random(3);
    for (size_t i = 0; i < 60; ++i) {
        const size_t t = random.below(mesh.triangle_count());
        const uint32_t a = mesh.triangles[3 * t], b = mesh.triangles[3 * t + 1], c = mesh.triangles[3 * t + 2];
        if (used[a] || used[b] || used[c]) continue;
        used[a] = used[b] = used[c] = true;
        move(a, b, i % 3 ? c : b); // on the opposite edge, or onto a neighbor
    }
    EXPECT_EQ(build_status(mesh, mollified(0)), HMF_ERROR_MESH_DEGENERATE);
    for (const double margin : {1e-5, 1e-3}) {
        SCOPED_TRACE(margin);
        const Hierarchy hierarchy(mesh, mollified(margin));
        ASSERT_TRUE(hierarchy);
        EXPECT_EQ(read_level(hierarchy, 0).raised_count, 0u);
        const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
        EXPECT_EQ(solution.status, HMF_OK) << solution.error.message;
        expect_foliation(read_level(hierarchy, 0), solution.foliation);
        // The library finds its loops on a hierarchy of its own, with the same lengths.
        hmf_hierarchy_options other = mollified(margin);
        other.ratio = 0.3;
        const Hierarchy coarser(mesh, other);
        ASSERT_TRUE(coarser);
        const Loops loops = library_loops(hierarchy, 0), same = library_loops(coarser, 0);
        EXPECT_EQ(same.elements, loops.elements);
        EXPECT_EQ(same.offsets, loops.offsets);
    }
}

// All lengths get the same addition: on equilateral triangles nothing changes,
// and the margin of the others is what was asked for.
TEST(Mollify, AddsWhatIsMissing) {
    const TriMesh mesh = with_bad_triangles(torus(24, 12, 3, 1), 20, 1e-3, 5);
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    const hmf::Mesh& input = hierarchy.get()->input;
    const double* position = hierarchy.get()->levels[0].position;
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Metric plain, thick;
    hmf::Call call(memory, nullptr, nullptr, nullptr);
    ASSERT_TRUE(hmf::measure(input, position, nullptr, plain, nullptr, call));
    ASSERT_TRUE(hmf::measure(input, position, nullptr, thick, nullptr, call));
    ASSERT_TRUE(hmf::mollify(input, 0.01, thick, nullptr, call));
    double mean = 0, margin = HUGE_VAL;
    for (uint32_t e = 0; e < input.edge_count; ++e) mean += plain.length[e] / input.edge_count;
    for (uint32_t h = 0; h < 2 * input.edge_count; ++h)
        margin = std::min(margin, thick.length[hmf::edge_of(input.next[h])] + thick.length[hmf::edge_of(input.prev(h))]
                                      - thick.length[hmf::edge_of(h)]);
    EXPECT_NEAR(margin, 0.01 * mean, 1e-12 * mean);
    const double added = thick.length[0] - plain.length[0];
    EXPECT_GT(added, 0);
    for (uint32_t e = 0; e < input.edge_count; ++e) EXPECT_NEAR(thick.length[e] - plain.length[e], added, 1e-14);
    for (uint32_t f = 0; f < input.face_count; ++f) EXPECT_GT(thick.four_areas[f], 0);
}

TEST(Mollify, LeavesGoodMeshesAlone) {
    const TriMesh mesh = torus(24, 12, 3, 1);
    const Hierarchy plain(mesh), mollify(mesh, mollified(1e-3));
    ASSERT_TRUE(plain && mollify);
    const Solution a = solve(plain, nullptr, solve_options(HMF_METHOD_NEWTON, 0)),
                   b = solve(mollify, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
    EXPECT_EQ(a.values, b.values);
}

// As documented (docs/mathematics.md, section 7): the weights of level 0 lie between 1e-9 and 1e6.
TEST(Mollify, WeightsAreKeptWithinBounds) {
    hmf::Mesh mesh{};
    mesh.edge_count = 4;
    double weight[] = {0, 1, 2e6, 4e6}; // sums of two cotangents
    EXPECT_EQ(hmf::clamp_weights(mesh, hmf::INTRINSIC_WEIGHTS, weight), 0u);
    const double expected[] = {1e-9, 0.5, 1e6, 1e6};
    for (size_t e = 0; e < 4; ++e) EXPECT_EQ(weight[e], expected[e]) << e;
}

TEST(Mollify, Range) {
    const TriMesh mesh = torus(12, 8, 3, 1);
    for (const double bad : {-1e-9, 0.2, HUGE_VAL, std::nan("")})
        EXPECT_EQ(build_status(mesh, mollified(bad)), HMF_ERROR_OPTIONS);
    EXPECT_EQ(build_status(mesh, mollified(0.1)), HMF_OK);
    TriMesh point = mesh;
    std::fill(point.positions.begin(), point.positions.end(), 1.0);
    EXPECT_EQ(build_status(point, mollified(1e-5)), HMF_ERROR_MESH_DEGENERATE);
}

} // namespace test_intrinsic
