// Sub-unit corrections. A value has at most 60 bits. Beside a needle or a cap, where weights are a million times those
// of the neighbors, a change of one unit can cause a residual above 1e-8. Then each vertex gets a correction by a
// fraction of a unit: the real foliation
//
//     F'_ij = | F_ij - s_ij d_i - s_ji d_j |        (twisted_model.hpp)
//
// has the required residual and is in the class of the integers. Counts and leaves are still those of the integers.
//
// A regular vertex may move by several units, as in a step of Newton's method. A vertex at a zero moves by less than
// one, as in a Whitehead move: branch points and other vertices are at integer distances, so it meets none of them.
#pragma once

#include "../solve/solve.hpp"
#include "../solve/twisted_model.hpp"

namespace hmf {

// After HMF_LIMIT_STALLED on the stop level: if quantization is the reason, corrections reach the tolerance. Then
// HMF_OK, with the certificate and the corrections in the log. Otherwise HMF_LIMIT_CLASS if steps needed a certificate,
// or HMF_LIMIT_STALLED.
[[nodiscard]] hmf_status correct_below_unit(State& state, const SolveOptions& options, const ClassGuard& guard,
                                            Call& call, SolveLog& log);

// part: d of each vertex, into its + direction as chosen by a new TwistedModel of this foliation. If found.max exceeds
// goal, no corrections help, and part is unspecified.
[[nodiscard]] hmf_status find_fractions(LevelWork& work, double goal, Array<double>& part, ResidualResult& found);

// The residual of [W] Eq. 4 of F' at each vertex; residual may be NULL.
[[nodiscard]] hmf_status residuals_with_fractions(Foliation& f, const Rings& rings, const double* weight,
                                                  const double* part, Star& star, double* residual, Call& call,
                                                  ResidualResult& found);

// Tests that no edge at a zero or at a fixed vertex is reversed, and that each vertex with reversed edges or
// opened edges of value 0 keeps an unreversed edge in both of its directions. Then no vertex becomes an extremum at any
// time of the step (docs/mathematics.md, section 8). Vertices joined by edges that stay 0 count as one.
Done keeps_class(const Foliation& f, const Rings& rings, const TwistedModel& model, const double* part, Memory& memory,
                 bool& keeps);

} // namespace hmf
