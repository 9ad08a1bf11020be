#include "subdomain_solver.hpp"

#include "steering.hpp"

#include <cmath>

namespace hmf {

namespace {

// Without zeros, and where nothing is held, d is known up to a constant, which rounding would make large.  What
// rounding leaves in the sum of the right sides comes where it counts least.
void hold_one(const TwistedModel& model, Array<uint32_t>& number, const uint32_t* with) {
    if (!model.is_exact()) return;
    uint32_t strongest = 0;
    for (uint32_t v = 0; v < model.count; ++v) {
        if (model.is_fixed[v] || number[v] == NONE) return;
        if (model.row_scale[v] < model.row_scale[strongest]) strongest = v;
    }
    const auto leader = [with](uint32_t v) { return with ? with[v] : v; };
    for (uint32_t v = 0; v < model.count; ++v)
        if (leader(v) == leader(strongest)) number[v] = NONE;
}

} // namespace

Done SubdomainSolver::list_unknowns(const TwistedModel& model, Array<uint32_t>& number, const uint32_t* with,
                                    Memory& memory) {
    const auto leader = [with](uint32_t v) { return with ? with[v] : v; };
    uint32_t count = 0, vertices = 0, entries = 0;
    for (uint32_t v = 0; v < model.count; ++v) {
        if (model.is_fixed[v]) number[v] = NONE;
        if (number[v] == NONE) continue;
        number[v] = leader(v) == v ? count++ : number[leader(v)];
        if (number[v] == NONE) continue;
        ++vertices;
        entries += model.offset[v + 1] - model.offset[v];
    }
    if (!first_.allocate_filled(memory, count + size_t{1}, 0u) || !vertex_.allocate(memory, vertices)
        || !offset_.allocate(memory, count + size_t{1}) || !column_.allocate(memory, entries)
        || !entry_.allocate(memory, entries) || !diagonal_.allocate(memory, count) || !right_.allocate(memory, count)
        || !d_.allocate(memory, count))
        return false;
    for (uint32_t v = 0; v < model.count; ++v)
        if (number[v] != NONE) ++first_[number[v]];
    for (uint32_t i = 0, before = 0; i <= count; ++i) {
        const uint32_t size = first_[i];
        first_[i] = before;
        before += size;
    }
    for (uint32_t v = 0; v < model.count; ++v)
        if (number[v] != NONE) vertex_[first_[number[v]]++] = v;
    for (uint32_t i = count; i > 0; --i) first_[i] = first_[i - 1];
    first_[0] = 0;
    return true;
}

Done SubdomainSolver::extract(const TwistedModel& model, Array<uint32_t>& number, Solver solver, Call& call,
                              const uint32_t* with) {
    if (solver == Solver::direct) hold_one(model, number, with);
    if (!list_unknowns(model, number, with, call.memory)) return false;
    uint32_t at = 0;
    for (uint32_t i = 0; i < d_.size(); ++i) {
        const bool alone = first_[i + 1] - first_[i] == 1;
        double right = 0, diagonal = 0;
        offset_[i] = at;
        for (uint32_t m = first_[i]; m < first_[i + 1]; ++m) {
            const uint32_t v = vertex_[m];
            right += model.right[v];
            if (alone) diagonal = model.diagonal[v];
            for (uint32_t t = model.offset[v]; t < model.offset[v + 1]; ++t) {
                const uint32_t other = number[model.column[t]];
                // The sum of the diagonals less what joins them, of which rounding would leave nothing.
                if (!alone && other != i) diagonal += std::fabs(model.entry[t]);
                if (!alone && other == i) continue;
                if (other == NONE) {
                    right -= model.entry[t] * model.d[model.column[t]];
                    continue;
                }
                column_[at] = other;
                entry_[at++] = model.entry[t];
            }
        }
        diagonal_[i] = diagonal;
        right_[i] = right;
        d_[i] = model.d[vertex_[first_[i]]];
    }
    offset_[d_.size()] = at;
    factor_ = SparseFactor();
    if (solver == Solver::direct && !factor_.build(matrix(), call)) return false;
    return !factor_.empty() || multigrid_.setup(matrix(), call.memory, &call);
}

Done SubdomainSolver::solve(TwistedModel& model, double accuracy, Call& call) {
    if (factor_.empty())
        multigrid_.solve(matrix(), right_.data(), d_.data(), accuracy, steering::ITERATIONS_WITH_NEW_SETUP, call);
    else if (!factor_.solve(right_.data(), d_.data(), call.memory)) return false;
    for (uint32_t i = 0; i < d_.size(); ++i)
        for (uint32_t m = first_[i]; m < first_[i + 1]; ++m) model.d[vertex_[m]] = d_[i];
    return !call.cancelled() && !call.finishing();
}

} // namespace hmf
