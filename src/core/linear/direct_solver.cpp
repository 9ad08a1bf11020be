#include "direct_solver.hpp"

#include <cmath>

namespace hmf {

namespace {

// Of the multigrid, if the factor would be too large.
constexpr double FALLBACK_ACCURACY = 1e-12;
constexpr uint32_t FALLBACK_ITERATIONS = 200;

// If nothing is held in a singular system, x is known up to a constant, which rounding would make large.  What
// rounding leaves in the sum of the right sides comes where it counts least.
void hold_one(const LinearSystem& system, Array<uint32_t>& number, const uint32_t* with) {
    if (!system.is_singular) return;
    uint32_t strongest = 0;
    for (uint32_t i = 0; i < system.matrix.n; ++i) {
        if (system.is_fixed[i] || number[i] == DirectSolver::HELD) return;
        if (system.row_scale[i] < system.row_scale[strongest]) strongest = i;
    }
    const auto leader = [with](uint32_t i) { return with ? with[i] : i; };
    for (uint32_t i = 0; i < system.matrix.n; ++i)
        if (leader(i) == leader(strongest)) number[i] = DirectSolver::HELD;
}

} // namespace

Done DirectSolver::list_unknowns(const LinearSystem& system, Array<uint32_t>& number, const uint32_t* with,
                                 Memory& memory) {
    const auto leader = [with](uint32_t v) { return with ? with[v] : v; };
    const SignedMatrix& a = system.matrix;
    uint32_t count = 0, members = 0, entries = 0;
    for (uint32_t v = 0; v < system.matrix.n; ++v) {
        if (system.is_fixed[v]) number[v] = HELD;
        if (number[v] == HELD) continue;
        number[v] = leader(v) == v ? count++ : number[leader(v)];
        if (number[v] == HELD) continue;
        ++members;
        entries += a.offset[v + 1] - a.offset[v];
    }
    if (!first_.allocate_filled(memory, count + size_t{1}, 0u) || !member_.allocate(memory, members)
        || !offset_.allocate(memory, count + size_t{1}) || !column_.allocate(memory, entries)
        || !entry_.allocate(memory, entries) || !diagonal_.allocate(memory, count) || !right_.allocate(memory, count)
        || !x_.allocate(memory, count))
        return false;
    for (uint32_t v = 0; v < system.matrix.n; ++v)
        if (number[v] != HELD) ++first_[number[v]];
    for (uint32_t i = 0, before = 0; i <= count; ++i) {
        const uint32_t size = first_[i];
        first_[i] = before;
        before += size;
    }
    for (uint32_t v = 0; v < system.matrix.n; ++v)
        if (number[v] != HELD) member_[first_[number[v]]++] = v;
    for (uint32_t i = count; i > 0; --i) first_[i] = first_[i - 1];
    first_[0] = 0;
    return true;
}

Done DirectSolver::extract(const LinearSystem& system, Array<uint32_t>& number, Call& call, const uint32_t* with) {
    hold_one(system, number, with);
    if (!list_unknowns(system, number, with, call.memory)) return false;
    const SignedMatrix& a = system.matrix;
    uint32_t at = 0;
    for (uint32_t i = 0; i < x_.size(); ++i) {
        const bool alone = first_[i + 1] - first_[i] == 1;
        double right = 0, diagonal = 0;
        offset_[i] = at;
        for (uint32_t m = first_[i]; m < first_[i + 1]; ++m) {
            const uint32_t v = member_[m];
            right += system.right[v];
            if (alone) diagonal = a.diagonal[v];
            for (uint32_t t = a.offset[v]; t < a.offset[v + 1]; ++t) {
                const uint32_t other = number[a.column[t]];
                // The sum of the diagonals less what joins them, of which rounding would leave nothing.
                if (!alone && other != i) diagonal += std::fabs(a.entry[t]);
                if (!alone && other == i) continue;
                if (other == HELD) {
                    right -= a.entry[t] * system.x[a.column[t]];
                    continue;
                }
                column_[at] = other;
                entry_[at++] = a.entry[t];
            }
        }
        diagonal_[i] = diagonal;
        right_[i] = right;
        x_[i] = system.x[member_[first_[i]]];
    }
    offset_[x_.size()] = at;
    return factor_.build(matrix(), call);
}

Done DirectSolver::solve(const LinearSystem& system, Call& call) {
    if (!factor_.empty()) {
        factor_.solve(right_.data(), x_.data());
    } else {
        SignedMultigrid multigrid;
        if (!multigrid.setup(matrix(), call)) return false;
        multigrid.solve(matrix(), right_.data(), x_.data(), FALLBACK_ACCURACY, FALLBACK_ITERATIONS, call);
    }
    for (uint32_t k = 0; k < x_.size(); ++k)
        for (uint32_t m = first_[k]; m < first_[k + 1]; ++m) system.x[member_[m]] = x_[k];
    return !call.cancelled() && !call.finishing();
}

} // namespace hmf
