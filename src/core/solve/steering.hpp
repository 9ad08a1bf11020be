// The numbers that steer the cascade and Newton's method: when to go on, how exactly
// to solve, when to give up.  None decides what is right: every step is checked, every
// result has its residual and its certificate.  They decide how long it takes.
//
// bench/steering.md has what they were measured against; bench/steering.py measures
// them again.  "guard": a bound of a loop that no mesh of the corpus reaches.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hmf {
namespace steering {

// How far a level is solved.  The finest goes to the caller's tolerance, the coarsest
// so far that the zeros are in place if the finest is so many times as large, others only pass a start on.
constexpr double coarsest_residual = 1e-8;
constexpr uint64_t coarsest_share = 8;
constexpr double middle_residual = 1e-2;
// This is enough where the last step came to no bound, so that zeros are in place.
constexpr double coarsest_residual_in_place = 1e-4;
// Where that level is long and zeros are nearly everywhere, as on a small mesh with a hundred handles.
constexpr double coarsest_residual_of_many = 0.3;
constexpr uint32_t finest_rounds = 1000; // guard: it ends where nothing is gained, see patience
constexpr uint32_t coarsest_rounds = 40;
constexpr uint32_t middle_rounds = 3;
// Sweeps of single moves before the first model.
constexpr uint32_t coarsest_sweeps = 3;
constexpr uint32_t finer_sweeps = 1;
// What a coarser level got wrong are short waves, which the smoother takes out.  Long
// ones add up over the levels: on every third one they are solved for, too.
constexpr size_t long_waves_every = 3;
// Zeros of a double lie near its holes, where a coarser level has another boundary: on so many
// levels next to the finest the long waves are solved for, and once more above this residual.
constexpr size_t double_levels = 2;
constexpr double double_residual = 0.3;
// One or two extrema of a step are no limb but lie near the zeros, and are settled by moves.
constexpr uint64_t few_extrema_on_double = 2;

// Progress is half of the least residual yet, or so much less energy.
constexpr double less_residual = 0.5;
constexpr double less_energy = 1e-9;
constexpr uint32_t patience = 12; // rounds without progress, after which a level has stalled
// After so many rounds the unit of the values is looked at, whether rounding is what
// holds them up; where a finer one has no room, a stall is believed sooner.
constexpr uint32_t rounds_before_finer = 3;
constexpr uint32_t patience_when_rounded = 4;
// And later where the last step came to a bound: a zero on a ring of heavy edges goes on by one of them in a round.
constexpr uint32_t patience_with_zeros = 60;
// So often a level that has stalled goes on after precise steps and moves of its zeros.
constexpr uint32_t stalls = 8;

// Residual from which on the minimum is near: a whole step is worth more effort.
constexpr double close_residual = 1e-2;
// Relative accuracy of the linear solves while zeros move: of the first round, of the
// next ones.  A tighter one would solve a model that does not last.
constexpr double first_accuracy = 1e-2;
constexpr double next_accuracy = 1e-3;
constexpr uint32_t loose_rounds = 3;
// Where they stay: this share of what is missing to the tolerance, within limits.
// Mostly the residual comes first, with a share of the tolerance as its goal; a large
// step changes the pulls against which it is measured.
constexpr double tight_share = 0.003;
constexpr double tightest = 1e-11;
constexpr double residual_share = 0.5;
constexpr double residual_share_after_large_step = 0.2;
constexpr double large_residual = 0.1;
// On a solve that ends so far from its goal, and above this, the multigrid has failed: a direct solver takes over.
constexpr double failed_residual = 1e-9, failed_share = 1e3;
// Steps before parts of a unit are looked for: to the minimum, whatever the residual.
constexpr double precise_accuracy = 1e-12;
constexpr uint32_t precise_steps = 2;
// Values on limbs that no loop goes round decay below the error of a solve: it goes on
// with this factor, as long as it is above the end of doubles.
constexpr double continued = 1e-4;
constexpr double end_of_doubles = 1e-13;

// Iterations of conjugate gradients.  With the setup of an earlier model: a new one costs
// about ten, and where zeros have moved it needs a fifth as many.
constexpr uint32_t iterations_with_old_setup = 16;
constexpr double changed_share = 0.01;              // of the rows: the old setup is not tried
constexpr uint32_t iterations_with_new_setup = 200; // guard
constexpr uint32_t iterations_with_smoother = 10;
constexpr uint32_t iterations_between_bounds = 100; // guard
constexpr uint32_t passes_between_bounds = 4;
// A vertex rests at a bound if its pull is balanced up to this share, well above the
// error of a loose solve near the minimum.
constexpr double resting_share = 1e-4;

// A step that fails is mended where it failed: the vertices within some rings stay. Each
// widen_every attempts there is a ring more; after mending_attempts all take half the step.
constexpr uint32_t attempts = 24; // guard
constexpr uint32_t mending_attempts = 16;
constexpr uint32_t first_rings_held = 2;
constexpr uint32_t widen_every = 4;
constexpr double least_factor = 0.02;
constexpr size_t most_overturned = 200; // vertices held for the class; more: half the step
// A rise of the energy below this share is rounding; up to the other one a solve
// between the bounds may still cure it.
constexpr double rounding_of_energy = 1e-17;
constexpr double curable_rise = 1e-5;
constexpr uint32_t solves_of_a_step = 2;
constexpr double rise_gets_less = 0.7; // by which another solve may follow
// After so many steps in a row that were not taken whole the next one is solved for again wherever its energy rises.
constexpr uint32_t failures = 2;
constexpr uint32_t rounds_for_extrema = 8;

// Single moves near the zeros after a step: rings and passes.  A zero that has not
// arrived after some rounds has far to go, in nearly flat surroundings.
constexpr uint32_t near_rings = 3, near_passes = 20;
constexpr uint32_t far_rings = 6, far_passes = 40;
constexpr uint32_t far_after = 2; // rounds
// After the first pass a vertex has a reason to move if it or a neighbor did by more than this share of the residual.
constexpr double share_at_rest = 1e-3;
// Where zeros are nearly everywhere: not more than so many moves for each vertex of the level, or so many passes.
constexpr uint32_t moves_per_vertex = 8, least_passes = 4;
constexpr double everywhere = 0.75; // of the vertices are picked: least_passes
// Sweeps over all vertices after a step that was shortened, and after late ones.
constexpr uint32_t sweeps_after_short_step = 10;
constexpr uint32_t late_sweeps = 2;
constexpr uint32_t late_after = 1, late_after_tight = 3; // rounds

// Where only a part of the mesh is left with more than this share of the largest residual, it is solved for alone, with
// some rings around it: a part of the vertices up to part_share, in early rounds a smaller one.  Again as long as
// the residual falls by part_gain, else it is what the border of the part holds back, and no more after so many such
// steps that had to be shortened.
constexpr double part_residual = 1e-3;
constexpr uint32_t part_rings = 4;
constexpr double part_share = 0.6, early_part_share = 0.15;
constexpr uint32_t early_part_rounds = 3;
constexpr double part_accuracy = 1e-6;
constexpr double part_gain = 0.1;
constexpr uint32_t parts_in_a_row = 20; // guard
constexpr uint32_t parts_shortened = 2;

// Vertices or steps that a search around a cluster may look at: on a small level all of
// them, a few where there are many searches.  Sizes of levels in vertices.
constexpr uint32_t tiny_level = 64, small_level = 1024, large_level = 100000;
constexpr uint32_t budget_on_tiny_level = 512;
constexpr uint32_t budget_per_vertex = 8; // of a small level
constexpr uint32_t search_budget = 8192;
constexpr uint32_t budget_on_large_level = 512;
// And all searches of a sweep together, for each vertex of a level that is not small.
constexpr uint32_t credit_per_vertex = 4;
// Sweeps of single moves alone end after so many without a move, in both orders.
constexpr uint32_t sweeps_at_rest = 2;
constexpr double sweeps_of_half_progress = 50; // how many there are is not known

} // namespace steering
} // namespace hmf
