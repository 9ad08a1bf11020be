#include "count_blocks.hpp"

#include <cstdlib>
#include <new>

uint64_t test::blocks = 0;

extern "C" void __sanitizer_cov_trace_pc();
extern "C" void __sanitizer_cov_trace_pc() { ++test::blocks; }

// Memory that is cleared or copied by the standard library counts as well, at 64 bytes a block.
void* operator new(size_t bytes) {
    test::blocks += bytes / 64;
    if (void* const memory = std::malloc(bytes ? bytes : 1)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
