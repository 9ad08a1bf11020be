// The foliation of the interface: the caller's values, and on level 0 the
// integers on the intrinsic triangulation, where it was solved.
//
//     solve, relax --> state on the intrinsic side --copy--> solved
//                          | reversed flips
//                          v
//                      state on the caller's side ----------> values = integers * unit
//
// Where doubles are too short for the residual (triangles of extreme aspect),
// the solved integers have more bits than the values: solved_bits.
//
// One block (result.hpp), immutable.  It holds on to its hierarchy.
#pragma once

#include "../solve/solve.hpp"
#include "result.hpp"

namespace hmf {

// Base of what an application computes from a foliation and keeps with it.
struct Kept {
    uint64_t bytes;
    void (*destroy)(Kept* kept, const hmf_hierarchy& hierarchy);
};

} // namespace hmf

struct hmf_foliation {
    const hmf_hierarchy* hierarchy;
    size_t level;
    double unit;            // a power of two; values are integers of it below 2^53
    uint64_t count;         // edges of the level; of a double with its back, which the caller does not see
    const double* values;   // count, in the caller's order
    const int64_t* solved;  // count, internal order, intrinsic side of level 0; NULL: the same as the values
    uint64_t solved_bits;   // the unit of `solved` is that of the values / 2^solved_bits; heights are multiples of
                            // that of the values
    const double* fraction; // vertices of the level, beyond the integers of `solved` (fraction.hpp); NULL: none
    uint64_t poles;         // of the values; only foliations of the caller have any
    uint64_t bytes;         // of its block
    uint64_t has_report;    // 1 or 0
    hmf_report report;
    mutable std::atomic<hmf::Kept*> kept; // NULL until an application needs it
};

namespace hmf {

// What make_foliation needs beside the values of a state.
struct FoliationData {
    double unit = 1; // of the state
    uint64_t poles = 0;
    const int64_t* solved = nullptr; // in a unit that is 2^solved_bits times finer
    uint32_t solved_bits = 0;
    const double* fraction = nullptr; // of the vertices of the level, or NULL
    const SolveLog* log = nullptr;    // NULL: no report
};

// The values of a state on its level (level 0: the caller's side) as an object.
// Fails if a value has more bits than a double.
[[nodiscard]] hmf_status make_foliation(const State& state, const FoliationData& data, Call& call, hmf_foliation** out);

// The foliation is there, and has no poles.
[[nodiscard]] hmf_status check_foliation(const hmf_foliation* foliation, Call& call);

// Its values into a state on its level, the caller's side on level 0; the
// state has room down to level `finest`.
[[nodiscard]] hmf_status load_values(const hmf_foliation& foliation, size_t finest, State& state, Call& call);
// The same on the side where it is solved: what to measure and improve, in a unit of its own, given back.
[[nodiscard]] hmf_status load_solved(const hmf_foliation& foliation, State& state, double& unit, Call& call);

// The values of a state in a unit that is 2^bits times as large (coarser_unit.hpp);
// all heights must be multiples of it.
[[nodiscard]] hmf_status coarsen_unit(State& state, uint32_t bits, Call& call);

[[nodiscard]] hmf_status refuse_poles(uint64_t poles, Call& call);

// Internal number of an edge of the caller.
inline uint32_t internal_edge(const hmf_hierarchy& h, size_t level, size_t e) {
    return level == 0 ? h.edge_internal[e] : static_cast<uint32_t>(e);
}

} // namespace hmf
