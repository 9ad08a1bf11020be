// What every fuzz target starts from: the input as numbers, and the assertion.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#define FUZZ_ASSERT(condition)                                                                                         \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            std::fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                                       \
            std::abort();                                                                                              \
        }                                                                                                              \
    } while (0)

namespace fuzz {

// Bytes of the input as numbers; zeros when they run out.
class Bytes {
public:
    Bytes(const uint8_t* data, size_t size) : data_(data), size_(size) {}
    bool empty() const { return at_ >= size_; }
    uint8_t byte() { return empty() ? uint8_t{0} : data_[at_++]; }
    uint32_t below(uint32_t n) { return byte() % n; }
    uint32_t wide_below(uint32_t n) { // of two bytes, high one first
        const uint32_t high = byte();
        return ((high << 8) | byte()) % n;
    }
    bool rarely() { return byte() % 16 == 15; }

private:
    const uint8_t* data_;
    size_t size_, at_ = 0;
};

// splitmix64, for what needs more numbers than there are bytes: the same on every platform.
inline uint64_t next_random(uint64_t& state) {
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

} // namespace fuzz
