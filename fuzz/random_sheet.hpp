// Bytes -> a surface with boundary: a grid, flat, or closed to a tube or to a torus, with holes of a cell each, its
// vertices shifted.  Or a disk of one or two triangles.
//
//     +--+--+--+--+--+
//     | /| /| /| /| /|     holes only where both numbers are odd, and a row and a
//     +--+--+--+--+--+     column away from the border: no two of them touch,
//     | /|  | /|  | /|     so every boundary is a simple curve
//     +--+--+--+--+--+
//     | /| /| /| /| /|
//     +--+--+--+--+--+
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bytes.hpp"

namespace fuzz {

struct Sheet {
    std::vector<double> positions;
    std::vector<uint32_t> triangles;
    size_t genus = 0, boundaries = 0;

    size_t vertex_count() const { return positions.size() / 3; }
    size_t triangle_count() const { return triangles.size() / 3; }

    explicit Sheet(Bytes& bytes) {
        const uint32_t kind = bytes.below(8);
        if (kind == 0) {
            small(bytes.below(2) == 0);
            return;
        }
        const bool round = kind % 4 >= 2, torus = kind % 4 == 3; // closed in x; in y as well
        const uint32_t n = 5 + bytes.below(8), m = 5 + bytes.below(8);
        const uint32_t columns = round ? n : n + 1, rows = torus ? m : m + 1;
        uint64_t state = bytes.byte();
        const double shift = bytes.below(128) / 256.0; // of both signs together
        const auto shifted = [&](uint32_t at) {
            return at + shift * (static_cast<double>(next_random(state) % 1024) / 1024 - 0.5);
        };
        for (uint32_t x = 0; x < columns; ++x)
            for (uint32_t y = 0; y < rows; ++y) place(shifted(x), shifted(y), n, m, round, torus);
        size_t holes = 0;
        for (uint32_t x = 0; x < n; ++x)
            for (uint32_t y = 0; y < m; ++y) {
                const bool inside = x % 2 == 1 && y % 2 == 1 && x + 1 < n && y + 1 < m;
                if (inside && (bytes.byte() % 4 == 0 || (torus && holes == 0))) {
                    ++holes;
                    continue;
                }
                const uint32_t a = x * rows + y, b = (x + 1) % columns * rows + y,
                               c = (x + 1) % columns * rows + (y + 1) % rows, d = x * rows + (y + 1) % rows;
                triangles.insert(triangles.end(), {a, b, c, a, c, d});
            }
        genus = torus;
        boundaries = holes + (torus ? 0 : round ? 2 : 1);
    }

private:
    void small(bool one) {
        positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
        triangles = {0, 1, 2, 0, 2, 3};
        if (one) {
            positions.resize(9);
            triangles.resize(3);
        }
        boundaries = 1;
    }
    void place(double x, double y, double n, double m, bool round, bool torus) {
        const double u = 6.283185307179586 * x / n, v = 6.283185307179586 * y / m;
        const double r = torus ? 3 + std::cos(v) : 1;
        const double at[3] = {round ? r * std::cos(u) : x, round ? r * std::sin(u) : y,
                              torus   ? std::sin(v)
                              : round ? 3 * y / m
                                      : 0};
        positions.insert(positions.end(), at, at + 3);
    }
};

} // namespace fuzz
