// Overlaps of triangles in the plane, and what looking for them takes.
#include "src/applications/atlas/overlaps.hpp"
#include "support/make_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace test_overlaps {

// Needles along the diagonal, side by side: the box of each is nearly that of all, so that in cells as small as the
// triangles each would be in every cell. None overlaps; pushed together each second one does.
TEST(Overlaps, NeedlesTakeLittleMemory) {
    constexpr uint32_t COUNT = 1000;
    test::Triangles t; // each with a back, so that the mesh is closed
    for (uint32_t k = 0; k < COUNT; ++k) {
        const double at = 8 * k, far = 1 << 20;
        t.positions.insert(t.positions.end(), {at, 0, 0, at + 4, 0, 0, at + far, far, 0});
        t.triangles.insert(t.triangles.end(), {3 * k, 3 * k + 1, 3 * k + 2, 3 * k + 1, 3 * k, 3 * k + 2});
    }
    test::MadeMesh made(t);
    const hmf::Mesh mesh = made.mesh();
    hmf::Memory memory(nullptr, nullptr, nullptr, 1 << 20);
    hmf_error error{};
    hmf::Call call(memory, &error, nullptr, nullptr);
    hmf::Array<uint32_t> side;
    hmf::GridLayout layout;
    hmf::Array<uint8_t> bad;
    const size_t sides = 2 * size_t{mesh.edge_count};
    ASSERT_TRUE(side.allocate(memory, mesh.face_count) && layout.x.allocate(memory, sides)
                && layout.y.allocate(memory, sides) && layout.chart.allocate(memory, mesh.face_count));
    layout.chart_count = 1;
    for (const bool together : {false, true}) {
        for (uint32_t h = 0; h < sides; ++h) {
            const uint32_t v = mesh.origin[h];
            side[mesh.face[h]] = h;
            layout.x[h] = static_cast<int64_t>(made.positions[3 * v]) - (together && v / 3 % 2 ? 6 : 0);
            layout.y[h] = static_cast<int64_t>(made.positions[3 * v + 1]);
        }
        for (uint32_t f = 0; f < mesh.face_count; ++f) layout.chart[f] = f % 2 == 0 ? 0 : hmf::NONE;
        ASSERT_TRUE(hmf::find_overlaps(mesh, side, layout, 1, bad, call)) << error.message;
        EXPECT_EQ(std::count(bad.begin(), bad.end(), 1), together ? COUNT / 2 : 0);
    }
}

} // namespace test_overlaps
