// Numbers by level, so that the arrays of a coarse level are prefixes of those
// of a finer one:
//
//     | coarsest | removed between n-1 and n | ... | removed between 0 and 1 |
//     |<-- level n -->|
//     |<---------- level n-1 -------------->| ...
#include "renumber.hpp"

namespace hmf {

namespace {

// Survivors from 0, removed ones from kept; both keep their order.  Which is
// which cannot be predicted, so there is no branch: masks choose.
uint32_t choose(uint32_t mask, uint32_t ones, uint32_t zeros) { return (ones & mask) | (zeros & ~mask); }

template <class Removed>
void number_elements(uint32_t end, uint32_t kept, uint32_t* number, Removed removed) {
    uint32_t survivors = 0;
    for (uint32_t x = 0; x < end; ++x) {
        const uint32_t gone = removed(x);
        number[x] = choose(0 - gone, kept + x - survivors, survivors);
        survivors += 1 - gone;
    }
}

void compose_elements(uint32_t count, uint32_t kept, uint32_t* number, const uint32_t* coarser) {
    for (uint32_t x = 0; x < count; ++x) {
        const uint32_t here = number[x], stays = 0 - static_cast<uint32_t>(here < kept);
        number[x] = choose(stays, coarser[here & stays], here);
    }
}

uint32_t renumbered_side(const uint32_t* edge, uint32_t h) { return 2 * edge[edge_of(h)] + (h & 1u); }

} // namespace

void number_level(const WorkMesh& work, const Collapse* records, size_t record_count, const Numbering& out) {
    const Mesh& mesh = work.mesh;
    number_elements(work.vertex_end, mesh.vertex_count, out.vertex, [&](uint32_t v) { return mesh.out[v] == NONE; });
    number_elements(work.edge_end, mesh.edge_count, out.edge, [&](uint32_t e) { return work.removed(e); });
    for (uint32_t f = 0; f < work.face_end; ++f) out.face[f] = 0;
    for (size_t n = 0; n < record_count; ++n) out.face[records[n].face_left] = out.face[records[n].face_right] = NONE;
    number_elements(work.face_end, mesh.face_count, out.face, [&](uint32_t f) { return out.face[f] == NONE; });
}

void compact(WorkMesh& work, const Numbering& numbers) {
    // In place: no number rises.  What stays cannot be predicted; each element is
    // written to the next free number, and the next one overwrites a removed one.
    Mesh& mesh = work.mesh;
    for (uint32_t e = 0, to = 0; e < work.edge_end; ++e) {
        const uint32_t stays = !work.removed(e);
        for (uint32_t side = 0; side < 2; ++side) {
            const uint32_t h = 2 * e + side, face = mesh.face[h] & (0 - stays); // no face at all: any
            mesh.origin[to + side] = numbers.vertex[mesh.origin[h]];
            mesh.next[to + side] = renumbered_side(numbers.edge, mesh.next[h]);
            mesh.face[to + side] = numbers.face[face];
        }
        to += 2 * stays;
    }
    for (uint32_t v = 0, to = 0; v < work.vertex_end; ++v) {
        const uint32_t stays = mesh.out[v] != NONE;
        mesh.out[to] = renumbered_side(numbers.edge, mesh.out[v] & (0 - stays));
        work.degree[to] = work.degree[v];
        for (int c = 0; c < 3; ++c) work.at(to)[c] = work.at(v)[c];
        if (!work.quadrics.empty()) work.quadrics[to] = work.quadrics[v];
        to += stays;
    }
    work.vertex_end = mesh.vertex_count;
    work.edge_end = mesh.edge_count;
    work.face_end = mesh.face_count;
}

void compose(const Level& level, const Numbering& numbers, const Level& coarser_level, const Numbering& coarser) {
    compose_elements(level.mesh.vertex_count, coarser_level.mesh.vertex_count, numbers.vertex, coarser.vertex);
    compose_elements(level.mesh.edge_count, coarser_level.mesh.edge_count, numbers.edge, coarser.edge);
    compose_elements(level.mesh.face_count, coarser_level.mesh.face_count, numbers.face, coarser.face);
}

void renumber_collapses(Collapse* collapses, size_t count, const Numbering& numbers) {
    for (size_t n = 0; n < count; ++n) {
        Collapse& c = collapses[n];
        uint32_t* const half_edges[5] = {&c.h, &c.jk, &c.lj, &c.ki, &c.il};
        for (uint32_t* h : half_edges) *h = renumbered_side(numbers.edge, *h);
        c.vertex = numbers.vertex[c.vertex];
        c.face_left = numbers.face[c.face_left];
        c.face_right = numbers.face[c.face_right];
    }
}

} // namespace hmf
