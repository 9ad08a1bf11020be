// Words that look random, the same on every machine [Steele, Lea and Flood
// 2014, splitmix64].
#pragma once

#include <cstdint>

namespace hmf {

// The next word; seed: any number first.
inline uint64_t random_word(uint64_t& seed) {
    uint64_t x = seed += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

} // namespace hmf
