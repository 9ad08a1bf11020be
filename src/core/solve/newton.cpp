// The direct method: Newton steps on the twisted Laplacian, globalized by
// Whitehead moves.
//
// One round on a level:
//   1. sweeps of Whitehead moves: zeros move, clusters open
//   2. the quadratic model for the current signs (twisted_model.hpp), solved by conjugate gradients with signed
//      multigrid: loosely as long as zeros move. Once the set of active bounds is stable, it is fixed, and the same
//      solve continues to full accuracy
//   3. the solution is projected to its bounds, rounded and applied to all vertices at once. Extrema caused by rounding
//      or a loose solve are removed. The step is accepted if every zero is where it was or at the branch point of its
//      triangle (so the class is kept) and the energy decreases. Otherwise the vertices where it fails are fixed, or
//      the step is halved
//   4. moves near the singularities, where the model is not smooth
// A level that has stalled continues with exactly solved steps, and moves of the remaining zeros.
// Far from the singularities one round is exact, so a few rounds reach the
// minimum.  The certificate is the residual of [W] Eq. 4 at every vertex.
#include "newton_policy.hpp"
#include "newton_update.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

class Newton {
public:
    explicit Newton(LevelWork& work) :
        w_(work), f_(work.state.foliation), weight_(work.level.weight), step_(work, model_) {}

    Done allocate() {
        Memory& memory = w_.call.memory;
        const Mesh& mesh = f_.mesh;
        const size_t n = mesh.vertex_count;
        patch_.start(memory);
        picked_.start(memory);
        return model_.allocate(mesh, memory, w_.call.parallel) && step_.allocate() && unbounded_.allocate(memory, n)
            && distance_.allocate(memory, n) && patch_.reserve(n) && picked_.reserve(n + size_t{1});
    }

    // Computes signs, energy and residual of the current foliation.
    Done linearize() { return model_.linearize(f_, w_.rings, weight_, w_.star, w_.call); }
    const TwistedModel& model() const { return model_; }

    // The zeros of the last linearization.
    Done hand_over(ZeroList& zeros) {
        zeros.vertices.clear();
        zeros.tripods.clear();
        for (uint32_t v : model_.fixed_zeros)
            if (!zeros.vertices.push(v)) return false;
        for (uint32_t h : model_.tripod)
            if (!zeros.tripods.push(h)) return false;
        return zeros.known = true;
    }

    void sweeps(uint32_t n) {
        for (uint32_t i = 0; i < n && w_.go_on(); ++i) {
            SweepResult result;
            w_.sweeps.sweep(f_, w_.rings, weight_, backward_, w_.star, result, w_.call, 0);
            backward_ = !backward_;
            ++w_.statistics.sweep_count;
        }
    }

    // HMF_OK, or memory, or HMF_CANCELLED.  accepted: the share of the step that
    // was taken, 0 if none would do.  tight: it was solved for tightly.
    hmf_status step(const Effort& effort, double& accepted, bool& tight) {
        accepted = 0;
        step_.begin();
        const hmf_status status = try_step(effort, accepted, tight);
        if (accepted == 0) step_.restore();
        return status;
    }

    // Moves at the vertices within some rings of the zeros.
    // late: a zero that has not arrived yet moves far, in a region where the foliation is nearly 0.
    void relax_after_step(bool late) {
        pick_near_zeros((late ? 2 : 1) * steering::NEAR_RINGS);
        const size_t n = f_.mesh.vertex_count, most = size_t{steering::MOVES_PER_VERTEX} * n / (picked_.size() + 1);
        const size_t wanted = size_t{late ? 2u : 1u} * steering::NEAR_PASSES;
        zeros_everywhere_ = static_cast<double>(picked_.size()) > steering::EVERYWHERE * static_cast<double>(n);
        const size_t passes = zeros_everywhere_ ? steering::LEAST_PASSES
                                                : std::min(wanted, std::max(size_t{steering::LEAST_PASSES}, most));
        // The last pass in which a vertex has a reason to move; NONE: not picked.
        Array<uint32_t>& due = distance_;
        for (uint32_t v : picked_) due[v] = 0;
        const double negligible = steering::NEGLIGIBLE_MOVE * model_.residual_max;
        for (uint32_t pass = 0; pass < passes && w_.go_on(); ++pass)
            for (size_t i = 0; i < picked_.size(); ++i) {
                const uint32_t v = picked_[pass % 2 ? picked_.size() - 1 - i : i];
                if (due[v] < pass) continue;
                SweepResult result;
                if (!relax_vertex(f_, w_.rings, weight_, v, w_.star, result) || result.largest <= negligible) continue;
                due[v] = pass + 1;
                for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1]; ++t) {
                    uint32_t& neighbor = due[w_.rings.neighbor[t]];
                    if (neighbor != NONE) neighbor = pass + 1;
                }
            }
    }

    // Most vertices are near a zero; as of the last relax_after_step.
    bool zeros_are_everywhere() const { return zeros_everywhere_; }
    // No bound was active in the last step: zeros are in place, and the remaining residual is the error of the solve.
    bool was_within_bounds() const { return bounds_met_ == 0; }
    // The first solution of the last step, projected to its bounds, made extrema: values on limbs had no correct
    // digits.
    bool limbs_were_wrong() const { return limbs_were_wrong_; }

    // Steps to the minimum itself, whatever the residual: the remaining error is the rounding to the unit.
    hmf_status step_precisely() {
        Effort effort{};
        effort.loose = effort.tight = steering::TIGHTEST;
        effort.close = effort.go_on = true;
        for (uint32_t i = 0; i < steering::PRECISE_STEPS; ++i) {
            if (!linearize()) return interrupted(w_.call);
            double accepted = 0;
            bool tight = false;
            if (const hmf_status status = step(effort, accepted, tight)) return status;
            if (accepted < 1) break;
        }
        return HMF_OK;
    }

    // One move for each zero whose residual is above this value; false: none moved.
    bool move_zeros(double residual) {
        bool moved = false;
        for (const uint32_t v : model_.fixed_zeros) {
            if (residual_at(f_, w_.rings, weight_, v, 0, w_.star) <= residual) continue;
            SweepResult result;
            moved |= relax_vertex(f_, w_.rings, weight_, v, w_.star, result);
        }
        return moved;
    }

private:
    // The vertices within some rings of the zeros, nearest first, with their distances.
    void pick_near_zeros(uint32_t rings_around) {
        const Mesh& mesh = f_.mesh;
        picked_.clear();
        for (uint32_t v = 0; v < mesh.vertex_count; ++v) distance_[v] = NONE;
        const auto add = [&](uint32_t v, uint32_t ring) {
            if (distance_[v] != NONE) return;
            distance_[v] = ring;
            picked_.add(v);
        };
        // Every zero is where it was before the step, or at a vertex next to that.
        for (uint32_t v : model_.fixed_zeros) add(v, 0);
        for (uint32_t h : model_.tripod) {
            const uint32_t corners[3] = {h, mesh.next[h], mesh.prev(h)};
            for (uint32_t g : corners) add(mesh.origin[g], 0);
        }
        grow_picked(rings_around);
    }

    // By the given number of rings.
    void grow_picked(uint32_t rings_around) {
        for (size_t i = 0; i < picked_.size(); ++i) {
            const uint32_t v = picked_[i];
            if (distance_[v] == rings_around) continue;
            for (uint32_t t = w_.rings.offset[v]; t < w_.rings.offset[v + 1]; ++t) {
                const uint32_t u = w_.rings.neighbor[t];
                if (distance_[u] != NONE) continue;
                distance_[u] = distance_[v] + 1;
                picked_.add(u);
            }
        }
    }

    // Solves the model and sets the values of the whole step; false: see interrupted().
    Done propose(const Effort& effort, bool& tight) {
        model_.assemble(f_, w_.rings, weight_, w_.call);
        if (!w_.go_on()) return false;
        ++w_.statistics.linear_solve_count;
        tight = model_.is_exact();
        // On limbs that no loop goes around, the values decay below the error of a loose solve. The solve is then
        // continued as long as this reduces the number of extrema.
        uint64_t had = UINT64_MAX;
        for (double accuracy = tight ? effort.tight : effort.loose;; accuracy *= steering::CONTINUED) {
            if (!solve_linear(accuracy, effort.residual)) return false;
            if (had != UINT64_MAX) step_.restore(); // else they are there
            std::memcpy(unbounded_.data(), model_.d.data(), model_.count * sizeof(double));
            set_bounded_values();
            if (!w_.go_on()) return false;
            if (effort.go_on && !model_.is_exact() && (tight || bounds_met_ == 0)) {
                if (!tight) accuracy = effort.tight;
                tight = true;
                step_.restore();
                if (!solve_between_bounds(accuracy, effort.residual)) return false;
                step_.set_values(1);
            }
            if (!w_.go_on()) return false;
            uint64_t extrema = step_.find_candidates();
            if (had == UINT64_MAX) limbs_were_wrong_ = extrema > 0;
            if (extrema > 0 && !tight) {
                // Unknowns fixed at their bounds restrict their neighbors: start again from the unprojected solution.
                step_.restore();
                std::memcpy(model_.d.data(), unbounded_.data(), model_.count * sizeof(double));
                set_bounded_values();
                extrema = step_.find_candidates();
            }
            if (extrema == 0 || extrema >= had || accuracy < steering::END_OF_DOUBLES) return true;
            had = extrema;
            std::memcpy(model_.d.data(), unbounded_.data(), model_.count * sizeof(double));
        }
    }

    void set_bounded_values() {
        bounds_met_ = model_.project(f_, w_.rings, patch_, distance_);
        step_.set_values(1);
    }

    // For tests of the guard: the step times this factor, within its bounds.
    void lengthen(double factor) {
        for (uint32_t v = 0; v < f_.mesh.vertex_count; ++v) {
            double& d = model_.d[v];
            d *= factor;
            if (d < static_cast<double>(model_.lower[v])) d = static_cast<double>(model_.lower[v]);
            if (d > static_cast<double>(model_.upper[v])) d = static_cast<double>(model_.upper[v]);
        }
        step_.set_values(1);
        step_.find_candidates();
    }

    // Leaves the values changed where it is not accepted.
    hmf_status try_step(const Effort& effort, double& accepted, bool& tight) {
        if (!propose(effort, tight)) return interrupted(w_.call);
        // If the step went too far at a vertex, made extrema or moved zeros, the neighborhood there is fixed. If the
        // energy increases, too many bounds are active: the other unknowns are solved for again, as long as the
        // increase becomes smaller. If nothing helps, the whole step is shortened.
        double factor = 1, rise = HUGE_VAL;
        uint32_t radius = steering::FIRST_RINGS_HELD;
        const bool unchecked = w_.options.unchecked > 0 && !w_.gated;
        if (unchecked) lengthen(w_.options.unchecked);
        for (uint32_t attempt = 0; attempt < steering::STEP_ATTEMPTS; ++attempt) {
            step_.forget_too_far();
            if (attempt > 0) {
                bounds_met_ = UINT64_MAX; // some are held
                step_.set_values(factor);
                if (!w_.go_on()) return interrupted(w_.call);
                step_.find_candidates();
            }
            step_.list_invalid(picked_);
            const bool valid = step_.remove_extrema() && (unchecked || step_.zeros_are_in_place());
            if (!w_.go_on()) return interrupted(w_.call);
            if (valid) energy_change_ = step_.energy_change();
            if (valid && (unchecked || energy_change_ <= steering::ROUNDING_OF_ENERGY * model_.energy)) {
                bool kept = true;
                if (w_.gated) {
                    if (const hmf_status status = w_.guard->certify(w_.state, w_.recorder.unit(), w_.call))
                        return status;
                    kept = w_.guard->holds();
                }
                if (kept) {
                    accepted = factor;
                    return HMF_OK;
                }
                step_.restore();
                bool held = false;
                if (!fix_overturned(held)) return w_.call.out_of_memory();
                if (!held) factor *= 0.5;
                continue;
            }
            step_.restore();
            if (!tight && effort.close) {
                // The error of the solve may be what went wrong.
                tight = true;
                if (!solve_linear(effort.tight, effort.residual)) return interrupted(w_.call);
                model_.project(f_, w_.rings, patch_, distance_);
            } else if (valid && energy_change_ < steering::RISE_GETS_LESS * rise) {
                rise = energy_change_;
                ++w_.statistics.linear_solve_count;
                if (!solve_between_bounds(effort.close ? effort.tight : effort.loose, effort.residual))
                    return interrupted(w_.call);
            } else if (step_.too_far() != NONE) {
                if ((attempt + 1) % steering::WIDEN_EVERY == 0) ++radius;
                // Where the certificate judges, zeros may move: there one place at a time is held.
                if (w_.gated || unchecked) picked_.clear();
                picked_.add(step_.too_far());
                model_.fix_around(f_, w_.rings, picked_, radius, patch_, distance_);
            } else {
                factor *= 0.5;
            }
        }
        return HMF_OK;
    }

    // The values before the step are back, the step is not.  A step keeps the class if
    // each vertex has in each of its directions an edge that the step does not
    // reverse: the others stay where they are from now on.  any: there are some.
    Done fix_overturned(bool& any) {
        Array<uint32_t> held;
        held.start(w_.call.memory);
        for (uint32_t v = 0; v < f_.mesh.vertex_count; ++v) {
            const Rings::Side* side = &w_.rings.side[w_.rings.offset[v]];
            const uint32_t degree = w_.rings.offset[v + 1] - w_.rings.offset[v];
            // Runs between closed corners; the first one goes on at the end.
            uint32_t closed = 0;
            bool here = false, first = false, overturned = false;
            for (uint32_t t = 0; t < degree; ++t) {
                const uint32_t h = side[t].half_edge;
                if (f_.at(h) != 0) here |= !step_.reverses(h);
                if (f_.corner2(h) != 0 || f_.at(h) == 0) continue;
                if (closed++ == 0) first = here;
                else overturned |= !here;
                here = false;
            }
            if (closed > 0) overturned |= !(here || first);
            if (overturned && !held.push(v)) return false;
        }
        any = !held.empty();
        if (!any) return true;
        model_.fix_around(f_, w_.rings, held, 1, patch_, distance_);
        return true;
    }

    // Continues from model_.d.
    Done solve_linear(double accuracy, double residual, bool between_bounds = false) {
        LinearOptions options;
        options.row_tolerance = residual;
        options.fixed = between_bounds ? model_.at_bounds.data() : nullptr;
        options.fixed_count = between_bounds ? model_.at_bounds.size() : 0;
        return solver_.solve(model_.system(), model_.changed.data(), accuracy, options, w_.call);
    }

    // The unknowns at a bound keep their value, the others are solved for.
    Done solve_between_bounds(double accuracy, double residual) {
        model_.fix_active();
        if (!solve_linear(accuracy, residual, true)) return false;
        model_.release();
        model_.project(f_, w_.rings, patch_, distance_);
        return true;
    }

    LevelWork& w_;
    Foliation& f_;
    const double* weight_;
    TwistedModel model_;
    NewtonUpdate step_;
    LinearSolver solver_;
    bool zeros_everywhere_ = false, limbs_were_wrong_ = false;
    uint64_t bounds_met_ = UINT64_MAX; // by the last step
    Array<double> unbounded_;          // the solution of the model before it was brought into its bounds
    Array<uint32_t> patch_, distance_;
    Array<uint32_t> picked_; // vertices near zeros, or those that a step has made invalid
    bool backward_ = false;
    double energy_change_ = 0; // of the last step that was valid
};

// A coarsest level ends early where zeros are nearly everywhere, or known to be in place.
bool is_good_start(const LevelPolicy& plan, const Newton& newton, double residual) {
    return (plan.is_long_coarsest() && newton.zeros_are_everywhere() && residual <= steering::COARSEST_RESIDUAL_OF_MANY)
        || (plan.cheap && newton.was_within_bounds() && residual <= steering::COARSEST_RESIDUAL_IN_PLACE);
}

} // namespace

hmf_status newton_level(LevelWork& work, double tolerance) {
    const LevelPolicy plan(work, tolerance);
    const bool finest = plan.finest;
    const double goal = plan.goal;
    Newton newton(work);
    if (!newton.allocate()) return work.call.out_of_memory();
    newton.sweeps(plan.coarsest ? steering::COARSEST_SWEEPS : steering::FINER_SWEEPS);
    if (plan.sweep_only) return work.call.cancelled() || work.call.finishing() ? HMF_CANCELLED : HMF_OK;
    StallDetector progress;
    uint64_t steps_left = finest && work.options.step_limit ? work.options.step_limit : plan.rounds;
    UnitRefinement unit{!finest};
    uint32_t stalls_left = work.options.unchecked > 0 ? 0 : steering::STALLS;
    bool moves_wait = false, zeros_moved = false;
    uint32_t failed = 0; // steps in a row that were not taken whole
    for (uint32_t round = 0; round < plan.rounds; ++round) {
        if (!newton.linearize()) return interrupted(work.call);
        const TwistedModel& model = newton.model();
        // After a step that was solved for to the end moves are made only if it has not reached the goal.
        if (moves_wait && model.residual_max > goal) {
            newton.relax_after_step(finest && round > steering::LATE_AFTER + 1);
            if (round > steering::LATE_AFTER + 1) newton.sweeps(steering::LATE_SWEEPS);
            if (!newton.linearize()) return interrupted(work.call);
        }
        moves_wait = false;
        if (work.call.finishing()) return HMF_CANCELLED;
        // The first step of a level needs no reason but on the last level.
        const double residual = round == 0 && !finest ? 1 : model.residual_max;
        if (!work.record(2, model.energy, residual)) return work.call.out_of_memory();
        if (residual <= goal || is_good_start(plan, newton, residual)) {
            work.recorder.certificate = {true, model.energy, residual, model.residual_sum / model.count};
            if (work.guard && !newton.hand_over(work.guard->zeros)) return work.call.out_of_memory();
            return HMF_OK;
        }
        const uint32_t patience = zeros_moved ? std::max(unit.patience, steering::PATIENCE_WITH_ZEROS) : unit.patience;
        if (!progress.goes_on(residual, model.energy, patience)) {
            if (finest && unit.is_refined(work, goal, progress)) continue;
            if (!finest) return HMF_OK;
            if (const hmf_status status = newton.step_precisely()) return status;
            if (!newton.linearize()) return interrupted(work.call);
            if (model.residual_max > goal && (stalls_left == 0 || !newton.move_zeros(goal)))
                return end_beyond_rounding(work, goal);
            stalls_left -= stalls_left > 0;
            progress.forget_least();
            continue;
        }
        if (work.call.out_of_time()) return HMF_LIMIT_TIME;
        if (steps_left == 0) return HMF_LIMIT_ITERATIONS;
        if (round >= steering::ROUNDS_BEFORE_FINER && residual < steering::CLOSE_RESIDUAL
            && unit.is_refined(work, goal, progress))
            continue;
        --steps_left;
        double accepted = 0;
        bool tight = false;
        Effort effort = effort_for(round, residual, goal, finest);
        effort.close |= failed >= steering::FAILURES;
        if (const hmf_status status = newton.step(effort, accepted, tight)) return status;
        failed = accepted < 1 ? failed + 1 : 0;
        zeros_moved = accepted == 1 && !newton.was_within_bounds();
        moves_wait = accepted == 1 && tight && !plan.middle;
        if (moves_wait) continue;
        newton.relax_after_step(finest && round > steering::LATE_AFTER);
        if (accepted == 1 && plan.middle && !newton.limbs_were_wrong()) return HMF_OK; // it only provides a start
        if (accepted < 1 || round > steering::LATE_AFTER) newton.sweeps(steering::LATE_SWEEPS);
    }
    if (work.call.cancelled() || work.call.finishing()) return HMF_CANCELLED;
    if (!finest) return HMF_OK;
    if (const hmf_status status = newton.step_precisely()) return status;
    return end_beyond_rounding(work, goal);
}

} // namespace hmf
