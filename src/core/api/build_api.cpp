// hmf.h: build.
#include "entry.hpp"

#include <new>

using namespace hmf;

namespace hmf {

bool read_build_options(const hmf_hierarchy_options* from, BuildOptions& options) {
    const BuildOptions defaults;
    hmf_hierarchy_options& given = options;
    const bool readable = copy_options(from, given);
    if (options.collapse == 0) options.collapse = defaults.collapse;
    if (options.ratio == 0) options.ratio = defaults.ratio;
    if (readable && options.collapse >= HMF_COLLAPSE_MIDPOINT && options.collapse <= HMF_COLLAPSE_QSLIM
        && options.ratio >= 0.05 && options.ratio <= 0.95 && options.mollify >= 0 && options.mollify <= 0.1
        && !options.allocate == !options.release && options.position_stride <= PTRDIFF_MAX)
        return true;
    options.allocate = nullptr;
    options.release = nullptr;
    return false;
}

hmf_status refuse_build_options(Call& call) {
    return call.fail(
        HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
        "hmf_hierarchy_options is unusable. Set struct_size to its size and unused fields to 0; ratio "
        "is in [0.05, 0.95], mollify in [0, 0.1], position_stride fits into memory, allocate and release come "
        "together.");
}

} // namespace hmf

extern "C" {

hmf_status hmf_hierarchy_create(const double* positions, size_t vertex_count, const uint32_t* triangles,
                                size_t triangle_count, const hmf_hierarchy_options* options, const hmf_control* control,
                                hmf_hierarchy** out, hmf_error* error) {
    if (out) *out = nullptr;
    const Control given(control);
    BuildOptions build;
    const bool readable = read_build_options(options, build);
    Memory own(build.allocate, build.release, build.allocator_user, build.memory_limit);
    {
        Call call(own, error, nullptr, nullptr);
        if (!out)
            return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0,
                             "out is NULL. Give the address of a hierarchy pointer.");
        if (!given.usable) return unusable_options("hmf_control", call);
        if (!readable) return refuse_build_options(call);
        void* block = own.take(sizeof(hmf_hierarchy));
        if (!block) return call.out_of_memory();
        *out = new (block) hmf_hierarchy(build.allocate, build.release, build.allocator_user, build.memory_limit);
    }
    hmf_hierarchy* h = *out;
    h->memory.keep_arrays();
    Call call(h->memory, error, given.given);
    const hmf_status status = build_hierarchy(*h, positions, vertex_count, static_cast<size_t>(build.position_stride),
                                              triangles, triangle_count, build, call);
    h->memory.release_kept();
    if (status != HMF_OK) {
        hmf_hierarchy_destroy(h);
        *out = nullptr;
    } else {
        h->info.memory_bytes = h->memory.used();
        call.finished();
    }
    return status;
}

void hmf_hierarchy_destroy(hmf_hierarchy* hierarchy) {
    if (!hierarchy || hierarchy->references.fetch_sub(1, std::memory_order_acq_rel) > 1) return;
    Memory own(hierarchy->allocate, hierarchy->release, hierarchy->allocator_user, 0, sizeof *hierarchy);
    hierarchy->~hmf_hierarchy();
    own.give(hierarchy, sizeof *hierarchy);
}

uint64_t hmf_hierarchy_memory_estimate(size_t vertex_count, size_t triangle_count,
                                       const hmf_hierarchy_options* options) {
    BuildOptions build;
    if (!read_build_options(options, build)) return 0;
    if (vertex_count == 0 || triangle_count == 0 || vertex_count > 0x7fffffff / 3 || triangle_count > 0x7fffffff / 3)
        return 0;
    return build_memory_bound(vertex_count, triangle_count, build) + sizeof(hmf_hierarchy);
}

} // extern "C"
