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
    const hmf_hierarchy& h = *work.state.hierarchy;
    const Mesh &mesh = work.level.mesh, &last = h.levels[work.options.stop()].mesh;
    const bool is_small = parameters::COARSEST_SHARE * mesh.vertex_count <= last.vertex_count;
    role = work.state.level == work.options.stop() ? Role::finest
         : work.state.level + 1 < h.level_count    ? Role::middle
         : is_small                                ? Role::cheap_coarsest
                                                   : Role::coarsest;
    goal = role == Role::finest || role == Role::cheap_coarsest ? tolerance : parameters::CLOSE;
    rounds = role == Role::middle ? parameters::MIDDLE_ROUNDS : parameters::LEVEL_ROUNDS;
    // A torus without marked vertices has no zeros, so one step is exact from any start: the levels in between only
    // separate vertices that splits have left together, by their sweep.
    if (role == Role::middle && h.genus == 1 && mesh.marked_count == 0) rounds = 0;
}

SolveTolerance LevelPolicy::tolerance() const {
    // As long as zeros move, the next model is another one: a tight solve of this one would be wasted.
    if (role != Role::finest) return {parameters::CLOSE, parameters::CLOSE, 0};
    return {parameters::CLOSE, parameters::TIGHTEST, parameters::RESIDUAL_SHARE * goal};
}

} // namespace hmf
