// hmf.h: build.
#include "mesh_entry.hpp"

#include <new>

using namespace hmf;

namespace hmf {

static bool read(const hmf_hierarchy_options* from, hmf_hierarchy_options& all, BuildOptions& options) {
    if (!copy_options(from, all)) return false;
    if (all.collapse) options.collapse = all.collapse;
    if (all.ratio != 0) options.ratio = all.ratio;
    if (all.coarsest) options.coarsest = all.coarsest;
    options.mollify = all.mollify;
    options.position_stride = all.position_stride;
    options.marked_vertices = all.marked_vertices;
    options.marked_count = all.marked_count;
    return options.collapse >= HMF_COLLAPSE_MIDPOINT && options.collapse <= HMF_COLLAPSE_QSLIM && options.ratio >= 0.05
        && options.ratio <= 0.95 && options.mollify >= 0 && options.mollify <= 0.1 && !all.allocate == !all.release
        && options.position_stride <= PTRDIFF_MAX;
}

bool read_build_options(const hmf_hierarchy_options* from, hmf_hierarchy_options& all, BuildOptions& options) {
    if (read(from, all, options)) return true;
    all.allocate = nullptr;
    all.release = nullptr;
    return false;
}

hmf_status refuse_build_options(Call& call) {
    return call.fail(
        HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
        "hmf_hierarchy_options is unusable. Set struct_size to its size and unused fields to 0; ratio "
        "is in [0.05, 0.95], mollify in [0, 0.1], position_stride fits into memory, allocate and release come "
        "together.");
}

hmf_status MeshEntry::check(const void* out) {
    if (!out) return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "out is NULL. Give the address of a pointer.");
    return control_.usable ? HMF_OK : unusable_options("hmf_control", call);
}

} // namespace hmf

extern "C" {

hmf_status hmf_hierarchy_create(const double* positions, size_t vertex_count, const uint32_t* triangles,
                                size_t triangle_count, const hmf_hierarchy_options* options, const hmf_control* control,
                                hmf_hierarchy** out, hmf_error* error) {
    if (out) *out = nullptr;
    const Control given(control);
    hmf_hierarchy_options all;
    BuildOptions build;
    const bool readable = read_build_options(options, all, build);
    Memory own(all.allocate, all.release, all.allocator_user, all.memory_limit);
    {
        Call call(own, error, nullptr, nullptr);
        if (!out)
            return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0,
                             "out is NULL. Give the address of a hierarchy pointer.");
        if (!given.usable) return unusable_options("hmf_control", call);
        if (!readable) return refuse_build_options(call);
        void* block = own.take(sizeof(hmf_hierarchy));
        if (!block) return call.out_of_memory();
        *out = new (block) hmf_hierarchy(all.allocate, all.release, all.allocator_user, all.memory_limit);
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
    hmf_hierarchy_options all;
    BuildOptions build;
    if (!read_build_options(options, all, build)) return 0;
    if (vertex_count == 0 || triangle_count == 0 || vertex_count > 0x7fffffff / 3 || triangle_count > 0x7fffffff / 3)
        return 0;
    return build_memory_bound(vertex_count, triangle_count, build) + sizeof(hmf_hierarchy);
}

} // extern "C"
