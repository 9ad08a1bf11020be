// On a triangle with edge values F the energy sum 1/2 cot F^2 is area * |grad u|^2,
// exactly where the values are differences of a linear function:
//
//            k
//           / \          cot(angle at k) belongs to F_ij
//          i---j
//
// The map (u, v) is conformal, so |grad u| is how much it stretches.
#include "conformal_scale.hpp"

#include "../../core/mesh/weights.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

// x = 2^e m with m in [.7, 1.4], log m = 2 artanh z with |z| < .172, and artanh z = z (1 + z^2 / 3 + z^4 / 5 + ...).
double natural_log(double x) {
    int exponent = 0;
    double m = std::frexp(x, &exponent);
    if (m < 0.70710678118654752) {
        m *= 2;
        --exponent;
    }
    const double z = (m - 1) / (m + 1), s = z * z, s2 = s * s, s4 = s2 * s2;
    const double low = 1 + s * (1.0 / 3) + s2 * (1.0 / 5 + s * (1.0 / 7));
    const double middle = 1.0 / 9 + s * (1.0 / 11) + s2 * (1.0 / 13 + s * (1.0 / 15));
    const double high = 1.0 / 17 + s * (1.0 / 19) + s2 * (1.0 / 21);
    return exponent * 0.69314718055994531 + 2 * z * (low + s4 * (middle + s4 * high));
}

namespace {

// The extent of some points.
struct Extent {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    double square_of_diagonal() const {
        double sum = 0;
        for (size_t c = 0; c < 3; ++c) sum += (high[c] - low[c]) * (high[c] - low[c]);
        return sum;
    }
};

Extent extent_of(const double* position, size_t count) {
    Extent extent;
    for (size_t v = 0; v < count; ++v)
        for (size_t c = 0; c < 3; ++c) {
            const double x = position[3 * v + c];
            extent.low[c] = std::min(extent.low[c], x);
            extent.high[c] = std::max(extent.high[c], x);
        }
    return extent;
}

constexpr double FLAT_TRIANGLE = 1e-12; // height of a triangle, in its longest side

double product_of(const double (&a)[3], const double (&b)[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Area of a triangle and its energy for each unit of it; F: of the sides from corner i to i + 1.
struct Triangle {
    double area = 0, density = 0;

    Triangle(const double* p0, const double* p1, const double* p2, const double (&F)[3]) {
        double a[3], b[3], c[3]; // the sides; their sum is 0
        for (size_t x = 0; x < 3; ++x) {
            a[x] = p1[x] - p0[x];
            b[x] = p2[x] - p1[x];
            c[x] = p0[x] - p2[x];
        }
        const double ab = product_of(a, b), bc = product_of(b, c), ca = product_of(c, a);
        const double cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
        const double square = product_of(cross, cross), doubled = std::sqrt(square);
        // The density of a triangle that is flat up to rounding would be that of the whole surface many times over.
        const double longest = std::max(-ca - ab, std::max(-ab - bc, -bc - ca));
        if (!(doubled > FLAT_TRIANGLE * longest)) return;
        area = 0.5 * doubled;
        density = -(bc * (F[0] * F[0]) + ca * (F[1] * F[1]) + ab * (F[2] * F[2])) / square;
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

// Of log_scale over the surface, from some value on.
struct Moments {
    double first = 0, second = 0;
    void operator+=(const Moments& part) {
        first += part.first;
        second += part.second;
    }
};

} // namespace

Done ConformalScale::measure(const Mesh& mesh, const double* position, const int64_t* value, double unit,
                             Memory& memory, Call* call) {
    constexpr double least = 1e-14; // of the largest density
    const auto go_on = [call] { return !call || call->tick(0, true); };
    const Parallel alone;
    const Parallel& parallel = call ? call->parallel : alone;
    mean = offset = variance_ = mean_density_ = 0;
    if (!log_scale.allocate(memory, mesh.face_count) || !area.allocate(memory, mesh.face_count) || !go_on())
        return false;
    const auto measure_face = [&](uint32_t h, uint32_t g, uint32_t k, Totals& totals) {
        const double F[3] = {static_cast<double>(value[edge_of(h)]) * unit,
                             static_cast<double>(value[edge_of(g)]) * unit,
                             static_cast<double>(value[edge_of(k)]) * unit};
        const auto at = [&](uint32_t side) { return position + size_t{3} * mesh.origin[side]; };
        const Triangle triangle(at(h), at(g), at(k), F);
        const uint32_t t = mesh.face[h];
        area[t] = triangle.area;
        log_scale[t] = triangle.density;
        totals.area += triangle.area;
        totals.energy += triangle.area * triangle.density;
        if (triangle.density > totals.densest && triangle.density < HUGE_VAL) totals.densest = triangle.density;
    };
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
    mean_density_ = std::max(0.0, whole.energy / whole.area);
    if (!go_on()) return false;
    // Densities are taken in a power of two near their mean, so that the unit of the positions does not matter, and
    // the moments from near the mean on, so that little is lost in the difference of the two.
    int exponent = 0;
    std::frexp(mean_density_, &exponent);
    exponent = std::max(exponent, -1000); // the power is a number, too
    const double unit_density = std::ldexp(1.0, -exponent), densest = whole.densest * unit_density;
    const auto log_of = [&](double density) {
        const double x = density * unit_density;
        return 0.5 * natural_log(x > least * densest ? std::min(x, densest) : least * densest);
    };
    const double center = log_of(mean_density_), share = 1 / whole.area;
    const Moments moments = parallel.sum_blocks<Moments>(area.size(), [&](size_t begin, size_t end) {
        Moments part;
        for (size_t t = begin; t < end; ++t) {
            area[t] *= share;
            log_scale[t] = log_of(log_scale[t]);
            const double off = log_scale[t] - center;
            part += {area[t] * off, area[t] * off * off};
        }
        return part;
    });
    mean = center + moments.first;
    offset = exponent * (0.5 * 0.69314718055994531);
    variance_ = std::max(0.0, moments.second - moments.first * moments.first);
    return go_on();
}

double ConformalScale::unevenness() const { return std::sqrt(variance_); }

double ConformalScale::across(const double* position, size_t vertex_count) const {
    return std::sqrt(mean_density_ * extent_of(position, vertex_count).square_of_diagonal());
}

} // namespace hmf
