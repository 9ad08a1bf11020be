// Lists of elements of level 0 by the numbers of the caller.
#pragma once

#include "../../core/hierarchy/caller_numbers.hpp"

namespace hmf {

// Internal face of each triangle of the caller.
[[nodiscard]] hmf_status caller_faces(const hmf_hierarchy& h, Array<uint32_t>& face, Call& call);

// The caller's triangle on the left of each half-edge of level 0, a few of all.
[[nodiscard]] hmf_status caller_triangles(const hmf_hierarchy& h, const Array<uint32_t>& half_edges,
                                          Array<uint32_t>& triangles, Call& call);

// caller[internal[i]] = i
[[nodiscard]] hmf_status inverse_numbers(const uint32_t* internal, size_t count, Array<uint32_t>& caller, Call& call);

} // namespace hmf
