// Edges from a vertex to itself that bound a disk, as the intrinsic Delaunay
// triangulation has around the tip of a spike.
#pragma once

#include "../base/memory.hpp"
#include "mesh.hpp"

namespace hmf {

// All arrays are empty if no edge joins a vertex to itself.
struct Monogons {
    Array<uint8_t> edge;   // per edge: 1 if it bounds a monogon or lies in one
    Array<uint8_t> vertex; // per vertex: INSIDE, HOST, SELF_EDGE
    Array<uint32_t> edges; // those with edge[e] = 1, ascending

    static constexpr uint8_t INSIDE = 1;    // in the interior of a monogon
    static constexpr uint8_t HOST = 2;      // a monogon hangs on it, and it is not inside of another
    static constexpr uint8_t SELF_EDGE = 4; // has an edge to itself that bounds no disk, and is not inside

    Done find(const Mesh& mesh, Memory& memory);
};

} // namespace hmf
