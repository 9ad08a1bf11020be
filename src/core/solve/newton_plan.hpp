// What Newton's method does on a level: how far it goes, how well each step is solved for, whether there is progress.
// The numbers are those of steering.hpp.
#pragma once

#include "solve.hpp"
#include "steering.hpp"

namespace hmf {

// How well to solve for a step.
struct Effort {
    double loose;    // relative tolerance of a solve after which zeros move
    double tight;    // and of one where they hardly do
    double residual; // of [W] Eq. 4, with which any solve may stop; 0: none
    bool go_on;      // to a tight solve, where the zeros stay
    bool close;      // near the minimum: more effort for a whole step pays
    bool part;       // only what Newton::is_in_part has picked moves
};

// residual: before the step.  goal: the tolerance on the finest level.
Effort effort_for(uint32_t round, double residual, double goal, bool finest);
Effort effort_for_part(Effort effort);

// Does a level get better?
class Progress {
public:
    // False: not for so many rounds.
    bool goes_on(double residual, double energy, uint32_t patience);
    void forget_least() { least_residual_ = least_energy_ = none; }

private:
    static constexpr double none = 1e300;
    double least_residual_ = none, least_energy_ = none;
    uint32_t without_ = 0;
};

// Is it the rounding that so many steps have not been enough?  Looked at once.
struct UnitOfLevel {
    bool known;
    uint32_t patience = steering::patience; // less where the unit cannot be as fine as it should

    bool is_refined(LevelWork& work, double goal, Progress& progress);
};

// Steps of a part, between those of the whole level: zeros that have far to go through a limb, where values fall by
// decades, and what they leave behind, for which the rest of the mesh has nothing to do.
struct Parts {
    uint32_t in_a_row = 0, shortened = 0;
    double before = 0; // residual before the last step

    bool are_worth_it(uint32_t round, double residual);
    void next(bool part) { in_a_row = part ? in_a_row + 1 : 0; }
};

// What a level asks of the method: minima on the last, starts for the next on the others.
struct LevelPlan {
    bool finest, coarsest, middle, next_to_double, cheap = false;
    double goal;
    uint32_t rounds;
    bool smooth_only; // long waves are left to other levels
    // A torus without marks has no zeros, so one step is exact, wherever it starts: the levels in between
    // only take apart what splits have left together.
    bool sweep_only;

    LevelPlan(const LevelWork& work, double tolerance);
    // Its work counts.
    bool is_long_coarsest() const { return coarsest && !finest && !cheap; }
};

} // namespace hmf
