// Beyond the last bit.  A value has at most 60 bits.  Beside a needle or a cap, where weights are a million times
// those of the neighbors, one unit more or less can be a residual above 1e-8.  Then each vertex gets a part of a
// unit more: the real foliation
//
//     F'_ij = | F_ij - s_ij d_i - s_ji d_j |        (twisted_model.hpp)
//
// has the residual that is asked for, and is in the class of the integers.  What is counted and followed stays with the
// integers.
//
// A regular vertex may go by some units, as in a step of Newton's method.  A vertex at a zero goes by less than one, as
// in a Whitehead move: branch points and other vertices are at integer distances, so none is on its way.
#pragma once

#include "solve.hpp"
#include "twisted_model.hpp"

namespace hmf {

// part: d of each vertex, into its + direction as a TwistedModel calls it that has seen no other foliation.
// found.max is at most goal, or there are none that help, and part means nothing.
[[nodiscard]] hmf_status find_fractions(LevelWork& work, double goal, Array<double>& part, ResidualResult& found);

// The residual of [W] Eq. 4 of F' at each vertex; residual may be NULL.
[[nodiscard]] hmf_status residuals_with_fractions(Foliation& f, const Rings& rings, const double* weight,
                                                  const double* part, Star& star, double* residual, Call& call,
                                                  ResidualResult& found);

// No edge at a zero, or at a vertex that rests, is reversed; where edges of a vertex are, or such of value 0 open, it
// keeps an edge that is not in both of its directions: so none becomes an extremum, on the way either
// (docs/mathematics.md, section 8).  What edges of value 0 that do not open hold together counts as one vertex.
Done keeps_class(const Foliation& f, const Rings& rings, const TwistedModel& model, const double* part, Memory& memory,
                 bool& keeps);

} // namespace hmf
