// (u, v) of the smallest and the coarsest surfaces, where narrow parts are rings of edges and bands of triangles with
// value 0.
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

} // namespace test_coarse_maps
