// The library's objects and results, given back by themselves.
#pragma once

#include <hmf/hmf.h>
#include <hmf/applications.h>

#include <memory>
#include <string>

#include "failure.hpp"

namespace cli {

struct GiveBack {
    void operator()(hmf_hierarchy* hierarchy) const { hmf_hierarchy_destroy(hierarchy); }
    void operator()(hmf_foliation* foliation) const { hmf_foliation_destroy(foliation); }
    void operator()(const void* result) const { hmf_free(result); }
};
template <class T>
using Owned = std::unique_ptr<T, GiveBack>;

inline void check(hmf_status status, const hmf_error& error, const std::string& subject) {
    if (status != HMF_OK) fail_with(status, error, subject);
}

// call(T** out, hmf_error*) makes one result of the library.  Throws Failure.
template <class T, class Call>
Owned<T> make(const std::string& subject, Call call) {
    T* raw = nullptr;
    hmf_error error{};
    const hmf_status status = call(&raw, &error);
    Owned<T> result(raw);
    check(status, error, subject);
    return result;
}

} // namespace cli
