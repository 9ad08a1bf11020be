#include "harmonic_forms.hpp"

#include "../../core/mesh/mesh_copy.hpp"
#include "../../core/mesh/weights.hpp"
#include "../parameterize/harmonic_form.hpp"
#include "closed_forms.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// A period of 1 is 2^42: values below 2^11 are doubles without rounding.
constexpr int PERIOD_BITS = 42;
constexpr double TOLERANCE = 2e-10; // of the divergence, see TwistedLaplacian
constexpr double LARGEST_RESIDUAL = 1e-8;

double in_periods(int64_t value) { return static_cast<double>(value) * (1.0 / (int64_t{1} << PERIOD_BITS)); }

// The two half-edges whose values add up to minus that of 2 * edge before a flip.
struct Unflip {
    uint32_t edge, first, second;
};

class Forms {
public:
    Forms(const hmf_hierarchy& h, size_t level, const Array<uint32_t>& half_edge, HarmonicForms& out, Call& call) :
        h_(h), level_(level), mesh_(h.levels[level].mesh), weight_(h.levels[level].weight), half_edge_(half_edge),
        out_(out), call_(call) {}

    hmf_status run() {
        if (classes_.build(mesh_, call_) || build_system() || list_unflips()) return call_.status();
        const uint32_t n = classes_.count();
        for (uint32_t i = 0; i < n; ++i) {
            const double whole = n;
            call_.range(0.1 + 0.9 * i / whole, 0.1 + 0.9 * (i + 1) / whole);
            if (make_harmonic(i) || measure(i) || hand_over(i)) return call_.status();
        }
        if (!(out_.residual <= LARGEST_RESIDUAL))
            return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                              "The forms are harmonic up to %.1e only. Improve the worst triangles of the mesh.",
                              out_.residual);
        return find_periods();
    }

private:
    hmf_status build_system() {
        if (!bundle_.turn.allocate_filled(call_.memory, mesh_.edge_count, int8_t{1})
            || !form_.value.allocate(call_.memory, mesh_.edge_count)
            || !integral_.allocate(call_.memory, classes_.count()) || !charts_.build(mesh_, bundle_, call_))
            return call_.stopped();
        return laplacian_.build(mesh_, bundle_, charts_, weight_, call_) ? call_.stopped() : HMF_OK;
    }

    hmf_status list_unflips() {
        unflips_.start(call_.memory);
        if (level_ > 0 || h_.intrinsic_flip_count == 0) return HMF_OK;
        MeshCopy copy;
        if (!copy.allocate_sides(mesh_, call_.memory)) return call_.out_of_memory();
        Mesh mesh = copy.sides_of(mesh_, call_.parallel);
        for (size_t k = h_.intrinsic_flip_count; k-- > 0;) {
            if (!call_.work(32)) return call_.was_cancelled();
            const uint32_t edge = h_.intrinsic_flips[k];
            unflip_sides(mesh.next, edge);
            // From the end of 2 * edge back to its beginning, around its triangle.
            const uint32_t second = mesh.next[2 * edge];
            if (!unflips_.push({edge, second, mesh.next[second]})) return call_.out_of_memory();
        }
        return HMF_OK;
    }

    hmf_status make_harmonic(uint32_t i) {
        std::fill(form_.value.begin(), form_.value.end(), 0);
        classes_.add(i, int64_t{1} << PERIOD_BITS, form_.value.data());
        return laplacian_.make_harmonic(form_, TOLERANCE, call_, {});
    }

    // Inner products and intersections with all classes: a form that is harmonic has the same products with every form
    // of a class.  And how far from harmonic it is.
    hmf_status measure(uint32_t i) {
        const uint32_t n = classes_.count();
        double* const inner_products = out_.inner_products + size_t{n} * i;
        if (!call_.work(uint64_t{n} * n)) return call_.was_cancelled();
        if (!classes_.products(weight_, form_.value.data(), inner_products, call_.memory)
            || !classes_.intersections(form_.value.data(), integral_.data(), call_.memory))
            return call_.out_of_memory();
        for (uint32_t j = 0; j < n; ++j) {
            inner_products[j] *= in_periods(1);
            const int32_t wanted = i + n / 2 == j ? 1 : j + n / 2 == i ? -1 : 0;
            if (static_cast<int64_t>(integral_[j]) != wanted * (int64_t{1} << PERIOD_BITS))
                return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                                  "The integral of the product of the forms %u and %u is wrong. Please report it.", i,
                                  j);
            out_.intersections[size_t{n} * i + j] = wanted;
        }
        const Sum sum = call_.parallel.sum_blocks<Sum>(mesh_.vertex_count, [&](size_t begin, size_t end) {
            Sum here;
            for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) here += divergence(v);
            return here;
        });
        if (sum.pull > 0) out_.residual = std::max(out_.residual, std::sqrt(sum.divergence / sum.pull));
        return HMF_OK;
    }
    // Squares over vertices: of the sum of the fluxes, and of the sum of their sizes.
    struct Sum {
        double divergence = 0, pull = 0;
        void operator+=(const Sum& other) {
            divergence += other.divergence;
            pull += other.pull;
        }
    };
    Sum divergence(uint32_t v) const {
        double sum = 0, size = 0;
        for (const uint32_t h : charts_.stars.of(v)) {
            const double flux = weight_[edge_of(h)] * static_cast<double>(form_.at(bundle_, h));
            sum += flux;
            size += std::fabs(flux);
        }
        return {sum * sum, size * size};
    }

    // On the caller's triangles, where it is closed.
    hmf_status hand_over(uint32_t i) {
        for (const Unflip& at : unflips_)
            form_.value[at.edge] = -form_.at(bundle_, at.first) - form_.at(bundle_, at.second);
        const Mesh& mesh = level_ == 0 ? h_.input : mesh_;
        const int64_t largest = int64_t{1} << 53;
        uint64_t open = 0, large = 0;
        for (const int64_t value : form_.value) large += value > largest || value < -largest;
        for_each_face(mesh, 0, 2 * mesh.edge_count, [&](uint32_t a, uint32_t b, uint32_t c) {
            open += form_.at(bundle_, a) + form_.at(bundle_, b) + form_.at(bundle_, c) != 0;
        });
        if (large > 0)
            return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                              "Form %u has values above 2048 periods. Improve the worst triangles of the mesh.", i);
        if (open > 0)
            return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                              "Form %u is not closed in %llu triangles. Please report it.", i,
                              static_cast<unsigned long long>(open));
        double* const to = out_.values + half_edge_.size() * i;
        for (size_t e = 0; e < half_edge_.size(); ++e) to[e] = in_periods(form_.at(bundle_, half_edge_[e]));
        return call_.tick(1) ? HMF_OK : call_.was_cancelled();
    }

    double inner(size_t i, size_t j) const { return out_.inner_products[classes_.count() * i + j]; }

    // Conjugation and period matrix, see the header.
    hmf_status find_periods() {
        const size_t n = classes_.count(), g = n / 2;
        for (size_t i = 0; i < n; ++i) // equal up to the residual of the forms
            for (size_t j = 0; j < i; ++j)
                out_.inner_products[n * i + j] = out_.inner_products[n * j + i] = 0.5 * (inner(i, j) + inner(j, i));
        for (size_t j = 0; j < n; ++j)
            for (size_t i = 0; i < g; ++i) {
                out_.conjugation[n * i + j] = -inner(i + g, j);
                out_.conjugation[n * (i + g) + j] = inner(i, j);
            }
        for (size_t i = 0; i < n; ++i) {
            if (!call_.work(n * n)) return call_.was_cancelled();
            for (size_t j = 0; j < n; ++j) {
                double square = i == j ? 1 : 0;
                for (size_t k = 0; k < n; ++k) square += out_.conjugation[n * i + k] * out_.conjugation[n * k + j];
                out_.conjugation_error = std::max(out_.conjugation_error, std::fabs(square));
            }
        }
        Array<double> mean, factor;
        if (!mean.allocate(call_.memory, n * n) || !factor.allocate(call_.memory, n * n)) return call_.out_of_memory();
        std::copy(out_.inner_products, out_.inner_products + n * n, mean.begin());
        if (const hmf_status status = make_complex(mean.data(), factor)) return status;
        for (size_t i = 0; i < g; ++i)
            for (size_t j = 0; j < g; ++j) factor[g * i + j] = mean[n * (i + g) + j + g];
        if (!invert(factor.data(), g, out_.period_imaginary)) return not_positive();
        for (size_t i = 0; i < g; ++i)
            for (size_t j = 0; j < i; ++j) out_.period_imaginary[g * j + i] = out_.period_imaginary[g * i + j];
        for (size_t i = 0; i < g; ++i)
            for (size_t j = 0; j <= i; ++j) {
                double sum = 0;
                for (size_t k = 0; k < g; ++k) sum -= mean[n * i + k + g] * out_.period_imaginary[g * k + j];
                out_.period_real[g * i + j] = out_.period_real[g * j + i] = sum;
            }
        return HMF_OK;
    }

    // M = (M + S M^-1 S^T) / 2 until rounding stops the difference of both from falling.
    hmf_status make_complex(double* matrix, Array<double>& factor) {
        constexpr uint32_t most_steps = 64; // about five do
        constexpr double enough = 1e-8;
        const size_t n = classes_.count(), g = n / 2;
        Array<double> inverse;
        if (!inverse.allocate(call_.memory, n * n)) return call_.out_of_memory();
        double before = HUGE_VAL;
        for (uint32_t step = 0; step < most_steps; ++step) {
            std::copy(matrix, matrix + n * n, factor.begin());
            if (!invert(factor.data(), n, inverse.data())) return not_positive();
            double change = 0, size = 0;
            for (size_t i = 0; i < n; ++i)
                for (size_t j = 0; j < n; ++j) {
                    const double sign = (i < g) == (j < g) ? 1 : -1, here = matrix[n * i + j],
                                 turned = sign * inverse[n * ((i + g) % n) + (j + g) % n];
                    change = std::max(change, std::fabs(turned - here));
                    size = std::max(size, std::fabs(here));
                    factor[n * i + j] = 0.5 * (here + turned);
                }
            if (change >= before && change <= enough * size) return HMF_OK;
            std::copy(factor.begin(), factor.end(), matrix);
            before = change;
        }
        return not_positive();
    }

    // Also where the call was cancelled.
    hmf_status not_positive() {
        if (call_.cancelled()) return call_.was_cancelled();
        return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                          "The inner products of the forms are not positive. Please report it.");
    }

    // Of a symmetric positive matrix, which becomes its factor (Cholesky); false: it is not, or the call was cancelled.
    bool invert(double* matrix, size_t n, double* inverse) {
        for (size_t i = 0; i < n; ++i) {
            if (!call_.work(n * n)) return false;
            for (size_t j = 0; j <= i; ++j) {
                double sum = matrix[n * i + j];
                for (size_t k = 0; k < j; ++k) sum -= matrix[n * i + k] * matrix[n * j + k];
                if (i == j && !(sum > 0)) return false;
                matrix[n * i + j] = i == j ? std::sqrt(sum) : sum / matrix[n * j + j];
            }
        }
        for (size_t c = 0; c < n; ++c) {
            double* const column = inverse + n * c; // the inverse is symmetric
            if (!call_.work(2 * n * n)) return false;
            for (size_t i = 0; i < n; ++i) {
                double sum = i == c ? 1 : 0;
                for (size_t k = 0; k < i; ++k) sum -= matrix[n * i + k] * column[k];
                column[i] = sum / matrix[n * i + i];
            }
            for (size_t i = n; i-- > 0;) {
                for (size_t k = i + 1; k < n; ++k) column[i] -= matrix[n * k + i] * column[k];
                column[i] /= matrix[n * i + i];
            }
        }
        return true;
    }

    const hmf_hierarchy& h_;
    const size_t level_;
    const Mesh& mesh_;
    const double* const weight_;
    const Array<uint32_t>& half_edge_;
    HarmonicForms& out_;
    Call& call_;
    ClosedForms classes_;
    SignBundle bundle_; // trivial
    VertexCharts charts_;
    TwistedLaplacian laplacian_;
    TwistedForm form_;
    Array<uint64_t> integral_; // of the product with each form of the basis
    Array<Unflip> unflips_;
};

} // namespace

hmf_status harmonic_forms(const hmf_hierarchy& hierarchy, size_t level, const Array<uint32_t>& half_edge,
                          HarmonicForms& out, Call& call) {
    return Forms(hierarchy, level, half_edge, out, call).run();
}

} // namespace hmf
