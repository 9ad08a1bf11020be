#include "linear_solver.hpp"

namespace hmf {

namespace {

// A setup costs about ten iterations, and one for the current matrix needs a fifth as many of them.
constexpr uint32_t ITERATIONS_WITH_EARLIER_SETUP = 16;
constexpr uint32_t MOST_ITERATIONS = 200;
constexpr double MOST_CHANGED = 0.01; // share of the rows: the earlier setup is not tried

} // namespace

// The finest level of the multigrid takes the changed rows, unless there are too many.
Done LinearSolver::refresh(const SignedMatrix& matrix, uint8_t* changed, Call& call) {
    const size_t rows = call.parallel.sum_blocks<size_t>(matrix.n, [=](size_t begin, size_t end) {
        size_t sum = 0;
        for (size_t i = begin; i < end; ++i) sum += changed[i];
        return sum;
    });
    is_own_ = is_own_ && rows == 0;
    if (static_cast<double>(rows) > MOST_CHANGED * matrix.n) rung_ = Rung::setup;
    else if (rung_ == Rung::multigrid && rows > 0) multigrid_.refresh(matrix, changed, call.parallel);
    if (rung_ == Rung::setup) {
        if (!multigrid_.setup(matrix, call)) return false;
        rung_ = Rung::multigrid;
        is_own_ = true;
    }
    call.parallel.for_blocks(matrix.n, [=](size_t begin, size_t end) { std::memset(changed + begin, 0, end - begin); });
    return true;
}

Done LinearSolver::solve(const LinearSystem& system, uint8_t* changed, double accuracy, LinearOptions options,
                         Call& call) {
    options.row_scale = options.row_tolerance > 0 ? system.row_scale : nullptr;
    while (rung_ != Rung::direct) {
        if (!refresh(system.matrix, changed, call)) return false;
        const LinearResult result =
            multigrid_.solve(system.matrix, system.right, system.x, accuracy,
                             is_own_ ? MOST_ITERATIONS : ITERATIONS_WITH_EARLIER_SETUP, call, options);
        if (call.cancelled() || call.finishing()) return false;
        if (result.converged || call.out_of_time()) return true;
        rung_ = is_own_ ? Rung::direct : Rung::setup;
    }
    return solve_directly(system, options, call);
}

Done LinearSolver::solve_directly(const LinearSystem& system, const LinearOptions& options, Call& call) {
    multigrid_ = SignedMultigrid();
    Array<uint32_t> number;
    if (!number.allocate_filled(call.memory, system.matrix.n, 0u)) return false;
    for (size_t k = 0; k < options.fixed_count; ++k) number[options.fixed[k]] = DirectSolver::HELD;
    DirectSolver solver;
    return solver.extract(system, number, call) && solver.solve(system, call);
}

} // namespace hmf
