// The queue of Dijkstra's algorithm: a binary heap of items, nearest first,
// the lower number first where distances are equal.  An item may be in it several times; the caller that takes it out
// checks whether the entry is still valid.
#pragma once

#include "memory.hpp"

namespace hmf {

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
