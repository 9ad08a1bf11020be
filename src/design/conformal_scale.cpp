// On a triangle with edge values F the energy sum 1/2 cot F^2 is area * |grad u|^2,
// exactly where the values are differences of a linear function:
//
//            k
//           / \          cot(angle at k) belongs to F_ij
//          i---j
//
// The map (u, v) is conformal, so |grad u| is how much it stretches.
#include "conformal_scale.hpp"

#include "../mesh/weights.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

double natural_log(double x) {
    int exponent = 0;
    double m = std::frexp(x, &exponent);
    if (m < 0.70710678118654752) {
        m *= 2;
        --exponent;
    }
    // log m = 2 artanh z, |z| < 0.172
    const double z = (m - 1) / (m + 1), square = z * z;
    double sum = 0;
    for (int k = 21; k >= 1; k -= 2) sum = sum * square + 1.0 / k;
    return exponent * 0.69314718055994531 + 2 * z * sum;
}

Done ConformalScale::measure(const Mesh& mesh, const double* position, const int64_t* value, double unit,
                             Memory& memory, Call* call) {
    constexpr double least = 1e-14;       // of the largest density
    constexpr uint32_t stride = 1u << 16; // half-edges, and faces, between two reports
    const auto go_on = [call] { return !call || call->tick(0, true); };
    mean = offset = across = 0;
    if (!log_scale.allocate_filled(memory, mesh.face_count, 0.0) || !area.allocate_filled(memory, mesh.face_count, 0.0))
        return false;
    // Coordinates from -1 to 1, by a power of two: fourth powers are harmless.
    double largest = 0, low[3] = {}, high[3] = {};
    for (size_t i = 0; i < size_t{3} * mesh.vertex_count; ++i) {
        const double x = position[i] < 0 ? -position[i] : position[i];
        if (x > largest) largest = x;
        if (i < 3 || position[i] < low[i % 3]) low[i % 3] = position[i];
        if (i < 3 || position[i] > high[i % 3]) high[i % 3] = position[i];
    }
    int exponent = 0;
    std::frexp(largest, &exponent);
    const double shrink = std::ldexp(1.0, -exponent);
    double whole = 0, top = 0, whole_energy = 0, diagonal = 0;
    const auto measure_face = [&](uint32_t h, uint32_t g, uint32_t k) {
        const uint32_t side[3] = {h, g, k};
        double p[3][3], cross[3];
        for (size_t i = 0; i < 3; ++i)
            for (size_t c = 0; c < 3; ++c) p[i][c] = position[size_t{3} * mesh.origin[side[i]] + c] * shrink;
        for (size_t c = 0; c < 3; ++c) {
            const size_t x = (c + 1) % 3, y = (c + 2) % 3;
            cross[c] = (p[1][x] - p[0][x]) * (p[2][y] - p[0][y]) - (p[1][y] - p[0][y]) * (p[2][x] - p[0][x]);
        }
        const double doubled = std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
        const uint32_t t = mesh.face[h];
        area[t] = doubled / 2;
        whole += doubled / 2;
        if (!(doubled > 0)) return;
        double energy = 0;
        for (size_t i = 0; i < 3; ++i) { // the side from i to i + 1 is opposite to i + 2
            const double *a = p[(i + 2) % 3], *b = p[i], *c = p[(i + 1) % 3];
            double dot = 0;
            for (size_t x = 0; x < 3; ++x) dot += (b[x] - a[x]) * (c[x] - a[x]);
            const double F = static_cast<double>(value[edge_of(side[i])]) * unit;
            energy += 0.5 * dot / doubled * F * F;
        }
        whole_energy += energy;
        const double density = energy / (doubled / 2);
        log_scale[t] = density;
        if (density > top && density < HUGE_VAL) top = density;
    };
    const uint32_t half_edges = 2 * mesh.edge_count;
    for (uint32_t begin = 0; begin < half_edges; begin += std::min(stride, half_edges - begin)) {
        if (!go_on()) return false;
        for_each_face(mesh, begin, begin + std::min(stride, half_edges - begin), measure_face);
    }
    if (!(whole > 0) || !(top > 0)) { // no extent, or no foliation
        for (double& s : log_scale) s = 0;
        return true;
    }
    for (size_t c = 0; c < 3; ++c) diagonal += (high[c] - low[c]) * shrink * ((high[c] - low[c]) * shrink);
    across = whole_energy > 0 ? std::sqrt(whole_energy / whole * diagonal) : 0;
    offset = exponent * -0.69314718055994531;
    for (size_t t = 0; t < area.size(); ++t) {
        if (t % stride == 0 && !go_on()) return false;
        area[t] /= whole;
        double density = log_scale[t];
        if (!(density > least * top)) density = least * top;
        if (density > top) density = top;
        log_scale[t] = 0.5 * natural_log(density);
        mean += area[t] * log_scale[t];
    }
    return true;
}

double ConformalScale::unevenness() const {
    double square = 0;
    for (size_t t = 0; t < area.size(); ++t) square += area[t] * (log_scale[t] - mean) * (log_scale[t] - mean);
    return std::sqrt(square);
}

} // namespace hmf
