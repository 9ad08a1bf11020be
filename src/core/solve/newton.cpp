// The direct method: Newton steps on the twisted Laplacian, globalized by Whitehead moves.
//
//     sweeps of moves                           zeros move, clusters open
//     repeat
//         linearize                             signs, bounds, energy, residual
//         residual <= goal: done
//         no progress: escalate                 the next rung of the ladder below
//         step                                  newton_step.hpp: loose while zeros move, tight once they stay
//         moves near the zeros                  where the model is not smooth
//
// Far from the zeros one round is exact, so a few rounds reach the minimum. The residual is that of [W] Eq. 4, at every
// vertex.
#include "near_zeros.hpp"
#include "newton_step.hpp"
#include "parameters.hpp"

namespace hmf {

namespace {

class NewtonLevel {
public:
    NewtonLevel(LevelWork& work, double tolerance) :
        w_(work), policy_(work, tolerance), step_(work, room_), near_(work, step_.model(), room_) {}

    hmf_status run();

private:
    const TwistedModel& model() const { return step_.model(); }
    bool is_finest() const { return policy_.role == LevelPolicy::Role::finest; }
    bool is_coarsest() const { return policy_.role >= LevelPolicy::Role::coarsest; }
    bool has_ended() const { return w_.call.cancelled() || w_.call.finishing(); }
    void sweep(uint32_t count);
    void move_near_zeros();
    hmf_status linearize();
    hmf_status begin_round();
    bool is_good_start(double residual) const;
    hmf_status hand_over(double residual);
    bool makes_no_progress(double residual);
    hmf_status escalate(bool& goes_on);
    hmf_status step_exactly();

    LevelWork& w_;
    const LevelPolicy policy_;
    Neighborhood room_;
    NewtonStep step_;
    NearZeros near_;
    StepOutcome last_; // of the last step
    uint32_t step_count_ = 0;
    bool moves_are_due_ = false; // after the last step
    StallDetector stall_;
    enum class Rung { steps, finer_unit } rung_ = Rung::steps;
    uint32_t stalls_left_ = parameters::STALLS;
};

hmf_status NewtonLevel::run() {
    if (!room_.allocate(w_.call.memory, w_.state.foliation.mesh.vertex_count) || !step_.allocate())
        return w_.call.out_of_memory();
    sweep(is_coarsest() ? parameters::COARSEST_SWEEPS : parameters::SWEEPS);
    uint64_t steps_left = is_finest() && w_.options.step_limit ? w_.options.step_limit : policy_.rounds;
    for (uint32_t round = 0; round < policy_.rounds; ++round) {
        if (const hmf_status status = begin_round()) return status;
        // The first step of a level needs no reason, except on the finest level.
        const double residual = round == 0 && !is_finest() ? 1 : model().residual_max;
        if (!w_.record(2, model().energy, residual)) return w_.call.out_of_memory();
        if (residual <= policy_.goal || is_good_start(residual)) return hand_over(residual);
        if (makes_no_progress(residual)) {
            bool goes_on = false;
            const hmf_status status = escalate(goes_on);
            if (!goes_on) return status;
            continue;
        }
        if (w_.call.out_of_time()) return HMF_LIMIT_TIME;
        if (steps_left-- == 0) return HMF_LIMIT_ITERATIONS;
        if (const hmf_status status = step_.take(policy_.tolerance(), last_)) return status;
        moves_are_due_ = true;
        ++step_count_;
        if (policy_.role == LevelPolicy::Role::middle && last_.is_whole() && !last_.had_extrema) {
            move_near_zeros();
            return HMF_OK;
        }
    }
    if (has_ended()) return HMF_CANCELLED;
    return is_finest() ? HMF_LIMIT_STALLED : HMF_OK;
}

// Linearizes, after moves near the zeros. A tight step may have reached the goal: then there are none.
hmf_status NewtonLevel::begin_round() {
    const bool may_have_arrived = last_.is_whole() && last_.is_tight;
    if (moves_are_due_ && !may_have_arrived) move_near_zeros();
    if (const hmf_status status = linearize()) return status;
    if (moves_are_due_ && model().residual_max > policy_.goal) {
        move_near_zeros();
        if (const hmf_status status = linearize()) return status;
    }
    return w_.call.finishing() ? HMF_CANCELLED : HMF_OK;
}

void NewtonLevel::move_near_zeros() {
    moves_are_due_ = false;
    near_.relax();
    if (!last_.is_whole() || step_count_ > parameters::FIRST_STEPS) sweep(parameters::SWEEPS);
}

// A tight step that meets no bound has reached the goal, were it not for the rounding to the unit.
bool NewtonLevel::makes_no_progress(double residual) {
    if (is_finest() && rung_ == Rung::steps && last_.is_whole() && last_.is_tight && last_.zeros_stay) return true;
    return stall_.is_stalled(residual, model().energy, policy_.goal, last_.is_whole() && !last_.zeros_stay);
}

// What a level does when a round makes no progress: the next rung. Each is needed by a family of meshes.
//
//     rung           entered                                         needed by
//     finer unit     the first time, if rounding to the unit         needles, caps
//                    limits the residual and a finer one fits
//     exact steps    every later time. Then vertices at zeros        small meshes with hundreds of zeros
//                    that are not balanced move
//     give up        if none moves, or after many stalls
//
// Levels that only provide a start end at the first stall. Two more rungs lie outside of a level: if the
// certificate fails, all is solved again with a certificate for each level (class_guard.hpp); and at the end of a call
// that stalled, values are corrected by less than a unit (extreme/fraction.hpp).
hmf_status NewtonLevel::escalate(bool& goes_on) {
    goes_on = is_finest();
    if (!is_finest()) return HMF_OK;
    if (rung_ == Rung::steps) {
        rung_ = Rung::finer_unit;
        if (w_.refine_unit(policy_.goal)) stall_.restart();
        return HMF_OK;
    }
    stall_.restart();
    if (const hmf_status status = step_exactly()) return goes_on = false, status;
    if (const hmf_status status = linearize()) return goes_on = false, status;
    const double residual = model().residual_max;
    goes_on = residual <= policy_.goal || (stalls_left_-- > 0 && near_.move_zeros(policy_.goal));
    return HMF_LIMIT_STALLED;
}

// Steps to the minimum itself, whatever the residual: the remaining error is the rounding to the unit.
hmf_status NewtonLevel::step_exactly() {
    StepOutcome outcome;
    for (uint32_t i = 0; i < parameters::EXACT_STEPS; ++i) {
        if (const hmf_status status = linearize()) return status;
        if (const hmf_status status = step_.take(SolveTolerance::exact(), outcome)) return status;
        if (!outcome.is_whole()) break;
    }
    return HMF_OK;
}

// A coarsest level ends early where zeros are nearly everywhere, or known to be in place.
bool NewtonLevel::is_good_start(double residual) const {
    switch (policy_.role) {
    case LevelPolicy::Role::cheap_coarsest: return last_.zeros_stay && residual <= parameters::CLOSE;
    case LevelPolicy::Role::coarsest: return near_.are_everywhere() && residual <= parameters::PROGRESS;
    default: return false;
    }
}

hmf_status NewtonLevel::hand_over(double residual) {
    w_.log.certificate = {true, model().energy, residual, model().residual_sum / model().count};
    return w_.guard && !near_.list(w_.guard->zeros) ? w_.call.out_of_memory() : HMF_OK;
}

hmf_status NewtonLevel::linearize() { return step_.linearize() ? HMF_OK : interrupted(w_.call); }

void NewtonLevel::sweep(uint32_t count) {
    for (uint32_t i = 0; i < count && w_.go_on(); ++i) {
        SweepResult result;
        w_.sweeps.sweep(w_.state.foliation, w_.rings, w_.level.weight, w_.statistics.sweep_count % 2 == 1, w_.star,
                        result, w_.call, 0);
        ++w_.statistics.sweep_count;
    }
}

} // namespace

hmf_status newton_level(LevelWork& work, double tolerance) { return NewtonLevel(work, tolerance).run(); }

} // namespace hmf
