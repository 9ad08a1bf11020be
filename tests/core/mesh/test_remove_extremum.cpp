// An extremum moves to its second direction, on a torus whose values are differences of a height.  There the cluster is
// what is connected above a level, and the level sinks until something beside the cluster is higher.
#include <gtest/gtest.h>

#include <cstdlib>
#include <vector>

#include "src/core/foliation/foliation.hpp"
#include "support/make_mesh.hpp"
#include "support/meshes.hpp"

namespace test_remove_extremum {

using namespace hmf;

namespace {

constexpr uint32_t around = 12;
constexpr int64_t step = 10000, period = step * around;

struct Heights {
    test::MadeMesh made;
    Memory memory{nullptr, nullptr, nullptr, 0};
    Foliation f;
    std::vector<int64_t> height, value;

    explicit Heights(uint32_t along) : made(test::torus_triangles(around, along)) {
        f.mesh = made.mesh();
        for (uint32_t v = 0; v < f.mesh.vertex_count; ++v) height.push_back(step * (v / along));
        EXPECT_TRUE(f.allocate_scratch(f.mesh.vertex_count, memory));
    }
    // From the start of h to its end.
    int64_t rise(uint32_t h) const {
        const int64_t d = height[f.mesh.target(h)] - height[f.mesh.origin[h]];
        return d > period / 2 ? d - period : d < -period / 2 ? d + period : d;
    }
    std::vector<int64_t> values() const {
        std::vector<int64_t> all(f.mesh.edge_count);
        for (uint32_t e = 0; e < f.mesh.edge_count; ++e) all[e] = std::llabs(rise(2 * e));
        return all;
    }
    void set() {
        value = values();
        f.value = value.data();
    }

    // Levels the vertices that are connected to v at its height or above, until one beside them is higher.
    void level_by_heights(uint32_t v, int64_t side) {
        std::vector<uint32_t> part = {v};
        std::vector<char> inside(f.mesh.vertex_count, 0);
        inside[v] = 1;
        for (;;) {
            int64_t nearest = INT64_MAX;
            for (size_t i = 0; i < part.size(); ++i)
                for (const uint32_t h : f.mesh.around(part[i])) {
                    const uint32_t w = f.mesh.target(h);
                    if (inside[w]) continue;
                    if (rise(h) == 0) {
                        inside[w] = 1;
                        part.push_back(w);
                    }
                }
            for (const uint32_t u : part)
                for (const uint32_t h : f.mesh.around(u))
                    if (!inside[f.mesh.target(h)]) nearest = std::min(nearest, -side * rise(h));
            if (nearest < 0) return;
            for (const uint32_t u : part) height[u] -= side * nearest;
        }
    }
};

} // namespace

TEST(RemoveExtremum, LevelsWhatIsHigher) {
    test::Random random(5);
    size_t joined = 0, removed = 0;
    for (uint32_t round = 0; round < 60; ++round) {
        Heights heights(8 + round % 5);
        Foliation& f = heights.f;
        const int64_t roughness = round % 3 == 0 ? 3 : 2000, side = round % 2 ? 1 : -1; // many are equal, or none
        for (int64_t& x : heights.height) x += static_cast<int64_t>(random.unit() * static_cast<double>(roughness));
        const uint32_t v = static_cast<uint32_t>(heights.height.size() / 2) + round % 7;
        for (const uint32_t h : f.mesh.around(v)) // the slope of the hill
            heights.height[f.mesh.target(h)] += side * static_cast<int64_t>((1 + 0.8 * random.unit()) * step);
        heights.height[v] += 35 * side * step / 10;
        heights.set();
        if (!explore_cluster(f, v, ClusterSearch().up_to_corners(2)).is_pole()) continue;
        ASSERT_TRUE(remove_extremum(f, v)) << round;
        ++removed;
        EXPECT_FALSE(explore_cluster(f, v).is_pole());
        joined += f.members.size() - 1;
        heights.level_by_heights(v, side);
        EXPECT_EQ(heights.value, heights.values()) << round;
    }
    EXPECT_GT(removed, 40u);
    EXPECT_GT(joined, 2 * removed);
}

// A ridge that falls by a unit from vertex to vertex: each joins at a distance of its own.
TEST(RemoveExtremum, WorkIsLinearInTheVerticesThatJoin) {
    const auto work = [](uint32_t along) {
        Heights heights(along);
        Foliation& f = heights.f;
        const uint32_t first = 6 * along, length = along / 2;
        for (uint32_t k = 0; k < length; ++k) heights.height[first + k] += 3 * step / 2 - k;
        heights.set();
        f.take_walked();
        EXPECT_TRUE(remove_extremum(f, first));
        EXPECT_GE(f.members.size(), length);
        return f.take_walked();
    };
    EXPECT_LT(work(2000), 5 * work(500));
}

} // namespace test_remove_extremum
