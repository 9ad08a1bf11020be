#include "newton_policy.hpp"

#include <algorithm>

namespace hmf {

bool StallDetector::is_stalled(double residual, double energy, double goal, bool passes_bounds) {
    const uint32_t patience = passes_bounds ? parameters::PATIENCE_AT_BOUNDS : parameters::PATIENCE;
    if (residual < parameters::PROGRESS * least_residual_ || energy < least_energy_ * (1 - goal)) without_progress_ = 0;
    else if (++without_progress_ > patience) return true;
    least_residual_ = std::min(least_residual_, residual);
    least_energy_ = std::min(least_energy_, energy);
    return false;
}

LevelPolicy::LevelPolicy(const LevelWork& work, double tolerance) {
    finest = work.state.level == work.options.stop();
    coarsest = work.state.level + 1 == work.state.hierarchy->level_count;
    middle = !finest && !coarsest;
    const Level& last = work.state.hierarchy->levels[work.options.stop()];
    is_cheap = coarsest && parameters::COARSEST_SHARE * work.level.mesh.vertex_count <= last.mesh.vertex_count;
    goal = finest || is_cheap ? tolerance : parameters::CLOSE;
    rounds = middle ? parameters::MIDDLE_ROUNDS : parameters::LEVEL_ROUNDS;
    sweep_only = middle && work.state.hierarchy->genus == 1 && work.level.mesh.marked_count == 0;
}

SolveTolerance LevelPolicy::tolerance(uint32_t round, double residual) const {
    // As long as zeros move, the next model is another one: a tight solve of this one would be wasted.
    if (!finest) return {parameters::CLOSE, parameters::CLOSE, 0, false, residual < parameters::CLOSE};
    return {parameters::CLOSE, parameters::TIGHTEST, parameters::RESIDUAL_SHARE * goal, round > 0,
            residual < parameters::CLOSE};
}

} // namespace hmf
