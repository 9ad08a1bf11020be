#include "newton_step.hpp"

#include "parameters.hpp"

#include <cmath>

namespace hmf {

Done NewtonStep::allocate() {
    Memory& memory = w_.call.memory;
    const Mesh& mesh = f_.mesh;
    const size_t n = mesh.vertex_count;
    patch_.start(memory);
    return model_.allocate(mesh, memory, w_.call.parallel) && update_.allocate() && unbounded_.allocate(memory, n)
        && patch_.reserve(n);
}

hmf_status NewtonStep::take(const SolveTolerance& tolerance, StepOutcome& outcome) {
    outcome = {};
    update_.begin();
    const hmf_status status = try_step(tolerance, outcome);
    if (outcome.share == 0) update_.restore();
    outcome.zeros_stay = bounds_met_ == 0;
    return status;
}

// Leaves the values changed where it is not accepted.
hmf_status NewtonStep::try_step(const SolveTolerance& tolerance, StepOutcome& outcome) {
    if (!propose(tolerance, outcome)) return interrupted(w_.call);
    double factor = 1, rise = HUGE_VAL;
    for (uint32_t attempt = 0; attempt < parameters::STEP_ATTEMPTS; ++attempt) {
        if (attempt > 0) {
            bounds_met_ = UINT64_MAX;
            update_.set_values(factor);
            if (!w_.go_on()) return interrupted(w_.call);
            update_.find_candidates();
        }
        bool is_valid = false, keeps = true;
        const bool passed = passes(is_valid);
        if (w_.call.memory.failure() || !w_.go_on()) return interrupted(w_.call);
        if (passed) {
            if (const hmf_status status = keeps_class(keeps)) return status;
            if (keeps) {
                outcome.share = factor;
                return HMF_OK;
            }
        }
        update_.restore();
        if (!keeps) {
            bool is_held = false;
            if (!fix_overturned(is_held)) return w_.call.out_of_memory();
            if (!is_held) factor *= 0.5;
        } else if (!outcome.is_tight && tolerance.tight < tolerance.loose) {
            outcome.is_tight = true;
            if (!solve_linear(tolerance.tight, tolerance.residual)) return interrupted(w_.call);
            model_.project(f_, w_.rings, patch_, distance_);
        } else if (is_valid && energy_change_ < parameters::PROGRESS * rise) {
            rise = energy_change_;
            ++w_.statistics.linear_solve_count;
            if (!solve_between_bounds(tolerance.tight, tolerance.residual)) return interrupted(w_.call);
        } else if (update_.too_far() != NONE) {
            // Where the certificate judges, zeros may move: there one place at a time is held.
            if (w_.checks_class()) invalid_.clear();
            invalid_.add(update_.too_far());
            model_.fix_around(f_, w_.rings, invalid_, 1 + attempt, patch_, distance_); // more and more rings
        } else {
            factor *= 0.5;
        }
    }
    return HMF_OK;
}

// Solves the model and sets the values of the whole step; false: see interrupted().
Done NewtonStep::propose(const SolveTolerance& tolerance, StepOutcome& outcome) {
    model_.assemble(f_, w_.rings, weight_, w_.call);
    if (!w_.go_on()) return false;
    ++w_.statistics.linear_solve_count;
    bool& tight = outcome.is_tight = model_.is_exact();
    // On protrusions that no loop goes around, the values decay below the error of a loose solve. The solve is then
    // continued as long as this reduces the number of extrema.
    uint64_t had = UINT64_MAX;
    for (double accuracy = tight ? tolerance.tight : tolerance.loose;; accuracy *= parameters::CONTINUED) {
        if (!solve_linear(accuracy, tolerance.residual)) return false;
        if (had != UINT64_MAX) update_.restore(); // else they are there
        std::memcpy(unbounded_.data(), model_.d.data(), model_.count * sizeof(double));
        set_bounded_values();
        if (!w_.go_on()) return false;
        if (tolerance.tight < tolerance.loose && !model_.is_exact() && (tight || bounds_met_ == 0)) {
            if (!tight) accuracy = tolerance.tight;
            tight = true;
            update_.restore();
            if (!solve_between_bounds(accuracy, tolerance.residual)) return false;
            update_.set_values(1);
        }
        if (!w_.go_on()) return false;
        uint64_t extrema = update_.find_candidates();
        if (had == UINT64_MAX) outcome.had_extrema = extrema > 0;
        if (extrema > 0 && !tight) {
            // Unknowns fixed at their bounds restrict their neighbors: start again from the unprojected solution.
            update_.restore();
            std::memcpy(model_.d.data(), unbounded_.data(), model_.count * sizeof(double));
            set_bounded_values();
            extrema = update_.find_candidates();
        }
        if (extrema == 0 || extrema >= had || accuracy < parameters::TIGHTEST) return true;
        had = extrema;
        std::memcpy(model_.d.data(), unbounded_.data(), model_.count * sizeof(double));
    }
}

void NewtonStep::set_bounded_values() {
    bounds_met_ = model_.project(f_, w_.rings, patch_, distance_);
    update_.set_values(1);
}

// is_valid: also without regard to the energy.
bool NewtonStep::passes(bool& is_valid) {
    update_.forget_too_far();
    update_.list_invalid(invalid_);
    is_valid = update_.remove_extrema() && update_.zeros_are_in_place();
    if (is_valid) energy_change_ = update_.energy_change();
    return is_valid && energy_change_ <= 0;
}

hmf_status NewtonStep::keeps_class(bool& keeps) {
    keeps = true;
    if (!w_.checks_class()) return HMF_OK;
    const hmf_status status = w_.guard->certify(w_.state, w_.log.unit(), w_.call);
    keeps = w_.guard->holds();
    return status;
}

// The values before the step are back, the step is not.  A step keeps the class if
// each vertex has in each of its directions an edge that the step does not
// reverse: the others stay where they are from now on.  any: there are some.
Done NewtonStep::fix_overturned(bool& any) {
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
            if (f_.at(h) != 0) here |= !update_.reverses(h);
            if (f_.corner2(h) != 0 || f_.at(h) == 0) continue;
            if (closed++ == 0) first = here;
            else overturned |= !here;
            here = false;
        }
        if (closed > 0) overturned |= !(here || first);
        if (overturned && !held.push(v)) return false;
    }
    any = !held.empty();
    if (any) model_.fix_around(f_, w_.rings, held, 1, patch_, distance_);
    return true;
}

// Continues from model_.d.
Done NewtonStep::solve_linear(double accuracy, double residual, bool between_bounds) {
    LinearOptions options;
    options.row_tolerance = residual;
    options.fixed = between_bounds ? model_.at_bounds.data() : nullptr;
    options.fixed_count = between_bounds ? model_.at_bounds.size() : 0;
    return solver_.solve(model_.system(), model_.changed.data(), accuracy, options, w_.call);
}

// The unknowns at a bound keep their value, the others are solved for.
Done NewtonStep::solve_between_bounds(double accuracy, double residual) {
    model_.fix_active();
    if (!solve_linear(accuracy, residual, true)) return false;
    model_.release();
    model_.project(f_, w_.rings, patch_, distance_);
    return true;
}

} // namespace hmf
