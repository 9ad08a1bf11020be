// Lengths of classes: what several strips of one class tell of its closed geodesics.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "src/core/hierarchy/caller_numbers.hpp"
#include "src/applications/loops/class_lengths.hpp"
#include "src/applications/loops/library_loops.hpp"

namespace test_class_lengths {

using namespace test;

namespace {

constexpr size_t COLUMNS = 60;
const double PI = std::acos(-1.0);

// A torus whose tube is 1 thick but at two necks, .5 in column 0 and .75 in column 30: two closed geodesics around it.
TriMesh with_two_necks() {
    const size_t m = 24;
    TriMesh mesh = torus(COLUMNS, m, 3, 1);
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        const double angle = 2 * PI * static_cast<double>(v / m) / COLUMNS;
        const double middle[3] = {3 * std::cos(angle), 3 * std::sin(angle), 0};
        const double thick =
            1 - 0.5 * std::exp(-9 * (1 - std::cos(angle))) - 0.25 * std::exp(-9 * (1 + std::cos(angle)));
        for (size_t a = 0; a < 3; ++a)
            mesh.positions[3 * v + a] = middle[a] + thick * (mesh.positions[3 * v + a] - middle[a]);
    }
    return mesh;
}

class Strips {
public:
    explicit Strips(size_t level) : hierarchy_(with_two_necks(), 0.5, 300), level_(level) {}

    hmf::ClassLengths lengths() { return hmf::ClassLengths(*hierarchy_.get(), level_, call_); }
    // Around the tube between two columns.
    uint32_t add(hmf::ClassLengths& lengths, size_t column) {
        const hmf_hierarchy& h = *hierarchy_.get();
        const double angle = 2 * PI * (static_cast<double>(column) + 0.5) / COLUMNS;
        const double x = std::cos(angle), y = std::sin(angle);
        std::vector<uint32_t> faces = section(
            read_level(hierarchy_, level_), [=](const double* p) { return x * p[1] - y * p[0]; },
            [=](const double* p) { return x * p[0] + y * p[1]; });
        if (level_ == 0)
            for (uint32_t& f : faces) f = hmf::internal_face(h, f);
        const uint64_t offsets[] = {0, faces.size()};
        hmf::Loops read;
        EXPECT_EQ(hmf::read_loops(hmf::loop_mesh(h, level_), HMF_PATH_TRIANGLES, 1, offsets, faces.data(), call_, read),
                  HMF_OK)
            << error_.message;
        uint32_t id = 0;
        EXPECT_TRUE(lengths.add(read.loop(0), read.length(0), id));
        return id;
    }

private:
    Hierarchy hierarchy_;
    size_t level_;
    hmf::Memory memory_{nullptr, nullptr, nullptr, 0};
    hmf_error error_{};
    hmf::Call call_{memory_, &error_, nullptr, nullptr};
};

// In the largest coordinate, 4; lengths are tilted by at most 1 %.
double round_neck(double radius) { return 2 * PI * radius / 4; }

const size_t NEAR_THE_WIDE_NECK[] = {27, 31, 28, 30, 29, 32};

} // namespace

// However many longer ones came before, and whether their length has been measured on a finer level or not.
TEST(ClassLengths, ShorterStripIsPulledToAnotherGeodesic) {
    for (const size_t level : {0, 1})
        for (const bool measured : {false, true}) {
            Strips strips(level);
            hmf::ClassLengths lengths = strips.lengths();
            uint32_t id = 0;
            bool changed = false;
            for (const size_t column : NEAR_THE_WIDE_NECK) id = strips.add(lengths, column);
            EXPECT_NEAR(lengths.length(id), round_neck(0.75), 0.04 * round_neck(0.75));
            if (measured) {
                lengths.want(id);
                ASSERT_TRUE(lengths.measure(changed));
                EXPECT_EQ(changed, level > 0);
                EXPECT_NEAR(lengths.length(id), round_neck(0.75), 0.02 * round_neck(0.75));
            }
            EXPECT_EQ(strips.add(lengths, 0), id);
            lengths.want(id);
            ASSERT_TRUE(lengths.measure(changed));
            EXPECT_EQ(changed, level > 0) << measured;
            EXPECT_NEAR(lengths.length(id), round_neck(0.5), 0.02 * round_neck(0.5)) << level << " " << measured;
        }
}

} // namespace test_class_lengths
