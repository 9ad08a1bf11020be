// The host of the interface under arbitrary input: its allocator, its progress function, and what it expects of
// each status.
#pragma once

#include <hmf/hmf.h>
#include <hmf/applications.h>

#include <algorithm>
#include <cstring>
#include <initializer_list>

#include "../bytes.hpp"
#include "../owned.hpp"

namespace fuzz {

// The limit bounds the hierarchy with what the running call takes: not the
// foliations and results that the caller already has.
struct Meter {
    uint64_t used = 0, peak = 0, calls = 0, fail = 0, limit = 0;
    uint64_t held = 0;   // by the hierarchy
    uint64_t beside = 0; // by other objects, when the call began

    void begin_call() { beside = used - held; }

    static void* take(void* user, size_t size) {
        Meter& meter = *static_cast<Meter*>(user);
        if (++meter.calls == meter.fail) return nullptr;
        meter.used += size;
        meter.peak = std::max(meter.peak, meter.used);
        FUZZ_ASSERT(meter.limit == 0 || meter.used - meter.beside <= meter.limit);
        void* block = std::malloc(size ? size : 1);
        if (block) std::memset(block, 0xa5, size);
        return block;
    }
    static void give(void* user, void* block, size_t size) {
        Meter& meter = *static_cast<Meter*>(user);
        FUZZ_ASSERT(block && meter.used >= size);
        meter.used -= size;
        std::free(block);
    }
};

struct Stop {
    uint32_t at = 0, calls = 0;
    int32_t answer = 0;
    static int32_t call(void* user, double fraction) {
        Stop& stop = *static_cast<Stop*>(user);
        FUZZ_ASSERT(fraction >= 0 && fraction <= 1);
        return ++stop.calls == stop.at ? stop.answer : HMF_PROGRESS_CONTINUE;
    }
};

inline Meter* meter_now = nullptr;
inline size_t marks_now = 0;
// Charts for this input?  Packing them takes ten times as long as all the rest.
inline bool charts_now = false;

// Of all singularities of a foliation; marked vertices take their share.
inline int64_t index_sum(const hmf_hierarchy* h) {
    return 4 - 4 * static_cast<int64_t>(hmf_hierarchy_describe(h)->genus) - static_cast<int64_t>(marks_now);
}

// With boundary the list has what touches the caller's half of the double, and the sum may be another.
inline bool has_index_sum(const hmf_hierarchy* h, int64_t sum) {
    return hmf_hierarchy_describe(h)->boundary_count > 0 || sum == index_sum(h);
}

// A status that the call may return; a failure tells its story.
inline void expect_status(hmf_status status, const hmf_error& error, std::initializer_list<int> classes) {
    bool known = status == HMF_OK;
    for (const int c : classes) known |= status / 100 == c && status != 0;
    FUZZ_ASSERT(known);
    if (status == HMF_OK) {
        FUZZ_ASSERT(error.status == HMF_OK);
    } else {
        FUZZ_ASSERT(error.status == status);
        FUZZ_ASSERT(std::memchr(error.message, 0, sizeof error.message) && std::strlen(error.message) > 10);
    }
}

// Of a call that makes a result: given if and only if it succeeds.
template <class T, class Call>
inline Owned<T> result_of(std::initializer_list<hmf_status> others, bool memory_is_short, Call&& call) {
    T* out = reinterpret_cast<T*>(&others); // must be overwritten
    meter_now->begin_call();
    const hmf_status status = call(&out);
    FUZZ_ASSERT((out != nullptr) == (status == HMF_OK));
    FUZZ_ASSERT(status == HMF_OK || std::find(others.begin(), others.end(), status) != others.end()
                || (memory_is_short && status / 100 == 2));
    return Owned<T>(out);
}

// NULL where memory is short.
inline Owned<hmf_level_mesh> level_of(const hmf_hierarchy* h, size_t level, bool memory_is_short) {
    return result_of<hmf_level_mesh>({}, memory_is_short,
                                     [&](auto out) { return hmf_level(h, level, nullptr, out, nullptr); });
}

} // namespace fuzz
