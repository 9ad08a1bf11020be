#include "newton_policy.hpp"

#include <algorithm>

namespace hmf {

Effort effort_for(uint32_t round, double residual, double goal, bool finest) {
    Effort effort{};
    effort.close = residual < steering::CLOSE_RESIDUAL;
    effort.loose = steering::LOOSE_ACCURACY;
    effort.tight = finest ? steering::TIGHTEST : steering::LOOSE_ACCURACY;
    effort.residual = finest ? steering::RESIDUAL_SHARE * goal : 0;
    // As long as zeros move, the next model is another one: a tight solve
    // of this one would be wasted.
    effort.go_on = finest && round > 0;
    return effort;
}

bool StallDetector::goes_on(double residual, double energy, uint32_t patience) {
    if (residual < steering::LESS_RESIDUAL * least_residual_ || energy < least_energy_ * (1 - steering::LESS_ENERGY))
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
    if (!unit_change.enough) patience = steering::PATIENCE_WHEN_ROUNDED;
    if (unit_change.changed) progress.forget_least();
    return unit_change.changed;
}

LevelPolicy::LevelPolicy(const LevelWork& work, double tolerance) {
    const size_t above = work.state.level - work.options.stop(); // levels that are still to come
    finest = above == 0;
    coarsest = work.state.level + 1 == work.state.hierarchy->level_count;
    middle = !finest && !coarsest;
    const Level& last = work.state.hierarchy->levels[work.options.stop()];
    cheap = coarsest && steering::COARSEST_SHARE * work.level.mesh.vertex_count <= last.mesh.vertex_count;
    goal = finest ? tolerance : cheap ? steering::COARSEST_RESIDUAL : steering::MIDDLE_RESIDUAL;
    rounds = finest ? steering::FINEST_ROUNDS : coarsest ? steering::COARSEST_ROUNDS : steering::MIDDLE_ROUNDS;
    sweep_only = middle && work.state.hierarchy->genus == 1 && work.level.mesh.marked_count == 0;
}

} // namespace hmf
