#include "other.hpp"

// A torus of 6 x 8 vertices on a square grid.
hmf::Hierarchy build() {
    static const double x[] = {8, 4, -4, -8, -4, 4}, y[] = {0, 7, 7, 0, -7, -7};
    static const double r[] = {3, 2, 0, -2, -3, -2, 0, 2}, z[] = {0, 2, 3, 2, 0, -2, -3, -2};
    std::vector<std::array<double, 3>> positions;
    std::vector<uint32_t> triangles;
    for (uint32_t i = 0; i < 6; ++i)
        for (uint32_t j = 0; j < 8; ++j) {
            positions.push_back({x[i] * (8 + r[j]), y[i] * (8 + r[j]), 8 * z[j]});
            const uint32_t a = 8 * i + j, b = 8 * ((i + 1) % 6) + j, c = 8 * ((i + 1) % 6) + (j + 1) % 8,
                           d = 8 * i + (j + 1) % 8;
            triangles.insert(triangles.end(), {a, b, c, a, c, d});
        }
    return hmf::Hierarchy(positions, triangles);
}

double energy(const hmf::Foliation& foliation) { return foliation.energy(); }
