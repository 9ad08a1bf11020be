// Sanitizers are up to twenty times slower.  A test of many cases of one kind takes some of them there: those that
// reach the same code; the others run in the build without.
#pragma once

namespace test {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool with_sanitizers = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr bool with_sanitizers = true;
#else
constexpr bool with_sanitizers = false;
#endif
#else
constexpr bool with_sanitizers = false;
#endif

template <class T>
constexpr T sample(T all, T some) {
    return with_sanitizers ? some : all;
}

} // namespace test
