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

constexpr uint32_t block = MultigridLevel::block;

// The part of a level's matrix below the diagonal.
struct LowerRows {
    const uint32_t* start;
    const uint32_t* column;
    const float* entry;

    explicit LowerRows(const MultigridLevel& level) :
        start(level.start.data()), column(level.column.data()), entry(level.entry.data()) {}
    // Sum of entry * x over row i.
    float product(size_t i, const float* x) const {
        static_assert(block == 5, "written out here");
        float sum = 0;
        size_t k = start[i];
        const size_t end = start[i + 1];
        do {
            const uint32_t* c = column + k;
            const float* e = entry + k;
            sum += ((e[0] * x[c[0]] + e[1] * x[c[1]]) + (e[2] * x[c[2]] + e[3] * x[c[3]])) + e[4] * x[c[4]];
            k += block;
        } while (k < end);
        return sum;
    }
    // y -= value times row i, that is column i above the diagonal.
    void subtract(size_t i, float value, float* y) const {
        size_t k = start[i];
        const size_t end = start[i + 1];
        do {
            const uint32_t* c = column + k;
            const float* e = entry + k;
            for (size_t t = 0; t < block; ++t) y[c[t]] -= e[t] * value;
            k += block;
        } while (k < end);
    }
};

} // namespace

// From the unknowns of the matrices to those with unit diagonals.
static void scale_prolongation(MultigridLevel& fine, const Array<float>& coarse_scale) {
    for (size_t c = 0; c < coarse_scale.size(); ++c)
        for (uint32_t t = fine.prolongation_start[c]; t < fine.prolongation_start[c + 1]; ++t)
            fine.prolongation_entry[t] *= coarse_scale[c] / fine.scale[fine.prolongation_row[t]];
}

Done SignedMultigrid::setup(const SignedMatrix& matrix, Memory& memory, Call* call, uint32_t depth) {
    for (MultigridLevel& level : level_) level = MultigridLevel{};
    level_count_ = 0;
    dense_n_ = 0;
    const size_t n = matrix.n;
    double largest = 0;
    for (uint32_t i = 0; i < matrix.n; ++i)
        if (matrix.diagonal[i] > largest) largest = matrix.diagonal[i];
    double threshold = 1e-22 * largest;
    if (threshold < 1e-30) threshold = 1e-30;
    Array<double> near_kernel;
    if (!near_kernel.allocate_filled(memory, n, 1)) return false;
    CoarseMatrix storage;
    SignedMatrix current = matrix;
    float strength = 0.05f;
    for (uint32_t l = 0; l < max_levels; ++l) {
        MultigridLevel& level = level_[l];
        if (!unit_diagonal_scale(current, threshold, level.scale, memory)) return false;
        if (l > 0) {
            scale_prolongation(level_[l - 1], level.scale);
            if (l > 1) level_[l - 1].scale.release();
        }
        if (current.n <= dense_limit) {
            if (!factorise(current, level.scale, memory)) return false;
            break;
        }
        ++level_count_;
        const bool last = l + 1 == depth || l + 1 == max_levels;
        CoarseMatrix coarse;
        if (!continues(call) || (!last && !coarsen(current, level, strength, near_kernel, coarse, memory, call))
            || !continues(call) || !scale_matrix(current, level, memory))
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
        if (!first_.allocate(memory, m) || !image_.allocate(memory, m)) return false;
    }
    // Last, when what the setup needed for itself is gone.
    return residual_.allocate(memory, n) && direction_.allocate(memory, n) && product_.allocate(memory, n);
}

Done SignedMultigrid::refresh(const SignedMatrix& matrix, Memory& memory) {
    return level_count_ == 0 || scale_matrix(matrix, level_[0], memory);
}

double SignedMultigrid::operator_complexity() const {
    double all = 0;
    for (uint32_t l = 0; l < level_count_; ++l) all += level_[l].n + static_cast<double>(level_[l].start[level_[l].n]);
    return level_count_ ? all / (level_[0].n + static_cast<double>(level_[0].start[level_[0].n])) : 1;
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

// Forward sweep from x = 0, then the right side of the next level.
void SignedMultigrid::descend(uint32_t l) {
    MultigridLevel& level = level_[l];
    const float* b = level.b.data();
    float* x = level.x.data();
    float* r = level.r.data();
    const LowerRows rows(level);
    // After a sweep from zero the residual is that of the part above the diagonal.
    for (size_t i = 0; i < level.n; ++i) {
        const float value = b[i] - rows.product(i, x);
        x[i] = value;
        r[i] = 0;
        rows.subtract(i, value, r);
    }
    if (level.prolongation_start.empty()) return;
    const bool last = l + 1 == level_count_;
    float* coarse = last ? dense_b_.data() : level_[l + 1].b.data();
    const size_t m = last ? dense_n_ : level_[l + 1].n;
    const uint32_t* start = level.prolongation_start.data();
    const uint32_t* row = level.prolongation_row.data();
    const float* entry = level.prolongation_entry.data();
    for (size_t c = 0; c < m; ++c) {
        float sum = floor_value;
        for (uint32_t t = start[c]; t < start[c + 1]; ++t) sum += entry[t] * r[row[t]];
        coarse[c] = sum;
    }
}

// Adds the correction of the next level, then a backward sweep.
void SignedMultigrid::ascend(uint32_t l) {
    MultigridLevel& level = level_[l];
    float* x = level.x.data();
    if (!level.prolongation_start.empty()) {
        const bool last = l + 1 == level_count_;
        const float* coarse = last ? dense_b_.data() : level_[l + 1].x.data();
        const size_t m = last ? dense_n_ : level_[l + 1].n;
        const uint32_t* start = level.prolongation_start.data();
        const uint32_t* row = level.prolongation_row.data();
        const float* entry = level.prolongation_entry.data();
        for (size_t c = 0; c < m; ++c)
            for (uint32_t t = start[c]; t < start[c + 1]; ++t) x[row[t]] += entry[t] * coarse[c];
    }
    float* r = level.r.data();
    const LowerRows rows(level);
    std::memcpy(r, level.b.data(), level.n * sizeof(float));
    for (size_t i = level.n; i-- > 0;) {
        const float value = r[i] - rows.product(i, x);
        x[i] = value;
        rows.subtract(i, value, r);
    }
}

void SignedMultigrid::v_cycle(uint32_t first) {
    for (uint32_t l = first; l < level_count_; ++l) descend(l);
    solve_dense(dense_b_.data());
    for (uint32_t l = level_count_; l-- > first;) ascend(l);
}

namespace {

// y = A x.
void multiply(const MultigridLevel& level, const float* x, float* y) {
    const LowerRows rows(level);
    for (size_t i = 0; i < level.n; ++i) {
        y[i] = x[i] + rows.product(i, x);
        rows.subtract(i, -x[i], y);
    }
}

// x A x.
double energy(const MultigridLevel& level, const float* x) {
    const LowerRows rows(level);
    double sum = 0;
    for (size_t i = 0; i < level.n; ++i)
        sum += static_cast<double>(x[i]) * (static_cast<double>(x[i]) + 2 * static_cast<double>(rows.product(i, x)));
    return sum;
}

double dot(const float* x, const float* y, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; ++i) sum += static_cast<double>(x[i]) * static_cast<double>(y[i]);
    return sum;
}

} // namespace

// Two steps of flexible conjugate gradients on level 1.
void SignedMultigrid::k_cycle() {
    MultigridLevel& level = level_[1];
    const size_t n = level.n;
    float* b = level.b.data();
    float* x = level.x.data();
    float* c = first_.data();
    float* v = image_.data();
    v_cycle(1);
    std::memcpy(c, x, n * sizeof(float));
    const double cb = dot(c, b, n);
    multiply(level, c, v);
    const double cv = dot(c, v, n);
    if (!(cv > 0)) return;
    const float step = static_cast<float>(cb / cv);
    for (size_t i = 0; i < n; ++i) b[i] -= step * v[i];
    v_cycle(1);
    const double xb = dot(x, b, n), xv = dot(x, v, n);
    // What is left of the second direction once it is conjugate to the first.
    const double xx = energy(level, x);
    const double rest = xx - xv * xv / cv;
    const double second = rest > 1e-6 * xx ? xb / rest : 0;
    const float along_x = static_cast<float>(second), along_c = static_cast<float>(cb / cv - xv / cv * second);
    for (size_t i = 0; i < n; ++i) x[i] = along_x * x[i] + along_c * c[i];
}

void SignedMultigrid::precondition() {
    if (level_count_ < 2) {
        v_cycle(0);
        return;
    }
    descend(0);
    k_cycle();
    ascend(0);
}

// --- Conjugate gradients -----------------------------------------------------

namespace {

// y = A x; returns x * y.
double multiply(const SignedMatrix& a, const double* x, double* y) {
    double sum = 0;
    for (size_t i = 0; i < a.n; ++i) {
        double v = a.diagonal[i] * x[i];
        for (uint32_t k = a.offset[i]; k < a.offset[i + 1]; ++k) v += a.entry[k] * x[a.column[k]];
        y[i] = v;
        sum += x[i] * v;
    }
    return sum;
}

double scaled_norm(const float* scale, const double* r, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; ++i) {
        const double g = static_cast<double>(scale[i]) * r[i];
        sum += g * g;
    }
    return std::sqrt(sum);
}

// The two norms of a residual: 2-norm with the scaling to unit diagonal,
// largest row with that of the caller.
class ResidualNorms {
public:
    ResidualNorms(const float* scale, const float* row_scale) : scale_(scale), row_scale_(row_scale) {}
    void add(size_t i, double r) {
        const double g = static_cast<double>(scale_[i]) * r;
        sum_ += g * g;
        if (!row_scale_) return;
        const double row = static_cast<double>(row_scale_[i]) * std::fabs(r);
        if (row > largest_row_) largest_row_ = row;
    }
    double norm() const { return std::sqrt(sum_); }
    double largest_row() const { return largest_row_; }

private:
    const float* scale_;
    const float* row_scale_; // may be null
    double sum_ = 0, largest_row_ = 0;
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

    const double reference = scaled_norm(scale, b, n);
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
    double before_restart = 1e300;
    for (uint32_t restart = 0; restart < 8; ++restart) {
        multiply(matrix, x, r);
        for (size_t i = 0; i < n; ++i) r[i] = b[i] - r[i];
        leave_out(r);
        ResidualNorms norms(scale, options.row_scale);
        for (size_t i = 0; i < n; ++i) norms.add(i, r[i]);
        double norm = norms.norm();
        const auto is_small = [&] {
            return !(norm > goal) || (options.row_scale && norms.largest_row() <= options.row_tolerance);
        };
        result.residual = norm / reference;
        result.row_residual = norms.largest_row();
        result.converged = norm < 1e300 && is_small();
        if (result.converged || !(norm < 0.5 * before_restart) || result.iterations >= iteration_limit) return result;
        before_restart = norm;

        for (size_t i = 0; i < n; ++i) q[i] = 0;
        double pq = 0; // 0: no direction yet
        while (!is_small() && result.iterations < iteration_limit) {
            if (!continues(&call) || call.out_of_time()) {
                result.residual = norm / reference;
                result.row_residual = norms.largest_row();
                return result;
            }
            const double inverse = 1 / norm;
            for (size_t i = 0; i < n; ++i)
                input[i] = static_cast<float>(static_cast<double>(scale[i]) * r[i] * inverse) + floor_value;
            precondition();
            leave_out(output);
            double zr = 0, zq = 0;
            for (size_t i = 0; i < n; ++i) {
                const double z = static_cast<double>(scale[i]) * static_cast<double>(output[i]);
                zr += z * r[i];
                zq += z * q[i];
            }
            const double beta = pq > 0 ? -zq / pq : 0;
            for (size_t i = 0; i < n; ++i) {
                const double z = static_cast<double>(scale[i]) * static_cast<double>(output[i]);
                p[i] = pq > 0 ? z + beta * p[i] : z;
            }
            pq = multiply(matrix, p, q);
            leave_out(q);
            ++result.iterations;
            if (!(pq > 0) || !(zr > 0)) break;
            const double alpha = zr / pq;
            norms = ResidualNorms(scale, options.row_scale);
            for (size_t i = 0; i < n; ++i) {
                x[i] += alpha * p[i];
                r[i] -= alpha * q[i];
                norms.add(i, r[i]);
            }
            norm = norms.norm();
        }
    }
    return result;
}

} // namespace hmf
