// Stable sort of n items by a key of few values, in blocks: parts of the items count theirs, then all parts know
// where those of each key begin.
#pragma once

#include <algorithm>

#include "memory.hpp"

namespace hmf {

// Calls key(i) < keys twice for each item; put(i, at) then moves item i to its place. begin[k] .. begin[k + 1] are the
// places of key k; begin may be NULL.
template <class Key, class Put>
Done place_by_few(size_t n, uint32_t keys, Key key, Put put, uint32_t* begin, const Parallel& parallel,
                  Memory& memory) {
    constexpr size_t most_parts = 16;
    const size_t size = std::max(Parallel::SMALLEST, (n + most_parts - 1) / most_parts);
    Array<uint32_t> next; // of each part and key
    if (!next.allocate(memory, most_parts * keys)) return false;
    parallel.for_blocks(n, size, [&](size_t first, size_t end) {
        uint32_t* const count = &next[first / size * keys];
        std::memset(count, 0, keys * sizeof(uint32_t));
        for (size_t i = first; i < end; ++i) ++count[key(i)];
    });
    uint32_t sum = 0;
    for (uint32_t k = 0; k < keys; ++k) {
        if (begin) begin[k] = sum;
        for (size_t part = 0; part * size < n; ++part) {
            uint32_t& at = next[part * keys + k];
            const uint32_t here = at;
            at = sum;
            sum += here;
        }
    }
    if (begin) begin[keys] = sum;
    parallel.for_blocks(n, size, [&](size_t first, size_t end) {
        uint32_t* const at = &next[first / size * keys];
        for (size_t i = first; i < end; ++i) put(i, at[key(i)]++);
    });
    return true;
}

// The numbers 0 .. n - 1 in this order.
template <class Key>
Done sort_by_few(uint32_t n, uint32_t keys, Key key, uint32_t* order, uint32_t* begin, const Parallel& parallel,
                 Memory& memory) {
    return place_by_few(
        n, keys, [&](size_t i) { return key(static_cast<uint32_t>(i)); },
        [&](size_t i, uint32_t at) { order[at] = static_cast<uint32_t>(i); }, begin, parallel, memory);
}

} // namespace hmf
