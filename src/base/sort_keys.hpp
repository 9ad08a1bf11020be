// Stable radix sort of items by falling keys, in linear time.
#pragma once

#include "memory.hpp"

namespace hmf {

// The order of non-negative floats is that of their bits.
inline uint32_t key_of(double x) {
    const float f = static_cast<float>(x);
    uint32_t bits;
    std::memcpy(&bits, &f, sizeof bits);
    return bits;
}

inline bool sort_falling(Array<uint32_t>& items, Array<uint32_t>& key, Memory& memory) {
    constexpr uint32_t digits = 2048, last = digits - 1;
    const size_t n = items.size();
    Array<uint32_t> other, other_key, count;
    if (!other.allocate(memory, n) || !other_key.allocate(memory, n) || !count.allocate(memory, digits)) return false;
    for (uint32_t shift = 0; shift < 32; shift += 11) {
        for (uint32_t& c : count) c = 0;
        for (const uint32_t k : key) ++count[last - ((k >> shift) & last)];
        uint32_t sum = 0;
        for (uint32_t& c : count) { const uint32_t here = c; c = sum; sum += here; }
        for (size_t i = 0; i < n; ++i) {
            const uint32_t to = count[last - ((key[i] >> shift) & last)]++;
            other[to] = items[i];
            other_key[to] = key[i];
        }
        items.swap(other);
        key.swap(other_key);
    }
    return true;
}

} // namespace hmf
