// Work on the threads of the host, with the same bits for every number of them.
//
// The elements of a pass are cut into blocks, by their number alone:
//
//     | block 0 | block 1 | block 2 | ...      a task takes the next block that is free
//
// Tasks with an odd number take them from the end: so the order of a pass depends on the host, and a block that is not
// independent of the others shows in tests without a race.  A block writes what no other block of the pass reads or
// writes.  Sums are taken within each block and then over the blocks, in order.  Without a callback the same blocks run
// one after the other.  Tasks do not allocate, report or look at the clock: that is done between the passes.
//
// A task has a slot, a number below slots() that no other task has at the same
// time: room that a block needs for itself is made once for each slot.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "../../../include/hmf/hmf.h"

namespace hmf {

class Parallel {
public:
    Parallel() = default;
    Parallel(hmf_parallel_for_fn run, void* user, uint32_t workers) :
        run_(run), user_(user), slots_(!run                   ? 1
                                       : workers == 0         ? 16
                                       : workers < MOST_SLOTS ? workers
                                                              : MOST_SLOTS) {}

    uint32_t slots() const { return slots_; }

    // f(block, slot) for each block below count.
    template <class F>
    void for_each(uint32_t count, F f) const {
        const uint32_t tasks = count < slots_ ? count : slots_;
        if (tasks < 2) {
            for (uint32_t block = 0; block < count; ++block) f(block, 0u);
            return;
        }
        Work<F> work{f, count, {}};
        run_(user_, Work<F>::take, &work, tasks);
    }

    // Calls f(begin, end) for blocks of the given number of elements.
    template <class F>
    void for_blocks(size_t n, size_t size, F f) const {
        for_each(static_cast<uint32_t>((n + size - 1) / size), [&](uint32_t block, uint32_t) {
            const size_t begin = block * size, end = begin + size < n ? begin + size : n;
            f(begin, end);
        });
    }

    // f(begin, end) for blocks of pass_block(n) elements.
    template <class F>
    void for_blocks(size_t n, F f) const {
        for_blocks(n, pass_block(n), f);
    }

    template <class T>
    void copy(T* to, const T* from, size_t n) const {
        for_blocks(n,
                   [=](size_t begin, size_t end) { std::memcpy(to + begin, from + begin, (end - begin) * sizeof(T)); });
    }

    // The sum of T = f(begin, end) over blocks; T has += and begins at T{}.
    template <class T, class F>
    T sum_blocks(size_t n, F f) const {
        const size_t size = pass_block(n);
        T part[MOST_PARTS];
        for_blocks(n, size, [&](size_t begin, size_t end) { part[begin / size] = f(begin, end); });
        T sum{};
        for (size_t k = 0; k * size < n; ++k) sum += part[k]; // NOLINT(clang-analyzer-core*): each block set its part
        return sum;
    }

    // Elements of a block in a pass over n: a multiple of smallest, which takes as long as
    // waking a thread or more, with which there are at most most_parts blocks.
    static constexpr size_t SMALLEST = 4096, MOST_PARTS = 256;
    static size_t pass_block(size_t n) {
        constexpr size_t whole = SMALLEST * MOST_PARTS;
        return n <= whole ? SMALLEST : (n + whole - 1) / whole * SMALLEST;
    }

private:
    static constexpr uint32_t MOST_SLOTS = 256;

    template <class F>
    struct Work {
        F& f;
        uint32_t count;
        std::atomic<uint64_t> taken; // from the beginning, and from the end in the upper half

        static void take(void* context, uint32_t slot) {
            Work& work = *static_cast<Work*>(context);
            const bool from_end = slot % 2 != 0;
            for (;;) {
                const uint64_t before =
                    work.taken.fetch_add(from_end ? uint64_t{1} << 32 : 1, std::memory_order_relaxed);
                const uint32_t first = static_cast<uint32_t>(before), last = static_cast<uint32_t>(before >> 32);
                if (first + last >= work.count) return;
                work.f(from_end ? work.count - 1 - last : first, slot);
            }
        }
    };

    hmf_parallel_for_fn run_ = nullptr;
    void* user_ = nullptr;
    uint32_t slots_ = 1;
};

} // namespace hmf
