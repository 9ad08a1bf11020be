// The cycle of the signed multigrid (K-cycle: Notay, Vassilevski 2008) and
// conjugate gradients around it.  Not in [W].
//
//   level 0   smooth, restrict                      prolong, smooth
//   level 1        K-cycle: two steps of conjugate gradients, each with
//   level 2..           one V-cycle
//   last                     L D L^T factor
//
// One forward Gauss-Seidel sweep before and one backward after make the
// preconditioner symmetric but for the K-cycle and rounding; flexible
// conjugate gradients allow for those.
#include "signed_multigrid.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "signed_aggregation.hpp"

namespace hmf {

// Added to the diagonal of the coarsest level, which is about 1. Without it, a loose solve amplifies what is near the
// kernel, such as the wave of a ring of heavy edges.
static constexpr double COARSEST_SHIFT = 1e-3;

// --- Levels ------------------------------------------------------------------

MultigridLevels::~MultigridLevels() {
    if (!level_) return;
    for (uint32_t l = 0; l < MOST; ++l) level_[l].~MultigridLevel();
    memory_->give(level_, MOST * sizeof(MultigridLevel));
}

MultigridLevels& MultigridLevels::operator=(MultigridLevels&& other) noexcept {
    std::swap(level_, other.level_);
    std::swap(memory_, other.memory_);
    return *this;
}

Done MultigridLevels::start(Memory& memory) {
    if (level_) {
        for (uint32_t l = 0; l < MOST; ++l) level_[l] = MultigridLevel{};
        return true;
    }
    void* const block = memory.take(MOST * sizeof(MultigridLevel));
    if (!block) return false;
    level_ = static_cast<MultigridLevel*>(block);
    memory_ = &memory;
    for (uint32_t l = 0; l < MOST; ++l) new (level_ + l) MultigridLevel;
    return true;
}

Done SignedMultigrid::setup(const SignedMatrix& matrix, Call& call) {
    Memory& memory = call.memory;
    const Parallel& parallel = call.parallel;
    room_.release();
    coarse_room_.release();
    sums_.release();
    level_count_ = 0;
    coarsest_ = SparseFactor();
    coarsest_vector_.release();
    if (!level_.start(memory)) return false;
    const size_t n = matrix.n;
    double largest = 0;
    for (uint32_t i = 0; i < matrix.n; ++i)
        if (matrix.diagonal[i] > largest) largest = matrix.diagonal[i];
    double threshold = 1e-22 * largest;
    if (threshold < 1e-30) threshold = 1e-30;
    Array<double> near_kernel;
    if (!near_kernel.allocate_filled(memory, n, 1, parallel)) return false;
    CoarseMatrix storage;
    SignedMatrix current = matrix;
    float strength = 0.05f;
    for (uint32_t l = 0; l < MAX_LEVELS; ++l) {
        MultigridLevel& level = level_[l];
        const bool is_coarsest = l > 0 && current.n <= SMALL;
        if (is_coarsest) {
            if (!coarsest_vector_.allocate(memory, current.n) || !level.scale.allocate_filled(memory, current.n, 1))
                return false;
        } else if (!unit_diagonal_scale(current, threshold, level.scale, parallel, memory)) return false;
        if (l > 0) {
            MultigridLevel& finer = level_[l - 1];
            finer.prolongation.scale(level.scale.data(), finer.scale.data(), parallel);
            finer.prolongation.renumber(finer.matrix, parallel);
            if (l > 1) finer.scale.release();
        }
        if (is_coarsest) {
            if (!coarsest_.build(current, call, COARSEST_SHIFT)) return false;
            break;
        }
        ++level_count_;
        level.n = current.n;
        const bool last = current.n == 0 || l + 1 == MAX_LEVELS;
        CoarseMatrix coarse;
        if (!continues(call) || (!last && !coarsen(current, level, strength, near_kernel, coarse, call))
            || !continues(call) || !level.matrix.build(current, level.scale.data(), l == 0, parallel, memory)
            || !level.b.allocate(memory, level.n) || !level.x.allocate(memory, level.n)
            || !level.r.allocate(memory, level.n))
            return false;
        if (last) break;
        storage = static_cast<CoarseMatrix&&>(coarse);
        current = storage.view();
        // A coarse diagonal far below 1 belongs to the kernel of a component.
        threshold = 1e-11;
        strength *= 0.5f;
    }
    near_kernel.release();
    storage = CoarseMatrix{};
    // Last, when what the setup needed for itself is gone.
    uint32_t segments = 0;
    for (uint32_t l = 0; l < level_count_ && l < 2; ++l) segments = std::max(segments, level_[l].matrix.segments());
    return sums_.allocate(memory, segments)
        && (level_count_ < 2 || coarse_room_.allocate(memory, 2 * size_t{level_[1].n}))
        && room_.allocate(memory, 3 * n);
}

void SignedMultigrid::refresh(const SignedMatrix& matrix, const uint8_t* changed, const Parallel& parallel) {
    if (level_count_ > 0) level_[0].matrix.refresh(matrix, level_[0].scale.data(), changed, parallel);
}

// --- Cycle -------------------------------------------------------------------

float* SignedMultigrid::next_right(uint32_t l) {
    return l + 1 == level_count_ ? coarsest_vector_.data() : level_[l + 1].b.data();
}

const float* SignedMultigrid::next_solution(uint32_t l) const {
    return l + 1 == level_count_ ? coarsest_vector_.data() : level_[l + 1].x.data();
}

void SignedMultigrid::leave_out(const LinearOptions* held, const MultigridLevel& level, Array<float>& vector) {
    for (size_t k = 0; held && k < held->fixed_count; ++k) vector[level.matrix.number(held->fixed[k])] = 0;
}

// Between the sweeps of a level: the next one is given what the forward sweep has left, and its solution is added.
void SignedMultigrid::descend(uint32_t l, const Parallel& parallel, const LinearOptions* held) {
    MultigridLevel& level = level_[l];
    if (level.prolongation.empty()) return;
    level.matrix.find_rest(level.x.data(), level.r.data(), parallel);
    leave_out(held, level, level.r);
    const SweepMatrix* const next = l + 1 < level_count_ ? &level_[l + 1].matrix : nullptr;
    level.prolongation.restrict_to(next_right(l), level.r.data(), FLOOR_VALUE, next, parallel);
}

void SignedMultigrid::ascend(uint32_t l, const Parallel& parallel, const LinearOptions* held) {
    MultigridLevel& level = level_[l];
    if (level.prolongation.empty()) return;
    const SweepMatrix* const next = l + 1 < level_count_ ? &level_[l + 1].matrix : nullptr;
    level.prolongation.add_to(level.x.data(), next_solution(l), next, parallel);
    leave_out(held, level, level.x);
}

// Only the last level may have no next one: then there is no factor, and it is empty.
void SignedMultigrid::v_cycle(uint32_t l, const Parallel& parallel) {
    for (uint32_t m = l; m < level_count_; ++m) {
        level_[m].matrix.forward(level_[m].b.data(), level_[m].x.data(), parallel);
        descend(m, parallel);
    }
    coarsest_.solve(coarsest_vector_.data(), coarsest_vector_.data());
    for (uint32_t m = level_count_; m-- > l;) {
        ascend(m, parallel);
        level_[m].matrix.backward(level_[m].b.data(), level_[m].x.data(), parallel);
    }
}

// On level 0.
void SignedMultigrid::correct(const Parallel& parallel, const LinearOptions* held) {
    descend(0, parallel, held);
    if (level_count_ > 1) k_cycle(parallel);
    else v_cycle(1, parallel);
    ascend(0, parallel, held);
}

StepVectors SignedMultigrid::step_vectors(Array<double>& room, uint32_t l) {
    const size_t n = level_[l].n;
    float* const first = reinterpret_cast<float*>(room.data());
    StepVectors v;
    float** const vectors[] = {&v.product, &v.direction, &v.solution, &v.difference};
    for (size_t k = 0; k < 4; ++k) *vectors[k] = first + k * n;
    v.sums = sums_.data();
    return v;
}

// Two steps of flexible conjugate gradients on level 1.
void SignedMultigrid::k_cycle(const Parallel& parallel) {
    MultigridLevel& level = level_[1];
    const size_t n = level.n;
    const StepVectors v = step_vectors(coarse_room_, 1);
    float *const g = level.b.data(), *const x = level.x.data();
    const auto correct_level_1 = [&] {
        descend(1, parallel);
        v_cycle(2, parallel);
        ascend(1, parallel);
    };
    std::memset(v.solution, 0, n * sizeof(float));
    level.matrix.forward(g, x, parallel);
    correct_level_1();
    const StepSums first = level.matrix.backward_to_step(g, x, v, parallel);
    if (!(first.zAz > 0)) return;
    level.matrix.step_forward(static_cast<float>(first.zr / first.zAz), 0, g, x, v, parallel);
    correct_level_1();
    const StepSums second = level.matrix.backward_to_step(g, x, v, parallel);
    // The part of the second direction that is conjugate to the first.
    const double beta = -second.zq / first.zAz, rest = second.zAz + beta * second.zq;
    const float step = static_cast<float>(rest > 1e-6 * second.zAz ? second.zr / rest : 0),
                of_first = static_cast<float>(beta) * step;
    parallel.for_blocks(n, [=](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) x[i] = v.solution[i] + of_first * v.direction[i] + step * x[i];
    });
}

// --- Conjugate gradients -----------------------------------------------------

namespace {

bool is_zero(const double* x, size_t n, const Parallel& parallel) {
    struct Any {
        bool any = false;
        void operator+=(const Any& other) { any |= other.any; }
    };
    return !parallel
                .sum_blocks<Any>(n,
                                 [=](size_t begin, size_t end) {
                                     while (begin < end && x[begin] == 0) ++begin;
                                     return Any{begin < end};
                                 })
                .any;
}

} // namespace

// A solve on its way.
struct SignedMultigrid::Search {
    const SignedMatrix& matrix;
    const double* b;
    double* x;
    const LinearOptions& options;
    double reference, goal; // norms
    uint32_t limit;
    LinearResult result;

    bool is_small(double norm, double row) const {
        return !(norm > goal) || (options.row_scale && row <= options.row_tolerance);
    }
    void tell(double norm, double row) {
        result.residual = norm / reference;
        result.row_residual = row;
    }
};

// The true residual in the unit of the sweeps, as their right side, and its norms in that unit.
ResidualNorms SignedMultigrid::find_residual(const Search& s, double per_unit, const float* held,
                                             const Parallel& parallel) {
    const SignedMatrix& matrix = s.matrix;
    const SweepMatrix& sweeps = level_[0].matrix;
    const double *const b = s.b, *const x = s.x;
    const float *const scale = level_[0].scale.data(), *const row_scale = s.options.row_scale;
    float* const g = level_[0].b.data();
    const bool any_held = s.options.fixed_count > 0;
    const bool from_zero = s.result.iterations == 0 && is_zero(x, matrix.n, parallel);
    ResidualNorms norms = parallel.sum_blocks<ResidualNorms>(matrix.n, [=, &sweeps](size_t begin, size_t end) {
        ResidualNorms sum;
        for (size_t i = begin; i < end; ++i) {
            double r = b[i];
            if (!from_zero) {
                r -= matrix.diagonal[i] * x[i];
                for (uint32_t t = matrix.offset[i], last = matrix.offset[i + 1]; t < last; ++t)
                    r -= matrix.entry[t] * x[matrix.column[t]];
            }
            const uint32_t k = sweeps.number(i);
            double own = static_cast<double>(scale[i]) * r * per_unit;
            if (any_held && held[k] < 0) own = r = 0;
            g[k] = static_cast<float>(own) + FLOOR_VALUE;
            sum.squares += own * own;
            if (!row_scale) continue;
            const double row = static_cast<double>(row_scale[i]) * std::fabs(r);
            if (row > sum.largest_row) sum.largest_row = row;
        }
        return sum;
    });
    norms.largest_row *= per_unit;
    return norms;
}

// Steps that need no product with the matrix: they reduce the residual by a factor, then restart from the true
// residual. Ends without convergence where the true residual differs from the recurrence.
void SignedMultigrid::search_from(Search& s, Call& call) {
    constexpr double share = 1e-3, least_gain = 0.1, some_drift = 1.01, most_drift = 1.25, none = 1e300;
    const size_t n = s.matrix.n;
    MultigridLevel& level = level_[0];
    const float* const scale = level.scale.data();
    float *const g = level.b.data(), *const x = level.x.data();
    StepVectors v = step_vectors(room_, 0);
    v.row_scale = v.difference + n;
    const LinearOptions& options = s.options;
    const Parallel& parallel = call.parallel;
    const SweepMatrix& sweeps = level.matrix;
    parallel.for_blocks(n, [=, &sweeps, &options](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const uint32_t k = sweeps.number(i);
            v.row_scale[k] = options.row_scale && scale[i] > 0 ? options.row_scale[i] / scale[i] : 0;
            v.product[k] = v.direction[k] = 0;
        }
    });
    for (size_t k = 0; k < options.fixed_count; ++k) v.row_scale[sweeps.number(options.fixed[k])] = -1;
    double* const solution = s.x;
    double unit = s.reference, before = none, pq = 0; // 0: no direction yet
    bool broken = false, ended = false;
    for (;;) {
        // What 1 means in single precision is the norm of the residual, or nearly so.
        parallel.for_blocks(
            n, [=](size_t begin, size_t end) { std::memset(&v.solution[begin], 0, (end - begin) * sizeof(float)); });
        ResidualNorms norms = find_residual(s, 1 / unit, v.row_scale, parallel);
        const auto norm = [&] { return std::sqrt(norms.squares) * unit; };
        const auto row = [&] { return norms.largest_row * unit; };
        s.tell(norm(), row());
        s.result.converged = norm() < 1e300 && s.is_small(norm(), row());
        if (s.result.converged || s.result.iterations >= s.limit) return;
        if (broken || !(norm() < least_gain * before) || (before < none && norm() > most_drift * unit)) return;
        before = norm();
        const double enough = share * norm();
        // The direction is continued unless A p is too inexact; the component of the true residual along it is no
        // longer 0.
        if (norm() > some_drift * unit) pq = 0;
        double pr = parallel.sum_blocks<double>(n, [=](size_t begin, size_t end) {
            double sum = 0;
            for (size_t k = begin; k < end; ++k) sum += static_cast<double>(v.direction[k] * g[k]);
            return sum;
        });
        sweeps.forward(g, x, parallel, v.row_scale);
        while (!s.is_small(norm(), row()) && s.result.iterations < s.limit && norm() > enough) {
            if (!continues(call) || call.out_of_time()) {
                ended = true;
                break;
            }
            correct(parallel, &options);
            const StepSums sums = sweeps.backward_to_step(g, x, v, parallel);
            const double beta = pq > 0 ? -sums.zq / pq : 0;
            pq = sums.zAz + beta * sums.zq;
            ++s.result.iterations;
            broken = !(pq > 0) || !(sums.zr > 0);
            if (broken) break;
            const double alpha = (sums.zr + beta * pr) / pq;
            norms = sweeps.step_forward(static_cast<float>(alpha), static_cast<float>(beta), g, x, v, parallel);
            pr = 0;
        }
        s.tell(norm(), row());
        parallel.for_blocks(n, [=, &sweeps](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                solution[i] += static_cast<double>(scale[i]) * static_cast<double>(v.solution[sweeps.number(i)]) * unit;
        });
        if (ended) return;
        unit = norm();
    }
}

LinearResult SignedMultigrid::solve(const SignedMatrix& matrix, const double* b, double* x, double relative_tolerance,
                                    uint32_t iteration_limit, Call& call, const LinearOptions& options) {
    const size_t n = matrix.n;
    const float* const scale = level_[0].scale.data();
    const double reference = std::sqrt(call.parallel.sum_blocks<double>(n, [=](size_t begin, size_t end) {
        double squares = 0;
        for (size_t i = begin; i < end; ++i) {
            const double own = static_cast<double>(scale[i]) * b[i];
            squares += own * own;
        }
        return squares;
    }));
    LinearResult result;
    if (!(reference > 0) || !(reference < 1e300)) {
        for (size_t i = 0; i < n; ++i) x[i] = 0;
        result.converged = reference == 0;
        return result;
    }
    // Zero entries of the sweeps meet values that were not yet computed.
    for (uint32_t l = 0; l < level_count_; ++l) std::memset(level_[l].x.data(), 0, level_[l].n * sizeof(float));
    if (level_count_ > 1) std::memset(coarse_room_.data(), 0, coarse_room_.size() * sizeof(double));
    Search search{matrix, b, x, options, reference, relative_tolerance * reference, iteration_limit, result};
    search_from(search, call);
    return search.result;
}

} // namespace hmf
