// In-place sorting without recursion or memory: heap sort with the order given.
#pragma once

#include <cstddef>

namespace hmf {

// go_on() after each step of logarithmic length; false: the sort stops there, and returns false.
template <class T, class Less, class GoOn>
bool heap_sort(T* items, size_t n, const Less& less, const GoOn& go_on) {
    const auto sink = [&](size_t i, size_t end) {
        const T item = items[i];
        for (size_t child = 2 * i + 1; child < end; child = 2 * i + 1) {
            if (child + 1 < end && less(items[child], items[child + 1])) ++child;
            if (!less(item, items[child])) break;
            items[i] = items[child];
            i = child;
        }
        items[i] = item;
    };
    for (size_t i = n / 2; i-- > 0;) {
        if (!go_on()) return false;
        sink(i, n);
    }
    for (size_t end = n; end-- > 1;) {
        if (!go_on()) return false;
        const T largest = items[0];
        items[0] = items[end];
        items[end] = largest;
        sink(0, end);
    }
    return true;
}

template <class T, class Less>
void heap_sort(T* items, size_t n, const Less& less) {
    heap_sort(items, n, less, [] { return true; });
}

} // namespace hmf
