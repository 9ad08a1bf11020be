// The beginning of every call of the interface: account of memory, error,
// progress, options, and the checks of arguments that most calls share.
#pragma once

#include "../hierarchy/hierarchy.hpp"

namespace hmf {

// The field of this name, if there is one.
template <class Options>
auto reserved_in(const Options& options, int) -> decltype(options.reserved) {
    return options.reserved;
}
template <class Options>
uint32_t reserved_in(const Options&, long) {
    return 0;
}

// A structure of the caller, read with its struct_size: missing fields become
// zero, a longer structure must end in zeros, and so is what is reserved.  NULL: all zero.  Sizes of structures
// are multiples of their alignment; another number would cut a pointer in two.
template <class Options>
bool copy_options(const Options* from, Options& to) {
    std::memset(static_cast<void*>(&to), 0, sizeof to);
    if (!from) return true;
    uint32_t size = 0;
    std::memcpy(&size, from, sizeof size);
    if (size < sizeof size || size > 4096 || size % alignof(Options) != 0) return false;
    const unsigned char* bytes = reinterpret_cast<const unsigned char*>(from);
    for (size_t i = sizeof to; i < size; ++i)
        if (bytes[i] != 0) return false; // NOLINT(clang-analyzer-core*): the caller says that it has so many
    std::memcpy(static_cast<void*>(&to), from, size < sizeof to ? size : sizeof to);
    return reserved_in(to, 0) == 0;
}

// Writes the defaults, as far as the structure of the caller reaches; what is beyond them is zero.
template <class Options>
void init_options(Options* to, uint32_t struct_size, Options defaults) {
    if (!to || struct_size < sizeof struct_size) return;
    defaults.struct_size = struct_size;
    std::memset(static_cast<void*>(to), 0, struct_size);
    std::memcpy(static_cast<void*>(to), &defaults, std::min<size_t>(struct_size, sizeof defaults));
}

// As above; fails the call with a sentence that names the structure.
[[nodiscard]] hmf_status unusable_options(const char* name, Call& call);
template <class Options>
[[nodiscard]] hmf_status read_options(const Options* from, Options& to, const char* name, Call& call) {
    return copy_options(from, to) ? HMF_OK : unusable_options(name, call);
}

// The control of the caller; all NULL if it is absent or unusable.
struct Control {
    explicit Control(const hmf_control* from) : usable(copy_options(from, given)) {
        if (!usable) std::memset(static_cast<void*>(&given), 0, sizeof given);
    }
    hmf_control given;
    bool usable;
};

// A call on a hierarchy (NULL is allowed until check): its allocations are
// counted on top of those of the hierarchy.
class Entry {
    Control control_;
    hmf_error* error_;

public:
    // can_finish: HMF_PROGRESS_FINISH is another answer than CANCEL.
    Entry(const hmf_hierarchy* hierarchy, const hmf_control* control, hmf_error* error, bool can_finish = false);

    Memory memory;
    Call call;

    // The status; a call that has succeeded reports its end.
    [[nodiscard]] hmf_status end();

    // The same call on the memory of something that outlives it, up to a fraction of the progress.
    Call part(Memory& own, double until) {
        Call part(own, error_, control_.given);
        part.never_finish();
        part.range(call.reached(), until);
        call.range(until, 1);
        return part;
    }

    // hierarchy, control and out are there; *out becomes NULL.
    template <class Result>
    [[nodiscard]] hmf_status check(const hmf_hierarchy* hierarchy, Result** out) {
        if (out) *out = nullptr;
        return check(hierarchy, static_cast<const void*>(out));
    }
    // For outputs of the caller, which stay as they are.
    [[nodiscard]] hmf_status check(const hmf_hierarchy* hierarchy, const void* out);
};

// The options with all defaults in place; false: they are unusable, and name no allocator.
bool read_build_options(const hmf_hierarchy_options* from, BuildOptions& options);
hmf_status refuse_build_options(Call& call);

[[nodiscard]] hmf_status check_level(const hmf_hierarchy& hierarchy, size_t level, Call& call);
[[nodiscard]] hmf_status check_count(size_t count, size_t needed, const char* what, Call& call);

} // namespace hmf
