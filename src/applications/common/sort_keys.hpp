// Stable radix sort of items by falling keys, in linear time.
#pragma once

#include "../../core/base/memory.hpp"

namespace hmf {

// The order of non-negative floats is that of their bits.
inline uint32_t key_of(double x) {
    const float f = static_cast<float>(x);
    uint32_t bits;
    std::memcpy(&bits, &f, sizeof bits);
    return bits;
}

struct KeyedItems {
    Array<uint32_t> item, key; // to be filled

    Done allocate(Memory& memory, size_t n) {
        return item.allocate(memory, n) && key.allocate(memory, n) && other_item_.allocate(memory, n)
            && other_key_.allocate(memory, n);
    }

    void sort_falling() {
        constexpr uint32_t digits = 2048, last = digits - 1;
        uint32_t count[digits];
        for (uint32_t shift = 0; shift < 32; shift += 11) {
            for (uint32_t& c : count) c = 0;
            for (const uint32_t k : key) ++count[last - ((k >> shift) & last)];
            uint32_t sum = 0;
            for (uint32_t& c : count) {
                const uint32_t here = c;
                c = sum;
                sum += here;
            }
            for (size_t i = 0; i < item.size(); ++i) {
                const uint32_t to = count[last - ((key[i] >> shift) & last)]++;
                other_item_[to] = item[i];
                other_key_[to] = key[i];
            }
            item.swap(other_item_);
            key.swap(other_key_);
        }
    }

private:
    Array<uint32_t> other_item_, other_key_;
};

} // namespace hmf
