// What the fuzz targets share: bytes -> a closed surface with a random valid
// foliation, and the assertions that every operation must keep.
//
// The surface is a chain of 1 to 3 grid tori, glued at triangles.  Each torus
// may carry a loop of random weight around its column 0.  Or it is a sphere, a
// tube with two ends, with a loop around the tube.  Up to 7 vertices are marked,
// on the sphere at least two on each side of the loop.  Whitehead moves under
// random weights then spread the foliation.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "../src/core/foliation/whitehead.hpp"
#include "../tests/support/check_mesh.hpp"
#include "bytes.hpp"

namespace fuzz {

using namespace hmf;

class RandomFoliation {
public:
    static constexpr uint32_t spare_vertices = 64;

    explicit RandomFoliation(Bytes& bytes) : memory_(nullptr, nullptr, nullptr, 0) {
        const uint32_t tori = (1 + bytes.byte() % 4u) % 4u; // 0: a sphere
        const uint32_t n = 4 + bytes.byte() % 4u, m = 3 + bytes.byte() % 4u;
        std::vector<std::array<uint32_t, 3>> triangles;
        std::map<std::pair<uint32_t, uint32_t>, int64_t> crossing;
        uint32_t vertices = 0;
        std::array<uint32_t, 3> seam{};
        for (uint32_t k = 0; k < tori; ++k) {
            const bool first = k == 0, last = k + 1 == tori;
            // Vertices of this torus; the triangle at (2, 0) is glued to the
            // one at (2, 1) of the torus before.
            std::vector<uint32_t> id(n * m);
            const uint32_t head[3] = {2 * m + 0, 3 % n * m + 0, 3 % n * m + 1 % m};
            const uint32_t tail[3] = {2 * m + 1 % m, 3 % n * m + 1 % m, 3 % n * m + 2 % m};
            for (uint32_t i = 0; i < n * m; ++i) id[i] = NONE;
            if (!first) {
                id[head[0]] = seam[0];
                id[head[1]] = seam[2];
                id[head[2]] = seam[1];
            }
            for (uint32_t i = 0; i < n * m; ++i)
                if (id[i] == NONE) id[i] = vertices++;
            seam = {id[tail[0]], id[tail[1]], id[tail[2]]};
            int64_t weight = static_cast<int64_t>(bytes.wide_below(65536)) << (bytes.byte() % 20u);
            if (first && weight == 0) weight = 1 << 20;
            weight_.push_back(weight);
            across_.emplace_back();
            for (uint32_t x = 0; x < n; ++x)
                for (uint32_t y = 0; y < m; ++y) {
                    const uint32_t a = id[x * m + y], b = id[(x + 1) % n * m + y],
                                   c = id[(x + 1) % n * m + (y + 1) % m], d = id[x * m + (y + 1) % m];
                    const bool glued = (!first && x == 2 && y == 0) || (!last && x == 2 && y == 1);
                    if (!glued) triangles.push_back({a, b, c});
                    triangles.push_back({a, c, d});
                    if (x != 0) continue;
                    crossing[key(a, b)] += weight;
                    crossing[key(a, c)] += weight;
                    across_[k].push_back({a, b});
                    across_[k].push_back({a, c});
                }
        }
        if (tori == 0) make_sphere(bytes, n, m, triangles, vertices, crossing);
        mark(bytes, tori == 0, triangles, vertices, crossing);
        build(triangles, vertices, crossing);
        f.mesh.marked_count = static_cast<uint32_t>(side_of_mark_.size());
        euler_ = static_cast<int64_t>(vertices) - f.mesh.edge_count + f.mesh.face_count;
        FUZZ_ASSERT(euler_ == 2 - 2 * static_cast<int64_t>(tori));
        FUZZ_ASSERT(check(f.mesh) == nullptr);
        assert_valid();
        shake(bytes, 1 + bytes.byte() % 4u);
    }

    // Sweeps of legal moves under random weights: a random valid foliation.
    void shake(Bytes& bytes, uint32_t sweeps) {
        std::vector<double> weight(f.mesh.edge_count);
        for (uint32_t s = 0; s < sweeps; ++s) {
            uint32_t state = 1 + bytes.byte();
            for (double& w : weight) {
                state = state * 1664525u + 1013904223u;
                w = 1 + (state >> 24) * ((state >> 20) % 4);
            }
            Rings rings;
            Star star;
            FUZZ_ASSERT(rings.build(f.mesh, weight.data(), memory_) && star.allocate(memory_, rings.max_degree));
            SweepResult result;
            for (uint32_t v = 0; v < f.mesh.vertex_count; ++v) {
                relax_vertex(f, rings, weight.data(), v, star, result);
                if (f.mesh.vertex_count < 40) assert_valid();
            }
            assert_valid();
        }
    }

    // Necessary for the class, on the connectivity of the start: a closed path
    // that crosses loop k exactly once is not shorter than its weight, and no
    // path between marked vertices on different sides of a loop on the sphere.
    void assert_class() {
        const Mesh& mesh = f.mesh;
        for (uint32_t a = 0; a < mesh.marked_count && across_.empty(); ++a)
            for (uint32_t b = 0; b < a; ++b)
                if (side_of_mark_[a] != side_of_mark_[b])
                    FUZZ_ASSERT(distance(a, b, std::vector<int8_t>(2 * mesh.edge_count, 0)) >= weight_[0]);
        for (size_t k = 0; k < across_.size(); ++k) {
            std::vector<int8_t> crosses(2 * mesh.edge_count, 0); // per half-edge
            std::vector<uint32_t> start;
            for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h)
                for (const auto& pair : across_[k])
                    if (mesh.origin[h] == pair.first && mesh.target(h) == pair.second) {
                        crosses[h] = crosses[twin(h)] = 1;
                        start.push_back(h);
                    }
            FUZZ_ASSERT(start.size() == across_[k].size());
            for (const uint32_t first : start)
                FUZZ_ASSERT(f.at(first) + distance(mesh.target(first), mesh.origin[first], crosses) >= weight_[k]);
        }
    }

    // No pole, exact triangle inequalities, index sum 2 * chi - marked vertices.
    void assert_valid() {
        const SingularityCount count = count_singularities(f);
        FUZZ_ASSERT(count.broken_triangles == 0);
        FUZZ_ASSERT(count.poles == 0);
        FUZZ_ASSERT(count.index_sum == 2 * euler_ - f.mesh.marked_count);
    }

    std::vector<uint32_t> connectivity() const {
        std::vector<uint32_t> all(f.mesh.origin, f.mesh.origin + 2 * f.mesh.edge_count);
        all.insert(all.end(), f.mesh.next, f.mesh.next + 2 * f.mesh.edge_count);
        all.insert(all.end(), f.mesh.face, f.mesh.face + 2 * f.mesh.edge_count);
        return all;
    }
    std::vector<int64_t> values() const { return {f.value, f.value + f.mesh.edge_count}; }

    Memory& memory() { return memory_; }

    Foliation f;

private:
    static std::pair<uint32_t, uint32_t> key(uint32_t a, uint32_t b) {
        return a < b ? std::make_pair(a, b) : std::make_pair(b, a);
    }

    // Rings of m vertices, n of them, and two vertices at the ends.  The loop
    // runs between rings 0 and 1.
    void make_sphere(Bytes& bytes, uint32_t n, uint32_t m, std::vector<std::array<uint32_t, 3>>& triangles,
                     uint32_t& vertices, std::map<std::pair<uint32_t, uint32_t>, int64_t>& crossing) {
        const int64_t weight = (1 + static_cast<int64_t>(bytes.wide_below(65536))) << (2 + bytes.byte() % 20u);
        weight_.push_back(weight);
        for (uint32_t y = 0; y < m; ++y) {
            const uint32_t z = (y + 1) % m;
            triangles.push_back({n * m, y, z});
            triangles.push_back({n * m + 1, (n - 1) * m + z, (n - 1) * m + y});
            for (uint32_t x = 0; x + 1 < n; ++x) {
                triangles.push_back({x * m + y, x * m + m + y, x * m + m + z});
                triangles.push_back({x * m + y, x * m + m + z, x * m + z});
            }
            crossing[key(y, m + y)] = crossing[key(y, m + z)] = weight;
        }
        vertices = n * m + 2;
    }

    // Chooses marked vertices and gives them the first numbers.  On a sphere the
    // ends of the tube are marked, and one more of each half at least.
    void mark(Bytes& bytes, bool sphere, std::vector<std::array<uint32_t, 3>>& triangles, uint32_t vertices,
              std::map<std::pair<uint32_t, uint32_t>, int64_t>& crossing) {
        std::vector<uint32_t> marked;
        if (sphere) {
            const uint32_t ring = static_cast<uint32_t>(crossing.size() / 2); // vertices of ring 0
            marked = {vertices - 2, vertices - 1, bytes.wide_below(ring), ring + bytes.wide_below(vertices - 2 - ring)};
            for (const uint32_t v : marked) side_of_mark_.push_back(v == vertices - 2 || v < ring);
        }
        for (uint32_t more = bytes.byte() % (sphere ? 4u : 8u); more > 0; --more) {
            const uint32_t v = bytes.wide_below(vertices);
            if (std::find(marked.begin(), marked.end(), v) != marked.end()) continue;
            side_of_mark_.push_back(sphere && (v == vertices - 2 || v < crossing.size() / 2));
            marked.push_back(v);
        }
        std::vector<uint32_t> number(vertices, NONE);
        uint32_t next = 0;
        for (const uint32_t v : marked) number[v] = next++;
        for (uint32_t& v : number)
            if (v == NONE) v = next++;
        for (auto& triangle : triangles)
            for (uint32_t& v : triangle) v = number[v];
        std::map<std::pair<uint32_t, uint32_t>, int64_t> renumbered;
        for (const auto& edge : crossing)
            renumbered[key(number[edge.first.first], number[edge.first.second])] = edge.second;
        crossing.swap(renumbered);
        for (auto& edges : across_)
            for (auto& edge : edges) edge = {number[edge.first], number[edge.second]};
    }

    // Shortest way along edges that do not cross; the meshes are small.
    int64_t distance(uint32_t from, uint32_t to, const std::vector<int8_t>& crosses) const {
        const Mesh& mesh = f.mesh;
        std::vector<int64_t> length(mesh.vertex_count, INT64_MAX);
        std::vector<uint8_t> done(mesh.vertex_count, 0);
        length[from] = 0;
        for (;;) {
            uint32_t v = NONE;
            for (uint32_t u = 0; u < mesh.vertex_count; ++u)
                if (!done[u] && length[u] != INT64_MAX && (v == NONE || length[u] < length[v])) v = u;
            FUZZ_ASSERT(v != NONE);
            if (v == to) return length[v];
            done[v] = 1;
            uint32_t h = mesh.out[v];
            do {
                if (!crosses[h]) length[mesh.target(h)] = std::min(length[mesh.target(h)], length[v] + f.at(h));
                h = mesh.rotate_ccw(h);
            } while (h != mesh.out[v]);
        }
    }

    void build(const std::vector<std::array<uint32_t, 3>>& triangles, uint32_t vertices,
               const std::map<std::pair<uint32_t, uint32_t>, int64_t>& crossing) {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> half;
        uint32_t edges = 0;
        const size_t room = triangles.size() * 3 / 2 + 3 * spare_vertices;
        origin_.resize(2 * room);
        next_.resize(2 * room);
        face_.resize(2 * room);
        value_.resize(room);
        out_.resize(vertices + spare_vertices);
        for (uint32_t t = 0; t < triangles.size(); ++t) {
            uint32_t side[3];
            for (uint32_t s = 0; s < 3; ++s) {
                const uint32_t a = triangles[t][s], b = triangles[t][(s + 1) % 3];
                FUZZ_ASSERT(!half.count({a, b}));
                if (!half.count({b, a})) {
                    half[{a, b}] = 2 * edges;
                    side[s] = 2 * edges++;
                } else {
                    side[s] = half[{b, a}] ^ 1u;
                    half[{a, b}] = side[s];
                }
                origin_[side[s]] = a;
                out_[a] = side[s];
                face_[side[s]] = t;
            }
            for (uint32_t s = 0; s < 3; ++s) next_[side[s]] = side[(s + 1) % 3];
        }
        f.mesh = {vertices,     edges,      static_cast<uint32_t>(triangles.size()), origin_.data(), next_.data(),
                  face_.data(), out_.data()};
        f.value = value_.data();
        if (!f.allocate_scratch(vertices + spare_vertices, memory_)) std::abort();
        for (uint32_t e = 0; e < edges; ++e) {
            const auto found = crossing.find(key(origin_[2 * e], origin_[2 * e + 1]));
            value_[e] = found == crossing.end() ? 0 : found->second;
        }
    }

    Memory memory_;
    int64_t euler_ = 0;
    std::vector<int64_t> weight_;                                    // of the loop of each torus, or of the sphere
    std::vector<uint8_t> side_of_mark_;                              // of the loop of the sphere, per marked vertex
    std::vector<std::vector<std::pair<uint32_t, uint32_t>>> across_; // edges that it crosses, all the same way
    std::vector<uint32_t> origin_, next_, face_, out_;
    std::vector<int64_t> value_;
};

} // namespace fuzz
