// The half-edges out of every vertex, one star after the other:
//
//     offset:   0        5           11 ...
//     half_edge | star 0 |  star 1    | ...      counter-clockwise from out[v]
//
// A walk over it does not wait for each half-edge to know the next one, which is
// most of the time of a walk over a mesh that does not fit into the caches.
#pragma once

#include "../../core/mesh/mesh.hpp"

namespace hmf {

struct Stars {
    Array<uint32_t> offset;    // vertex_count + 1
    Array<uint32_t> half_edge; // 2 * edge_count

    Done build(const Mesh& mesh, Call& call);

    // A pass over the vertices prefetches the data of the vertex that is this far ahead.
    static constexpr uint32_t AHEAD = 8;

    struct Star {
        const uint32_t *first, *last;
        const uint32_t* begin() const { return first; }
        const uint32_t* end() const { return last; }
        uint32_t size() const { return static_cast<uint32_t>(last - first); }
        uint32_t operator[](uint32_t t) const { return first[t]; }
        // The next half-edge counter-clockwise.
        uint32_t after(uint32_t t) const { return t + 1 < size() ? first[t + 1] : first[0]; }
    };
    Star of(uint32_t v) const { return {half_edge.data() + offset[v], half_edge.data() + offset[v + 1]}; }
};

} // namespace hmf
