// Work, counted: the blocks of instructions that the library and the readers ran.  Both are compiled so that each block
// calls a counter (-fsanitize-coverage=trace-pc): the same counts on every run.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace test {

extern uint64_t blocks;

// The exponent of growth of the work from one input to one of four times its size.
template <class Count>
void expect_growth(const char* name, Count&& work, size_t n, double most) {
    const double small = static_cast<double>(work(n)), large = static_cast<double>(work(4 * n));
    EXPECT_LE(std::log(large / small) / std::log(4), most) << name << ": " << small << ", " << large;
}

template <class Count>
void expect_linear(const char* name, Count&& work, size_t n) {
    expect_growth(name, work, n, 1.2);
}

} // namespace test
