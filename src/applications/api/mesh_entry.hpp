// The beginning of a call that takes a mesh and returns no hierarchy: its build options, and an account of memory that
// ends with it.
#pragma once

#include "../../core/api/entry.hpp"

namespace hmf {

class MeshEntry {
    Control control_;

public:
    BuildOptions options;

private:
    bool readable_;

public:
    MeshEntry(const hmf_hierarchy_options* from, const hmf_control* control, hmf_error* error) :
        control_(control), readable_(read_build_options(from, options)),
        hierarchy(options.allocate, options.release, options.allocator_user, options.memory_limit),
        call(hierarchy.memory, error, control_.given) {
        hierarchy.memory.keep_arrays();
        call.never_finish();
    }

    hmf_hierarchy hierarchy; // with nothing in it
    Call call;

    // out is there, and the control can be read.
    template <class Result>
    [[nodiscard]] hmf_status check(Result** out) {
        if (!out) return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "out is NULL. Give the address of a pointer.");
        *out = nullptr;
        return control_.usable ? HMF_OK : unusable_options("hmf_control", call);
    }
    [[nodiscard]] hmf_status check_options() { return readable_ ? HMF_OK : refuse_build_options(call); }
};

} // namespace hmf
