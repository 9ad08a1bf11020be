// Numbers by level, so that the arrays of a coarse level are prefixes of those
// of a finer one:
//
//     | coarsest | removed between n-1 and n | ... | removed between 0 and 1 |
//     |<-- level n -->|
//     |<---------- level n-1 -------------->| ...
#include "renumber.hpp"

namespace hmf {

namespace {

// level[x]: last level that has x -> new numbers, in place of nothing else.
template <class Count>
void assign(const Array<uint16_t>& level, const Level* levels, size_t level_count, Array<uint32_t>& next, Array<uint32_t>& number, Count count) {
    for (size_t k = 0; k < level_count; ++k) next[k] = k + 1 < level_count ? count(levels[k + 1].mesh) : 0;
    for (size_t x = 0; x < level.size(); ++x) number[x] = next[level[x]]++;
}

} // namespace

hmf_status number_by_level(const Level* levels, size_t level_count, const Collapse* collapses, Numbering& out, Call& call) {
    const Mesh& fine = levels[0].mesh;
    const uint16_t coarsest = static_cast<uint16_t>(level_count - 1);
    Array<uint16_t> vertex, edge, face;
    Array<uint32_t> next;
    if (!vertex.allocate_filled(call.memory, fine.vertex_count, coarsest) || !edge.allocate_filled(call.memory, fine.edge_count, coarsest)
        || !face.allocate_filled(call.memory, fine.face_count, coarsest) || !next.allocate(call.memory, level_count)
        || !out.vertex.allocate(call.memory, fine.vertex_count) || !out.edge.allocate(call.memory, fine.edge_count)
        || !out.face.allocate(call.memory, fine.face_count))
        return call.out_of_memory();
    for (size_t k = 0; k < level_count; ++k)
        for (size_t n = levels[k].collapse_begin; n < levels[k].collapse_end; ++n) {
            const Collapse& c = collapses[n];
            const uint16_t here = static_cast<uint16_t>(k);
            vertex[c.vertex] = here;
            edge[edge_of(c.h)] = edge[edge_of(c.jk)] = edge[edge_of(c.lj)] = here;
            face[c.face_left] = face[c.face_right] = here;
        }
    assign(vertex, levels, level_count, next, out.vertex, [](const Mesh& m) { return m.vertex_count; });
    assign(edge, levels, level_count, next, out.edge, [](const Mesh& m) { return m.edge_count; });
    assign(face, levels, level_count, next, out.face, [](const Mesh& m) { return m.face_count; });
    return HMF_OK;
}

void renumber_log(Collapse* collapses, size_t collapse_count, uint32_t* flips, size_t flip_count, const Numbering& numbers) {
    for (size_t n = 0; n < collapse_count; ++n) {
        Collapse& c = collapses[n];
        uint32_t* const half_edges[5] = {&c.h, &c.jk, &c.lj, &c.ki, &c.il};
        for (uint32_t* h : half_edges) *h = renumbered_side(numbers.edge, *h);
        c.vertex = numbers.vertex[c.vertex];
        c.face_left = numbers.face[c.face_left];
        c.face_right = numbers.face[c.face_right];
    }
    for (size_t n = 0; n < flip_count; ++n) flips[n] = numbers.edge[flips[n]];
}

} // namespace hmf
