// Meshes for tests: hmf::Mesh from triangles, and some closed surfaces.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "../../src/core/mesh/mesh.hpp"

namespace test {

struct Triangles {
    std::vector<double> positions;   // 3 per vertex
    std::vector<uint32_t> triangles; // 3 per triangle, counter-clockwise
    uint32_t vertex_count() const { return static_cast<uint32_t>(positions.size() / 3); }
};

// Connectivity that owns its arrays; edges numbered by first appearance.
struct MadeMesh {
    std::vector<uint32_t> origin, next, face, out;
    std::vector<double> positions;

    MadeMesh() = default;
    explicit MadeMesh(const Triangles& t) : positions(t.positions) {
        const uint32_t faces = static_cast<uint32_t>(t.triangles.size() / 3);
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> half_edge;
        for (uint32_t f = 0; f < faces; ++f) {
            uint32_t h[3];
            for (uint32_t s = 0; s < 3; ++s) {
                const uint32_t a = t.triangles[3 * f + s], b = t.triangles[3 * f + (s + 1) % 3];
                const auto reverse = half_edge.find({b, a});
                if (reverse != half_edge.end()) h[s] = reverse->second ^ 1u;
                else {
                    h[s] = static_cast<uint32_t>(origin.size());
                    origin.resize(origin.size() + 2, hmf::NONE);
                    half_edge[{a, b}] = h[s];
                }
            }
            next.resize(origin.size(), hmf::NONE);
            face.resize(origin.size(), hmf::NONE);
            for (uint32_t s = 0; s < 3; ++s) {
                origin[h[s]] = t.triangles[3 * f + s];
                next[h[s]] = h[(s + 1) % 3];
                face[h[s]] = f;
            }
        }
        out.resize(t.vertex_count(), hmf::NONE);
        for (uint32_t h = 0; h < origin.size(); ++h)
            if (out[origin[h]] == hmf::NONE) out[origin[h]] = h;
    }

    hmf::Mesh mesh() {
        hmf::Mesh m;
        m.vertex_count = static_cast<uint32_t>(out.size());
        m.edge_count = static_cast<uint32_t>(origin.size() / 2);
        uint32_t faces = 0;
        for (uint32_t f : face) faces = f + 1 > faces ? f + 1 : faces;
        m.face_count = faces;
        m.origin = origin.data();
        m.next = next.data();
        m.face = face.data();
        m.out = out.data();
        return m;
    }
};

// A grid of n (around the hole) by m (around the tube) vertices; vertex (x, y) is x * m + y.
inline Triangles torus_triangles(uint32_t n, uint32_t m, double radius = 3, double tube = 1) {
    Triangles t;
    for (uint32_t x = 0; x < n; ++x)
        for (uint32_t y = 0; y < m; ++y) {
            const double u = 2 * 3.14159265358979323846 * x / n, v = 2 * 3.14159265358979323846 * y / m;
            const double r = radius + tube * std::cos(v);
            t.positions.insert(t.positions.end(), {r * std::cos(u), r * std::sin(u), tube * std::sin(v)});
            const uint32_t a = x * m + y, b = (x + 1) % n * m + y, c = (x + 1) % n * m + (y + 1) % m,
                           d = x * m + (y + 1) % m;
            t.triangles.insert(t.triangles.end(), {a, b, c, a, c, d});
        }
    return t;
}

// The boundary of the cells of a box that `solid` holds, each square cut into
// 2 * fine * fine triangles.  The caller keeps cells from touching only at an
// edge or a corner.
inline Triangles voxels(int nx, int ny, int nz, const std::vector<char>& solid, int fine = 1) {
    Triangles t;
    std::map<std::tuple<int, int, int>, uint32_t> number;
    const auto vertex = [&](const std::array<int, 3>& p) {
        const auto made = number.insert({std::make_tuple(p[0], p[1], p[2]), t.vertex_count()});
        if (made.second)
            t.positions.insert(t.positions.end(), {double(p[0]) / fine, double(p[1]) / fine, double(p[2]) / fine});
        return made.first->second;
    };
    const auto is_solid = [&](int x, int y, int z) {
        return x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz
            && solid[static_cast<size_t>((x * ny + y) * nz + z)];
    };
    for (int x = 0; x < nx; ++x)
        for (int y = 0; y < ny; ++y)
            for (int z = 0; z < nz; ++z) {
                if (!is_solid(x, y, z)) continue;
                for (int axis = 0; axis < 3; ++axis)
                    for (int way = 0; way < 2; ++way) {
                        int to[3] = {x, y, z};
                        to[axis] += way ? 1 : -1;
                        if (is_solid(to[0], to[1], to[2])) continue;
                        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                        for (int i = 0; i < fine; ++i)
                            for (int j = 0; j < fine; ++j) {
                                uint32_t q[4];
                                for (int k = 0; k < 4; ++k) {
                                    std::array<int, 3> p = {x * fine, y * fine, z * fine};
                                    const size_t pu = static_cast<size_t>(u), pv = static_cast<size_t>(v),
                                                 pa = static_cast<size_t>(axis);
                                    p[pa] += way * fine;
                                    p[pu] += i + (k == 1 || k == 2);
                                    p[pv] += j + (k >= 2);
                                    q[k] = vertex(p);
                                }
                                if (way) t.triangles.insert(t.triangles.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
                                else t.triangles.insert(t.triangles.end(), {q[0], q[2], q[1], q[0], q[3], q[2]});
                            }
                    }
            }
    return t;
}

// A plate with a x b square holes: genus a * b.
inline Triangles plate(int a, int b, int fine = 1) {
    const int nx = 2 * a + 1, ny = 2 * b + 1;
    std::vector<char> solid(static_cast<size_t>(nx * ny), 1);
    for (int i = 0; i < a; ++i)
        for (int j = 0; j < b; ++j) solid[static_cast<size_t>((2 * i + 1) * ny + 2 * j + 1)] = 0;
    return voxels(nx, ny, 1, solid, fine);
}

} // namespace test
