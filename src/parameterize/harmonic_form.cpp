// One twisted Poisson solve: min over w of  sum of weight * (form + dw)^2.
#include "harmonic_form.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr uint32_t STRIDE = 65536; // vertices between two calls of the progress function

} // namespace

hmf_status TwistedLaplacian::build(const Mesh& mesh, const SignBundle& bundle, const VertexCharts& charts,
                                   const double* weight, Call& call) {
    mesh_ = &mesh;
    bundle_ = &bundle;
    charts_ = &charts;
    weight_ = weight;
    const uint32_t n = mesh.vertex_count, m = mesh.edge_count;
    if (!offset_.allocate(call.memory, n + size_t{1}) || !column_.allocate(call.memory, size_t{2} * m)
        || !entry_.allocate(call.memory, size_t{2} * m) || !diagonal_.allocate(call.memory, n)
        || !right_.allocate(call.memory, n) || !w_.allocate(call.memory, n))
        return call.out_of_memory();
    uint32_t at = 0;
    for (uint32_t v = 0; v < n; ++v) {
        if (v % STRIDE == 0 && !call.tick(0)) return HMF_CANCELLED;
        offset_[v] = at;
        double sum = 0;
        diagonal_[v] = 0;
        if (charts.odd[v]) continue;
        for (const uint32_t h : mesh.around(v)) {
            const uint32_t u = mesh.target(h);
            const double alpha = weight[edge_of(h)];
            // Both charts against that of the face left of h.
            const double entry = -alpha * charts.chart[h] * charts.chart[mesh.next[h]];
            sum += alpha;
            if (u == v) {
                sum += entry;
            } else if (!charts.odd[u]) {
                column_[at] = u;
                entry_[at++] = entry;
            }
        }
        diagonal_[v] = sum;
    }
    offset_[n] = at;
    const SignedMatrix matrix{n, offset_.data(), column_.data(), entry_.data(), diagonal_.data()};
    if (multigrid_.setup(matrix, call.memory, &call)) return HMF_OK;
    return call.cancelled() ? HMF_CANCELLED : call.out_of_memory();
}

hmf_status TwistedLaplacian::make_harmonic(TwistedForm& form, double relative_tolerance, Call& call) {
    const Mesh& mesh = *mesh_;
    const uint32_t n = mesh.vertex_count;
    double divergence = 0, pull = 0; // squared norms
    for (uint32_t v = 0; v < n; ++v) {
        if (v % STRIDE == 0 && !call.tick(0)) return HMF_CANCELLED;
        right_[v] = w_[v] = 0;
        if (charts_->odd[v]) continue;
        double sum = 0;
        for (const uint32_t h : mesh.around(v)) {
            const double flux = weight_[edge_of(h)] * static_cast<double>(charts_->chart[h] * form.at(*bundle_, h));
            right_[v] += flux;
            sum += flux < 0 ? -flux : flux;
        }
        divergence += right_[v] * right_[v] / diagonal_[v];
        pull += sum * sum / diagonal_[v];
    }
    // Against the divergence that the rounding of the form leaves nothing helps.
    const double noise = divergence > 0 ? 1e-13 * std::sqrt(pull / divergence) : 1;
    if (noise >= 1) return HMF_OK;
    relative_tolerance = std::max(relative_tolerance, noise);
    const SignedMatrix matrix{n, offset_.data(), column_.data(), entry_.data(), diagonal_.data()};
    constexpr uint32_t iteration_limit = 300;
    iterations_ +=
        multigrid_.solve(matrix, right_.data(), w_.data(), relative_tolerance, iteration_limit, call).iterations;
    if (call.cancelled()) return HMF_CANCELLED;
    for (uint32_t v = 0; v < n; ++v) {
        if (v % STRIDE == 0 && !call.tick(0)) return HMF_CANCELLED;
        if (charts_->odd[v] || !(w_[v] > -4e18 && w_[v] < 4e18)) continue;
        const int64_t w = static_cast<int64_t>(w_[v] < 0 ? w_[v] - 0.5 : w_[v] + 0.5);
        for (const uint32_t h : mesh.around(v)) form.add(*bundle_, h, -charts_->chart[h] * w);
    }
    return HMF_OK;
}

} // namespace hmf
