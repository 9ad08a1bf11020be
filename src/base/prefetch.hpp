// Asks for memory that is read soon, where the compiler has a word for it.
#pragma once

namespace hmf {

inline void prefetch(const void* address) {
#if defined(__GNUC__)
    __builtin_prefetch(address);
#else
    (void)address;
#endif
}

} // namespace hmf
