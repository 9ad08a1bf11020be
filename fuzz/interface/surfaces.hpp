// Surfaces made of bytes: anything, chains of tori, spheres.
#pragma once

#include <cmath>
#include <vector>

#include "../bytes.hpp"

namespace fuzz {

inline double coordinate(Bytes& bytes) {
    const uint8_t b = bytes.byte();
    if (b == 255) return static_cast<double>(NAN);
    if (b == 254) return static_cast<double>(INFINITY);
    if (b == 253) return 1e300;
    if (b == 252) return 1e-300;
    return (b - 126) / 32.0;
}

struct Surface {
    std::vector<double> positions;
    std::vector<uint32_t> triangles;
};

inline Surface anything(Bytes& bytes) {
    Surface s;
    const uint32_t vertices = bytes.below(16), triangles = bytes.below(40);
    for (uint32_t i = 0; i < 3 * vertices; ++i) s.positions.push_back(coordinate(bytes));
    for (uint32_t i = 0; i < 3 * triangles; ++i) s.triangles.push_back(bytes.below(vertices + 1));
    return s;
}

// Tori in a row; each is glued to the one before along a triangle.
// Large ones have several levels, and linear systems that are solved on several levels.
inline Surface chain_of_tori(Bytes& bytes, bool large) {
    Surface s;
    const uint32_t tori = 1 + bytes.below(large ? 2 : 3);
    for (uint32_t t = 0; t < tori; ++t) {
        const uint32_t n = (large ? 14 : 4) + bytes.below(6), m = (large ? 14 : 4) + bytes.below(4);
        std::vector<uint32_t> id(n * m, UINT32_MAX);
        if (t > 0) {
            // The last triangle goes; its corners are 0, m and m + 1 of this torus, the other way round.
            const size_t last = s.triangles.size() - 3;
            id[0] = s.triangles[last], id[m] = s.triangles[last + 2], id[m + 1] = s.triangles[last + 1];
            s.triangles.resize(last);
        }
        for (uint32_t i = 0; i < n * m; ++i) {
            if (id[i] != UINT32_MAX) continue;
            id[i] = static_cast<uint32_t>(s.positions.size() / 3);
            const double u = 6.283185307179586 * (i / m) / n, v = 6.283185307179586 * (i % m) / m;
            const double r = 2 + std::cos(v);
            const double p[3] = {6.0 * t + r * std::cos(u), r * std::sin(u), std::sin(v)};
            for (const double x : p) s.positions.push_back(x);
        }
        for (uint32_t x = 0; x < n; ++x)
            for (uint32_t y = 0; y < m; ++y) {
                const uint32_t a = id[x * m + y], b = id[(x + 1) % n * m + y], c = id[(x + 1) % n * m + (y + 1) % m],
                               d = id[x * m + (y + 1) % m];
                if (t == 0 || x + y > 0) s.triangles.insert(s.triangles.end(), {a, b, c});
                s.triangles.insert(s.triangles.end(), {a, c, d});
            }
    }
    // Stretches and dents; then, rarely, damage.
    const uint32_t vertices = static_cast<uint32_t>(s.positions.size() / 3);
    for (uint32_t i = bytes.below(24); i > 0; --i)
        s.positions[(bytes.byte() * 7u + bytes.byte()) % (3 * vertices)] += (bytes.byte() - 128) / 256.0;
    if (bytes.rarely())
        for (uint32_t i = 1 + bytes.below(4); i > 0; --i)
            s.triangles[(bytes.byte() * 7u + bytes.byte()) % s.triangles.size()] = bytes.below(vertices + 2);
    if (bytes.rarely()) s.triangles.resize(s.triangles.size() - 3);
    if (bytes.rarely()) s.positions[bytes.byte() % s.positions.size()] = coordinate(bytes);
    return s;
}

// Two pyramids over a ring, in layers.
inline Surface sphere(Bytes& bytes) {
    Surface s;
    const uint32_t n = 4 + bytes.below(6), layers = 2 + bytes.below(5);
    for (uint32_t k = 0; k < layers; ++k)
        for (uint32_t i = 0; i < n; ++i) {
            const double u = 6.283185307179586 * i / n, z = (k + 1.0) / (layers + 1) * 2 - 1, r = std::sqrt(1 - z * z);
            for (const double x : {r * std::cos(u), r * std::sin(u), z}) s.positions.push_back(x);
        }
    for (const double x : {0.0, 0.0, -1.0, 0.0, 0.0, 1.0}) s.positions.push_back(x);
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t j = (i + 1) % n, top = (layers - 1) * n;
        s.triangles.insert(s.triangles.end(), {layers * n, j, i, layers * n + 1, top + i, top + j});
        for (uint32_t k = 0; k + 1 < layers; ++k) {
            const uint32_t a = k * n + i, b = k * n + j;
            s.triangles.insert(s.triangles.end(), {a, b, b + n, a, b + n, a + n});
        }
    }
    for (uint32_t i = bytes.below(12); i > 0; --i)
        s.positions[(bytes.byte() * 7u + bytes.byte()) % s.positions.size()] += (bytes.byte() - 128) / 512.0;
    return s;
}

} // namespace fuzz
