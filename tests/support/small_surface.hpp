// A surface of a few vertices with a foliation, both made by hand.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "../../src/core/foliation/whitehead.hpp"
#include "check_mesh.hpp"

namespace test {

// Side 2e of a triangle runs along edge e, 2e + 1 against it.
constexpr uint32_t with(uint32_t e) { return 2 * e; }
constexpr uint32_t against(uint32_t e) { return 2 * e + 1; }
using TriangleSides = std::vector<std::array<uint32_t, 3>>;

// All values are 0 and all weights 1 at first.
struct SmallSurface {
    std::vector<uint32_t> origin, next, face, out;
    std::vector<int64_t> value;
    std::vector<double> weight;
    hmf::Memory memory{nullptr, nullptr, nullptr, 0};
    hmf::Foliation foliation;
    hmf::Rings rings;
    hmf::Star star;

    // start: the vertex where each half-edge starts.
    SmallSurface(const TriangleSides& triangles, std::vector<uint32_t> start, uint32_t vertices, uint32_t marked = 0) :
        origin(std::move(start)), next(origin.size()), face(origin.size()), out(vertices), value(origin.size() / 2, 0),
        weight(value.size(), 1) {
        for (uint32_t t = 0; t < triangles.size(); ++t)
            for (uint32_t s = 0; s < 3; ++s) {
                next[triangles[t][s]] = triangles[t][(s + 1) % 3];
                face[triangles[t][s]] = t;
            }
        for (uint32_t h = 0; h < origin.size(); ++h) out[origin[h]] = h;
        hmf::Mesh& mesh = foliation.mesh;
        mesh.vertex_count = vertices;
        mesh.edge_count = static_cast<uint32_t>(value.size());
        mesh.face_count = static_cast<uint32_t>(triangles.size());
        mesh.marked_count = marked;
        mesh.origin = origin.data();
        mesh.next = next.data();
        mesh.face = face.data();
        mesh.out = out.data();
        foliation.value = value.data();
        EXPECT_EQ(hmf::check(mesh), nullptr);
        EXPECT_TRUE(foliation.allocate_scratch(vertices, memory));
    }
    void prepare() {
        ASSERT_TRUE(rings.build(foliation.mesh, weight.data(), memory) && star.allocate(memory, rings.max_degree));
    }
    void expect_foliation() {
        const hmf::SingularityCount count = hmf::count_singularities(foliation);
        EXPECT_EQ(count.poles, 0u);
        EXPECT_EQ(count.broken_triangles, 0u);
        EXPECT_EQ(count.index_sum, 2 * foliation.mesh.euler() - foliation.mesh.marked_count);
    }
    const hmf::Rings::Side* side(uint32_t vertex) { return &rings.side[rings.offset[vertex]]; }
    void read(uint32_t vertex) {
        hmf::read_star(foliation, side(vertex), rings.offset[vertex + 1] - rings.offset[vertex], weight.data(), star);
    }
    // The direction that this half-edge leaves in, whatever pulls.
    void choose(uint32_t half_edge) {
        const uint32_t vertex = origin[half_edge];
        read(vertex);
        for (uint32_t t = 0; t < star.degree; ++t)
            if (side(vertex)[t].half_edge == half_edge) star.best = star.group[t];
    }
    // As read() or choose() has left it.
    void move(uint32_t vertex, int64_t mu) {
        ASSERT_TRUE(hmf::plan_move(foliation, side(vertex), star));
        EXPECT_TRUE(foliation.pushed.empty());
        ASSERT_GE(hmf::room_for_move(foliation, side(vertex), star), mu);
        hmf::apply_move(foliation, side(vertex), star, mu);
        expect_foliation();
    }
};

// Appends a handle with one edge f at its boundary: edges a, a + 1, a + 2, a + 3 from that vertex to itself.
inline void add_handle(TriangleSides& triangles, uint32_t f, uint32_t a) {
    triangles.push_back({f, with(a), against(a + 2)});
    triangles.push_back({with(a + 2), with(a + 1), against(a + 3)});
    triangles.push_back({with(a + 3), against(a), against(a + 1)});
}

// A polygon, whose sides are glued to each other or to the given triangles, round vertex 0.  At vertex 0 a handle of
// value 0 hangs.  Spokes of value 30 lead to it from the corners, that of corner k is edge k and ends there; the last
// spoke starts at corner 0 as well.
struct Polygon : SmallSurface {
    static constexpr uint32_t handle(uint32_t corners) { return corners + 1; } // the first of its five edges
    static constexpr uint32_t others(uint32_t corners) { return corners + 6; } // those of the sides from here on

    // corners: the vertices there.
    Polygon(const std::vector<uint32_t>& sides, const std::vector<uint32_t>& corners, TriangleSides more,
            const std::vector<uint32_t>& starts, uint32_t vertices, uint32_t marked = 0) :
        SmallSurface(triangles(sides, std::move(more)), start(corners, starts), vertices, marked) {
        for (uint32_t k = 0; k <= corners.size(); ++k) value[k] = 30;
    }

private:
    static TriangleSides triangles(const std::vector<uint32_t>& sides, TriangleSides all) {
        const uint32_t n = static_cast<uint32_t>(sides.size()), f = handle(n);
        for (uint32_t k = 0; k < n; ++k) all.push_back({sides[k], with(k + 1), against(k)});
        all.push_back({with(0), with(f), against(n)});
        add_handle(all, against(f), f + 1);
        return all;
    }
    static std::vector<uint32_t> start(const std::vector<uint32_t>& corners, const std::vector<uint32_t>& starts) {
        std::vector<uint32_t> all;
        for (size_t k = 0; k <= corners.size(); ++k) {
            all.push_back(corners[k % corners.size()]);
            all.push_back(0);
        }
        all.resize(all.size() + 10, 0);
        all.insert(all.end(), starts.begin(), starts.end());
        return all;
    }
};

// A torus without a disk, which is the polygon: edge e around one way, x and y together around the other.
// e, x and y are 0, so that vertices 1 and 2 are at a zero.
struct HexagonTorus : Polygon {
    static constexpr uint32_t e = others(6), x = e + 1, y = e + 2;
    explicit HexagonTorus(uint32_t marked = 0) :
        Polygon({with(e), with(x), with(y), against(e), against(y), against(x)}, {1, 1, 2, 1, 1, 2}, {},
                {1, 1, 1, 2, 2, 1}, 3, marked) {}
};

} // namespace test
