// The quadratic model of the direct method: the energy with the signs of the
// local potentials frozen.
//
// At a regular cluster (two directions, index 0) one direction is called +
// and the other -; half-edge h has the sign s_h of the direction it leaves in.
// Moving vertex i by d_i into its + direction changes the value of an edge to
//
//     F'_ij = | F_ij - s_ij d_i - s_ji d_j |
//
// and the energy sum alpha F'^2 is quadratic in d.  Zero edges inside a
// regular cluster get opposite signs at their two ends: F' = |d_i - d_j|.
// Vertices of other clusters (zeros) rest.  The model is exact while
//
//     s d_v <= a_v        at every corner of a tripod: stop at its branch point
//     s d_v <= F_vm       at every neighbour m that rests: stop there
//
// and no vertex becomes an extremum of the local potential.  A vertex that
// stops at a branch point rests there in its turn: its neighbours must not
// pass it, either.
#pragma once

#include "../foliation/whitehead.hpp"

namespace hmf {

struct TwistedModel {
    uint32_t count = 0;        // unknowns: one per vertex; those that rest have an empty row
    uint32_t resting = 0;      // vertices that rest
    Array<int8_t> sign;        // per half-edge; 0 where the origin rests
    Array<uint8_t> rests;      // per vertex
    Array<int8_t> product;     // per edge: of its two signs in the last model
    Array<int8_t> gauge;       // per vertex, and the queue: scratch of align_signs
    Array<uint32_t> queue;
    Array<uint32_t> offset;    // count + 1, rows of the matrix
    Array<uint32_t> column;    // off-diagonal entries
    Array<double> entry;
    Array<double> diagonal, right; // count
    Array<int64_t> lower, upper;   // count, bounds of d; INT64_MIN and INT64_MAX where there is none
    Array<double> d;               // count, the solution
    Array<int32_t> index;          // per vertex, before the step; a cluster's at one of its vertices
    Array<uint32_t> tripod;        // a half-edge of each, before the step

    bool allocate(const Mesh& mesh, Memory& memory);
    // Signs, matrix, right side and bounds of the current foliation.  Stops
    // half-way if the call is cancelled.
    void assemble(Foliation& f, const Rings& rings, const double* weight, Call* call = nullptr);
    // No zeros, hence no bounds: one step reaches the minimum.
    bool is_exact() const { return tripod.empty() && resting == 0; }
    // Brings d into the bounds and improves it near the bounds that are
    // active by projected Gauss-Seidel; returns the number of active bounds.
    uint64_t project(const Foliation& f, const Rings& rings, Array<uint32_t>& patch, Array<uint32_t>& distance);
    // Matrix and right side in which the unknowns at a bound have their value.
    void fix_active(Array<double>& fixed_entry, Array<double>& fixed_right) const;
    // Keeps the vertices within some rings of v where they are, and lets the
    // others take that over.
    void freeze(const Foliation& f, const Rings& rings, uint32_t v, uint32_t radius, Array<uint32_t>& patch, Array<uint32_t>& distance);
    // New value of d_v from its neighbours, within the bounds.
    double relaxed(uint32_t unknown_index) const;

private:
    void align_signs(const Mesh& mesh, const Rings& rings);
    bool at_bound(uint32_t k) const { return d[k] == static_cast<double>(lower[k]) || d[k] == static_cast<double>(upper[k]); }
    bool clip(uint32_t k);
    void rest(const Foliation& f, const Rings& rings, uint32_t k);
    void relax_around(const Foliation& f, const Rings& rings, Array<uint32_t>& patch, Array<uint32_t>& distance);
};

} // namespace hmf
