// Queues, sets and numbers that the stages build on, against those of the standard library or exact arithmetic.
#include "src/core/base/disjoint_sets.hpp"
#include "src/core/base/heap_sort.hpp"
#include "src/applications/common/nearest_first_rounded.hpp"
#include "src/core/base/nearest_first.hpp"
#include "src/core/base/two_doubles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>

#include "support/meshes.hpp"

namespace test_base {

namespace {

using hmf::TwoDoubles;
using Pair = std::pair<double, uint32_t>;

struct Reference {
    std::priority_queue<Pair, std::vector<Pair>, std::greater<Pair>> queue;
    Pair pop() {
        const Pair top = queue.top();
        queue.pop();
        return top;
    }
};

// Many distances are equal.
Pair drawn(test::Random& random) {
    const double distance = static_cast<double>(random.below(40));
    return {distance, static_cast<uint32_t>(random.below(1000))};
}

double near_one(test::Random& random) { return 1 + random.unit(); }

TwoDoubles fine(test::Random& random) {
    const double high = near_one(random);
    return hmf::joined(high, (random.unit() - 0.5) * 0x1p-53);
}

void expect_same(TwoDoubles a, TwoDoubles b) {
    const TwoDoubles off = a - b;
    EXPECT_LE(std::fabs(off.high), 1e-30 * std::fabs(b.high));
}

} // namespace

// Many distances are equal: the lower number comes first.
TEST(NearestFirst, IsAPriorityQueue) {
    test::Random random(4);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::NearestFirst heap;
    heap.start(memory);
    Reference reference;
    for (int i = 0; i < 4000; ++i) {
        // More come than go at first, then all go.
        if (i < 2500 && (reference.queue.empty() || random.below(3) > 0)) {
            const Pair next = drawn(random);
            reference.queue.push(next);
            ASSERT_TRUE(heap.push({next.first, next.second}));
        } else if (!reference.queue.empty()) {
            const hmf::NearestFirst::Entry entry = heap.pop();
            EXPECT_EQ(Pair(entry.distance, entry.item), reference.pop()) << i;
        }
        ASSERT_EQ(heap.empty(), reference.queue.empty());
    }
    EXPECT_TRUE(heap.empty());
}

// Keys of small whole numbers have their order.
TEST(NearestFirst, RoundedIsAPriorityQueue) {
    test::Random random(5);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::NearestFirstRounded heap;
    heap.start(memory);
    Reference reference;
    for (int i = 0; i < 4000; ++i) {
        if (i < 2500 && (reference.queue.empty() || random.below(3) > 0)) {
            const Pair next = drawn(random);
            reference.queue.push(next);
            ASSERT_TRUE(heap.push(next.first, next.second));
        } else if (!reference.queue.empty()) {
            const hmf::NearestFirstRounded::Entry entry = heap.pop_entry();
            const Pair expected = reference.pop();
            EXPECT_EQ(entry.key, hmf::key_of(expected.first)) << i;
            EXPECT_EQ(entry.item, expected.second) << i;
        }
        ASSERT_EQ(heap.empty(), reference.queue.empty());
    }
    EXPECT_TRUE(heap.empty());
}

TEST(HeapSort, Sorts) {
    test::Random random(6);
    for (size_t n = 0; n < 70; ++n) {
        std::vector<size_t> items(n + 1, 1000); // the last one is not to be touched
        for (size_t i = 0; i < n; ++i) items[i] = random.below(n + 1);
        std::vector<size_t> sorted = items;
        std::sort(sorted.begin(), sorted.end());
        items[n] = 0;
        hmf::heap_sort(items.data(), n, [](size_t a, size_t b) { return a < b; });
        EXPECT_EQ(items[n], 0u);
        items[n] = 1000;
        EXPECT_EQ(items, sorted) << n;
    }
}

// Against labels that are rewritten; the root is the smallest of a set.
TEST(DisjointSets, RootIsTheSmallest) {
    test::Random random(7);
    constexpr uint32_t n = 200;
    std::vector<uint32_t> parent(n), label(n);
    for (uint32_t i = 0; i < n; ++i) parent[i] = label[i] = i;
    for (int k = 0; k < 400; ++k) {
        const uint32_t i = static_cast<uint32_t>(random.below(n)), j = static_cast<uint32_t>(random.below(n));
        const uint32_t a = std::min(label[i], label[j]), b = std::max(label[i], label[j]);
        EXPECT_EQ(hmf::unite(parent.data(), i, j), a != b);
        std::replace(label.begin(), label.end(), b, a);
        for (uint32_t v = k % 7; v < n; v += 7) ASSERT_EQ(hmf::find_root(parent.data(), v), label[v]);
    }
}

TEST(TwoDoubles, SumsAndProductsAreExact) {
    test::Random random(8);
    for (int i = 0; i < 1000; ++i) {
        // Whole numbers of 53 and of 62 bits.
        const int64_t m = static_cast<int64_t>(random.bits() >> 11),
                      n = static_cast<int64_t>(random.bits() >> 11) * 512;
        const TwoDoubles sum = TwoDoubles::of_sum(static_cast<double>(m), static_cast<double>(-n));
        EXPECT_EQ(static_cast<int64_t>(sum.high) + static_cast<int64_t>(sum.low), m - n);
        const double a = near_one(random), b = near_one(random);
        const TwoDoubles product = TwoDoubles::of_product(a, b);
        EXPECT_EQ(product.high, a * b);
        EXPECT_EQ(product.low, std::fma(a, b, -(a * b)));
    }
}

// There and back again, to 30 digits.
TEST(TwoDoubles, HasThirtyDigits) {
    test::Random random(9);
    for (int i = 0; i < 1000; ++i) {
        const TwoDoubles a = fine(random), b = fine(random), c = fine(random);
        expect_same((a / b) * b, a);
        expect_same((a + b) * c, a * c + b * c);
        expect_same((a + b) * (a - b) + b * b, a * a);
        const TwoDoubles root = hmf::square_root(a);
        expect_same(root * root, a);
        EXPECT_NEAR(a.value(), a.high, 0x1p-52);
        EXPECT_EQ((a + -a).high, 0);
        expect_same(3 * a, a + a + a);
    }
    for (const double x : {0.0, 1.0, 3.0, 1e10}) {
        const TwoDoubles root = hmf::square_root(TwoDoubles::of_product(x, x));
        EXPECT_EQ(root.high, x);
        EXPECT_EQ(root.low, 0);
    }
}

} // namespace test_base
