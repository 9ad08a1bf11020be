// (u, v) of the smallest and the coarsest surfaces, where narrow parts are rings of edges and bands of triangles with
// value 0.
#include "support/map_judge.hpp"
#include "support/sample.hpp"
#include "support/surface.hpp"
#include "support/tubes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_coarse_maps {

using namespace test;

namespace {

Solution solved(const Hierarchy& hierarchy) {
    const auto set = loops_of(hierarchy, HMF_LOOPS_CUT);
    return solve(hierarchy, *set);
}

// A torus with one handle more, of three sides.
TriMesh with_handle(uint64_t seed) {
    Random random(seed);
    const TubeOptions options = random_tube(random);
    TriMesh mesh = closed_tube(options);
    const size_t rings = 1 + random.below(5);
    const double waist = std::exp(-4 * random.unit());
    EXPECT_TRUE(add_handle(mesh, rings, waist, random));
    EXPECT_EQ(mesh_defect(mesh), "");
    return mesh;
}

Owned<hmf_parameterization> map_of(const Solution& s) {
    return make<hmf_parameterization>([&](hmf_parameterization** out, hmf_error* error) {
        return hmf_parameterize(s.foliation.get(), nullptr, nullptr, out, error);
    });
}

} // namespace

// On a torus u has no zeros: |du| is the foliation on every edge, and the area of the image is the energy.
TEST(CoarseMaps, TorusOfNineVertices) {
    for (uint64_t seed = 0; seed < 50; ++seed) {
        SCOPED_TRACE(seed);
        TubeOptions options;
        options.variation = 1;
        options.seed = seed;
        const Hierarchy hierarchy(closed_tube(options));
        ASSERT_TRUE(hierarchy);
        const Solution s = solved(hierarchy);
        ASSERT_EQ(s.status, HMF_OK) << s.error.message;
        const auto map = map_of(s);
        ASSERT_TRUE(map);
        const LevelMesh mesh = read_level(hierarchy, 0);
        for (size_t t = 0; t < mesh.triangle_count; ++t)
            for (size_t c = 0; c < 3; ++c) {
                const double* const uv = map->corner_uv + 6 * t;
                EXPECT_NEAR(std::fabs(uv[2 * c] - uv[2 * ((c + 1) % 3)]), s.values[mesh.triangle_edges[3 * t + c]],
                            1e-7);
            }
        EXPECT_NEAR(map->area, s.report.energy, 1e-6 * s.report.energy);
    }
}

// Zeros in narrow parts: none goes to the far end of the surface, none shares a vertex with another one, and du stays
// closed. All weights are 1, so the heights of the zeros differ by whole numbers.
TEST(CoarseMaps, SmallHandles) {
    for (uint64_t seed = 0; seed < sample<uint64_t>(150, 30); ++seed) {
        SCOPED_TRACE(seed);
        const Hierarchy hierarchy(with_handle(seed));
        ASSERT_TRUE(hierarchy);
        Loops loops = library_loops(hierarchy, 0, seed % 2 ? HMF_LOOPS_PANTS : HMF_LOOPS_CUT);
        loops.weights.assign(loops.count(), 1);
        const Solution s = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 1e-8));
        ASSERT_EQ(s.status, HMF_OK) << s.error.message;
        const auto map = map_of(s);
        ASSERT_TRUE(map);
        const LevelMesh mesh = read_level(hierarchy, 0);
        const MapJudgment judged = judge_map(mesh, s.foliation, loops, *map);
        EXPECT_EQ(judged.defect, "");
        EXPECT_EQ(judged.turns, -4);
        EXPECT_LT(judged.off_lattice, 1e-5);
        EXPECT_NEAR(judged.area, map->area, 1e-9 * map->area);
        EXPECT_GT(judged.area, 0.95 * s.report.energy);
        EXPECT_LT(judged.area, 1.2 * s.report.energy);
    }
}

} // namespace test_coarse_maps
