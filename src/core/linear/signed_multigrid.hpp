// Linear solver of the direct method: conjugate gradients, preconditioned by
// smoothed-aggregation multigrid that respects signs.
//
// The matrix is a graph Laplacian whose off-diagonals have signs s = +-1,
//
//     A_vv >= sum over edges of alpha,     A_uv = s_uv alpha_uv,
//
// symmetric positive semidefinite.  If the product of -s along every closed path is +, flipping the signs of some
// unknowns makes it an ordinary Laplacian. Near a tripod this is impossible: the foliation makes a half turn there.
// Nothing here needs a global choice of signs, each aggregate has its own.
//
// Sweeps work in single precision on the matrix scaled to unit diagonal, so weights
// from 1e-9 to 1e6 fit, and steps of conjugate gradients with them (sweep_matrix.hpp): the
// residual is taken in double, they make 1e-3 of it, and it is taken again.  Where single precision does not suffice
// for that, the solve ends without convergence (linear_solver.hpp has what follows).
#pragma once

#include "prolongation.hpp"
#include "sparse_factor.hpp"
#include "sweep_matrix.hpp"

namespace hmf {

// Optional input of a solve beside the matrix and the right side.
struct LinearOptions {
    // n values: good enough is also an x where no row of |b - A x| times its
    // row_scale exceeds row_tolerance.
    const float* row_scale = nullptr;
    double row_tolerance = 0;
    // Unknowns that keep the value they have in x; their rows are not read. If b is 0, the solution is taken to be 0,
    // and so must they be.
    const uint32_t* fixed = nullptr;
    size_t fixed_count = 0;
};

struct LinearResult {
    uint32_t iterations = 0;
    double residual = 0;     // |b - A x| without fixed rows / |b|, each row divided by the root of its diagonal
    double row_residual = 0; // largest |b - A x| of a row times its row_scale; 0 without
    bool converged = false;
};

// One level of the preconditioner: matrix with unit diagonal, prolongation
// from the next coarser level, and room for the cycle.
struct MultigridLevel {
    uint32_t n = 0;
    Array<float> scale; // n, 1 / root of the diagonal; 0: left out; the cycle needs that of level 0 only
    SweepMatrix matrix;
    Prolongation prolongation; // from the next level; empty on the last one
    Array<float> b, x, r;      // n, by the numbers of the matrix
};

// Room for all levels there may be, in the memory of the call: several multigrids lie on one stack.
class MultigridLevels {
public:
    static constexpr uint32_t MOST = 24;
    MultigridLevels() = default;
    ~MultigridLevels();
    MultigridLevels(const MultigridLevels&) = delete;
    MultigridLevels& operator=(const MultigridLevels&) = delete;
    MultigridLevels& operator=(MultigridLevels&& other) noexcept;

    Done start(Memory& memory); // all of them empty
    bool empty() const { return !level_; }
    MultigridLevel& operator[](uint32_t l) {
        assert(level_ && l < MOST);
        return level_[l];
    }
    const MultigridLevel& operator[](uint32_t l) const {
        assert(level_ && l < MOST);
        return level_[l];
    }

private:
    MultigridLevel* level_ = nullptr;
    Memory* memory_ = nullptr;
};

class SignedMultigrid {
public:
    static constexpr uint32_t MAX_LEVELS = MultigridLevels::MOST;

    // Builds the preconditioner. Not done also if the call was asked to finish. The matrix is not kept.
    Done setup(const SignedMatrix& matrix, Call& call);

    // Takes the values of a matrix that hardly differs, in the same columns, for the
    // smoother of the finest level; the coarse levels stay.  changed: rows with other values.
    void refresh(const SignedMatrix& matrix, const uint8_t* changed, const Parallel& parallel);

    // Solves A x = b from the given x.  A may differ from the matrix of setup
    // in values and columns, not in size: a change of signs near singularities
    // costs a few iterations and saves the setup.  A singular A is allowed
    // where b is consistent.  Stops early on cancellation, finishing and the
    // time limit of the call.  Needs no memory.
    LinearResult solve(const SignedMatrix& matrix, const double* b, double* x, double relative_tolerance,
                       uint32_t iteration_limit, Call& call, const LinearOptions& options = {});

private:
    float* next_right(uint32_t level);
    const float* next_solution(uint32_t level) const;
    // held: has the fixed unknowns, which the correction leaves out.
    void descend(uint32_t level, const Parallel& parallel, const LinearOptions* held = nullptr);
    void ascend(uint32_t level, const Parallel& parallel, const LinearOptions* held = nullptr);
    static void leave_out(const LinearOptions* held, const MultigridLevel& level, Array<float>& vector);
    void correct(const Parallel& parallel, const LinearOptions* held);
    void k_cycle(const Parallel& parallel);
    void v_cycle(uint32_t level, const Parallel& parallel);
    struct Search;
    void search_from(Search& search, Call& call);
    ResidualNorms find_residual(const Search& search, double per_unit, const float* held, const Parallel& parallel);

    static constexpr uint32_t SMALL = 150; // unknowns of the coarsest level
    MultigridLevels level_;
    uint32_t level_count_ = 0;     // with sweeps; at least one
    SparseFactor coarsest_;        // empty: the last level with sweeps is the coarsest
    Array<float> coarsest_vector_; // its right side, then its solution
    StepVectors step_vectors(Array<double>& room, uint32_t level);
    // The vectors of conjugate gradients, six in single precision.
    Array<double> room_;
    Array<double> coarse_room_; // for the steps of the K-cycle, on level 1
    Array<StepSums> sums_;      // of the segments of level 0 or 1
};

} // namespace hmf
