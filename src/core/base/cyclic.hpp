// Cyclic sequences: where they begin does not count.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace hmf {

// Where the least rotation of a cyclic sequence begins; linear time.
inline size_t least_rotation(const uint32_t* s, size_t n) {
    size_t i = 0, j = 1, k = 0;
    while (i < n && j < n && k < n) {
        const size_t p = i + k < n ? i + k : i + k - n, q = j + k < n ? j + k : j + k - n;
        if (s[p] == s[q]) {
            ++k;
            continue;
        }
        if (s[p] > s[q]) i += k + 1;
        else j += k + 1;
        if (i == j) ++j;
        k = 0;
    }
    return std::min(i, j);
}

// Are two cyclic sequences of length n the same, wherever they begin?
inline bool same_cycle(const uint32_t* a, const uint32_t* b, size_t n) {
    const size_t i = least_rotation(a, n), j = least_rotation(b, n);
    for (size_t k = 0; k < n; ++k)
        if (a[(i + k) % n] != b[(j + k) % n]) return false;
    return true;
}

} // namespace hmf
