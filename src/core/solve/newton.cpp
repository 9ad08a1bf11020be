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
// A level that has stalled continues with exactly solved steps, and moves of the remaining zeros. If the residual is
// large in a part of the mesh only, 2 and 3 are done for the unknowns there (subdomain_solver.hpp).
// Far from the singularities one round is exact, so a few rounds reach the
// minimum.  The certificate is the residual of [W] Eq. 4 at every vertex.
#include "newton_policy.hpp"
#include "subdomain_solver.hpp"
#include "../linear/signed_multigrid.hpp"
#include "newton_update.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

class Newton {
public:
    // smooth_only: a few digits of the short waves are enough for the linear solves.
    Newton(LevelWork& work, bool smooth_only) :
        w_(work), f_(work.state.foliation), weight_(work.level.weight), step_(work, model_), smooth_only_(smooth_only) {
    }

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
    void relax_after_step(bool far) {
        pick_near_zeros(far ? steering::FAR_RINGS : steering::NEAR_RINGS);
        const size_t n = f_.mesh.vertex_count, most = size_t{steering::MOVES_PER_VERTEX} * n / (picked_.size() + 1);
        const size_t wanted = far ? steering::FAR_PASSES : steering::NEAR_PASSES;
        // Not on a double, where what fades along a strip is found by these moves (test_weight_search.cpp).
        zeros_everywhere_ = !w_.state.hierarchy->is_double()
                         && static_cast<double>(picked_.size()) > steering::EVERYWHERE * static_cast<double>(n);
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

    // The residuals that the linear solves report are not accurate: with edges of weight 10^5 the rounding of single
    // precision is a residual. Later solves compute the true one.
    void check_solves() { checked_ = true; }

    // Steps to the minimum itself, whatever the residual: the remaining error is the rounding to the unit.
    hmf_status step_precisely() {
        Effort effort{};
        effort.loose = effort.tight = steering::PRECISE_ACCURACY;
        effort.close = effort.go_on = checked_ = true;
        for (uint32_t i = 0; i < steering::PRECISE_STEPS; ++i) {
            if (!linearize()) return interrupted(w_.call);
            double accepted = 0;
            bool tight = false;
            if (const hmf_status status = step(effort, accepted, tight)) return status;
            if (accepted < 1) break;
        }
        return HMF_OK;
    }

    // Picks the vertices with a residual above this value, those near zeros, and some rings around all of them, for a
    // local step; false: they are more than this share of all.
    bool is_in_part(double residual, double share) {
        pick_near_zeros(0);
        for (uint32_t v = 0; v < model_.count; ++v)
            if (distance_[v] == NONE && !model_.is_fixed[v]
                && std::fabs(model_.right[v]) * static_cast<double>(model_.row_scale[v]) > residual) {
                distance_[v] = 0;
                picked_.add(v);
            }
        const size_t most = static_cast<size_t>(share * model_.count);
        if (picked_.size() > most) return false;
        grow_picked(steering::PART_RINGS);
        return picked_.size() <= most;
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
        part_step_ = effort.part;
        if (part_step_) {
            multigrid_.release_vectors();
            if (!part_.extract(model_, distance_, Solver::multigrid, w_.call)) return false;
        } else {
            ++w_.statistics.linear_solve_count;
        }
        tight = model_.is_exact();
        // On limbs that no loop goes around, the values decay below the error of a loose solve. The solve is then
        // continued as long as this reduces the number of extrema.
        const uint64_t few_extrema = w_.state.hierarchy->is_double() ? steering::FEW_EXTREMA_ON_DOUBLE : 0;
        uint64_t had = UINT64_MAX;
        for (double accuracy = tight ? effort.tight : effort.loose;; accuracy *= steering::CONTINUED) {
            if (!solve_linear(accuracy, effort.residual)) return false;
            if (had != UINT64_MAX) step_.restore(); // else they are there
            std::memcpy(unbounded_.data(), model_.d.data(), model_.count * sizeof(double));
            set_bounded_values();
            if (!w_.go_on()) return false;
            if (effort.go_on && !model_.is_exact() && (tight || zeros_stay())) {
                if (!tight) accuracy = effort.tight;
                tight = true;
                step_.restore();
                if (!solve_between_bounds(accuracy, effort.residual)) return false;
                step_.set_values(1);
            }
            if (!w_.go_on()) return false;
            uint64_t extrema = step_.find_candidates();
            if (had == UINT64_MAX) limbs_were_wrong_ = extrema > few_extrema;
            if (extrema > few_extrema && !tight) {
                // Unknowns fixed at their bounds restrict their neighbors: start again from the unprojected solution.
                step_.restore();
                std::memcpy(model_.d.data(), unbounded_.data(), model_.count * sizeof(double));
                set_bounded_values();
                extrema = step_.find_candidates();
            }
            if (extrema <= few_extrema || extrema >= had || accuracy < steering::END_OF_DOUBLES) return true;
            had = extrema;
            if (smooth_only_) multigrid_ready_ = smooth_only_ = false;
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
        double factor = 1, rise = 0;
        uint32_t radius = steering::FIRST_RINGS_HELD, solves = 0;
        const bool unchecked = w_.options.unchecked > 0 && !w_.gated;
        if (unchecked) lengthen(w_.options.unchecked);
        for (uint32_t attempt = 0; attempt < steering::STEP_ATTEMPTS && factor > steering::LEAST_FACTOR; ++attempt) {
            step_.forget_too_far();
            if (attempt > 0) {
                bounds_met_ = UINT64_MAX; // some are held
                step_.set_values(factor);
                if (!w_.go_on()) return interrupted(w_.call);
                step_.find_candidates();
            }
            step_.list_invalid(picked_);
            const bool valid = step_.remove_extrema(factor, patch_) && (unchecked || step_.zeros_are_in_place());
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
            } else if (valid && !part_step_
                       && (solves < steering::SOLVES_OF_A_STEP || energy_change_ < steering::RISE_GETS_LESS * rise)
                       && (effort.close || energy_change_ < steering::CURABLE_RISE * model_.energy)) {
                ++solves;
                rise = energy_change_;
                ++w_.statistics.linear_solve_count;
                // Far from the minimum this model does not last, and the setup is for one without these bounds.
                const double accuracy = effort.close ? effort.tight : steering::FIRST_ACCURACY;
                if (!solve_between_bounds(accuracy, effort.residual)) return interrupted(w_.call);
            } else if (step_.too_far() != NONE && attempt < steering::MENDING_ATTEMPTS) {
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
    // reverse: the others stay where they are from now on.  any: there are some, and not too many.
    Done fix_overturned(bool& any) {
        Array<uint32_t> held;
        held.start(w_.call.memory);
        for (uint32_t v = 0; v < f_.mesh.vertex_count && held.size() < steering::MOST_OVERTURNED; ++v) {
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
        any = !held.empty() && held.size() < steering::MOST_OVERTURNED;
        if (!any) return true;
        model_.fix_around(f_, w_.rings, held, 1, patch_, distance_);
        return true;
    }

    LinearOptions stop_at(double residual) const {
        LinearOptions options;
        options.unchecked = !checked_; // the next linearization evaluates the step
        if (residual > 0) options.row_scale = model_.row_scale.data();
        options.row_tolerance = residual;
        return options;
    }

    // So many rows have changed that the old setup would be too slow.
    bool has_changed_much() const {
        const size_t rows = w_.call.parallel.sum_blocks<size_t>(model_.count, [&](size_t begin, size_t end) {
            size_t sum = 0;
            for (size_t v = begin; v < end; ++v) sum += model_.changed[v];
            return sum;
        });
        return static_cast<double>(rows) > steering::CHANGED_SHARE * static_cast<double>(model_.count);
    }

    // Continues from model_.d.  The matrix of a level changes by signs near the
    // zeros only: one setup is used for all its steps unless it needs too many iterations.
    Done solve_linear(double accuracy, double residual) {
        if (part_step_) return part_.solve(model_, accuracy, w_.call);
        if (direct_) return solve_directly(false);
        part_.release(); // which may have been most of the mesh
        const SignedMatrix matrix = model_.matrix();
        LinearOptions options = stop_at(residual);
        if (multigrid_ready_ && !has_changed_much()) {
            options.stop_if_too_slow = true;
            if (!multigrid_.claim_vectors(w_.call.memory)) return false;
            multigrid_.refresh(matrix, model_.changed.data(), w_.call.parallel);
            model_.forget_changes(w_.call.parallel);
            const LinearResult result = multigrid_.solve(matrix, model_.right.data(), model_.d.data(), accuracy,
                                                         steering::ITERATIONS_WITH_OLD_SETUP, w_.call, options);
            if (w_.call.cancelled() || w_.call.finishing()) return false;
            if (result.converged) return true;
            options.stop_if_too_slow = false;
        }
        multigrid_ready_ = false;
        if (!multigrid_.setup(matrix, w_.call.memory, &w_.call, smooth_only_ ? 1 : SignedMultigrid::MAX_LEVELS))
            return false;
        multigrid_ready_ = true;
        model_.forget_changes(w_.call.parallel);
        const LinearResult result = multigrid_.solve(
            matrix, model_.right.data(), model_.d.data(), accuracy,
            smooth_only_ ? steering::ITERATIONS_WITH_SMOOTHER : steering::ITERATIONS_WITH_NEW_SETUP, w_.call, options);
        if (w_.call.cancelled() || w_.call.finishing()) return false;
        if (smooth_only_ || !failed(result, accuracy)) return true;
        direct_ = true;
        return solve_directly(false);
    }

    bool failed(const LinearResult& result, double accuracy) const {
        return !result.converged && result.residual > steering::FAILED_RESIDUAL
            && result.residual > steering::FAILED_SHARE * accuracy && !w_.call.out_of_time();
    }

    // Used if the multigrid fails. held: solves for the unknowns that are not fixed.
    Done solve_directly(bool held) {
        ++w_.statistics.linear_solve_count;
        for (uint32_t v = 0; v < model_.count; ++v) distance_[v] = 0;
        for (size_t k = 0; held && k < model_.at_bounds.size(); ++k) distance_[model_.at_bounds[k]] = NONE;
        multigrid_.release_vectors();
        const bool done = part_.extract(model_, distance_, Solver::direct, w_.call)
                       && part_.solve(model_, steering::TIGHTEST, w_.call);
        part_.release();
        return done;
    }

    // The unknowns at a bound keep their value, the others are solved for.
    Done solve_between_bounds(double accuracy, double residual) {
        for (uint32_t pass = 0; pass < steering::PASSES_BETWEEN_BOUNDS; ++pass) {
            model_.fix_active();
            LinearResult result;
            if (!direct_) {
                LinearOptions options = stop_at(residual);
                options.fixed = model_.at_bounds.data();
                options.fixed_count = model_.at_bounds.size();
                if (!multigrid_.claim_vectors(w_.call.memory)) return false;
                result = multigrid_.solve(model_.matrix(), model_.right.data(), model_.d.data(), accuracy,
                                          steering::ITERATIONS_BETWEEN_BOUNDS, w_.call, options);
                w_.statistics.linear_solve_count += pass > 0 && result.iterations > 0;
                if (w_.call.cancelled() || w_.call.finishing()) return false;
            }
            if ((direct_ || failed(result, accuracy)) && !solve_directly(true)) return false;
            const bool released = model_.release();
            if (model_.project(f_, w_.rings, patch_, distance_) == 0 && !released) break;
        }
        return true;
    }

    // After a step: do the vertices that came to a bound stay there?  Then the
    // model lasts.  Else they go on past it in the next step.
    bool zeros_stay() {
        model_.fix_active();
        for (uint32_t v : model_.at_bounds)
            if (residual_at(f_, w_.rings, weight_, v, 0, w_.star) > steering::BALANCED_SHARE) return false;
        return true;
    }

    LevelWork& w_;
    Foliation& f_;
    const double* weight_;
    TwistedModel model_;
    NewtonUpdate step_;
    SignedMultigrid multigrid_;
    bool multigrid_ready_ = false;
    bool zeros_everywhere_ = false, limbs_were_wrong_ = false, checked_ = false;
    uint64_t bounds_met_ = UINT64_MAX; // by the last step
    SubdomainSolver part_;
    bool part_step_ = false; // the step in hand is one of the part
    bool direct_ = false;    // the multigrid fails on this level
    bool smooth_only_;
    Array<double> unbounded_; // the solution of the model before it was brought into its bounds
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

// For the whole level, or a part of it.
Effort next_effort(const LevelWork& work, const LevelPolicy& plan, Newton& newton, LocalSteps& parts, uint32_t round,
                   double residual) {
    Effort effort = effort_for(round, residual, plan.goal, plan.finest);
    if (plan.finest && !work.gated && parts.are_worth_it(round, residual))
        effort.part =
            newton.is_in_part(std::max(steering::PART_RESIDUAL * residual, 0.5 * plan.goal),
                              round < steering::EARLY_PART_ROUNDS ? steering::EARLY_PART_SHARE : steering::PART_SHARE);
    parts.next(effort.part);
    return effort.part ? effort_for_part(effort) : effort;
}

} // namespace

hmf_status newton_level(LevelWork& work, double tolerance) {
    const LevelPolicy plan(work, tolerance);
    const bool finest = plan.finest;
    const double goal = plan.goal;
    Newton newton(work, plan.smooth_only);
    if (!newton.allocate()) return work.call.out_of_memory();
    newton.sweeps(plan.coarsest ? steering::COARSEST_SWEEPS : steering::FINER_SWEEPS);
    if (plan.sweep_only) return work.call.cancelled() || work.call.finishing() ? HMF_CANCELLED : HMF_OK;
    StallDetector progress;
    uint64_t steps_left = finest && work.options.step_limit ? work.options.step_limit : plan.rounds;
    UnitRefinement unit{!finest};
    LocalSteps parts;
    uint32_t stalls_left = work.options.unchecked > 0 ? 0 : steering::STALLS;
    bool moves_wait = false, zeros_moved = false;
    uint32_t failed = 0;   // steps in a row that were not taken whole
    double tight_from = 0; // the residual before a tight step of the whole level within all bounds
    for (uint32_t round = 0; round < plan.rounds; ++round) {
        if (!newton.linearize()) return interrupted(work.call);
        const TwistedModel& model = newton.model();
        // After a step that was solved for to the end moves are made only if it has not reached the goal.
        if (moves_wait && model.residual_max > goal) {
            newton.relax_after_step(finest && round > steering::FAR_AFTER + 1);
            if (round > steering::LATE_AFTER_TIGHT + 1) newton.sweeps(steering::LATE_SWEEPS);
            if (!newton.linearize()) return interrupted(work.call);
        }
        moves_wait = false;
        // Such a step should reduce the residual to almost nothing.
        if (tight_from > 0 && model.residual_max > steering::LESS_RESIDUAL * tight_from) newton.check_solves();
        tight_from = 0;
        if (work.call.finishing()) return HMF_CANCELLED;
        // The first step of a level needs no reason but on the last level.
        const double residual = round == 0 && !finest ? 1 : model.residual_max;
        if (plan.next_to_double && residual < steering::DOUBLE_RESIDUAL) return HMF_OK;
        if (!work.record(2, model.energy, residual)) return work.call.out_of_memory();
        if (residual <= goal || is_good_start(plan, newton, residual)) {
            work.recorder.certificate = {true, model.energy, residual, model.residual_sum / model.count};
            if (work.guard && !newton.hand_over(work.guard->zeros)) return work.call.out_of_memory();
            return HMF_OK;
        }
        const uint32_t patience = zeros_moved ? std::max(unit.patience, steering::PATIENCE_WITH_ZEROS) : unit.patience;
        if (!parts.in_a_row && !progress.goes_on(residual, model.energy, patience)) {
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
        Effort effort = next_effort(work, plan, newton, parts, round, residual);
        effort.close |= failed >= steering::FAILURES;
        if (const hmf_status status = newton.step(effort, accepted, tight)) return status;
        failed = accepted < 1 ? failed + 1 : 0;
        zeros_moved = accepted == 1 && !newton.was_within_bounds();
        if (effort.part) {
            if (accepted < 1) ++parts.shortened;
            newton.relax_after_step(false);
            continue;
        }
        moves_wait = accepted == 1 && tight && !plan.middle;
        if (moves_wait && newton.was_within_bounds()) tight_from = residual;
        if (moves_wait) continue;
        newton.relax_after_step(finest && round > steering::FAR_AFTER);
        if (accepted == 1 && plan.middle && !(plan.next_to_double && round == 0) && !newton.limbs_were_wrong())
            return HMF_OK; // it only provides a start
        if (accepted < 1) newton.sweeps(steering::SWEEPS_AFTER_SHORT_STEP);
        else if (round > steering::LATE_AFTER) newton.sweeps(steering::LATE_SWEEPS);
    }
    if (work.call.cancelled() || work.call.finishing()) return HMF_CANCELLED;
    if (!finest) return HMF_OK;
    if (const hmf_status status = newton.step_precisely()) return status;
    return end_beyond_rounding(work, goal);
}

} // namespace hmf
