// Disjoint sets of numbers as trees with path halving; the smallest number of a
// set is its root.
#pragma once

#include <cstdint>

namespace hmf {

inline uint32_t find_root(uint32_t* parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

// False if they were in one set already.
inline bool unite(uint32_t* parent, uint32_t i, uint32_t j) {
    i = find_root(parent, i);
    j = find_root(parent, j);
    if (i == j) return false;
    if (i < j) parent[j] = i;
    else parent[i] = j;
    return true;
}

} // namespace hmf
