// Callbacks that watch the library: an allocator that counts and can refuse,
// and a progress function that can stop a call.
#pragma once

#include <hmf/hmf.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace test {

// Counts bytes and calls; refuses the call number `fail` (from 1).
struct WatchedHost {
    uint64_t used = 0, peak = 0, calls = 0, fail = 0;

    static void* take(void* user, size_t size) {
        WatchedHost& watched = *static_cast<WatchedHost*>(user);
        if (++watched.calls == watched.fail) return nullptr;
        watched.used += size;
        watched.peak = std::max(watched.peak, watched.used);
        // Fresh memory is never zero by luck.
        void* block = std::malloc(size ? size : 1);
        std::memset(block, 0xa5, size);
        return block;
    }
    static void give(void* user, void* block, size_t size) {
        WatchedHost& watched = *static_cast<WatchedHost*>(user);
        EXPECT_NE(block, nullptr);
        EXPECT_GE(watched.used, size);
        watched.used -= size;
        std::free(block);
    }
    // Several levels even on small meshes.
    hmf_hierarchy_options options(uint64_t coarsest = 40) {
        hmf_hierarchy_options o{};
        o.struct_size = sizeof o;
        o.allocate = take;
        o.release = give;
        o.allocator_user = this;
        o.coarsest = coarsest;
        return o;
    }
};

// Answers the call number `stop` (from 1), which must be the last one.
struct Progress {
    uint64_t calls = 0, stop = 0;
    int32_t answer = HMF_PROGRESS_CANCEL;
    double last = 0;
    bool rising = true;

    static int32_t call(void* user, double fraction) {
        Progress& p = *static_cast<Progress*>(user);
        if (!(fraction >= p.last && fraction <= 1)) p.rising = false;
        p.last = fraction;
        return ++p.calls == p.stop ? p.answer : HMF_PROGRESS_CONTINUE;
    }
    hmf_control control() {
        hmf_control c{};
        c.struct_size = sizeof c;
        c.progress = call;
        c.progress_user = this;
        return c;
    }
};

// The most work between two calls of the progress function, counted and not timed: blocks of instructions that the
// library ran, in a build that counts them (tests/work).  A block takes about a nanosecond.
struct Work {
    explicit Work(const uint64_t& blocks) : now(blocks), last(blocks), begin(blocks) {}
    const uint64_t& now;
    uint64_t last, begin, most = 0;

    static int32_t call(void* user, double) {
        static_cast<Work*>(user)->report();
        return HMF_PROGRESS_CONTINUE;
    }
    void report() {
        most = std::max(most, now - last);
        last = now;
    }
    uint64_t all() const { return now - begin; }
    hmf_control control() {
        hmf_control c{};
        c.struct_size = sizeof c;
        c.progress = call;
        c.progress_user = this;
        return c;
    }
};

} // namespace test
