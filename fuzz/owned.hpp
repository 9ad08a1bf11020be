// Objects of the C interface that free themselves, and structures that know their size.
#pragma once

#include <hmf/hmf.h>
#include <hmf/applications.h>

#include <memory>

namespace fuzz {

struct Delete {
    void operator()(const hmf_hierarchy* hierarchy) const {
        hmf_hierarchy_destroy(const_cast<hmf_hierarchy*>(hierarchy));
    }
    void operator()(const hmf_foliation* foliation) const {
        hmf_foliation_destroy(const_cast<hmf_foliation*>(foliation));
    }
    void operator()(const void* result) const { hmf_free(result); }
};
template <class T>
using Owned = std::unique_ptr<const T, Delete>;

template <class T>
T sized() {
    T structure{};
    structure.struct_size = sizeof structure;
    return structure;
}

} // namespace fuzz
