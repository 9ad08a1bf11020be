// Every structural invariant of the edge-index mesh.
#pragma once

#include "../../src/core/mesh/mesh.hpp"

namespace hmf {

// NULL, or a sentence that says what is wrong.
inline const char* check(const Mesh& mesh) {
    if (mesh.vertex_count == 0 || mesh.edge_count == 0 || mesh.face_count == 0) return "a count is zero";
    const uint32_t sides = 2 * mesh.edge_count;
    if (sides != 3 * mesh.face_count) return "the numbers of edges and faces do not fit together";
    // Every face must own one triangle. They are compared by sums of numbers and of squares, so that no memory is
    // needed.
    uint64_t sum = 0, squares = 0, triangles = 0;
    for (uint32_t h = 0; h < sides; ++h) {
        const uint32_t a = mesh.next[h];
        if (a >= sides || mesh.next[a] >= sides) return "next is out of range";
        const uint32_t b = mesh.next[a];
        if (a == h || b == h || mesh.next[b] != h) return "next does not turn around a triangle";
        if (mesh.face[h] >= mesh.face_count || mesh.face[a] != mesh.face[h])
            return "the sides of a triangle disagree about the face";
        if (mesh.origin[h] >= mesh.vertex_count || mesh.origin[a] != mesh.origin[twin(h)])
            return "a half-edge does not start where the one before ends";
        if (h < a && h < b) {
            const uint64_t f = mesh.face[h];
            sum += f;
            squares += f * f;
            ++triangles;
        }
    }
    for (uint64_t f = 0; f < mesh.face_count; ++f) {
        sum -= f;
        squares -= f * f;
    }
    if (triangles != mesh.face_count || sum != 0 || squares != 0) return "the numbering of the faces has gaps";
    // Fans of different vertices are disjoint; together they must be everything.
    uint64_t reached = 0;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        const uint32_t first = mesh.out[v];
        if (first >= sides || mesh.origin[first] != v) return "out does not start at its vertex";
        for (const uint32_t h : mesh.around(v)) {
            if (mesh.origin[h] != v) return "a fan contains a half-edge of another vertex";
            if (++reached > sides) break;
        }
    }
    if (reached != sides) return "a vertex has several fans";
    return nullptr;
}

} // namespace hmf
