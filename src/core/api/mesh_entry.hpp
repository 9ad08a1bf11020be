// The beginning of a call that takes a mesh: its build options, and an account of memory that ends with it.
#pragma once

#include "entry.hpp"

namespace hmf {

// The options with all defaults in place; false: they are unusable, and `all` names no allocator.
bool read_build_options(const hmf_hierarchy_options* from, hmf_hierarchy_options& all, BuildOptions& options);
hmf_status refuse_build_options(Call& call);

// For calls that do not return a hierarchy.
class MeshEntry {
    Control control_;
    hmf_hierarchy_options all_{};

public:
    BuildOptions options;

private:
    bool readable_;

public:
    MeshEntry(const hmf_hierarchy_options* from, const hmf_control* control, hmf_error* error) :
        control_(control), readable_(read_build_options(from, all_, options)),
        hierarchy(all_.allocate, all_.release, all_.allocator_user, all_.memory_limit),
        call(hierarchy.memory, error, control_.given) {
        hierarchy.memory.keep_arrays();
        call.never_finish();
    }

    hmf_hierarchy hierarchy; // with nothing in it
    Call call;

    // out is there, and the control can be read.
    template <class Result>
    [[nodiscard]] hmf_status check(Result** out) {
        if (out) *out = nullptr;
        return check(static_cast<const void*>(out));
    }
    [[nodiscard]] hmf_status check_options() { return readable_ ? HMF_OK : refuse_build_options(call); }

private:
    [[nodiscard]] hmf_status check(const void* out);
};

} // namespace hmf
