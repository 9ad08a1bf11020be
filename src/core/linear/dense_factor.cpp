#include "dense_factor.hpp"

#include <cmath>
#include <type_traits>

namespace hmf {

namespace {

constexpr float SHIFT = 1e-3f; // far above the rounding
constexpr double SMALL_SHIFT = 1e-9;
// A pivot below this is hidden by the shift.  The last one of a singular matrix always is; on meshes of round triangles
// the others are above .04.
constexpr float WEAK_PIVOT = 10 * SHIFT;

template <class Real>
Real without_tiny(Real value) { // subnormal numbers are slow
    return std::fabs(value) > static_cast<Real>(1e-20) ? value : 0;
}

} // namespace

// Right-looking; column j of L is matrix[j * n + i], i >= j.
template <class Real>
Done DenseFactor::Factor<Real>::build(uint32_t size, Array<Real>& matrix, Real least_pivot, Real weak_pivot,
                                      uint32_t& weak, Memory& memory, Call* call) {
    const size_t n = size;
    if (!entry.allocate(memory, n * n) || !inverse.allocate(memory, n)) return false;
    Real* const a = matrix.data();
    weak = 0;
    for (size_t j = 0; j < n; ++j) {
        if (call && !call->work((n - j) * (n - j) / 8)) return false;
        const Real pivot = a[j * n + j];
        weak += !(pivot > weak_pivot);
        const Real one = 1 / std::sqrt(pivot > least_pivot ? pivot : least_pivot);
        inverse[j] = one;
        for (size_t i = j + 1; i < n; ++i) a[j * n + i] *= one;
        for (size_t k = j + 1; k < n; ++k) {
            const Real factor = a[j * n + k];
            if (factor == 0) continue;
            for (size_t i = k; i < n; ++i) a[k * n + i] -= factor * a[j * n + i];
        }
    }
    for (size_t j = 0; j < n; ++j)
        for (size_t i = j + 1; i < n; ++i) entry[j * n + i] = entry[i * n + j] = without_tiny(a[j * n + i]);
    return true;
}

template <class Real>
void DenseFactor::Factor<Real>::solve(uint32_t size, Real* b) const {
    const size_t n = size;
    for (size_t j = 0; j < n; ++j) {
        const Real* const column = &entry[j * n];
        const Real x = b[j] *= inverse[j];
        for (size_t i = j + 1; i < n; ++i) b[i] -= column[i] * x;
    }
    for (size_t j = n; j-- > 0;) {
        const Real* const row = &entry[j * n];
        const Real x = b[j] *= inverse[j];
        for (size_t i = 0; i < j; ++i) b[i] -= row[i] * x;
    }
}

Done DenseFactor::build(const SignedMatrix& matrix, const Array<float>& scale, Memory& memory, Call* call) {
    n_ = matrix.n;
    const size_t n = n_;
    const auto fill = [&](auto& a) {
        using Real = std::remove_reference_t<decltype(a[0])>;
        for (size_t i = 0; i < n; ++i)
            for (uint32_t k = matrix.offset[i]; k < matrix.offset[i + 1]; ++k) {
                const size_t j = matrix.column[k];
                a[i * n + j] +=
                    static_cast<Real>(matrix.entry[k] * static_cast<double>(scale[i]) * static_cast<double>(scale[j]));
            }
    };
    uint32_t weak = 0;
    double_ = {};
    wide_b_.release();
    if (!b_.allocate(memory, n)) return false;
    {
        Array<float> a;
        if (!a.allocate_filled(memory, n * n, 0)) return false;
        fill(a);
        for (size_t i = 0; i < n; ++i) a[i * n + i] = 1 + SHIFT;
        if (!single_.build(n_, a, 0.1f * SHIFT, WEAK_PIVOT, weak, memory, call)) return false;
    }
    if (weak < 2) return true;
    single_ = {};
    Array<double> a;
    if (!a.allocate_filled(memory, n * n, 0) || !wide_b_.allocate(memory, n)) return false;
    fill(a);
    for (size_t i = 0; i < n; ++i) {
        const double own = static_cast<double>(scale[i]);
        a[i * n + i] = own > 0 ? matrix.diagonal[i] * own * own + SMALL_SHIFT : 1;
    }
    return double_.build(n_, a, 0.1 * SMALL_SHIFT, 0.0, weak, memory, call);
}

void DenseFactor::solve() {
    if (double_.entry.empty()) {
        single_.solve(n_, b_.data());
        return;
    }
    for (size_t i = 0; i < n_; ++i) wide_b_[i] = static_cast<double>(b_[i]);
    double_.solve(n_, wide_b_.data());
    for (size_t i = 0; i < n_; ++i) b_[i] = static_cast<float>(wide_b_[i]);
}

} // namespace hmf
