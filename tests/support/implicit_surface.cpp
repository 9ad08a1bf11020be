#include "implicit_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace test {

namespace {

// The component with the most triangles, vertices renumbered, genus counted.
TriMesh largest_component(const TriMesh& mesh) {
    std::vector<uint32_t> root(mesh.vertex_count());
    std::iota(root.begin(), root.end(), 0u);
    const auto find = [&](uint32_t v) {
        while (root[v] != v) v = root[v] = root[root[v]];
        return v;
    };
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (size_t s = 1; s < 3; ++s) root[find(mesh.triangles[3 * t])] = find(mesh.triangles[3 * t + s]);
    std::vector<size_t> size(mesh.vertex_count(), 0);
    for (size_t t = 0; t < mesh.triangle_count(); ++t) ++size[find(mesh.triangles[3 * t])];
    const auto most = std::max_element(size.begin(), size.end());
    TriMesh result;
    if (most == size.end() || *most == 0) return result;
    const uint32_t kept = static_cast<uint32_t>(most - size.begin());
    std::vector<uint32_t> number(mesh.vertex_count(), UINT32_MAX);
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        if (find(mesh.triangles[3 * t]) != kept) continue;
        for (size_t s = 0; s < 3; ++s) {
            const uint32_t v = mesh.triangles[3 * t + s];
            if (number[v] == UINT32_MAX) {
                number[v] = static_cast<uint32_t>(result.vertex_count());
                result.positions.insert(result.positions.end(), &mesh.positions[3 * v], &mesh.positions[3 * v] + 3);
            }
            result.triangles.push_back(number[v]);
        }
    }
    // Euler characteristic: V - E + F with E = 3 F / 2.
    const long euler = static_cast<long>(result.vertex_count()) - static_cast<long>(result.triangle_count() / 2);
    result.genus = static_cast<size_t>((2 - euler) / 2);
    return result;
}

} // namespace

TriMesh implicit_surface(size_t n, double least, const std::function<double(double, double, double)>& field) {
    const size_t m = n + 3; // grid points per axis, with one layer outside
    const auto coordinate = [&](size_t i) { return (static_cast<double>(i) - 1) / static_cast<double>(n); };
    std::vector<double> value(m * m * m, -1);
    for (size_t i = 1; i + 1 < m; ++i)
        for (size_t j = 1; j + 1 < m; ++j)
            for (size_t k = 1; k + 1 < m; ++k)
                value[(i * m + j) * m + k] = field(coordinate(i), coordinate(j), coordinate(k));
    TriMesh mesh;
    std::map<std::pair<size_t, size_t>, uint32_t> number;
    // On the edge from an inner grid point to an outer one.
    const auto vertex = [&](size_t in, size_t out) {
        const auto found = number.find({in, out});
        if (found != number.end()) return found->second;
        const double t = std::clamp(value[in] / (value[in] - value[out]), least, 1 - least);
        const size_t a[3] = {in / (m * m), in / m % m, in % m}, b[3] = {out / (m * m), out / m % m, out % m};
        for (size_t x = 0; x < 3; ++x)
            mesh.positions.push_back(coordinate(a[x]) + t * (coordinate(b[x]) - coordinate(a[x])));
        return number[{in, out}] = static_cast<uint32_t>(mesh.vertex_count() - 1);
    };
    const size_t unit[3] = {m * m, m, 1};
    const size_t order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (size_t i = 0; i + 1 < m; ++i)
        for (size_t j = 0; j + 1 < m; ++j)
            for (size_t k = 0; k + 1 < m; ++k)
                for (size_t o = 0; o < 6; ++o) {
                    size_t corner[4] = {(i * m + j) * m + k, 0, 0, 0};
                    for (size_t x = 0; x < 3; ++x) corner[x + 1] = corner[x] + unit[order[o][x]];
                    if (o >= 3) std::swap(corner[2], corner[3]); // all tetrahedra turn the same way
                    // Inner corners first, by an even permutation.
                    size_t in = 0;
                    for (const size_t c : corner) in += value[c] > 0;
                    if (in == 0 || in == 4) continue;
                    size_t sorted[4], at = 0;
                    for (const size_t c : corner)
                        if (value[c] > 0) sorted[at++] = c;
                    for (const size_t c : corner)
                        if (!(value[c] > 0)) sorted[at++] = c;
                    size_t inversions = 0;
                    const auto place = [&](size_t c) { return std::find(corner, corner + 4, c) - corner; };
                    for (size_t a = 0; a < 4; ++a)
                        for (size_t b = a + 1; b < 4; ++b) inversions += place(sorted[a]) > place(sorted[b]);
                    if (inversions % 2) std::swap(sorted[in == 1 ? 2 : 0], sorted[in == 1 ? 3 : 1]);
                    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
                        mesh.triangles.insert(mesh.triangles.end(), {a, b, c});
                    };
                    const size_t* s = sorted;
                    if (in == 1) {
                        add(vertex(s[0], s[1]), vertex(s[0], s[2]), vertex(s[0], s[3]));
                    } else if (in == 3) {
                        add(vertex(s[0], s[3]), vertex(s[1], s[3]), vertex(s[2], s[3]));
                    } else {
                        const uint32_t a = vertex(s[0], s[2]), b = vertex(s[0], s[3]), c = vertex(s[1], s[3]),
                                       d = vertex(s[1], s[2]);
                        add(a, b, c);
                        add(a, c, d);
                    }
                }
    return largest_component(mesh);
}

TriMesh random_implicit_surface(size_t n, double frequency, Random& random) {
    const double least = std::pow(10, -1 - 4 * random.unit());
    double phase[3], shape[3];
    for (double& x : phase) x = 2 * PI * random.unit();
    for (double& x : shape) x = 0.35 + 0.15 * random.unit();
    const bool ball = random.below(2) == 0;
    const auto inside = [&](double x, double y, double z) { // of a box or a ball, about its distance
        const double u = std::abs(x - 0.5) - shape[0], v = std::abs(y - 0.5) - shape[1],
                     w = std::abs(z - 0.5) - shape[2];
        if (!ball) return -std::max({u, v, w});
        return 0.47 - std::sqrt((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5) + (z - 0.5) * (z - 0.5));
    };
    switch (random.below(3)) {
    case 0: {
        const double k = 2 * PI * frequency, level = 0.4 * (random.unit() - 0.5);
        return implicit_surface(n, least, [=](double x, double y, double z) {
            const double u = k * x + phase[0], v = k * y + phase[1], w = k * z + phase[2];
            const double gyroid = std::sin(u) * std::cos(v) + std::sin(v) * std::cos(w) + std::sin(w) * std::cos(u);
            return std::min(k * inside(x, y, z), gyroid - level);
        });
    }
    case 1: {
        std::vector<double> wave;
        for (size_t i = 0; i < 5 * 6; ++i) wave.push_back(2 * random.unit() - 1);
        return implicit_surface(n, least, [=](double x, double y, double z) {
            double sum = 0.2;
            for (size_t i = 0; i < 30; i += 5)
                sum += wave[i]
                     * std::sin(2 * PI * frequency * (wave[i + 1] * x + wave[i + 2] * y + wave[i + 3] * z)
                                + 9 * wave[i + 4]);
            return std::min(2 * PI * frequency * inside(x, y, z), sum);
        });
    }
    default: {
        // Rings in random places and planes.
        std::vector<std::array<double, 8>> rings;
        for (size_t i = 0; i < 2 + random.below(static_cast<size_t>(4 * frequency)); ++i) {
            std::array<double, 8> ring;
            for (size_t x = 0; x < 3; ++x) ring[x] = 0.3 + 0.4 * random.unit();
            ring[3] = 0.12 + 0.14 * random.unit();
            double normal[3], length = 0;
            for (double& x : normal) {
                x = random.unit() - 0.5;
                length += x * x;
            }
            for (size_t x = 0; x < 3; ++x) ring[4 + x] = normal[x] / std::sqrt(length);
            ring[7] = 0.05 + 0.03 * random.unit();
            rings.push_back(ring);
        }
        return implicit_surface(n, least, [=](double x, double y, double z) {
            double most = -1;
            for (const auto& ring : rings) {
                const double p[3] = {x - ring[0], y - ring[1], z - ring[2]};
                const double up = p[0] * ring[4] + p[1] * ring[5] + p[2] * ring[6];
                const double out =
                    std::sqrt(std::max(0.0, p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - up * up)) - ring[3];
                most = std::max(most, ring[7] - std::sqrt(up * up + out * out));
            }
            return most;
        });
    }
    }
}

} // namespace test
