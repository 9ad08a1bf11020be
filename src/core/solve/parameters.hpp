// The numbers of Newton's method. None of them decides whether a result is right: every step is checked, and every
// result has its residual and its certificate. They decide how long a solve takes, and whether it stalls.
// bench/steering.md says what each is worth, bench/steering.py measures it. "guard": no mesh reaches this bound.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hmf {
namespace parameters {

// --- Levels --------------------------------------------------------------------

// The coarsest level is solved until no step meets a bound and it is CLOSE, not by MIDDLE_ROUNDS, if it has at most
// this share of the vertices: 1 / COARSEST_SHARE.
constexpr uint64_t COARSEST_SHARE = 8;
// Residual of a start for the next level, and below which a minimum is near. Accuracy of a linear solve while zeros
// move: a higher one is useless, because the model changes. Moves of a vertex, as a share of the residual, that are no
// reason to move its neighbors again.
constexpr double CLOSE = 1e-2;
constexpr uint32_t LEVEL_ROUNDS = 1000; // guard
constexpr uint32_t MIDDLE_ROUNDS = 3;   // of a level that only provides a start

// --- Linear solves -------------------------------------------------------------

// Once the zeros are in place, a solve may stop when the residual is this share of the tolerance.
constexpr double RESIDUAL_SHARE = 0.5;
// An exact solve: about the precision of doubles.
constexpr double TIGHTEST = 1e-13;
// Values on protrusions that no loop goes around decay below the error of a solve. The solve is continued with its
// tolerance multiplied by this factor.
constexpr double CONTINUED = 1e-4;

// --- Progress, and the ladder (newton.cpp) ---------------------------------------

// Progress: the residual is this share of the least of the level. Also for other quantities that have to get less.
constexpr double PROGRESS = 0.5;
// Rounds without progress, after which a level has stalled.
constexpr uint32_t PATIENCE = 4;
// The same after a whole step that met a bound at first: a zero on a ring of heavy edges passes one of them per round.
constexpr uint32_t PATIENCE_AT_BOUNDS = 60;
constexpr uint32_t EXACT_STEPS = 2; // at a stall
constexpr uint32_t STALLS = 8;      // after which the level is given up

// --- A step that fails (newton_step.cpp) -------------------------------------------

constexpr uint32_t STEP_ATTEMPTS = 24; // guard

// --- Moves of single vertices ------------------------------------------------------

// Before the first step of a level, or of the coarsest one. Also after steps that were shortened, and after all but the
// first steps: zeros of stretched spheres with marked vertices have far to go.
constexpr uint32_t SWEEPS = 1, COARSEST_SWEEPS = 3, FIRST_STEPS = 2;
// After each step: vertices within these rings of the zeros.
constexpr uint32_t NEAR_RINGS = 6;
// Around bounds that are active: rings of unknowns that are solved for again.
constexpr uint32_t BOUND_RINGS = 8;
// Passes over such vertices; few if they are most of the level.
constexpr uint32_t NEAR_PASSES = 20, FEW_PASSES = 4;
constexpr double MOST = 0.75;
inline bool are_most(size_t picked, size_t all) {
    return static_cast<double>(picked) > MOST * static_cast<double>(all);
}
inline size_t local_passes(size_t picked, size_t all) { return are_most(picked, all) ? FEW_PASSES : NEAR_PASSES; }
// Vertices or steps that a search around a cluster may visit; of all searches of a sweep together, per vertex.
constexpr uint32_t SEARCH_BUDGET = 8192, CREDIT_PER_VERTEX = 4;

} // namespace parameters
} // namespace hmf
