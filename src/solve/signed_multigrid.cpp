// The cycle of the signed multigrid (K-cycle: Notay, Vassilevski 2008) and
// conjugate gradients around it.  Not in [W].
//
//   level 0   smooth, restrict                      prolong, smooth
//   level 1        K-cycle: two steps of conjugate gradients, each with
//   level 2..           one V-cycle
//   last                     Cholesky factor
//
// One forward Gauss-Seidel sweep before and one backward after make the
// preconditioner symmetric but for the K-cycle and rounding; flexible
// conjugate gradients allow for those.
#include "signed_multigrid.hpp"

#include <cmath>

#include "signed_aggregation.hpp"

namespace hmf {

namespace {

// Left-out components and orientable foliations make the matrix singular;
// the shift keeps the kernel from being blown up.
constexpr double dense_shift = 1e-3;
// Added to the right side in single precision: far from its support the
// sweeps would decay into subnormal numbers, which are slow.
constexpr float floor_value = 1e-25f;

} // namespace

Done SignedMultigrid::setup(const SignedMatrix& matrix, Memory& memory, Call* call, uint32_t depth) {
    for (MultigridLevel& level : level_) level = MultigridLevel{};
    level_count_ = 0;
    dense_n_ = 0;
    const Parallel parallel = call ? call->parallel : Parallel();
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
    for (uint32_t l = 0; l < max_levels; ++l) {
        MultigridLevel& level = level_[l];
        if (!unit_diagonal_scale(current, threshold, level.scale, parallel, memory)) return false;
        if (l > 0) {
            MultigridLevel& finer = level_[l - 1];
            finer.prolongation.scale(level.scale.data(), finer.scale.data(), parallel);
            if (l > 1) finer.scale.release();
        }
        if (current.n <= dense_limit) {
            if (!factorise(current, level.scale, memory)) return false;
            break;
        }
        ++level_count_;
        level.n = current.n;
        const bool last = l + 1 == depth || l + 1 == max_levels;
        CoarseMatrix coarse;
        if (!continues(call) || (!last && !coarsen(current, level, strength, near_kernel, coarse, memory, call))
            || !continues(call) || !level.matrix.build(current, level.scale.data(), parallel, memory)
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
    if (level_count_ > 1) {
        const size_t m = level_[1].n;
        if (!right_.allocate(memory, m) || !first_.allocate(memory, m) || !image_.allocate(memory, m)) return false;
    }
    // Last, when what the setup needed for itself is gone.
    return residual_.allocate(memory, n) && direction_.allocate(memory, n) && product_.allocate(memory, n);
}

void SignedMultigrid::refresh(const SignedMatrix& matrix, const uint8_t* changed, const Parallel& parallel) {
    if (level_count_ > 0) level_[0].matrix.refresh(matrix, level_[0].scale.data(), changed, parallel);
}

double SignedMultigrid::operator_complexity() const {
    double all = 0;
    for (uint32_t l = 0; l < level_count_; ++l) all += level_[l].n + level_[l].matrix.stored_entries();
    return level_count_ ? all / (level_[0].n + level_[0].matrix.stored_entries()) : 1;
}

// --- Coarsest level ----------------------------------------------------------

Done SignedMultigrid::factorise(const SignedMatrix& matrix, const Array<float>& scale, Memory& memory) {
    const size_t n = matrix.n;
    dense_n_ = matrix.n;
    Array<double> a;
    if (!a.allocate_filled(memory, n * n, 0) || !dense_.allocate(memory, n * n) || !dense_inverse_.allocate(memory, n)
        || !dense_b_.allocate(memory, n))
        return false;
    for (size_t i = 0; i < n; ++i) {
        for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1]; ++k) {
            const size_t j = matrix.column[k];
            a[i * n + j] += matrix.entry[k] * static_cast<double>(scale[i]) * static_cast<double>(scale[j]);
        }
        a[i * n + i] = 1 + dense_shift;
    }
    // By columns, right-looking; column j of L is a[j * n + i], i >= j.
    for (size_t j = 0; j < n; ++j) {
        double pivot = a[j * n + j];
        if (pivot < 0.1 * dense_shift) pivot = 0.1 * dense_shift;
        const double inverse = 1 / std::sqrt(pivot);
        dense_inverse_[j] = static_cast<float>(inverse);
        for (size_t i = j + 1; i < n; ++i) a[j * n + i] *= inverse;
        for (size_t k = j + 1; k < n; ++k) {
            const double factor = a[j * n + k];
            if (factor == 0) continue;
            for (size_t i = k; i < n; ++i) a[k * n + i] -= factor * a[j * n + i];
        }
    }
    for (size_t j = 0; j < n; ++j)
        for (size_t i = j + 1; i < n; ++i) {
            const double value = a[j * n + i];
            dense_[j * n + i] = dense_[i * n + j] = value > 1e-20 || value < -1e-20 ? static_cast<float>(value) : 0.0f;
        }
    return true;
}

void SignedMultigrid::solve_dense(float* b) const {
    const size_t n = dense_n_;
    for (size_t j = 0; j < n; ++j) {
        const float* factor = &dense_[j * n];
        const float x = b[j] *= dense_inverse_[j];
        for (size_t i = j + 1; i < n; ++i) b[i] -= factor[i] * x;
    }
    for (size_t j = n; j-- > 0;) {
        const float* factor = &dense_[j * n];
        const float x = b[j] *= dense_inverse_[j];
        for (size_t i = 0; i < j; ++i) b[i] -= factor[i] * x;
    }
}

// --- Cycle -------------------------------------------------------------------

float* SignedMultigrid::next_right(uint32_t l) {
    return l + 1 == level_count_ ? dense_b_.data() : level_[l + 1].b.data();
}

const float* SignedMultigrid::next_solution(uint32_t l) const {
    return l + 1 == level_count_ ? dense_b_.data() : level_[l + 1].x.data();
}

// Forward sweep from x = 0, then the right side of the next level.
void SignedMultigrid::descend(uint32_t l, const Parallel& parallel) {
    MultigridLevel& level = level_[l];
    level.matrix.forward(level.b.data(), level.x.data(), level.r.data(), parallel);
    if (!level.prolongation.empty())
        level.prolongation.restrict_to(next_right(l), level.r.data(), floor_value, parallel);
}

// Adds the correction of the next level, then a backward sweep, which uses up b.
void SignedMultigrid::ascend(uint32_t l, const Parallel& parallel) {
    MultigridLevel& level = level_[l];
    if (!level.prolongation.empty()) level.prolongation.add_to(level.x.data(), next_solution(l), parallel);
    level.matrix.backward(level.b.data(), level.x.data(), parallel);
}

void SignedMultigrid::v_cycle(uint32_t first, const Parallel& parallel) {
    for (uint32_t l = first; l < level_count_; ++l) descend(l, parallel);
    solve_dense(dense_b_.data());
    for (uint32_t l = level_count_; l-- > first;) ascend(l, parallel);
}

namespace {

double dot(const float* x, const float* y, size_t n, const Parallel& parallel) {
    return parallel.sum_blocks<double>(n, [=](size_t begin, size_t end) {
        double sum = 0;
        for (size_t i = begin; i < end; ++i) sum += static_cast<double>(x[i]) * static_cast<double>(y[i]);
        return sum;
    });
}

// y = a x + b z.
void combine(float a, const float* x, float b, const float* z, float* y, size_t n, const Parallel& parallel) {
    parallel.for_blocks(n, [=](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) y[i] = a * x[i] + b * z[i];
    });
}

} // namespace

// Two steps of flexible conjugate gradients on level 1.
void SignedMultigrid::k_cycle(const Parallel& parallel) {
    MultigridLevel& level = level_[1];
    const size_t n = level.n;
    const float* b = right_.data();
    float* x = level.x.data();
    float* c = first_.data();
    float* v = image_.data();
    std::memcpy(right_.data(), level.b.data(), n * sizeof(float));
    v_cycle(1, parallel);
    std::memcpy(c, x, n * sizeof(float));
    const double cb = dot(c, b, n, parallel);
    level.matrix.multiply(c, v, parallel);
    const double cv = dot(c, v, n, parallel);
    if (!(cv > 0)) return;
    const double step = cb / cv;
    combine(1, b, -static_cast<float>(step), v, level.b.data(), n, parallel);
    v_cycle(1, parallel);
    // What is left of the second direction once it is conjugate to the first.
    const double xv = dot(x, v, n, parallel), xb = dot(x, b, n, parallel) - step * xv;
    const double xx = level.matrix.energy(x, parallel);
    const double rest = xx - xv * xv / cv;
    const double second = rest > 1e-6 * xx ? xb / rest : 0;
    combine(static_cast<float>(step - xv / cv * second), c, static_cast<float>(second), x, x, n, parallel);
}

void SignedMultigrid::precondition(const Parallel& parallel) {
    if (level_count_ < 2) {
        v_cycle(0, parallel);
        return;
    }
    descend(0, parallel);
    k_cycle(parallel);
    ascend(0, parallel);
}

// --- Conjugate gradients -----------------------------------------------------

namespace {

// y = A x.
void multiply(const SignedMatrix& a, const double* x, double* y, const Parallel& parallel) {
    parallel.for_blocks(a.n, [=](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            double v = a.diagonal[i] * x[i];
            for (uint32_t k = a.offset[i]; k < a.offset[i + 1]; ++k) v += a.entry[k] * x[a.column[k]];
            y[i] = v;
        }
    });
}

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

// The two norms of a residual: 2-norm with the scaling to unit diagonal,
// largest row with that of the caller.
struct ResidualNorms {
    double squares = 0, largest_row = 0;
    void operator+=(const ResidualNorms& other) {
        squares += other.squares;
        if (other.largest_row > largest_row) largest_row = other.largest_row;
    }
    double norm() const { return std::sqrt(squares); }
};

// row_scale: may be null.  residual(i) is asked for once for each row.  input: if not null,
// what the preconditioner is to have next, the scaled residual times factor.
template <class Residual>
ResidualNorms residual_norms(size_t n, const float* scale, const float* row_scale, float* input, double factor,
                             const Parallel& parallel, Residual residual) {
    return parallel.sum_blocks<ResidualNorms>(n, [=](size_t begin, size_t end) {
        ResidualNorms norms;
        for (size_t i = begin; i < end; ++i) {
            const double r = residual(i), g = static_cast<double>(scale[i]) * r;
            norms.squares += g * g;
            if (input) input[i] = static_cast<float>(g * factor) + floor_value;
            if (!row_scale) continue;
            const double row = static_cast<double>(row_scale[i]) * std::fabs(r);
            if (row > norms.largest_row) norms.largest_row = row;
        }
        return norms;
    });
}

// Of a preconditioned residual z on the residual, and on A times the direction before.
struct Projections {
    double zr = 0, zq = 0;
    void operator+=(const Projections& other) {
        zr += other.zr;
        zq += other.zq;
    }
};

// z: scaled back here.
Projections project(size_t n, const float* scale, float* z, const double* r, const double* q,
                    const Parallel& parallel) {
    return parallel.sum_blocks<Projections>(n, [=](size_t begin, size_t end) {
        Projections sum;
        for (size_t i = begin; i < end; ++i) {
            z[i] *= scale[i];
            sum.zr += static_cast<double>(z[i]) * r[i];
            sum.zq += static_cast<double>(z[i]) * q[i];
        }
        return sum;
    });
}

// p = z + beta p and q = A z + beta q, which is A p; returns p * q.
double next_direction(const SignedMatrix& a, const float* z, double beta, double* p, double* q,
                      const Parallel& parallel) {
    return parallel.sum_blocks<double>(a.n, [=](size_t begin, size_t end) {
        double sum = 0;
        for (size_t i = begin; i < end; ++i) {
            double v = a.diagonal[i] * static_cast<double>(z[i]);
            for (uint32_t k = a.offset[i]; k < a.offset[i + 1]; ++k)
                v += a.entry[k] * static_cast<double>(z[a.column[k]]);
            p[i] = static_cast<double>(z[i]) + beta * p[i];
            q[i] = v + beta * q[i];
            sum += p[i] * q[i];
        }
        return sum;
    });
}

// Does an error that falls as in the last iterations reach its goal within the limit?
class Pace {
public:
    explicit Pace(uint32_t limit) : left_(limit) {}
    // After each iteration: by which factor the goal is missed.
    bool is_hopeless(double missing) {
        const double before = last_[0];
        for (uint32_t i = 0; i + 1 < span; ++i) last_[i] = last_[i + 1];
        last_[span - 1] = missing;
        --left_;
        if (known_ < span) {
            ++known_;
            return false;
        }
        const double rate = missing / before;
        for (uint32_t i = 0; i + span <= left_; i += span) missing *= rate;
        return missing > trust;
    }

private:
    static constexpr uint32_t span = 3;
    static constexpr double trust = 30; // the pace gets faster: then the prediction was too large by this much
    double last_[span] = {};
    uint32_t known_ = 0, left_;
};

} // namespace

LinearResult SignedMultigrid::solve(const SignedMatrix& matrix, const double* b, double* x, double relative_tolerance,
                                    uint32_t iteration_limit, Call& call, const LinearOptions& options) {
    LinearResult result;
    const size_t n = matrix.n;
    const float* scale = level_[0].scale.data();
    float* input = level_count_ ? level_[0].b.data() : dense_b_.data();
    float* output = level_count_ ? level_[0].x.data() : dense_b_.data();
    double* r = residual_.data();
    double* p = direction_.data();
    double* q = product_.data();
    const Parallel& parallel = call.parallel;

    const double reference =
        residual_norms(n, scale, nullptr, nullptr, 0, parallel, [=](size_t i) { return b[i]; }).norm();
    if (!(reference > 0) || !(reference < 1e300)) {
        for (size_t i = 0; i < n; ++i) x[i] = 0;
        result.converged = reference == 0;
        return result;
    }
    const double goal = relative_tolerance * reference;
    // Zero entries of the sweeps meet values that were not yet computed.
    for (uint32_t l = 0; l < level_count_; ++l) std::memset(level_[l].x.data(), 0, level_[l].n * sizeof(float));
    const auto leave_out = [&](auto* vector) {
        for (size_t k = 0; k < options.fixed_count; ++k) vector[options.fixed[k]] = 0;
    };

    // The residual of the recurrence drifts from the true one; at the goal the
    // true one decides, and if need be the search starts again from it.
    double norm = reference, before_restart = 1e300;
    Pace pace(iteration_limit);
    for (uint32_t restart = 0; restart < 8; ++restart) {
        if (restart > 0 || !is_zero(x, n, parallel)) multiply(matrix, x, r, parallel);
        else parallel.for_blocks(n, [=](size_t begin, size_t end) { std::memset(r + begin, 0, (end - begin) * 8); });
        for (size_t k = 0; k < options.fixed_count; ++k) r[options.fixed[k]] = b[options.fixed[k]];
        ResidualNorms norms = residual_norms(n, scale, options.row_scale, input, 1 / norm, parallel, [=](size_t i) {
            p[i] = q[i] = 0;
            return r[i] = b[i] - r[i];
        });
        norm = norms.norm();
        const auto is_small = [&] {
            return !(norm > goal) || (options.row_scale && norms.largest_row <= options.row_tolerance);
        };
        result.residual = norm / reference;
        result.row_residual = norms.largest_row;
        result.converged = norm < 1e300 && is_small();
        if (result.converged || !(norm < 0.5 * before_restart) || result.iterations >= iteration_limit) return result;
        before_restart = norm;

        double pq = 0; // 0: no direction yet
        while (!is_small() && result.iterations < iteration_limit) {
            if (!continues(&call) || call.out_of_time()) {
                result.residual = norm / reference;
                result.row_residual = norms.largest_row;
                return result;
            }
            precondition(parallel);
            leave_out(output);
            const auto [zr, zq] = project(n, scale, output, r, q, parallel);
            pq = next_direction(matrix, output, pq > 0 ? -zq / pq : 0, p, q, parallel);
            leave_out(q);
            ++result.iterations;
            if (!(pq > 0) || !(zr > 0)) break;
            const double alpha = zr / pq;
            // Times the norm before: about 1, as single precision wants it.
            norms = residual_norms(n, scale, options.row_scale, input, 1 / norm, parallel, [=](size_t i) {
                x[i] += alpha * p[i];
                return r[i] -= alpha * q[i];
            });
            norm = norms.norm();
            if (!options.hopeless_ends || is_small()) continue;
            double missing = norm / goal;
            if (options.row_scale && norms.largest_row < missing * options.row_tolerance)
                missing = norms.largest_row / options.row_tolerance;
            if (pace.is_hopeless(missing)) return result;
        }
    }
    return result;
}

} // namespace hmf
