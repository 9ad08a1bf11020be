// The numbers that control the cascade and Newton's method: when to continue, how accurately to solve, when to give up.
// None of them affects correctness: every step is checked, and every result has its residual and its certificate. They
// affect the time. bench/steering.md has the measurements, and bench/steering.py repeats them. "guard": a bound of a
// loop that no mesh of the corpus reaches.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hmf {
namespace steering {

// How far a level is solved: the finest to the caller's tolerance. The coarsest so far that the zeros are in place, if
// the finest has at least COARSEST_SHARE times as many edges. The others only give a start for the next level.
constexpr double COARSEST_RESIDUAL = 1e-8;
constexpr uint64_t COARSEST_SHARE = 8;
constexpr double MIDDLE_RESIDUAL = 1e-2;
// Sufficient if no bound was active in the last step, i.e. the zeros are in place.
constexpr double COARSEST_RESIDUAL_IN_PLACE = 1e-4;
// Used if that level takes long and zeros are nearly everywhere, as on a small mesh with a hundred handles.
constexpr double COARSEST_RESIDUAL_OF_MANY = 0.3;
constexpr uint32_t FINEST_ROUNDS = 1000; // guard: ends when there is no progress, see patience
constexpr uint32_t COARSEST_ROUNDS = 40;
constexpr uint32_t MIDDLE_ROUNDS = 3;
// Sweeps of single moves before the first model.
constexpr uint32_t COARSEST_SWEEPS = 3;
constexpr uint32_t FINER_SWEEPS = 1;
// A round counts as progress if it halves the best residual, or lowers the energy by this relative amount.
constexpr double LESS_RESIDUAL = 0.5;
constexpr double LESS_ENERGY = 1e-9;
constexpr uint32_t PATIENCE = 12; // rounds without progress, after which a level has stalled
// After this many rounds without progress a test decides whether rounding limits convergence. If the unit cannot be
// refined, the level counts as stalled earlier.
constexpr uint32_t ROUNDS_BEFORE_FINER = 3;
constexpr uint32_t PATIENCE_WHEN_ROUNDED = 4;
// The patience if the last step met a bound: a zero on a ring of heavy edges passes one of them per round.
constexpr uint32_t PATIENCE_WITH_ZEROS = 60;
// How often a stalled level continues after precise steps and moves of its zeros.
constexpr uint32_t STALLS = 8;

// Residual below which the minimum is near, and a whole step is worth its cost.
constexpr double CLOSE_RESIDUAL = 1e-2;
// Relative accuracy of the linear solves while zeros move: in the first round, and in the next ones. Higher accuracy is
// useless, because the model changes.
constexpr double LOOSE_ACCURACY = 1e-2;
// Accuracy once the zeros are in place: this share of the ratio of tolerance and residual, within limits. Usually the
// goal for the residual is met first, a share of the tolerance. A large step changes the pulls by which the residual is
// divided.
constexpr double TIGHTEST = 1e-12;
constexpr double RESIDUAL_SHARE = 0.5;
// Steps before sub-unit corrections are computed: to the minimum, whatever the residual.
constexpr uint32_t PRECISE_STEPS = 2;
// Values on limbs that no loop goes around decay below the error of a solve. The solve is continued with its tolerance
// multiplied by this factor, down to the precision of doubles.
constexpr double CONTINUED = 1e-4;
constexpr double END_OF_DOUBLES = 1e-13;

// A vertex is fixed at a bound if its pull is balanced up to this share, well above the error of a loose solve near the
// minimum.

// A step that fails is repeated with the vertices within some rings of the failure fixed. There is one ring more every
// WIDEN_EVERY attempts; after MENDING_ATTEMPTS the whole step is halved.
constexpr uint32_t STEP_ATTEMPTS = 24; // guard
constexpr uint32_t FIRST_RINGS_HELD = 2;
constexpr uint32_t WIDEN_EVERY = 4;
// An increase of the energy below this share is rounding. Up to the second one, a solve between the bounds may remove
// it.
constexpr double ROUNDING_OF_ENERGY = 1e-17;
constexpr double RISE_GETS_LESS = 0.7; // required for another solve
// After this many shortened steps in a row, the next one is solved again whenever its energy increases.
constexpr uint32_t FAILURES = 2;

// Single moves near the zeros after a step: rings and passes. A zero that has not arrived after some rounds moves far,
// in a region where the foliation is nearly 0.
constexpr uint32_t NEAR_RINGS = 3, NEAR_PASSES = 20;
// After the first pass a vertex is moved again only if it or a neighbor moved by more than this share of the residual.
constexpr double NEGLIGIBLE_MOVE = 1e-3;
// If zeros are nearly everywhere: at most this many moves for each vertex of the level, or this many passes.
constexpr uint32_t MOVES_PER_VERTEX = 8, LEAST_PASSES = 4;
constexpr double EVERYWHERE = 0.75; // of the vertices are picked: LEAST_PASSES
// Sweeps over all vertices after a step that was shortened, and after late ones.
constexpr uint32_t LATE_SWEEPS = 2;
constexpr uint32_t LATE_AFTER = 1; // rounds

// Vertices or steps that a search around a cluster may visit: all on a small level, few if there are many searches.
// Sizes of levels in vertices.
constexpr uint32_t SMALL_LEVEL = 1024;
constexpr uint32_t SEARCH_BUDGET = 8192;
// The budget of all searches of a sweep together, per vertex of a level that is not small.
constexpr uint32_t CREDIT_PER_VERTEX = 4;
// Sweeps of single moves end after this many without a move, in both orders.
constexpr uint32_t SWEEPS_WITHOUT_MOVE = 2;
constexpr double SWEEPS_OF_HALF_PROGRESS = 50; // the number of sweeps is not known in advance

} // namespace steering
} // namespace hmf
