// Cotangent weights ([W] Eq. 5).
#include "weights.hpp"

#include <algorithm>
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
        m = std::max(m, a);
    }
    return m;
}

// Cotangents of the angles at i, j and k, bounded; one root and one division
// serve all three.  Zeros for a triangle without area.
struct CornerCotangents {
    double cot_i = 0, cot_j = 0, cot_k = 0;

    CornerCotangents(const double* i, const double* j, const double* k) {
        double u[3], v[3], w[3];
        for (int c = 0; c < 3; ++c) {
            u[c] = j[c] - i[c];
            v[c] = k[c] - i[c];
            w[c] = k[c] - j[c];
        }
        const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
        const double double_area = std::sqrt(x * x + y * y + z * z);
        if (!(double_area > 0)) return;
        const double inverse = 1 / double_area;
        const auto bounded = [](double cot) {
            return cot > MAX_COTANGENT ? MAX_COTANGENT : cot < -MAX_COTANGENT ? -MAX_COTANGENT : cot;
        };
        cot_i = bounded(inverse * (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]));
        cot_j = bounded(-inverse * (u[0] * w[0] + u[1] * w[1] + u[2] * w[2]));
        cot_k = bounded(inverse * (v[0] * w[0] + v[1] * w[1] + v[2] * w[2]));
    }
};

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

hmf_status cotangent_sums(const Mesh& mesh, const double* position, double* sum, Call& call, double fraction) {
    EdgeSums sums(sum);
    if (!sums.allocate(mesh, call.memory)) return call.out_of_memory();
    const auto visit = [&](uint32_t ij, uint32_t jk, uint32_t ki) {
        const CornerCotangents corners(position + size_t{3} * mesh.origin[ij], position + size_t{3} * mesh.origin[jk],
                                       position + size_t{3} * mesh.origin[ki]);
        sums.set(ij, corners.cot_k);
        sums.set(jk, corners.cot_i);
        sums.set(ki, corners.cot_j);
    };
    const auto visit_block = [&](size_t begin, size_t end) {
        for_each_face(mesh, static_cast<uint32_t>(begin), static_cast<uint32_t>(end), visit);
    };
    return call.pass(size_t{2} * mesh.edge_count, fraction, visit_block) && sums.add(call, fraction) ? HMF_OK
                                                                                                     : HMF_CANCELLED;
}

uint64_t clamp_weights(const Mesh& mesh, const WeightBounds& bounds, double* sum, const Parallel& parallel) {
    return parallel.sum_blocks<uint64_t>(mesh.edge_count, [=](size_t begin, size_t end) {
        uint64_t negative = 0;
        for (size_t e = begin; e < end; ++e) {
            const double w = 0.5 * sum[e];
            negative += w < bounds.negative;
            sum[e] = !(w > bounds.floor) ? bounds.floor : w > bounds.cap ? bounds.cap : w;
        }
        return negative;
    });
}

} // namespace hmf
