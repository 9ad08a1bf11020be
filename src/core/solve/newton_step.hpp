// One step of Newton's method: solve the model, project the solution to its bounds, round it, check it, and change it
// until it passes.
//
//     solve             loosely; further if no bound is met, or if the solution makes extrema
//     repeat
//         apply         d rounded to integers, to all vertices
//         check         triangles closed, no extremum, every zero in place, the energy falls; if steps are guarded:
//                       the certificate of the class
//         passed: done
//         change        the first of these that applies:
//                           guarded, and vertices turned over    hold them
//                           the solve was loose (finest level)   solve tightly
//                           the energy rises, at most half       solve again between the bounds that are active
//                           as much as the time before
//                           it went too far at some vertices     hold them and the rings around them
//                           none of these                        half of the step
#pragma once

#include "near_zeros.hpp"
#include "newton_policy.hpp"
#include "newton_update.hpp"

namespace hmf {

// How a step ended.
struct StepOutcome {
    double share = 0;         // of it that was taken: 1 if it is whole, 0 if none would do
    bool is_tight = false;    // solved tightly
    bool zeros_stay = false;  // no bound was met: the remaining residual is the error of the solve
    bool had_extrema = false; // the first solution made extrema: values on protrusions had no correct digits
    bool is_whole() const { return share == 1; }
};

class NewtonStep {
public:
    NewtonStep(LevelWork& work, Neighborhood& room) :
        w_(work), f_(work.state.foliation), weight_(work.level.weight), update_(work, model_), distance_(room.distance),
        invalid_(room.list) {}
    Done allocate();

    // Signs, energy and residual of the current foliation.
    Done linearize() { return model_.linearize(f_, w_.rings, weight_, w_.star, w_.call); }
    const TwistedModel& model() const { return model_; }

    // After linearize(). HMF_OK also where no share of the step could be taken, then the values are those before it.
    hmf_status take(const SolveTolerance& tolerance, StepOutcome& outcome);

private:
    hmf_status try_step(const SolveTolerance& tolerance, StepOutcome& outcome);
    Done propose(const SolveTolerance& tolerance, StepOutcome& outcome);
    void set_bounded_values();
    bool passes(bool& is_valid);
    hmf_status keeps_class(bool& keeps);
    Done fix_overturned(bool& any);
    Done solve_linear(double accuracy, double residual, bool between_bounds = false);
    Done solve_between_bounds(double accuracy, double residual);

    LevelWork& w_;
    Foliation& f_;
    const double* weight_;
    TwistedModel model_;
    NewtonUpdate update_;
    LinearSolver solver_;
    uint64_t bounds_met_ = UINT64_MAX; // by the last solution; UINT64_MAX: some vertices are held
    Array<double> unbounded_;          // the solution of the model before it was brought into its bounds
    Array<uint32_t> patch_;            // of projections,
    Array<uint32_t>& distance_;        // and their rings
    Array<uint32_t>& invalid_;         // vertices that a step has made invalid
    double energy_change_ = 0;         // of the last step that was valid
};

} // namespace hmf
