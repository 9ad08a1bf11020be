// Prefetches memory that will be read soon; does nothing if the compiler has no such builtin. Use HMF_INLINE for every
// function that only prefetches: the compiler finds that a call of it has no effect, and removes the call.
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
