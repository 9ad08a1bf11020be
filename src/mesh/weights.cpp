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

uint64_t coarse_weights(const Mesh& mesh, const double* position, uint32_t begin, uint32_t end, double* weight) {
    uint64_t raised = 0;
    for (uint32_t e = begin; e < end; ++e) {
        const uint32_t h = 2 * e, t = twin(h);
        const double* i = position + size_t{3} * mesh.origin[h];
        const double* j = position + size_t{3} * mesh.origin[t];
        const double w = 0.5 * (cotangent(position + size_t{3} * mesh.origin[mesh.prev(h)], i, j)
                                + cotangent(position + size_t{3} * mesh.origin[mesh.prev(t)], j, i));
        raised += w < 0;
        weight[e] = w < COARSE_WEIGHT_FLOOR ? COARSE_WEIGHT_FLOOR : w > COARSE_WEIGHT_CAP ? COARSE_WEIGHT_CAP : w;
    }
    return raised;
}

} // namespace hmf
