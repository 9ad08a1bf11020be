// The flat surface of a foliation.  It takes two linear solves and several applications need it, so it is
// computed once and kept.
#pragma once

#include "../parameterize/flat_cone_metric.hpp"
#include "../../core/api/foliation_object.hpp"

namespace hmf {

// A solve left it with residuals of 1e-8 at most: what is measured there needs
// no further step.
inline bool is_minimum(const hmf_foliation& foliation) {
    const double residual = foliation.has_report ? foliation.report.residual_max : 1;
    return residual >= 0 && residual <= 1e-8;
}

// Its values where it is solved (load_solved), in the unit of the values: what leaves are followed on.
[[nodiscard]] hmf_status load_solved_in_unit_of_values(const hmf_foliation& foliation, State& state, Call& call);

struct SharedFlat : Kept {
    Memory memory;
    FlatConeMetric flat; // on the caller's side of the level
    // used: what counts towards the limit beside it.
    SharedFlat(const hmf_hierarchy& h, uint64_t used);
};

// The flat surface that is kept with a foliation whose residual is at most 1e-8; out is NULL for others, because their
// flat surface depends on how they are improved first. Any number of threads may call this: one result is kept, the
// others are freed.
[[nodiscard]] hmf_status shared_flat(const hmf_foliation& foliation, Entry& entry, const FlatConeMetric*& out);

} // namespace hmf
