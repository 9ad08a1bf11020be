// Singular values of a 2 x 2 matrix from its conformal and anti-conformal
// parts: f_z = (f_x - i f_y) / 2, f_zbar = (f_x + i f_y) / 2, and the singular
// values are |f_z| + |f_zbar| and ||f_z| - |f_zbar||.
#include "dilatation.hpp"

#include <cmath>

namespace hmf {

AffineMap affine_map(const double* p0, const double* p1, const double* p2, const double u[3], const double v[3]) {
    AffineMap map;
    double a[3], b[3], aa = 0, ab = 0, bb = 0;
    for (int c = 0; c < 3; ++c) {
        a[c] = p1[c] - p0[c];
        b[c] = p2[c] - p0[c];
        aa += a[c] * a[c];
        ab += a[c] * b[c];
        bb += b[c] * b[c];
    }
    // Corners in the frame: (0, 0), (x1, 0), (x2, y2).
    const double x1 = std::sqrt(aa), cross = aa * bb - ab * ab, doubled = cross > 0 ? std::sqrt(cross) : 0;
    map.area = 0.5 * doubled;
    if (!(x1 > 0) || !(doubled > 0)) {
        map.dilatation = HUGE_VAL;
        return map;
    }
    const double by_x1 = 1 / x1, by_y2 = x1 / doubled, x2 = ab * by_x1;
    const double u_x = (u[1] - u[0]) * by_x1, v_x = (v[1] - v[0]) * by_x1;
    const double u_y = (u[2] - u[0] - u_x * x2) * by_y2, v_y = (v[2] - v[0] - v_x * x2) * by_y2;
    const double re = 0.5 * (u_x + v_y), im = 0.5 * (v_x - u_y);
    const double conformal = std::sqrt(re * re + im * im);
    const double anti = 0.5 * std::sqrt((u_x - v_y) * (u_x - v_y) + (v_x + u_y) * (v_x + u_y));
    map.determinant = (conformal - anti) * (conformal + anti);
    map.differential[0] = re * re - im * im;
    map.differential[1] = 2 * re * im;
    const double larger = conformal + anti, smaller = conformal > anti ? conformal - anti : anti - conformal;
    map.dilatation = smaller * LARGEST_DILATATION > larger ? larger / smaller : HUGE_VAL;
    return map;
}

} // namespace hmf
