#include "marked_vertices.hpp"

namespace hmf {

hmf_status find_marked(const uint32_t* marked, uint64_t count, size_t vertex_count, const uint32_t* number,
                       Array<uint8_t>& is_marked, Call& call) {
    using Long = unsigned long long;
    if (count > 0 && !marked)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0,
                         "marked_vertices is NULL, but marked_count is %llu. Give as many vertices.",
                         static_cast<Long>(count));
    if (!is_marked.allocate_filled(call.memory, vertex_count, uint8_t{0})) return call.out_of_memory();
    for (uint64_t n = 0; n < count; ++n) {
        if (marked[n] >= vertex_count)
            return call.fail(HMF_ERROR_MESH_INDEX, HMF_ELEMENT_NONE, n,
                             "Marked vertex %llu is %u, but there are %llu vertices. Indices start at 0.",
                             static_cast<Long>(n), marked[n], static_cast<Long>(vertex_count));
        uint8_t& mark = is_marked[number ? number[marked[n]] : marked[n]];
        if (mark)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_VERTEX, marked[n],
                             "Vertex %u is marked twice. Name each marked vertex once.", marked[n]);
        mark = 1;
    }
    return HMF_OK;
}

hmf_status put_marked_first(const uint32_t* marked, uint64_t count, size_t vertex_count, uint32_t* vertex_internal,
                            double* position, Call& call) {
    if (count == 0) return HMF_OK;
    Array<uint8_t> is_marked; // by number in space
    Array<uint32_t> number;
    if (find_marked(marked, count, vertex_count, vertex_internal, is_marked, call)) return call.status();
    if (!number.allocate(call.memory, vertex_count)) return call.out_of_memory();
    uint32_t marks = 0, others = static_cast<uint32_t>(count);
    for (size_t v = 0; v < vertex_count; ++v) number[v] = is_marked[v] ? marks++ : others++;
    // The marked ones are put aside; the others only move up, so the last goes first.
    Array<double> aside;
    if (!aside.allocate(call.memory, size_t{3} * marks)) return call.out_of_memory();
    for (size_t v = 0; v < vertex_count; ++v)
        for (size_t c = 0; c < 3 && is_marked[v]; ++c) aside[size_t{3} * number[v] + c] = position[3 * v + c];
    for (size_t v = vertex_count; v-- > 0;)
        for (size_t c = 0; c < 3 && !is_marked[v]; ++c) position[size_t{3} * number[v] + c] = position[3 * v + c];
    for (size_t n = 0; n < aside.size(); ++n) position[n] = aside[n];
    for (size_t v = 0; v < vertex_count; ++v) vertex_internal[v] = number[vertex_internal[v]];
    return HMF_OK;
}

} // namespace hmf
