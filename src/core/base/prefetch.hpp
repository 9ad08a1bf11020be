// Asks for memory that is read soon; nothing where the compiler has no such builtin.
//
// HMF_INLINE for every function that does nothing else: a compiler finds that
// a call of it has no effect, and drops it.
#pragma once

#if defined(__GNUC__)
#define HMF_INLINE inline __attribute__((always_inline))
#else
#define HMF_INLINE inline
#endif

namespace hmf {

HMF_INLINE void prefetch(const void* address) {
#if defined(__GNUC__)
    __builtin_prefetch(address);
#else
    (void)address;
#endif
}

} // namespace hmf
