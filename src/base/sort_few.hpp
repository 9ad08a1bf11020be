// Stable sort of the numbers 0 .. n - 1 by a key of few values, in blocks: parts of
// the numbers count theirs, then all parts know where those of each key begin.
#pragma once

#include <algorithm>

#include "memory.hpp"

namespace hmf {

// key(i) < keys is asked for twice.  begin[k] .. begin[k + 1] is where those of key k are in order.
template <class Key>
Done sort_by_few(uint32_t n, uint32_t keys, Key key, uint32_t* order, uint32_t* begin, const Parallel& parallel,
                 Memory& memory) {
    constexpr size_t most_parts = 16;
    const size_t size = std::max(Parallel::smallest, (n + most_parts - 1) / most_parts);
    Array<uint32_t> next; // of each part and key
    if (!next.allocate(memory, most_parts * keys)) return false;
    parallel.for_blocks(n, size, [&](size_t first, size_t end) {
        uint32_t* const count = &next[first / size * keys];
        std::memset(count, 0, keys * sizeof(uint32_t));
        for (uint32_t i = static_cast<uint32_t>(first); i < end; ++i) ++count[key(i)];
    });
    uint32_t sum = 0;
    for (uint32_t k = 0; k < keys; ++k) {
        begin[k] = sum;
        for (size_t part = 0; part * size < n; ++part) {
            uint32_t& at = next[part * keys + k];
            const uint32_t here = at;
            at = sum;
            sum += here;
        }
    }
    begin[keys] = sum;
    parallel.for_blocks(n, size, [&](size_t first, size_t end) {
        uint32_t* const at = &next[first / size * keys];
        for (uint32_t i = static_cast<uint32_t>(first); i < end; ++i) order[at[key(i)]++] = i;
    });
    return true;
}

} // namespace hmf
