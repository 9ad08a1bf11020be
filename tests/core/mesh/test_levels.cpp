// The hierarchy as the interface shows it: numbering, counts, weights,
// positions, ratio, memory.
#include "support/extreme_surfaces.hpp"
#include "support/watched_host.hpp"
#include "support/surface.hpp"
#include "support/tubes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>

namespace test_levels {

using namespace test;

namespace {

std::vector<std::pair<const char*, TriMesh>> sample_meshes() {
    TorusOptions wild;
    wild.random_diagonals = true;
    wild.jitter = 0.5;
    wild.stretch = 5;
    return {{"torus", torus(60, 24, 2, 1)},
            {"wild torus", torus(60, 24, 2, 1, wild)},
            {"pretzel", pretzel(2, 3)},
            {"thin plate", subdivide(subdivide(subdivide(thin_plate(3, 100))))},
            {"bad triangles", with_bad_triangles(pretzel(2, 3), 200, 0.01, 5)},
            {"finger", torus_with_finger(40, 20, 60, 10)}};
}

double cotangent(const double* apex, const double* a, const double* b) {
    double u[3], v[3], n[3];
    for (int x = 0; x < 3; ++x) u[x] = a[x] - apex[x], v[x] = b[x] - apex[x];
    for (int x = 0; x < 3; ++x) n[x] = u[(x + 1) % 3] * v[(x + 2) % 3] - u[(x + 2) % 3] * v[(x + 1) % 3];
    return (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

} // namespace

TEST(Levels, MakersMakeWhatTheyPromise) {
    EXPECT_EQ(mesh_defect(torus(3, 3, 2, 1)), "");
    EXPECT_EQ(mesh_defect(trefoil(60, 6, 0.3)), "");
    EXPECT_EQ(mesh_defect(joined_tori(16, 8, 8, 5)), "");
    for (size_t genus = 1; genus <= 20; ++genus) EXPECT_EQ(mesh_defect(pretzel(genus, 1)), "") << genus;
    for (const auto& sample : sample_meshes()) EXPECT_EQ(mesh_defect(sample.second), "") << sample.first;
    EXPECT_EQ(mesh_defect(with_random_flips(subdivide(subdivide(plate(2))), 3000, 1 - 1e-12, 1)), "");
    // The check itself can fail.
    TriMesh wrong = torus(6, 6, 2, 1);
    wrong.genus = 2;
    EXPECT_NE(mesh_defect(wrong), "");
    wrong = torus(6, 6, 2, 1);
    wrong.triangles.resize(wrong.triangles.size() - 3);
    EXPECT_NE(mesh_defect(wrong), "");
}

TEST(Levels, EachIsAClosedSurfaceOfTheSameGenus) {
    for (const auto& sample : sample_meshes()) {
        SCOPED_TRACE(sample.first);
        const Hierarchy hierarchy(sample.second, 0.5, 300);
        ASSERT_TRUE(hierarchy);
        ASSERT_GE(hierarchy.levels(), 2u);
        for (size_t level = 0; level < hierarchy.levels(); ++level) {
            SCOPED_TRACE(level);
            const LevelMesh mesh = read_level(hierarchy, level);
            const long chi = static_cast<long>(mesh.vertex_count) - static_cast<long>(mesh.edge_count)
                           + static_cast<long>(mesh.triangle_count);
            EXPECT_EQ(chi, 2 - 2 * static_cast<long>(sample.second.genus));
            EXPECT_EQ(3 * mesh.triangle_count, 2 * mesh.edge_count);
            // Each side joins its two corners; each edge has two sides, once in each direction.
            std::vector<int> forward(mesh.edge_count, 0), count(mesh.edge_count, 0);
            std::vector<int> touched(mesh.vertex_count, 0);
            for (size_t t = 0; t < mesh.triangle_count; ++t)
                for (size_t s = 0; s < 3; ++s) {
                    const uint32_t e = mesh.triangle_edges[3 * t + s], a = mesh.triangle_vertices[3 * t + s],
                                   b = mesh.triangle_vertices[3 * t + (s + 1) % 3];
                    ASSERT_LT(e, mesh.edge_count);
                    ASSERT_LT(a, mesh.vertex_count);
                    const uint32_t u = mesh.edge_vertices[2 * e], v = mesh.edge_vertices[2 * e + 1];
                    ASSERT_TRUE((a == u && b == v) || (a == v && b == u));
                    ++count[e];
                    forward[e] += a == u && b == v;
                    touched[a] = 1;
                }
            for (size_t e = 0; e < mesh.edge_count; ++e) {
                ASSERT_EQ(count[e], 2);
                if (mesh.edge_vertices[2 * e] != mesh.edge_vertices[2 * e + 1]) { ASSERT_EQ(forward[e], 1); }
            }
            for (int hit : touched) ASSERT_EQ(hit, 1);
            for (double x : mesh.positions) ASSERT_TRUE(std::isfinite(x));
            for (double w : mesh.weights) {
                ASSERT_TRUE(std::isfinite(w));
                if (level > 0) { ASSERT_GT(w, 0); }
            }
        }
        EXPECT_EQ(read_level(hierarchy, 0).raised_count, 0u);
    }
}

TEST(Levels, LevelZeroIsTheMeshOfTheCaller) {
    for (const auto& sample : sample_meshes()) {
        SCOPED_TRACE(sample.first);
        const Hierarchy hierarchy(sample.second);
        ASSERT_TRUE(hierarchy);
        const LevelMesh mesh = read_level(hierarchy, 0);
        EXPECT_EQ(mesh.triangle_vertices, sample.second.triangles);
        EXPECT_EQ(mesh.positions, sample.second.positions);
        // Edges by first appearance.
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> number;
        std::vector<double> weights;
        for (size_t t = 0; t < sample.second.triangle_count(); ++t)
            for (size_t s = 0; s < 3; ++s) {
                const uint32_t a = sample.second.triangles[3 * t + s], b = sample.second.triangles[3 * t + (s + 1) % 3],
                               c = sample.second.triangles[3 * t + (s + 2) % 3];
                const auto name = std::minmax(a, b);
                const auto added = number.emplace(name, static_cast<uint32_t>(number.size()));
                const uint32_t e = added.first->second;
                ASSERT_EQ(mesh.triangle_edges[3 * t + s], e);
                if (added.second) {
                    ASSERT_EQ(mesh.edge_vertices[2 * e], a);
                    ASSERT_EQ(mesh.edge_vertices[2 * e + 1], b);
                    weights.push_back(0);
                }
                const double* x = sample.second.positions.data();
                weights[e] += 0.5 * cotangent(x + 3 * c, x + 3 * a, x + 3 * b);
            }
        ASSERT_EQ(number.size(), mesh.edge_count);
        for (size_t e = 0; e < mesh.edge_count; ++e)
            ASSERT_NEAR(mesh.weights[e], weights[e], 1e-6 * (1 + std::abs(weights[e]))) << e;
    }
}

// Half the sum of the two opposite cotangents, between the bounds; raised are those that were negative.
TEST(Levels, WeightsOfCoarseLevels) {
    size_t free = 0, raised = 0;
    for (const auto& sample : sample_meshes()) {
        SCOPED_TRACE(sample.first);
        const Hierarchy hierarchy(sample.second, 0.5, 300);
        ASSERT_TRUE(hierarchy);
        for (size_t level = 1; level < hierarchy.levels(); ++level) {
            const LevelMesh mesh = read_level(hierarchy, level);
            std::vector<double> expected(mesh.edge_count, 0);
            for (size_t c = 0; c < mesh.triangle_edges.size(); ++c) {
                const auto corner = [&](size_t s) {
                    return &mesh.positions[3 * mesh.triangle_vertices[c - c % 3 + (c % 3 + s) % 3]];
                };
                expected[mesh.triangle_edges[c]] += 0.5 * cotangent(corner(2), corner(0), corner(1));
            }
            size_t negative = 0, near = 0; // right angles round to either side
            for (size_t e = 0; e < mesh.edge_count; ++e) {
                negative += expected[e] < -1e-9;
                near += std::abs(expected[e]) <= 1e-9;
                const double bounded = std::min(std::max(expected[e], 1e-3), 1e3);
                free += bounded == expected[e];
                ASSERT_NEAR(mesh.weights[e], bounded, 1e-6 * (1 + std::abs(expected[e]))) << e;
            }
            EXPECT_GE(mesh.raised_count, negative);
            EXPECT_LE(mesh.raised_count, negative + near);
            raised += negative;
        }
    }
    EXPECT_GT(free, 1000u);
    EXPECT_GT(raised, 0u);
}

TEST(Levels, RatioAndCoarsestAreKept) {
    const TriMesh mesh = pretzel(2, 3);
    for (const double ratio : {0.25, 0.5, 0.75})
        for (const uint64_t coarsest : {200, 800})
            for (const int32_t collapse : {HMF_COLLAPSE_MIDPOINT, HMF_COLLAPSE_ENDPOINT, HMF_COLLAPSE_QSLIM}) {
                SCOPED_TRACE(testing::Message() << ratio << " " << coarsest << " " << collapse);
                const Hierarchy hierarchy(mesh, ratio, coarsest, collapse);
                ASSERT_TRUE(hierarchy);
                ASSERT_GE(hierarchy.levels(), 2u);
                for (size_t level = 1; level < hierarchy.levels(); ++level) {
                    const double found =
                        static_cast<double>(hierarchy.edges(level)) / static_cast<double>(hierarchy.edges(level - 1));
                    EXPECT_LT(found, 1);
                    if (level + 1 < hierarchy.levels()) {
                        EXPECT_NEAR(found, ratio, 0.02);
                    } else {
                        EXPECT_GT(found, ratio - 0.02);
                    }
                }
                const LevelMesh last = read_level(hierarchy, hierarchy.coarsest());
                EXPECT_LE(last.vertex_count, coarsest + coarsest / 10 + 10);
                EXPECT_GE(last.vertex_count, coarsest - coarsest / 10 - 10);
            }
}

TEST(Levels, SmallMeshIsOneLevel) {
    const Hierarchy hierarchy(torus(8, 6, 2, 1));
    ASSERT_TRUE(hierarchy);
    EXPECT_EQ(hierarchy.levels(), 1u);
}

TEST(Levels, PositionStride) {
    const TriMesh mesh = torus(30, 12, 2, 1);
    std::vector<double> wide(5 * mesh.vertex_count(), NAN);
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        std::memcpy(&wide[5 * v], &mesh.positions[3 * v], 3 * sizeof(double));
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    options.position_stride = 5 * sizeof(double);
    hmf_hierarchy* hierarchy = nullptr;
    ASSERT_EQ(hmf_hierarchy_create(wide.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                                   &options, nullptr, &hierarchy, nullptr),
              HMF_OK);
    const auto level =
        make<hmf_level_mesh>([&](auto out, hmf_error* error) { return hmf_level(hierarchy, 0, nullptr, out, error); });
    EXPECT_EQ(std::vector<double>(level->positions, level->positions + 3 * level->vertex_count), mesh.positions);
    hmf_hierarchy_destroy(hierarchy);
}

TEST(Levels, BuildIsDeterministicAndFreeOfUnits) {
    const TriMesh mesh = pretzel(2, 3);
    const Hierarchy first(mesh), second(mesh), large(scaled(mesh, 1024)), small(scaled(mesh, 1.0 / 4096));
    ASSERT_TRUE(first && second && large && small);
    ASSERT_EQ(first.levels(), second.levels());
    ASSERT_EQ(first.levels(), large.levels());
    ASSERT_EQ(first.levels(), small.levels());
    for (size_t level = 0; level < first.levels(); ++level) {
        const LevelMesh a = read_level(first, level), b = read_level(second, level), c = read_level(large, level),
                        d = read_level(small, level);
        EXPECT_EQ(a.positions, b.positions);
        for (const LevelMesh* other : {&b, &c, &d}) {
            EXPECT_EQ(a.triangle_edges, other->triangle_edges);
            EXPECT_EQ(a.weights, other->weights);
        }
    }
}

TEST(Levels, MemoryIsWhatTheAllocatorSaw) {
    for (const auto& sample : sample_meshes()) {
        SCOPED_TRACE(sample.first);
        WatchedHost watched;
        const hmf_hierarchy_options options = watched.options(0);
        {
            const Hierarchy hierarchy(sample.second, options);
            ASSERT_TRUE(hierarchy);
            EXPECT_EQ(hmf_hierarchy_describe(hierarchy.get())->memory_bytes, watched.used);
            EXPECT_LE(watched.peak, hmf_hierarchy_memory_estimate(sample.second.vertex_count(),
                                                                  sample.second.triangle_count(), &options));
        }
        EXPECT_EQ(watched.used, 0u);
    }
}

TEST(Levels, MemoryEstimateOfExtremeSurfaces) {
    struct Case {
        const char* name;
        TriMesh mesh;
        bool all_marked = false;
    };
    std::vector<Case> cases = {{"walls", walled_ring(1000, Strips::fans)},
                               {"rings", flat_ring(1024, Strips::fans)},
                               {"ladders on walls", walled_ring(1000, Strips::ladder)},
                               {"ladders on rings", flat_ring(1024, Strips::ladder)},
                               {"wheels", wheels(4000, 8)},
                               {"raised wheels", wheels(4000, 8, 0.1)},
                               {"valence 100 000", wheels(100000, 1)},
                               {"polygon", fan_polygon(2000)},
                               {"every vertex marked", torus(60, 40, 3, 1), true},
                               {"genus 64", plate(64)},
                               {"thin plate", thin_plate(20, 1e-3)}};
    Random random(5);
    for (int i = 0; i < 20; ++i) cases.push_back({"tube", closed_tube(random_tube(random))});
    for (const Case& at : cases) {
        SCOPED_TRACE(at.name);
        std::vector<uint32_t> marks;
        for (uint32_t v = 0; at.all_marked && v < at.mesh.vertex_count(); ++v) marks.push_back(v);
        const size_t n = at.mesh.vertex_count();
        if (at.name == std::string("polygon")) marks = {0, uint32_t(n / 4), uint32_t(n / 2), uint32_t(3 * n / 4)};
        const size_t times = at.name == std::string("polygon") ? 2 : 1; // its double is built
        WatchedHost watched;
        hmf_hierarchy_options options = watched.options(0);
        options.marked_vertices = marks.data();
        options.marked_count = marks.size();
        const Hierarchy hierarchy(at.mesh, options);
        ASSERT_TRUE(hierarchy);
        const uint64_t estimate = hmf_hierarchy_memory_estimate(times * n, times * at.mesh.triangle_count(), &options);
        EXPECT_LE(watched.peak, estimate) << n << " vertices";
    }
}

TEST(Levels, NothingForNull) {
    EXPECT_EQ(hmf_hierarchy_describe(nullptr), nullptr);
    EXPECT_EQ(hmf_hierarchy_memory_estimate(0, 0, nullptr), 0u);
    EXPECT_EQ(hmf_hierarchy_memory_estimate(SIZE_MAX, SIZE_MAX, nullptr), 0u);
    // Of a mesh that numbers of 32 bits can hold.
    const size_t most = 0x7fffffff / 3;
    EXPECT_GT(hmf_hierarchy_memory_estimate(most / 2, most, nullptr), 0u);
    EXPECT_GT(hmf_hierarchy_memory_estimate(most, most, nullptr), 0u);
    EXPECT_EQ(hmf_hierarchy_memory_estimate(most + 1, most, nullptr), 0u);
    EXPECT_EQ(hmf_hierarchy_memory_estimate(most, most + 1, nullptr), 0u);
    EXPECT_EQ(hmf_hierarchy_memory_estimate(1, 0, nullptr), 0u);
    EXPECT_EQ(hmf_hierarchy_memory_estimate(0, 1, nullptr), 0u);
}

TEST(Levels, VersionAndTexts) {
    EXPECT_EQ(hmf_version(),
              static_cast<uint32_t>(HMF_VERSION_MAJOR * 10000 + HMF_VERSION_MINOR * 100 + HMF_VERSION_PATCH));
    for (hmf_status status = -5; status < 1000; ++status) {
        const char* text = hmf_status_string(status);
        ASSERT_NE(text, nullptr);
        EXPECT_GT(std::strlen(text), 0u);
    }
    EXPECT_STRNE(hmf_status_string(HMF_ERROR_MESH_BOUNDARY), hmf_status_string(HMF_ERROR_MESH_GENUS));
}

} // namespace test_levels
