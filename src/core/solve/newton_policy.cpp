#include "newton_policy.hpp"

#include <algorithm>

namespace hmf {

Effort effort_for(uint32_t round, double residual, double goal, bool finest) {
    Effort effort{};
    effort.close = residual < steering::close_residual;
    effort.tight = steering::first_accuracy;
    if (finest) {
        effort.tight = std::max(steering::tight_share * goal / residual, steering::tightest);
        effort.tight = std::min(effort.tight, steering::first_accuracy);
        effort.residual = goal
                        * (residual > steering::large_residual ? steering::residual_share_after_large_step
                                                               : steering::residual_share);
    }
    effort.loose = round == 0                                      ? steering::first_accuracy
                 : round < steering::loose_rounds || !effort.close ? steering::next_accuracy
                                                                   : effort.tight;
    effort.loose = std::max(effort.loose, effort.tight);
    // As long as zeros move, the next model is another one: a tight solve
    // of this one would be wasted.
    effort.go_on = finest && round > 0;
    return effort;
}

Effort effort_for_part(Effort effort) {
    effort.go_on = false;
    effort.tight = effort.loose = steering::part_accuracy;
    return effort;
}

bool StallDetector::goes_on(double residual, double energy, uint32_t patience) {
    if (residual < steering::less_residual * least_residual_ || energy < least_energy_ * (1 - steering::less_energy))
        without_ = 0;
    else if (++without_ > patience) return false;
    least_residual_ = std::min(least_residual_, residual);
    least_energy_ = std::min(least_energy_, energy);
    return true;
}

bool UnitRefinement::is_refined(LevelWork& work, double goal, StallDetector& progress) {
    if (known) return false;
    known = true;
    const UnitChange unit_change = work.refine_unit(goal);
    if (!unit_change.enough) patience = steering::patience_when_rounded;
    if (unit_change.changed) progress.forget_least();
    return unit_change.changed;
}

bool LocalSteps::are_worth_it(uint32_t round, double residual) {
    const bool gains = residual < steering::part_gain * before;
    before = residual;
    return round > 0 && shortened < steering::parts_shortened && (in_a_row == 0 || gains)
        && in_a_row < steering::parts_in_a_row;
}

LevelPolicy::LevelPolicy(const LevelWork& work, double tolerance) {
    const size_t above = work.state.level - work.options.stop(); // levels that are still to come
    finest = above == 0;
    coarsest = work.state.level + 1 == work.state.hierarchy->level_count;
    middle = !finest && !coarsest;
    next_to_double = middle && work.state.hierarchy->is_double() && above <= steering::double_levels;
    const Level& last = work.state.hierarchy->levels[work.options.stop()];
    cheap = coarsest && steering::coarsest_share * work.level.mesh.vertex_count <= last.mesh.vertex_count;
    goal = finest ? tolerance : cheap ? steering::coarsest_residual : steering::middle_residual;
    rounds = finest ? steering::finest_rounds : coarsest ? steering::coarsest_rounds : steering::middle_rounds;
    smooth_only = middle && !next_to_double && above % steering::long_waves_every != 0;
    sweep_only = middle && work.state.hierarchy->genus == 1 && work.level.mesh.marked_count == 0;
}

} // namespace hmf
