// v along the leaves, by which the columns of quads are placed.
#include "src/applications/api/application_entry.hpp"
#include "src/applications/quads/quad_rulers.hpp"
#include "support/meshes.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace test_quad_columns {

namespace {

// A torus whose triangles are sheared by some columns: angles near 0 and 180 degrees.
test::TriMesh sheared_torus(uint32_t n, uint32_t m, uint32_t shear) {
    test::TriMesh mesh = test::torus(n, m, 2, 1, {true, 1, 0.2, 5});
    mesh.triangles.clear();
    const auto at = [&](uint32_t i, uint32_t j) { return i % n * m + j % m; };
    for (uint32_t i = 0; i < n; ++i)
        for (uint32_t j = 0; j < m; ++j)
            for (const uint32_t v : {at(i, j), at(i + 1, j + shear), at(i + 1, j + shear + 1), at(i, j),
                                     at(i + 1, j + shear + 1), at(i, j + 1)})
                mesh.triangles.push_back(v);
    return mesh;
}

} // namespace

// By Riemann's bilinear relation all closed leaves of a cylinder are equally long in v: its area by its height.  A
// torus has one cylinder, and no zero that is moved.
TEST(QuadColumns, LeavesOfACylinderAreEquallyLong) {
    for (const uint32_t shear : {0, 3, 7}) {
        const test::SolvedSurface surface(sheared_torus(24, 16, shear), {});
        ASSERT_TRUE(surface.solution.foliation);
        hmf::Memory memory(nullptr, nullptr, nullptr, 0);
        hmf::Call call(memory, nullptr, nullptr, nullptr);
        hmf::Leaves leaves;
        hmf::State solved;
        hmf::FlatConeMetric flat;
        ASSERT_EQ(leaves.load(*surface.solution.foliation, call), HMF_OK);
        ASSERT_EQ(hmf::load_solved_in_unit_of_values(*surface.solution.foliation, solved, call), HMF_OK);
        ASSERT_EQ(hmf::flat_cone_metric(solved, hmf::HARMONIC_TOLERANCE, flat, call), HMF_OK);
        const hmf::Foliation& f = leaves.state.foliation;
        const hmf::Conjugate conjugate(f, flat, 1);
        ASSERT_EQ(leaves.cylinders.list.size(), 1u);
        const int64_t height = leaves.cylinders.list[0].height;
        const double energy = surface.solution.foliation->report.energy, unit = surface.solution.foliation->unit;
        const double length = energy / (unit * unit) / static_cast<double>(height);
        for (int64_t k = 1; k < 20; ++k) {
            hmf::Array<hmf::Crossing> leaf;
            leaf.start(memory);
            ASSERT_TRUE(hmf::closed_leaf(f, hmf::leaf_at(f, leaves.cylinders, 0, 2 * height * k / 20 | 1),
                                         leaves.cylinders.graph.crossing_limit(), leaf));
            double v = 0;
            for (const hmf::Crossing& c : leaf) v += conjugate.step(c);
            EXPECT_NEAR(v / length, 1, 1e-5) << shear << " " << k;
        }
    }
}

} // namespace test_quad_columns
