// The queue of Dijkstra's algorithm where distances rounded to 24 bits suffice for the order. A search spends half of
// its time in this queue, so an entry is one word and is compared as one word:
//
//     [ key of the distance | item ]      (sort_keys.hpp)
#pragma once

#include "sort_keys.hpp"

namespace hmf {

class NearestFirstRounded {
public:
    struct Entry {
        uint32_t key, item;
    };

    void start(Memory& memory) { heap_.start(memory); }
    Done reserve(size_t n) { return heap_.reserve(n + 1); }
    void clear() { heap_.clear(); }
    bool empty() const { return heap_.empty(); }
    uint32_t top() const { return static_cast<uint32_t>(heap_[0]); }

    Done push(double distance, uint32_t item) {
        if (heap_.size() + 1 >= heap_.capacity() && !heap_.reserve(2 * heap_.capacity() + 2)) return false;
        add(distance, item);
        return true;
    }
    // Where room for it has been reserved.
    void add(double distance, uint32_t item) {
        const uint64_t word = uint64_t{key_of(distance)} << 32 | item;
        heap_.add(word);
        uint64_t* const heap = heap_.data();
        size_t i = heap_.size() - 1;
        for (; i > 0 && word < heap[(i - 1) / 2]; i = (i - 1) / 2) heap[i] = heap[(i - 1) / 2];
        heap[i] = word;
    }

    uint32_t pop() { return pop_entry().item; }
    Entry pop_entry() {
        uint64_t* const heap = heap_.data();
        const Entry top{static_cast<uint32_t>(heap[0] >> 32), static_cast<uint32_t>(heap[0])};
        const uint64_t last = heap_.back();
        heap_.pop();
        const size_t n = heap_.size();
        heap[n] = UINT64_MAX; // there may be one child only
        size_t i = 0;
        for (size_t child = 1; child < n; child = 2 * i + 1) {
            child += heap[child + 1] < heap[child]; // branch-free: mispredicted half the time
            if (heap[child] >= last) break;
            heap[i] = heap[child];
            i = child;
        }
        heap[i] = last;
        return top;
    }

private:
    Array<uint64_t> heap_;
};

} // namespace hmf
