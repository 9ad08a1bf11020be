// Numbers of twice the precision, as the sum of two doubles [Dekker, A floating-point technique for extending the
// available precision, 1971].  About 31 digits; no operation needs more than additions and products of doubles.
#pragma once

#include "memory.hpp"

#include <cmath>

namespace hmf {

struct TwoDoubles {
    double high = 0, low = 0;

    static TwoDoubles of_sum(double a, double b) {
        const double s = a + b, t = s - a;
        return {s, (a - (s - t)) + (b - t)};
    }
    // Halves of 26 bits: their products are exact.  |a| < 2^990.
    static TwoDoubles of_product(double a, double b) {
        const double p = a * b, a1 = upper(a), a2 = a - a1, b1 = upper(b), b2 = b - b1;
        return {p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2};
    }
    double value() const { return high + low; }

private:
    static double upper(double a) {
        const double c = 134217729.0 * a; // 2^27 + 1
        return c - (c - a);
    }
};

// |a| >= |b|, or nearly so.
inline TwoDoubles joined(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
}

inline TwoDoubles operator-(TwoDoubles a) { return {-a.high, -a.low}; }
inline TwoDoubles operator+(TwoDoubles a, TwoDoubles b) {
    const TwoDoubles s = TwoDoubles::of_sum(a.high, b.high), t = TwoDoubles::of_sum(a.low, b.low);
    const TwoDoubles u = joined(s.high, s.low + t.high);
    return joined(u.high, u.low + t.low);
}
inline TwoDoubles operator-(TwoDoubles a, TwoDoubles b) { return a + -b; }
inline TwoDoubles operator*(TwoDoubles a, TwoDoubles b) {
    const TwoDoubles p = TwoDoubles::of_product(a.high, b.high);
    return joined(p.high, p.low + (a.high * b.low + a.low * b.high));
}
inline TwoDoubles operator*(double a, TwoDoubles b) { return TwoDoubles{a, 0} * b; }
inline TwoDoubles operator/(TwoDoubles a, TwoDoubles b) {
    const double q = a.high / b.high;
    const TwoDoubles rest = a - q * b;
    const double r = rest.high / b.high;
    const TwoDoubles rest_of_it = rest - r * b;
    return joined(q, r) + TwoDoubles{rest_of_it.high / b.high, 0};
}
// Of a number >= 0.
inline TwoDoubles square_root(TwoDoubles a) {
    if (!(a.high > 0)) return {};
    const double x = std::sqrt(a.high);
    const TwoDoubles rest = a - TwoDoubles::of_product(x, x);
    return joined(x, rest.high / (2 * x));
}

} // namespace hmf
