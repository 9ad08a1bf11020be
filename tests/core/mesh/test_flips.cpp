// Flips of a foliation on meshes too small for the other tests.
#include <gtest/gtest.h>

#include "src/core/foliation/foliation.hpp"

namespace test_flips {

using namespace hmf;

// A torus of two vertices, of heights 0 and -far: edge 0 joins the first one to its copy at height 1, and all its other
// edges lead down. So a flip of edge 0 is "case 4", and the copy follows the vertex on its way down.
TEST(Flips, TheClusterLiesAheadOfItsOwnCopy) {
    for (const int64_t far : {int64_t{2}, int64_t{4}, int64_t{9}, int64_t{1} << 50}) {
        SCOPED_TRACE(far);
        uint32_t origin[12] = {0, 0, 1, 1, 0, 1, 0, 1, 1, 0, 1, 0}, next[12], face[12], out[2] = {0, 2};
        int64_t value[6] = {1, 1, far, far + 1, far, far - 1};
        Memory memory(nullptr, nullptr, nullptr, 0);
        Foliation f;
        f.mesh.vertex_count = 2;
        f.mesh.edge_count = 6;
        f.mesh.face_count = 4;
        f.mesh.origin = origin;
        f.mesh.next = next;
        f.mesh.face = face;
        f.mesh.out = out;
        f.mesh.set_triangle(0, 6, 5, 0);
        f.mesh.set_triangle(4, 3, 7, 1);
        f.mesh.set_triangle(2, 10, 9, 2);
        f.mesh.set_triangle(8, 1, 11, 3);
        f.value = value;
        ASSERT_TRUE(f.allocate_scratch(2, memory));
        ASSERT_EQ(count_singularities(f).poles, 0u);
        TransportStatistics statistics;
        flip_foliation(f, 0, false, statistics);
        const SingularityCount count = count_singularities(f);
        EXPECT_EQ(count.poles, 0u);
        EXPECT_EQ(count.broken_triangles, 0u);
        EXPECT_EQ(count.index_sum, 0);
        EXPECT_EQ(statistics.bad_flips, 1u);
    }
}

} // namespace test_flips
