#include "entry.hpp"

namespace hmf {

hmf_status unusable_options(const char* name, Call& call) {
    return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                     "%s has an unusable struct_size, or a field that this version does not know. Set struct_size to "
                     "sizeof(%s) and every other field to 0 first.",
                     name, name);
}

Entry::Entry(const hmf_hierarchy* h, const hmf_control* control, hmf_error* error, bool can_finish) :
    control_(control), error_(error),
    memory(h ? h->allocate : nullptr, h ? h->release : nullptr, h ? h->allocator_user : nullptr,
           h ? h->memory_limit : 0, h ? h->memory.used() : 0),
    call(memory, error, control_.given) {
    memory.keep_arrays();
    if (!can_finish) call.never_finish();
}

hmf_status Entry::end() {
    if (call.status()) return call.status();
    call.finished();
    return HMF_OK;
}

hmf_status Entry::check(const hmf_hierarchy* hierarchy, const void* out) {
    if (!control_.usable) return unusable_options("hmf_control", call);
    if (!hierarchy)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0,
                         "The object is NULL. Make a hierarchy with hmf_hierarchy_create, a foliation with hmf_solve.");
    if (!out)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0,
                         "The output is NULL. Give the address of what the call is to write.");
    return HMF_OK;
}

hmf_status check_level(const hmf_hierarchy& hierarchy, size_t level, Call& call) {
    if (level < hierarchy.level_count) return HMF_OK;
    return call.fail(HMF_ERROR_LEVEL, HMF_ELEMENT_LEVEL, level,
                     "There is no level %llu; the hierarchy has %llu, counted from 0.",
                     static_cast<unsigned long long>(level), static_cast<unsigned long long>(hierarchy.level_count));
}

hmf_status check_count(size_t count, size_t needed, const char* what, Call& call) {
    if (count == needed) return HMF_OK;
    return call.fail(HMF_ERROR_COUNT, HMF_ELEMENT_NONE, needed, "%s has %llu entries but the level has %llu.", what,
                     static_cast<unsigned long long>(count), static_cast<unsigned long long>(needed));
}

} // namespace hmf
