// What JavaScript needs beside hmf.h: counted memory and the way from the
// progress callback of C to a function of JavaScript.
//
// A JavaScript function cannot be put into the function table of the module
// without a WebAssembly type for it.  So one C function, which is in the table
// already, passes the call on to an import; progress_user is a number by which
// JavaScript finds its own function.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "../../../include/hmf/hmf.h"

extern "C" __attribute__((import_module("hmf"), import_name("progress"))) int32_t hmf_js_progress(uint32_t callback,
                                                                                                  double fraction);

namespace {

// Bytes that are taken and not given back.  WebAssembly memory never shrinks,
// so its size alone would not show a leak that is smaller than a page.
size_t bytes_in_use = 0;

void* allocate(void*, size_t size) {
    void* block = std::malloc(size ? size : 1);
    if (block) bytes_in_use += size;
    return block;
}

void release(void*, void* block, size_t size) {
    bytes_in_use -= size;
    std::free(block);
}

int32_t progress(void* user, double fraction) {
    return hmf_js_progress(static_cast<uint32_t>(reinterpret_cast<uintptr_t>(user)), fraction);
}

} // namespace

extern "C" {

__attribute__((export_name("hmf_js_take"))) void* hmf_js_take(size_t size) { return allocate(nullptr, size); }
__attribute__((export_name("hmf_js_give"))) void hmf_js_give(void* block, size_t size) {
    release(nullptr, block, size);
}
__attribute__((export_name("hmf_js_bytes_in_use"))) size_t hmf_js_bytes_in_use(void) { return bytes_in_use; }

// Addresses for the options.
__attribute__((export_name("hmf_js_allocate_fn"))) hmf_allocate_fn hmf_js_allocate_fn(void) { return allocate; }
__attribute__((export_name("hmf_js_release_fn"))) hmf_release_fn hmf_js_release_fn(void) { return release; }
__attribute__((export_name("hmf_js_progress_fn"))) hmf_progress_fn hmf_js_progress_fn(void) { return progress; }

// Traps on purpose, for the tests of what happens then.
__attribute__((export_name("hmf_js_trap"))) void hmf_js_trap(void) { __builtin_trap(); }
}
