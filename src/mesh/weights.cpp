// Cotangent weights ([W] Eq. 5).
#include "weights.hpp"

#include <cmath>

namespace hmf {

namespace {

constexpr double MAX_COTANGENT = 1e15;

double ratio(const double* u, const double* v) {
    const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    const double dot = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    return dot / std::sqrt(x * x + y * y + z * z);
}

double largest(const double* u) {
    double m = 0;
    for (int c = 0; c < 3; ++c) {
        const double a = u[c] < 0 ? -u[c] : u[c];
        if (a > m) m = a;
    }
    return m;
}

} // namespace

double cotangent(const double* apex, const double* a, const double* b) {
    double u[3], v[3];
    for (int c = 0; c < 3; ++c) {
        u[c] = a[c] - apex[c];
        v[c] = b[c] - apex[c];
    }
    double cot = ratio(u, v);
    const double size_u = largest(u), size_v = largest(v);
    if (!(size_u > 1e-60 && size_v > 1e-60 && size_u < 1e60 && size_v < 1e60)) {
        // Products of these would leave the range of double.
        if (!(size_u > 0) || !(size_v > 0)) return 0;
        for (int c = 0; c < 3; ++c) {
            u[c] /= size_u;
            v[c] /= size_v;
        }
        cot = ratio(u, v);
    }
    if (!(cot == cot)) return 0;
    return cot > MAX_COTANGENT ? MAX_COTANGENT : cot < -MAX_COTANGENT ? -MAX_COTANGENT : cot;
}

hmf_status coarse_weights(const Mesh& mesh, const double* position, double* weight, uint64_t& raised, Call& call, double fraction) {
    constexpr uint32_t step = 1u << 17; // half-edges
    for (uint32_t e = 0; e < mesh.edge_count; ++e) weight[e] = 0;
    const auto add = [weight](uint32_t h, double cotangent) { // half of it, as far as it is bounded
        weight[edge_of(h)] += cotangent > MAX_COTANGENT ? 0.5 * MAX_COTANGENT : cotangent < -MAX_COTANGENT ? -0.5 * MAX_COTANGENT : 0.5 * cotangent;
    };
    for (uint32_t begin = 0, left = 2 * mesh.edge_count; left > 0;) {
        if (!call.tick(fraction)) return HMF_CANCELLED;
        const uint32_t size = left < step ? left : step;
        for_each_face(mesh, begin, begin + size, [&](uint32_t ij, uint32_t jk, uint32_t ki) {
            // One area serves the three angles.
            const double* i = position + size_t{3} * mesh.origin[ij];
            const double* j = position + size_t{3} * mesh.origin[jk];
            const double* k = position + size_t{3} * mesh.origin[ki];
            double u[3], v[3], w[3];
            for (int c = 0; c < 3; ++c) {
                u[c] = j[c] - i[c];
                v[c] = k[c] - i[c];
                w[c] = k[c] - j[c];
            }
            const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
            const double area = std::sqrt(x * x + y * y + z * z); // of the parallelogram
            if (!(area > 0)) return;
            const double inverse = 1 / area;
            add(jk, inverse * (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]));
            add(ki, -inverse * (u[0] * w[0] + u[1] * w[1] + u[2] * w[2]));
            add(ij, inverse * (v[0] * w[0] + v[1] * w[1] + v[2] * w[2]));
        });
        begin += size;
        left -= size;
    }
    raised = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const double w = weight[e];
        raised += w < 0;
        weight[e] = !(w > COARSE_WEIGHT_FLOOR) ? COARSE_WEIGHT_FLOOR : w > COARSE_WEIGHT_CAP ? COARSE_WEIGHT_CAP : w;
    }
    return HMF_OK;
}

} // namespace hmf
