// The harmonic representative of a twisted cohomology class: the closed form
// nearest to a given one, among all with the same periods.
#pragma once

#include "../../core/linear/signed_multigrid.hpp"
#include "twisted_form.hpp"

namespace hmf {

// The twisted Laplacian of a bundle: one unknown per vertex, in its chart;
// vertices where the chart comes back with the opposite sign are held.
class TwistedLaplacian {
public:
    [[nodiscard]] hmf_status build(const Mesh& mesh, const SignBundle& bundle, const VertexCharts& charts,
                                   const double* weight, Call& call);
    // What is known of a form: where it is coclosed, up to a share of its fluxes, or of what rounding leaves of them.
    struct Known {
        const uint8_t* coclosed = nullptr; // per vertex
        double share = 0, energy = 0;
        bool by_values = false; // of the caller's values, which the caller can improve
    };
    // form += d(w) with the w that makes it coclosed: its divergence falls to
    // `tolerance` of what there would be if no two fluxes at a vertex cancelled.
    // HMF_ERROR_INTERNAL, or HMF_ERROR_VALUE_NOT_HARMONIC by values of the caller, if the form is not what is known of
    // it; HMF_ERROR_UNSUPPORTED if no solver comes so far.
    [[nodiscard]] hmf_status make_harmonic(TwistedForm& form, double tolerance, Call& call, const Known& known);
    uint32_t iterations() const { return iterations_; }

private:
    // Squared norms: of the divergence of a form, and of its fluxes without their signs.
    struct Balance {
        double divergence = 0, pull = 0;
        uint64_t unexpected = 0; // vertices
        void operator+=(const Balance& part) {
            divergence += part.divergence;
            pull += part.pull;
            unexpected += part.unexpected;
        }
    };
    Balance read_divergence(const TwistedForm& form, const Known& known, size_t begin, size_t end);
    [[nodiscard]] hmf_status find_w(double relative, Call& call);
    void fill_row(uint32_t v);
    int64_t rounded(uint32_t v) const;
    SignedMatrix matrix() const;

    const Mesh* mesh_ = nullptr;
    const SignBundle* bundle_ = nullptr;
    const VertexCharts* charts_ = nullptr;
    const double* weight_ = nullptr;
    Array<uint32_t> column_; // of the rows, which begin where the stars do
    Array<double> entry_, diagonal_, right_, w_;
    SignedMultigrid multigrid_;
    uint32_t iterations_ = 0;
};

// dv: the closed form that follows the flux weight * du, turned by a right angle;
// exact in its periods up to the rounding of the fluxes.  Not yet harmonic.
[[nodiscard]] hmf_status conjugate_form(const Mesh& mesh, const SignBundle& bundle, const VertexCharts& charts,
                                        const double* weight, const TwistedForm& du, TwistedForm& dv, Call& call);

} // namespace hmf
