// Marked vertices get the first internal numbers.
#pragma once

#include "../base/memory.hpp"

namespace hmf {

// Renumbers vertex_internal and position (3 per vertex), which are as
// order_vertices left them: marked vertices first, all else in the old order.
// marked: `count` of the caller's vertices.  Refuses vertices that do not exist
// or come twice.
[[nodiscard]] hmf_status put_marked_first(const uint32_t* marked, uint64_t count, size_t vertex_count,
                                          uint32_t* vertex_internal, double* position, Call& call);

} // namespace hmf
