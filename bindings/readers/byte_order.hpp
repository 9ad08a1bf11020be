// Numbers as they lie in a binary file, on machines of either byte order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace readers {

inline bool host_is_big_endian() {
    const uint16_t one = 1;
    unsigned char first = 0;
    std::memcpy(&first, &one, 1);
    return first == 0;
}

template <typename Number>
Number load(const char* place, bool big_endian = false) {
    unsigned char bytes[sizeof(Number)];
    std::memcpy(bytes, place, sizeof bytes);
    if (big_endian != host_is_big_endian()) std::reverse(bytes, bytes + sizeof bytes);
    Number number;
    std::memcpy(&number, bytes, sizeof bytes);
    return number;
}

} // namespace readers
