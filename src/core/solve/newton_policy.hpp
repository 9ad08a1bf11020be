// The policy of Newton's method on a level: how far to reduce the residual, how accurately to solve for each step, and
// when the level has stalled. The numbers are those of steering.hpp.
#pragma once

#include "solve.hpp"
#include "steering.hpp"

namespace hmf {

// Accuracy of the solve for a step.
struct Effort {
    double loose;    // relative tolerance of a solve while zeros move
    double tight;    // and once they hardly move
    double residual; // residual of [W] Eq. 4 at which any solve may stop; 0: none
    bool go_on;      // continue to a tight solve if the zeros stay
    bool close;      // near the minimum: worth the cost of a whole step
};

// residual: before the step.  goal: the tolerance on the finest level.
Effort effort_for(uint32_t round, double residual, double goal, bool finest);

// Detects stalls of a level.
class StallDetector {
public:
    // False: no progress for `patience` rounds.
    bool goes_on(double residual, double energy, uint32_t patience);
    void forget_least() { least_residual_ = least_energy_ = NONE; }

private:
    static constexpr double NONE = 1e300;
    double least_residual_ = NONE, least_energy_ = NONE;
    uint32_t without_ = 0;
};

// Tests once per level whether convergence is limited by quantization.
struct UnitRefinement {
    bool known;
    uint32_t patience = steering::PATIENCE; // less where the unit cannot be as fine as it should

    bool is_refined(LevelWork& work, double goal, StallDetector& progress);
};

// The policy of a level: the minimum on the finest, a good start for the next level on the others.
struct LevelPolicy {
    bool finest, coarsest, middle, cheap = false;
    double goal;
    uint32_t rounds;
    // A torus without marked vertices has no zeros, so one step is exact from any start: the levels in between only
    // separate vertices that splits have left together.
    bool sweep_only;

    LevelPolicy(const LevelWork& work, double tolerance);
    // Its cost matters.
    bool is_long_coarsest() const { return coarsest && !finest && !cheap; }
};

} // namespace hmf
