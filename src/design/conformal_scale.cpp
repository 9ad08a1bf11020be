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

namespace {

// The extent of some points.
struct Extent {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    void operator+=(const Extent& part) {
        for (size_t c = 0; c < 3; ++c) {
            low[c] = std::min(low[c], part.low[c]);
            high[c] = std::max(high[c], part.high[c]);
        }
    }
    double largest() const {
        double size = 0;
        for (size_t c = 0; c < 3; ++c) size = std::max(size, std::max(high[c], -low[c]));
        return size;
    }
    double square_of_diagonal(double scale) const {
        double sum = 0;
        for (size_t c = 0; c < 3; ++c) sum += (high[c] - low[c]) * scale * ((high[c] - low[c]) * scale);
        return sum;
    }
};

Extent extent_of(const double* position, size_t begin, size_t end) {
    Extent extent;
    for (size_t v = begin; v < end; ++v)
        for (size_t c = 0; c < 3; ++c) {
            const double x = position[3 * v + c];
            extent.low[c] = std::min(extent.low[c], x);
            extent.high[c] = std::max(extent.high[c], x);
        }
    return extent;
}

constexpr double FLAT = 1e-12; // height of a triangle, in its longest side

// Twice the area of a triangle, and its energy; F: of the sides from corner i to i + 1.
struct Triangle {
    double doubled, energy = 0;

    Triangle(const double (&p)[3][3], const double (&F)[3]) {
        double d[3][3], squared[3], cross[3]; // d: from corner i to i + 1
        for (size_t i = 0; i < 3; ++i) {
            for (size_t c = 0; c < 3; ++c) d[i][c] = p[(i + 1) % 3][c] - p[i][c];
            squared[i] = d[i][0] * d[i][0] + d[i][1] * d[i][1] + d[i][2] * d[i][2];
        }
        for (size_t c = 0; c < 3; ++c) {
            const size_t x = (c + 1) % 3, y = (c + 2) % 3;
            cross[c] = d[0][y] * d[2][x] - d[0][x] * d[2][y];
        }
        doubled = std::sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
        // The density of a triangle that is flat up to rounding would be that of the whole surface many times over.
        if (!(doubled > FLAT * std::max(squared[0], std::max(squared[1], squared[2])))) {
            doubled = 0;
            return;
        }
        for (size_t i = 0; i < 3; ++i) { // the side from i to i + 1 is opposite to i + 2
            const double *a = d[(i + 1) % 3], *b = d[(i + 2) % 3];
            energy -= (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * (F[i] * F[i]);
        }
        energy *= 0.5 / doubled;
    }
};

// Of some faces.
struct Totals {
    double area = 0, energy = 0, densest = 0;
    void operator+=(const Totals& part) {
        area += part.area;
        energy += part.energy;
        densest = std::max(densest, part.densest);
    }
};

} // namespace

Done ConformalScale::measure(const Mesh& mesh, const double* position, const int64_t* value, double unit,
                             Memory& memory, Call* call) {
    constexpr double least = 1e-14; // of the largest density
    const auto go_on = [call] { return !call || call->tick(0, true); };
    const Parallel alone;
    const Parallel& parallel = call ? call->parallel : alone;
    mean = offset = across = 0;
    if (!log_scale.allocate(memory, mesh.face_count) || !area.allocate(memory, mesh.face_count) || !go_on())
        return false;
    // Coordinates from -1 to 1, by a power of two: fourth powers are harmless.
    const Extent extent = parallel.sum_blocks<Extent>(
        mesh.vertex_count, [&](size_t begin, size_t end) { return extent_of(position, begin, end); });
    int exponent = 0;
    std::frexp(extent.largest(), &exponent);
    const double shrink = std::ldexp(1.0, -exponent);
    const auto measure_face = [&](uint32_t h, uint32_t g, uint32_t k, Totals& totals) {
        const uint32_t side[3] = {h, g, k}, t = mesh.face[h];
        double p[3][3], F[3];
        for (size_t i = 0; i < 3; ++i) {
            for (size_t c = 0; c < 3; ++c) p[i][c] = position[size_t{3} * mesh.origin[side[i]] + c] * shrink;
            F[i] = static_cast<double>(value[edge_of(side[i])]) * unit;
        }
        const Triangle triangle(p, F);
        area[t] = triangle.doubled / 2;
        totals.area += area[t];
        totals.energy += triangle.energy;
        const double density = triangle.doubled > 0 ? triangle.energy / area[t] : 0;
        log_scale[t] = density;
        if (density > totals.densest && density < HUGE_VAL) totals.densest = density;
    };
    if (!go_on()) return false;
    const Totals whole = parallel.sum_blocks<Totals>(size_t{2} * mesh.edge_count, [&](size_t begin, size_t end) {
        Totals here;
        for_each_face(mesh, static_cast<uint32_t>(begin), static_cast<uint32_t>(end),
                      [&](uint32_t h, uint32_t g, uint32_t k) { measure_face(h, g, k, here); });
        return here;
    });
    if (!(whole.area > 0) || !(whole.densest > 0)) { // no extent, or no foliation
        for (double& s : log_scale) s = 0;
        return true;
    }
    across = whole.energy > 0 ? std::sqrt(whole.energy / whole.area * extent.square_of_diagonal(shrink)) : 0;
    offset = exponent * -0.69314718055994531;
    if (!go_on()) return false;
    mean = parallel.sum_blocks<double>(area.size(), [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t t = begin; t < end; ++t) {
            area[t] /= whole.area;
            double density = log_scale[t];
            if (!(density > least * whole.densest)) density = least * whole.densest;
            if (density > whole.densest) density = whole.densest;
            log_scale[t] = 0.5 * natural_log(density);
            sum += area[t] * log_scale[t];
        }
        return sum;
    });
    return go_on();
}

double ConformalScale::unevenness() const {
    double square = 0;
    for (size_t t = 0; t < area.size(); ++t) square += area[t] * (log_scale[t] - mean) * (log_scale[t] - mean);
    return std::sqrt(square);
}

} // namespace hmf
