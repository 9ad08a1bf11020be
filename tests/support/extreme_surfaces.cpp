#include "extreme_surfaces.hpp"

#include <cmath>

namespace test {

namespace {

struct Maker {
    TriMesh mesh;
    uint32_t vertex(double x, double y, double z) {
        mesh.positions.insert(mesh.positions.end(), {x, y, z});
        return static_cast<uint32_t>(mesh.vertex_count() - 1);
    }
    void triangle(uint32_t a, uint32_t b, uint32_t c) { mesh.triangles.insert(mesh.triangles.end(), {a, b, c}); }
    void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        triangle(a, b, c);
        triangle(a, c, d);
    }
};

} // namespace

TriMesh walled_ring(size_t n, Strips strips, uint64_t seed) {
    constexpr size_t walls = 4;
    const double radius[4] = {3, 3, 1, 1}, height[4] = {0, 2, 2, 0};
    Maker maker;
    maker.mesh.genus = 1;
    const auto put = [&](size_t i, double r, double z) {
        const double angle = 2 * PI * static_cast<double>(i) / walls;
        return maker.vertex(r * std::cos(angle), r * std::sin(angle), z);
    };
    const auto corner = [](size_t i, size_t k) { return static_cast<uint32_t>(4 * (i % walls) + k); };
    for (size_t i = 0; i < walls; ++i)
        for (size_t k = 0; k < 4; ++k) put(i, radius[k], height[k]);
    Random random(seed);
    std::vector<uint32_t> line[walls];
    for (size_t i = 0; i < walls; ++i) {
        line[i].push_back(corner(i, 0));
        for (size_t j = 1; j <= n; ++j) {
            const double shift = 0.4 * (random.unit() - 0.5);
            line[i].push_back(put(i, 3, 2 * (static_cast<double>(j) + shift) / static_cast<double>(n + 1)));
        }
        line[i].push_back(corner(i, 1));
    }
    for (size_t i = 0; i < walls; ++i) {
        const std::vector<uint32_t>&a = line[i], &b = line[(i + 1) % walls];
        for (size_t j = 0; j + 1 < a.size(); ++j) {
            if (strips == Strips::ladder) {
                maker.quad(a[j], b[j], b[j + 1], a[j + 1]);
            } else {
                maker.triangle(a[0], b[j], b[j + 1]);
                maker.triangle(a[j], b.back(), a[j + 1]);
            }
        }
        for (size_t k = 1; k < 4; ++k)
            maker.quad(corner(i, k), corner(i + 1, k), corner(i + 1, (k + 1) % 4), corner(i, (k + 1) % 4));
    }
    return maker.mesh;
}

std::vector<uint32_t> walled_ring_longitude() { return {0, 4, 8, 12}; }

TriMesh flat_ring(size_t n, Strips strips) {
    const double radius[4] = {3, 3, 1, 1}, height[4] = {0, 1, 1, 0};
    Maker maker;
    maker.mesh.genus = 1;
    const auto at = [n](size_t i, size_t k) { return static_cast<uint32_t>(4 * (i % n) + k % 4); };
    for (size_t i = 0; i < n; ++i) {
        const double angle = 2 * PI * static_cast<double>(i) / static_cast<double>(n);
        for (size_t k = 0; k < 4; ++k)
            maker.vertex(radius[k] * std::cos(angle), radius[k] * std::sin(angle), height[k]);
    }
    for (const size_t k : {0, 2})
        for (size_t i = 0; i < n; ++i) maker.quad(at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
    // A path of steps on both circles: a fan over so many on one of them, then on the other one.
    const size_t step = strips == Strips::ladder ? 1 : n / 4;
    for (const size_t k : {1, 3}) {
        const size_t first = strips == Strips::ladder ? 1 : step / 2;
        size_t p = 0, q = 0;
        for (size_t end = first; p < n || q < n; end += step) {
            for (const size_t stop = std::min(end, n); p < stop; ++p)
                maker.triangle(at(p, k), at(p + 1, k), at(q, k + 1));
            for (const size_t stop = std::min(p == n ? n : (end - first) / step * step + step, n); q < stop; ++q)
                maker.triangle(at(p, k), at(q + 1, k + 1), at(q, k + 1));
        }
    }
    return maker.mesh;
}

TriMesh wheels(size_t n, size_t hubs, double lift) {
    const TriMesh coarse = torus(4, 3, 3, 1);
    Maker maker;
    maker.mesh.positions = coarse.positions;
    maker.mesh.genus = 1;
    for (size_t t = 0; t < coarse.triangle_count(); ++t) {
        const uint32_t* const corner = &coarse.triangles[3 * t];
        if (t >= hubs) {
            maker.triangle(corner[0], corner[1], corner[2]);
            continue;
        }
        double middle[3], u[3], w[3], size = 0, across = 0, width = 0;
        for (size_t c = 0; c < 3; ++c) {
            const auto at = [&](size_t k) { return coarse.positions[3 * corner[k] + c]; };
            middle[c] = (at(0) + at(1) + at(2)) / 3;
            u[c] = at(1) - at(0);
            w[c] = at(2) - at(0);
            size += u[c] * u[c];
        }
        size = std::sqrt(size);
        for (double& x : u) x /= size;
        for (size_t c = 0; c < 3; ++c) across += u[c] * w[c];
        for (size_t c = 0; c < 3; ++c) w[c] -= across * u[c];
        for (const double x : w) width += x * x;
        for (double& x : w) x /= std::sqrt(width);
        const double normal[3] = {u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]};
        const auto put = [&](double x, double y, double z) {
            double point[3];
            for (size_t c = 0; c < 3; ++c) point[c] = middle[c] + 0.12 * size * (x * u[c] + y * w[c]) + z * normal[c];
            return maker.vertex(point[0], point[1], point[2]);
        };
        const uint32_t first = static_cast<uint32_t>(maker.mesh.vertex_count());
        for (size_t j = 0; j < n; ++j) {
            const double angle = 2 * PI * static_cast<double>(j) / static_cast<double>(n) + 7 * PI / 6;
            put(std::cos(angle), std::sin(angle), 0);
        }
        const uint32_t hub = put(0, 0, lift);
        for (size_t j = 0; j < n; ++j) {
            const uint32_t a = first + static_cast<uint32_t>(j), b = first + static_cast<uint32_t>((j + 1) % n);
            const size_t near = 3 * j / n, after = 3 * (j + 1) / n;
            maker.triangle(hub, a, b);
            maker.triangle(a, corner[near], b);
            if (after != near) maker.triangle(b, corner[near], corner[after % 3]);
        }
    }
    return maker.mesh;
}

TriMesh fan_polygon(size_t n) {
    Maker maker;
    for (size_t i = 0; i < n; ++i)
        maker.vertex(static_cast<double>(i), static_cast<double>(i * i % 1000), static_cast<double>(i % 3));
    for (uint32_t i = 1; i + 1 < n; ++i) maker.triangle(0, i, i + 1);
    return maker.mesh;
}

} // namespace test
