// A task of a sweep: it looks only at the stars of the vertices inside of its block.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "src/core/foliation/whitehead.hpp"
#include "support/make_mesh.hpp"
#include "support/meshes.hpp"

namespace test_sweeps {

using namespace hmf;

namespace {

using Values = std::vector<int64_t>;
constexpr uint32_t around = 12, along = 16;

Values differences(const Mesh& mesh, const std::vector<int64_t>& height) {
    Values values(mesh.edge_count);
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const int64_t d = std::llabs(height[mesh.origin[2 * e]] - height[mesh.target(2 * e)]);
        values[e] = d > 50 * around ? std::llabs(100 * around - d) : d;
    }
    return values;
}

// Differences of a height on a torus that rises by 100 from column to column and by 0, 50 or 100 within one: no poles.
// Then vertices go down to a neighbor where that makes none: clusters of zero edges of any shape.
Values random_values(Foliation& f, test::Random& random) {
    const Mesh& mesh = f.mesh;
    std::vector<int64_t> height(mesh.vertex_count);
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) height[v] = 100 * (v / along) + 50 * int64_t(random.below(3));
    Values values = differences(mesh, height);
    for (int n = 0; n < 1500; ++n) {
        const uint32_t h = static_cast<uint32_t>(random.below(2 * mesh.edge_count)), v = mesh.origin[h];
        const int64_t before = height[v];
        if (before - height[mesh.target(h)] > 100 || height[mesh.target(h)] >= before) continue;
        height[v] = height[mesh.target(h)];
        Values changed = differences(mesh, height);
        f.value = changed.data();
        const SingularityCount count = count_singularities(f);
        if (count.poles == 0 && count.broken_triangles == 0) values.swap(changed);
        else height[v] = before;
    }
    return values;
}

// The vertices nearest to one, by edges: those are inside of block 0.
std::vector<uint32_t> ball(const Mesh& mesh, uint32_t center, size_t count) {
    std::vector<uint32_t> block(mesh.vertex_count, NONE), queue{center};
    block[center] = 0;
    for (size_t i = 0; i < queue.size(); ++i)
        for (const uint32_t h : mesh.around(queue[i])) {
            const uint32_t w = mesh.target(h);
            if (block[w] == 0 || queue.size() >= count) continue;
            block[w] = 0;
            queue.push_back(w);
        }
    return block;
}

// What a task did at a vertex; the values that it may see.
struct Outcome {
    bool moved = false, outside = false;
    double energy_change = 0;
    Values seen;
    bool operator==(const Outcome& other) const {
        return moved == other.moved && outside == other.outside && energy_change == other.energy_change
            && seen == other.seen;
    }
};

} // namespace

// The values beyond are exchanged for others: a task that reads them goes another way, and none are written.  Where a
// cluster goes on there the vertex waits as it is, or the task has no need to know how.
TEST(SweepTask, LooksNoFurtherThanItsBlock) {
    test::MadeMesh made(test::torus_triangles(around, along));
    test::Random random(5);
    Memory memory(nullptr, nullptr, nullptr, 0); // ends after what it gave
    Foliation whole;
    whole.mesh = made.mesh();
    const Mesh& mesh = whole.mesh;
    std::vector<double> weight(mesh.edge_count);
    for (double& w : weight) w = std::exp(4 * random.unit());
    Rings rings;
    Star star;
    ASSERT_TRUE(rings.build(mesh, weight.data(), memory) && star.allocate(memory, rings.max_degree)
                && whole.allocate_scratch(mesh.vertex_count, memory));
    std::vector<Values> drawn;
    while (drawn.size() < 50) drawn.push_back(random_values(whole, random));
    size_t moved = 0, waited = 0, with_others = 0;
    for (int n = 0; n < 20000; ++n) {
        const uint32_t v = static_cast<uint32_t>(random.below(mesh.vertex_count));
        const std::vector<uint32_t> block = ball(mesh, v, 1 + random.below(n % 2 ? 20 : 4));
        std::vector<uint8_t> seen(mesh.edge_count, 0); // in the stars of the block
        for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h)
            if (block[mesh.origin[h]] == 0) seen[edge_of(h)] = seen[edge_of(mesh.next[h])] = 1;
        const auto run = [&](const Values& before, const std::vector<uint32_t>& inside) {
            Outcome outcome;
            Foliation task;
            EXPECT_TRUE(task.share(whole, inside.data(), memory));
            Values after = before;
            task.value = after.data();
            task.epoch = whole.epoch;
            SweepResult result;
            outcome.moved = relax_vertex(task, rings, weight.data(), v, star, result);
            whole.epoch = task.epoch;
            outcome.outside = task.outside;
            outcome.energy_change = result.energy_change;
            if (!outcome.moved) { EXPECT_EQ(after, before); }
            with_others += outcome.moved && task.pushed.size() > 0;
            for (size_t e = 0; e < after.size(); ++e)
                if (seen[e]) outcome.seen.push_back(after[e]);
                else EXPECT_EQ(after[e], before[e]);
            return outcome;
        };
        const Values& one = drawn[random.below(drawn.size())];
        Values other = drawn[random.below(drawn.size())];
        for (size_t e = 0; e < other.size(); ++e)
            if (seen[e]) other[e] = one[e];
        const Outcome outcome = run(one, block);
        ASSERT_TRUE(outcome == run(other, block)) << "case " << n;
        moved += outcome.moved;
        waited += outcome.outside;
    }
    EXPECT_GT(moved, 1000u);
    EXPECT_GT(waited, 1000u);
    EXPECT_GT(with_others, 100u);
}

namespace {

// A torus whose height rises along the columns, but for the heights that are given.  The neighbors of vertex `base`
// that are higher pull at it.
struct Hill {
    static constexpr uint32_t columns = 200, rows = 8;
    test::MadeMesh made{test::torus_triangles(columns, rows)};
    Foliation f;
    Memory memory{nullptr, nullptr, nullptr, 0};
    Rings rings;
    Star star;
    Values values;
    std::vector<double> weight;
    static constexpr uint32_t at(uint32_t column, uint32_t row) { return column * rows + row; }
    static constexpr uint32_t base = 4 * rows + 3;

    explicit Hill(const std::map<uint32_t, int64_t>& given) {
        f.mesh = made.mesh();
        const Mesh& mesh = f.mesh;
        const auto height = [&](uint32_t v) -> int64_t {
            const auto found = given.find(v);
            return found != given.end() ? found->second : 100 * int64_t{v / rows} + 7 * int64_t{v % rows};
        };
        values.resize(mesh.edge_count);
        for (uint32_t e = 0; e < mesh.edge_count; ++e) {
            const int64_t d = std::llabs(height(mesh.origin[2 * e]) - height(mesh.target(2 * e)));
            values[e] = d > 50 * columns ? std::llabs(100 * columns - d) : d;
        }
        f.value = values.data();
        weight.assign(mesh.edge_count, 1);
        for (const uint32_t h : mesh.around(base)) // to those above it
            if (height(mesh.target(h)) > 400) weight[edge_of(h)] = 10;
        EXPECT_TRUE(rings.build(mesh, weight.data(), memory) && star.allocate(memory, rings.max_degree)
                    && f.allocate_scratch(mesh.vertex_count, memory));
        EXPECT_EQ(count_singularities(f).poles, 0u);
        EXPECT_EQ(count_singularities(f).broken_triangles, 0u);
    }
};

// Two rows of vertices hang on the base: all have its height, and all beside them are higher.
Hill with_limbs(uint32_t first, uint32_t second) {
    std::map<uint32_t, int64_t> height{{Hill::base, 400}};
    for (uint32_t i = 0; i < first; ++i) height[Hill::at(5 + i, 4)] = 400;
    for (uint32_t i = 0; i < second; ++i) height[Hill::at(4 + i, 2)] = 400;
    if (second > 0) height.insert({{Hill::at(3, 2), 440}, {Hill::at(3, 1), 450}, {Hill::at(4, 1), 470}});
    return Hill(height);
}

} // namespace

// What moves along has room for 64 in a task; more wait for the sweep over all, and nothing is done.
TEST(SweepTask, TakesNoMoreAlongThanItHasRoomFor) {
    using Two = std::pair<uint32_t, uint32_t>;
    for (const auto& [first, second] : {Two{1, 0}, Two{63, 0}, Two{64, 0}, Two{65, 0}, Two{90, 0}, Two{2, 3},
                                        Two{30, 34}, Two{34, 30}, Two{31, 34}, Two{34, 31}, Two{60, 60}}) {
        SCOPED_TRACE(testing::Message() << first << " and " << second);
        Hill whole = with_limbs(first, second), task = with_limbs(first, second);
        const std::vector<uint32_t> all(task.f.mesh.vertex_count, 0);
        Foliation shared;
        ASSERT_TRUE(shared.share(task.f, all.data(), task.memory));
        shared.epoch = task.f.epoch;
        SweepResult result;
        ASSERT_TRUE(relax_vertex(whole.f, whole.rings, whole.weight.data(), whole.base, whole.star, result));
        const Values before = task.values;
        const bool moved = relax_vertex(shared, task.rings, task.weight.data(), task.base, task.star, result);
        EXPECT_EQ(moved, first + second <= Foliation::MOST_INSIDE);
        EXPECT_EQ(shared.outside, !moved);
        EXPECT_EQ(task.values, moved ? whole.values : before);
    }
}

// The only way down from the base leads over a vertex beside it, of the same height.  A task cannot know that where the
// vertex is not inside of its block.
TEST(SweepTask, AsksNothingOfAVertexBeyond) {
    const std::map<uint32_t, int64_t> height{{Hill::base, 400},     {Hill::at(5, 4), 400}, {Hill::at(4, 2), 400},
                                             {Hill::at(3, 3), 421}, {Hill::at(3, 2), 410}, {Hill::at(4, 1), 310}};
    for (const bool inside : {false, true}) {
        SCOPED_TRACE(inside);
        Hill whole(height), task(height);
        std::vector<uint32_t> block(task.f.mesh.vertex_count, 0);
        block[Hill::at(4, 2)] = !inside;
        Foliation shared;
        ASSERT_TRUE(shared.share(task.f, block.data(), task.memory));
        shared.epoch = task.f.epoch;
        SweepResult result;
        EXPECT_TRUE(relax_vertex(whole.f, whole.rings, whole.weight.data(), whole.base, whole.star, result));
        const Values before = task.values;
        EXPECT_EQ(relax_vertex(shared, task.rings, task.weight.data(), task.base, task.star, result), inside);
        EXPECT_EQ(shared.outside, !inside);
        EXPECT_EQ(task.values, inside ? whole.values : before);
    }
}

// Of all moves, in one task or in several.
TEST(SweepResult, LargestIsOfAllMoves) {
    test::Random random(17);
    double largest = 0;
    SweepResult whole, sum;
    for (int part = 0; part < 9; ++part) {
        SweepResult task;
        for (int move = 0; move < 20; ++move) {
            const double pull = std::exp(6 * random.unit() - 3), excess = pull * random.unit();
            task.add_move(excess, pull);
            whole.add_move(excess, pull);
            largest = std::max(largest, excess / pull);
        }
        sum += task;
    }
    EXPECT_NEAR(whole.largest, largest, 1e-15);
    EXPECT_EQ(sum.largest, whole.largest);
    EXPECT_EQ(sum.moves, 180u);
}

} // namespace test_sweeps
