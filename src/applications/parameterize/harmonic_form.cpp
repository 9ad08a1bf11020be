// One twisted Poisson solve: min over w of  sum of weight * (form + dw)^2.
#include "harmonic_form.hpp"

#include "../../core/linear/sparse_factor.hpp"

#include <cmath>

namespace hmf {

// One row has all sides of the star: those to held vertices, and from the vertex to
// itself, have entry 0.
void TwistedLaplacian::fill_row(uint32_t v) {
    uint32_t at = charts_->stars.offset[v];
    double sum = 0;
    for (const uint32_t h : charts_->stars.of(v)) {
        const uint32_t u = mesh_->target(h);
        const double alpha = weight_[edge_of(h)];
        // Both charts against that of the face left of h.
        const double entry = -alpha * (charts_->chart[h] * charts_->chart[mesh_->next[h]]);
        sum += u == v ? alpha + entry : alpha;
        column_[at] = u;
        entry_[at++] = u == v || charts_->odd[u] || charts_->odd[v] ? 0 : entry;
    }
    diagonal_[v] = charts_->odd[v] ? 0 : sum;
}

hmf_status TwistedLaplacian::build(const Mesh& mesh, const SignBundle& bundle, const VertexCharts& charts,
                                   const double* weight, Call& call) {
    mesh_ = &mesh;
    bundle_ = &bundle;
    charts_ = &charts;
    weight_ = weight;
    const uint32_t n = mesh.vertex_count, m = mesh.edge_count;
    if (!column_.allocate(call.memory, size_t{2} * m) || !entry_.allocate(call.memory, size_t{2} * m)
        || !diagonal_.allocate(call.memory, n) || !right_.allocate(call.memory, n) || !w_.allocate(call.memory, n))
        return call.out_of_memory();
    if (!call.pass(n, 0, [&](size_t begin, size_t end) {
            for (size_t v = begin; v < end; ++v) {
                if (end - v > Stars::AHEAD)
                    for (const uint32_t h : charts.stars.of(static_cast<uint32_t>(v) + Stars::AHEAD)) {
                        prefetch(&mesh.origin[h]);
                        prefetch(&mesh.next[h]);
                        prefetch(&weight[edge_of(h)]);
                    }
                fill_row(static_cast<uint32_t>(v));
            }
        }))
        return HMF_CANCELLED;
    if (multigrid_.setup(matrix(), call)) return HMF_OK;
    return call.cancelled() ? HMF_CANCELLED : call.out_of_memory();
}

TwistedLaplacian::Balance TwistedLaplacian::read_divergence(const TwistedForm& form, const Known& known, size_t begin,
                                                            size_t end) {
    constexpr double rounding = 1e-6; // of the root of the energy of one edge
    Balance balance;
    for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) {
        right_[v] = w_[v] = 0;
        if (end - v > Stars::AHEAD)
            for (const uint32_t h : charts_->stars.of(v + Stars::AHEAD)) {
                prefetch(&form.value[edge_of(h)]);
                prefetch(&weight_[edge_of(h)]);
            }
        if (charts_->odd[v]) continue;
        double divergence = 0, pull = 0;
        for (const uint32_t h : charts_->stars.of(v)) {
            const double flux = weight_[edge_of(h)] * static_cast<double>(charts_->chart[h] * form.at(*bundle_, h));
            divergence += flux;
            pull += flux < 0 ? -flux : flux;
        }
        right_[v] = divergence;
        balance.divergence += divergence * divergence / diagonal_[v];
        balance.pull += pull * pull / diagonal_[v];
        // Values are whole units: each side of the star may be off by one.
        if (known.coclosed && known.coclosed[v])
            balance.unexpected +=
                std::fabs(divergence)
                > known.share * (pull + rounding * std::sqrt(known.energy * diagonal_[v])) + diagonal_[v];
    }
    return balance;
}

SignedMatrix TwistedLaplacian::matrix() const {
    return {mesh_->vertex_count, charts_->stars.offset.data(), column_.data(), entry_.data(), diagonal_.data()};
}

int64_t TwistedLaplacian::rounded(uint32_t v) const {
    const double w = w_[v];
    if (charts_->odd[v] || !(w > -4e18 && w < 4e18)) return 0;
    return static_cast<int64_t>(w < 0 ? w - 0.5 : w + 0.5);
}

// By conjugate gradients, or where they stop too early by a factor.
hmf_status TwistedLaplacian::find_w(double relative, Call& call) {
    constexpr uint32_t iteration_limit = 300;
    const LinearResult result = multigrid_.solve(matrix(), right_.data(), w_.data(), relative, iteration_limit, call);
    iterations_ += result.iterations;
    if (call.cancelled()) return call.was_cancelled();
    if (result.converged) return HMF_OK;
    SparseFactor factor;
    if (!factor.build(matrix(), call)) return call.stopped();
    if (factor.empty())
        return call.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
                         "Linear equations were solved to %.1g instead of %.1g. Improve the worst triangles of the "
                         "mesh.",
                         result.residual, relative);
    factor.solve(right_.data(), w_.data());
    return HMF_OK;
}

hmf_status TwistedLaplacian::make_harmonic(TwistedForm& form, double tolerance, Call& call, const Known& known) {
    const Mesh& mesh = *mesh_;
    const uint32_t n = mesh.vertex_count;
    if (!call.tick(0)) return call.was_cancelled();
    const Balance balance = call.parallel.sum_blocks<Balance>(
        n, [&](size_t begin, size_t end) { return read_divergence(form, known, begin, end); });
    if (balance.unexpected > 0)
        return call.fail(known.by_values ? HMF_ERROR_VALUE_NOT_HARMONIC : HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                         "u is not harmonic at %llu vertices where the foliation should be. %s",
                         static_cast<unsigned long long>(balance.unexpected),
                         known.by_values ? "Improve the values with hmf_relax." : "Please report it.");
    if (!(balance.divergence > 0)) return HMF_OK;
    const double relative = tolerance * std::sqrt(balance.pull / balance.divergence);
    if (relative >= 1) return HMF_OK;
    if (const hmf_status status = find_w(relative, call)) return status;
    const auto add = [&](size_t begin, size_t end) {
        for (uint32_t e = static_cast<uint32_t>(begin); e < end; ++e) {
            const uint32_t h = 2 * e, t = h + 1;
            if (end - e > 2 * Stars::AHEAD) {
                prefetch(&w_[mesh.origin[h + 4 * Stars::AHEAD]]);
                prefetch(&w_[mesh.origin[t + 4 * Stars::AHEAD]]);
            }
            form.add(*bundle_, h, -charts_->chart[h] * rounded(mesh.origin[h]));
            form.add(*bundle_, t, -charts_->chart[t] * rounded(mesh.origin[t]));
        }
    };
    return call.pass(mesh.edge_count, 0, add) ? HMF_OK : call.was_cancelled();
}

} // namespace hmf
