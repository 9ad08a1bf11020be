// Marked vertices get the first internal numbers.
#pragma once

#include "../base/memory.hpp"

namespace hmf {

// Refuses marked vertices that do not exist or come twice.  number: of each of the
// caller's vertices, NULL = as it is.  is_marked: vertex_count, by that number.
[[nodiscard]] hmf_status find_marked(const uint32_t* marked, uint64_t count, size_t vertex_count,
                                     const uint32_t* number, Array<uint8_t>& is_marked, Call& call);

// Renumbers vertex_internal and position (3 per vertex), which are as
// order_vertices left them: marked vertices first, all else in the old order.
// marked: `count` of the caller's vertices, checked as above.
[[nodiscard]] hmf_status put_marked_first(const uint32_t* marked, uint64_t count, size_t vertex_count,
                                          uint32_t* vertex_internal, double* position, Call& call);

} // namespace hmf
