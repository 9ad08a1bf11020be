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
// the finest has at least coarsest_share times as many edges. The others only give a start for the next level.
constexpr double coarsest_residual = 1e-8;
constexpr uint64_t coarsest_share = 8;
constexpr double middle_residual = 1e-2;
// Sufficient if no bound was active in the last step, i.e. the zeros are in place.
constexpr double coarsest_residual_in_place = 1e-4;
// Used if that level takes long and zeros are nearly everywhere, as on a small mesh with a hundred handles.
constexpr double coarsest_residual_of_many = 0.3;
constexpr uint32_t finest_rounds = 1000; // guard: ends when there is no progress, see patience
constexpr uint32_t coarsest_rounds = 40;
constexpr uint32_t middle_rounds = 3;
// Sweeps of single moves before the first model.
constexpr uint32_t coarsest_sweeps = 3;
constexpr uint32_t finer_sweeps = 1;
// The errors of a coarser level are short waves, which the smoother removes. Long waves add up over the levels, so
// every third level solves for them too.
constexpr size_t long_waves_every = 3;
// Zeros of a double lie near its holes, where a coarser level has another boundary. On this many levels next to the
// finest the long waves are solved for, and again above this residual.
constexpr size_t double_levels = 2;
constexpr double double_residual = 0.3;
// One or two extrema of a step are not on a limb but near the zeros, and are removed by moves.
constexpr uint64_t few_extrema_on_double = 2;

// A round counts as progress if it halves the best residual, or lowers the energy by this relative amount.
constexpr double less_residual = 0.5;
constexpr double less_energy = 1e-9;
constexpr uint32_t patience = 12; // rounds without progress, after which a level has stalled
// After this many rounds without progress a test decides whether rounding limits convergence. If the unit cannot be
// refined, the level counts as stalled earlier.
constexpr uint32_t rounds_before_finer = 3;
constexpr uint32_t patience_when_rounded = 4;
// The patience if the last step met a bound: a zero on a ring of heavy edges passes one of them per round.
constexpr uint32_t patience_with_zeros = 60;
// How often a stalled level continues after precise steps and moves of its zeros.
constexpr uint32_t stalls = 8;

// Residual below which the minimum is near, and a whole step is worth its cost.
constexpr double close_residual = 1e-2;
// Relative accuracy of the linear solves while zeros move: in the first round, and in the next ones. Higher accuracy is
// useless, because the model changes.
constexpr double first_accuracy = 1e-2;
constexpr double next_accuracy = 1e-3;
constexpr uint32_t loose_rounds = 3;
// Accuracy once the zeros are in place: this share of the ratio of tolerance and residual, within limits. Usually the
// goal for the residual is met first, a share of the tolerance. A large step changes the pulls by which the residual is
// divided.
constexpr double tight_share = 0.003;
constexpr double tightest = 1e-11;
constexpr double residual_share = 0.5;
constexpr double residual_share_after_large_step = 0.2;
constexpr double large_residual = 0.1;
// If a solve ends this far above its goal and above this residual, the multigrid has failed, and a direct solver is
// used.
constexpr double failed_residual = 1e-9, failed_share = 1e3;
// Steps before sub-unit corrections are computed: to the minimum, whatever the residual.
constexpr double precise_accuracy = 1e-12;
constexpr uint32_t precise_steps = 2;
// Values on limbs that no loop goes around decay below the error of a solve. The solve is continued with its tolerance
// multiplied by this factor, down to the precision of doubles.
constexpr double continued = 1e-4;
constexpr double end_of_doubles = 1e-13;

// Iterations of conjugate gradients with the setup of an earlier model: a new setup costs about ten, and needs a fifth
// as many iterations after zeros have moved.
constexpr uint32_t iterations_with_old_setup = 16;
constexpr double changed_share = 0.01;              // of the rows: the old setup is not tried
constexpr uint32_t iterations_with_new_setup = 200; // guard
constexpr uint32_t iterations_with_smoother = 10;
constexpr uint32_t iterations_between_bounds = 100; // guard
constexpr uint32_t passes_between_bounds = 4;
// A vertex is fixed at a bound if its pull is balanced up to this share, well above the error of a loose solve near the
// minimum.
constexpr double balanced_share = 1e-4;

// A step that fails is repeated with the vertices within some rings of the failure fixed. There is one ring more every
// widen_every attempts; after mending_attempts the whole step is halved.
constexpr uint32_t attempts = 24; // guard
constexpr uint32_t mending_attempts = 16;
constexpr uint32_t first_rings_held = 2;
constexpr uint32_t widen_every = 4;
constexpr double least_factor = 0.02;
constexpr size_t most_overturned = 200; // vertices fixed for the class; if more: half the step
// An increase of the energy below this share is rounding. Up to the second one, a solve between the bounds may remove
// it.
constexpr double rounding_of_energy = 1e-17;
constexpr double curable_rise = 1e-5;
constexpr uint32_t solves_of_a_step = 2;
constexpr double rise_gets_less = 0.7; // required for another solve
// After this many shortened steps in a row, the next one is solved again whenever its energy increases.
constexpr uint32_t failures = 2;
constexpr uint32_t rounds_for_extrema = 8;

// Single moves near the zeros after a step: rings and passes. A zero that has not arrived after some rounds moves far,
// in a region where the foliation is nearly 0.
constexpr uint32_t near_rings = 3, near_passes = 20;
constexpr uint32_t far_rings = 6, far_passes = 40;
constexpr uint32_t far_after = 2; // rounds
// After the first pass a vertex is moved again only if it or a neighbor moved by more than this share of the residual.
constexpr double negligible_move = 1e-3;
// If zeros are nearly everywhere: at most this many moves for each vertex of the level, or this many passes.
constexpr uint32_t moves_per_vertex = 8, least_passes = 4;
constexpr double everywhere = 0.75; // of the vertices are picked: least_passes
// Sweeps over all vertices after a step that was shortened, and after late ones.
constexpr uint32_t sweeps_after_short_step = 10;
constexpr uint32_t late_sweeps = 2;
constexpr uint32_t late_after = 1, late_after_tight = 3; // rounds

// If only a part of the mesh has more than this share of the largest residual, that part is solved for with some rings
// around it: at most part_share of the vertices, fewer in early rounds. It is repeated as long as the residual falls by
// part_gain; otherwise the border of the part limits it. After this many shortened steps of a part, the whole level is
// solved.
constexpr double part_residual = 1e-3;
constexpr uint32_t part_rings = 4;
constexpr double part_share = 0.6, early_part_share = 0.15;
constexpr uint32_t early_part_rounds = 3;
constexpr double part_accuracy = 1e-6;
constexpr double part_gain = 0.1;
constexpr uint32_t parts_in_a_row = 20; // guard
constexpr uint32_t parts_shortened = 2;

// Vertices or steps that a search around a cluster may visit: all on a small level, few if there are many searches.
// Sizes of levels in vertices.
constexpr uint32_t tiny_level = 64, small_level = 1024, large_level = 100000;
constexpr uint32_t budget_on_tiny_level = 512;
constexpr uint32_t budget_per_vertex = 8; // of a small level
constexpr uint32_t search_budget = 8192;
constexpr uint32_t budget_on_large_level = 512;
// The budget of all searches of a sweep together, per vertex of a level that is not small.
constexpr uint32_t credit_per_vertex = 4;
// Sweeps of single moves end after this many without a move, in both orders.
constexpr uint32_t sweeps_without_move = 2;
constexpr double sweeps_of_half_progress = 50; // the number of sweeps is not known in advance

} // namespace steering
} // namespace hmf
