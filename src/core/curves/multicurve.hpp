// Normal multicurves: disjoint simple closed curves that cross every triangle
// in arcs from side to side.  They are determined by one number per edge, how
// often they cross it; each triangle then has
//
//              k
//             /_\            x_i = (n_ij + n_ki - n_jk) / 2
//            /   \           arcs round corner i, the others likewise
//           /\   /\          (here 1, 1, 1)
//          i--|-|--j
//
// Crossings of edge e are numbered first[e], first[e] + 1, .. from the origin
// of half-edge 2e.
#pragma once

#include "loops.hpp"

namespace hmf {

// More crossings than this are refused, so that all numbers fit 32 bits.
constexpr uint64_t MULTICURVE_LIMIT = uint64_t{1} << 29;

struct Multicurve {
    Array<uint32_t> count; // per edge
    Array<uint32_t> first; // per edge; after trace, where count > 0
    Array<uint32_t> edges; // those with count > 0
    uint64_t total = 0;    // crossings
    // After trace.
    Array<uint32_t> strand; // per crossing: 2 * component, + 1 if it leaves through half-edge 2e + 1
    Loops components;
    Array<uint32_t> begin; // per component: its first crossing, left through half-edge 2e

    Done allocate(const Mesh& mesh, Memory& memory);
    Done add(const uint32_t* half_edges, size_t n);
    void clear();
    bool is_normal(const Mesh& mesh) const;   // corner counts are integers >= 0
    Done trace(const Mesh& mesh, Call& call); // needs is_normal
    // From the crossing at place p (from the origin of half-edge h) that leaves through h to the next one.
    void step(const Mesh& mesh, uint32_t& h, uint32_t& p) const;
};

} // namespace hmf
