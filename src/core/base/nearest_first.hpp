// The queue of Dijkstra's algorithm: a binary heap of items, nearest first,
// the lower number first where distances are equal.  An item may be in it several times; the caller that takes it out
// checks whether the entry is still valid.
//
// A search spends half of its time in this queue. If distances rounded to 24 bits suffice for the order, an entry is
// one word and is compared as one word:
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

template <class Distance>
class SmallestFirst {
public:
    struct Entry {
        Distance distance;
        uint32_t item;
    };

    void start(Memory& memory) { heap_.start(memory); }
    void clear() { heap_.clear(); }
    bool empty() const { return heap_.empty(); }
    const Entry& top() const { return heap_[0]; }

    Done push(Entry entry) {
        if (!heap_.reserve_one()) return false;
        add(entry);
        return true;
    }
    // Where room for it has been reserved.
    void add(Entry entry) {
        heap_.add(entry);
        size_t i = heap_.size() - 1;
        for (; i > 0 && before(entry, heap_[(i - 1) / 2]); i = (i - 1) / 2) heap_[i] = heap_[(i - 1) / 2];
        heap_[i] = entry;
    }

    Entry pop() {
        const Entry top = heap_[0], last = heap_.back();
        heap_.pop();
        const size_t n = heap_.size();
        if (n == 0) return top;
        size_t i = 0;
        for (size_t child = 1; child < n; child = 2 * i + 1) {
            if (child + 1 < n) child += before(heap_[child + 1], heap_[child]);
            if (!before(heap_[child], last)) break;
            heap_[i] = heap_[child];
            i = child;
        }
        heap_[i] = last;
        return top;
    }

private:
    // Branch-free: mispredicted half the time.
    static bool before(const Entry& a, const Entry& b) {
        return (a.distance < b.distance) | ((a.distance == b.distance) & (a.item < b.item));
    }

    Array<Entry> heap_;
};

using NearestFirst = SmallestFirst<double>;

} // namespace hmf
