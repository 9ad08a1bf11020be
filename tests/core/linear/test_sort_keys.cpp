// The radix sort against std::stable_sort: falling keys of all 32 bits, equal ones in their order.
#include "src/applications/common/sort_keys.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "support/meshes.hpp"

namespace test_sort_keys {

TEST(SortKeys, IsAStableSort) {
    test::Random random(8);
    for (const size_t n : {0, 1, 2, 100, 5000}) {
        for (const uint32_t mask : {0xffffffffu, 0xffu, 0xff00000u, 0xf0000000u}) {
            hmf::Memory memory(nullptr, nullptr, nullptr, 0);
            hmf::KeyedItems items;
            ASSERT_TRUE(items.allocate(memory, n));
            std::vector<uint32_t> key(n), order(n);
            for (size_t i = 0; i < n; ++i) {
                items.item[i] = static_cast<uint32_t>(i);
                items.key[i] = key[i] = static_cast<uint32_t>(random.bits()) & mask;
            }
            items.sort_falling();
            std::iota(order.begin(), order.end(), 0u);
            std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key[a] > key[b]; });
            EXPECT_TRUE(std::equal(order.begin(), order.end(), items.item.begin(), items.item.end()));
        }
    }
}

// Keys of numbers have the order of the numbers.
TEST(SortKeys, KeysOfNumbers) {
    test::Random random(9);
    for (int i = 0; i < 1000; ++i) {
        const double a = 1e6 * random.unit() * random.unit(), b = a * (1 + 1e-5 + random.unit());
        EXPECT_LT(hmf::key_of(a), hmf::key_of(b));
    }
    EXPECT_EQ(hmf::key_of(0), 0u);
}

} // namespace test_sort_keys
