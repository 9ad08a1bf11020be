// Repairs and components of meshes (bindings/readers): what is done to a surface and loses nothing of it is undone.
#include <components.hpp>
#include <repair.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "support/surface.hpp"

namespace test_repair {

using namespace readers;

namespace {

TriangleMesh plain(const test::TriMesh& mesh) { return {mesh.positions, mesh.triangles}; }

// a, then b moved along x.
TriangleMesh beside(const TriangleMesh& a, const TriangleMesh& b, double shift) {
    TriangleMesh both = a;
    for (size_t k = 0; k < b.positions.size(); ++k)
        both.positions.push_back(b.positions[k] + (k % 3 == 0 ? shift : 0.0));
    for (const uint32_t v : b.triangles) both.triangles.push_back(v + static_cast<uint32_t>(a.vertex_count()));
    return both;
}

TriangleMesh torus(size_t n = 9, size_t m = 7) { return plain(test::torus(n, m, 2, 0.8)); }

// Every component is a closed oriented manifold with this Euler characteristic.
void expect_surfaces(const TriangleMesh& mesh, size_t count, size_t genus) {
    const auto set = test::make<hmf_component_set>([&](hmf_component_set** out, hmf_error* e) {
        return hmf_components(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                              nullptr, nullptr, out, e);
    });
    ASSERT_EQ(set->count, count);
    for (const hmf_component* c = set->list; c != set->list + count; ++c) {
        const double* const p = set->part_positions + 3 * c->first_vertex;
        const uint32_t* const t = set->part_triangles + 3 * c->first_triangle;
        EXPECT_EQ(test::mesh_defect({{p, p + 3 * c->vertex_count}, {t, t + 3 * c->triangle_count}, genus}), "");
    }
    EXPECT_EQ(boundary_count(mesh), 0u);
}

size_t component_count(const TriangleMesh& mesh) {
    const std::vector<uint32_t> of = component_of_triangles(mesh.triangles, mesh.vertex_count());
    return of.empty() ? 0 : size_t{1} + *std::max_element(of.begin(), of.end());
}

// The places of the corners of each triangle, whichever way it turns.
using Place = std::array<double, 3>;
std::multiset<std::array<Place, 3>> places(const TriangleMesh& mesh) {
    std::multiset<std::array<Place, 3>> all;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        std::array<Place, 3> corners;
        for (size_t s = 0; s < 3; ++s) {
            const double* const p = &mesh.positions[3 * size_t{mesh.triangles[3 * t + s]}];
            corners[s] = {p[0], p[1], p[2]};
        }
        std::sort(corners.begin(), corners.end());
        all.insert(corners);
    }
    return all;
}

void turn(TriangleMesh& mesh, size_t t) { std::swap(mesh.triangles[3 * t + 1], mesh.triangles[3 * t + 2]); }

std::optional<double> joined(bool join) { return join ? std::optional<double>(0) : std::nullopt; }

// --- Repairs ---------------------------------------------------------------------

TEST(Repair, NothingToDo) {
    TriangleMesh mesh = beside(torus(), torus(11, 5), 7);
    for (const bool join : {false, true}) {
        TriangleMesh same = mesh;
        const Repairs done = repair(same, joined(join));
        EXPECT_EQ(done.count(), 0u);
        EXPECT_TRUE(done.sentences().empty());
        EXPECT_EQ(same.positions, mesh.positions);
        EXPECT_EQ(same.triangles, mesh.triangles);
        for (uint32_t v = 0; v < done.vertices.size(); ++v) EXPECT_EQ(done.vertices[v], v);
        for (uint32_t t = 0; t < done.triangles.size(); ++t) EXPECT_EQ(done.triangles[t], t);
    }
}

// Points in reach, of a grid whose distances are known: whatever the place of the cells in which they are looked for.
TEST(Repair, PointsInReach) {
    for (const double shift : {0.0, 0.1, 0.37, 123.4, -7.9}) {
        SCOPED_TRACE(shift);
        TriangleMesh soup;
        // Squares of side 1 in a row with gaps of 0.1, alternating up and down by 0.05.
        for (uint32_t i = 0; i < 20; ++i) {
            const double x = shift + 1.1 * i, y = shift + 0.05 * (i % 2);
            soup.positions.insert(soup.positions.end(),
                                  {x, y, shift, x + 1, y, shift, x + 1, y + 1, shift, x, y + 1, shift});
            soup.triangles.insert(soup.triangles.end(), {4 * i, 4 * i + 1, 4 * i + 2, 4 * i, 4 * i + 2, 4 * i + 3});
        }
        for (const double distance : {0.0, 0.1117, 0.1119, 0.9}) { // sqrt(0.1^2 + 0.05^2) = 0.1118
            TriangleMesh mesh = soup;
            const Repairs done = repair(mesh, distance);
            EXPECT_EQ(done.joined_vertices, distance < 0.1118 ? 0u : 38u);
            EXPECT_EQ(component_count(mesh), distance < 0.1118 ? 20u : 1u);
            EXPECT_EQ(mesh.triangle_count(), 40u);
        }
    }
}

TEST(Repair, UnusedVertices) {
    const TriangleMesh good = torus();
    TriangleMesh mesh = good;
    EXPECT_EQ(drop_unused_vertices(mesh), 0u);
    mesh.positions.insert(mesh.positions.begin(), {1, 2, 3});
    mesh.positions.insert(mesh.positions.begin() + 30, {4, 5, 6});
    mesh.positions.insert(mesh.positions.end(), {7, 8, 9});
    for (uint32_t& v : mesh.triangles) v += 1 + (v >= 9);
    EXPECT_EQ(drop_unused_vertices(mesh), 3u);
    EXPECT_EQ(mesh.positions, good.positions);
    EXPECT_EQ(mesh.triangles, good.triangles);
    EXPECT_EQ(mesh.origin.name_of_vertex(0), "vertex 1");
    EXPECT_EQ(mesh.origin.name_of_vertex(9), "vertex 11");
}

TEST(Repair, TurnedPatch) {
    const TriangleMesh good = torus();
    for (const size_t count : {size_t{1}, size_t{20}, good.triangle_count() / 2, good.triangle_count() - 5}) {
        TriangleMesh mesh = good;
        for (size_t t = 0; t < count; ++t) turn(mesh, t);
        const Repairs done = repair(mesh);
        EXPECT_EQ(done.turned_triangles, std::min(count, good.triangle_count() - count));
        EXPECT_EQ(done.count(), done.turned_triangles);
        expect_surfaces(mesh, 1, 1);
        EXPECT_EQ(places(mesh), places(good));
    }
}

TEST(Repair, TwoToriShareAVertex) {
    TriangleMesh mesh = beside(torus(), torus(), 7);
    const TriangleMesh good = mesh;
    const uint32_t n = static_cast<uint32_t>(torus().vertex_count());
    for (uint32_t& v : mesh.triangles)
        if (v == n + 3) v = 5;
    for (size_t a = 0; a < 3; ++a) mesh.positions[3 * size_t{n + 3} + a] = mesh.positions[size_t{15} + a];
    EXPECT_EQ(component_count(mesh), 1u);
    TriangleMesh repaired = mesh;
    const Repairs done = repair(repaired);
    EXPECT_EQ(done.split_vertices, 1u);
    EXPECT_EQ(done.unused_vertices, 1u);
    EXPECT_EQ(done.sentences(),
              (std::vector<std::string>{"split 1 vertex where several sheets touched", "dropped 1 unused vertex"}));
    EXPECT_EQ(repaired.vertex_count(), 2 * size_t{n});
    EXPECT_EQ(done.vertices.back(), 5u);
    expect_surfaces(repaired, 2, 1);
    EXPECT_EQ(places(repaired), places(mesh));
}

TEST(Repair, TwoToriShareAnEdge) {
    TriangleMesh mesh = beside(torus(), torus(), 7);
    const uint32_t n = static_cast<uint32_t>(torus().vertex_count());
    for (uint32_t& v : mesh.triangles)
        if (v == n || v == n + 1) v -= n;
    const Repairs done = repair(mesh);
    EXPECT_EQ(done.split_vertices, 2u);
    EXPECT_EQ(done.crowded_edges, 0u);
    expect_surfaces(mesh, 2, 1);
}

TEST(Repair, Duplicates) {
    const TriangleMesh good = torus();
    TriangleMesh mesh = good;
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        mesh.triangles.insert(mesh.triangles.end(), {a, b, c});
    };
    const uint32_t* t = good.triangles.data();
    add(t[0], t[1], t[2]);
    add(t[4], t[5], t[3]); // turned on
    add(t[4], t[5], t[3]);
    add(7, 7, 9);
    add(3, 3, 3);
    mesh.positions.insert(mesh.positions.end(), {1, 2, 3});
    const Repairs done = repair(mesh);
    EXPECT_EQ(done.duplicates, 3u);
    EXPECT_EQ(done.repeated_vertex, 2u);
    EXPECT_EQ(done.unused_vertices, 1u);
    EXPECT_EQ(done.count(), 6u);
    EXPECT_EQ(mesh.triangles, good.triangles);
    EXPECT_EQ(mesh.positions, good.positions);
}

TEST(Repair, BackSides) {
    // Listed from both sides.
    const TriangleMesh good = torus();
    TriangleMesh mesh = good;
    for (size_t t = 0; t < good.triangle_count(); ++t)
        for (const size_t s : {0, 2, 1}) mesh.triangles.push_back(good.triangles[3 * t + s]);
    Repairs done = repair(mesh);
    EXPECT_EQ(done.back_sides, good.triangle_count());
    EXPECT_EQ(done.count(), done.back_sides);
    EXPECT_EQ(mesh.triangles, good.triangles);
    // A sheet with a boundary.
    mesh = good;
    mesh.triangles.resize(mesh.triangles.size() / 2);
    const std::vector<uint32_t> half = mesh.triangles;
    for (size_t t = 0; t < half.size() / 3; ++t)
        for (const size_t s : {0, 2, 1}) mesh.triangles.push_back(half[3 * t + s]);
    done = repair(mesh);
    EXPECT_EQ(done.back_sides, half.size() / 3);
    EXPECT_EQ(mesh.triangle_count(), half.size() / 3);
    EXPECT_EQ(boundary_count(mesh), 2u);
    // A fin of two triangles stays, as a shell of its own.
    mesh = good;
    mesh.positions.insert(mesh.positions.end(), {9, 9, 9});
    const uint32_t tip = static_cast<uint32_t>(good.vertex_count());
    mesh.triangles.insert(mesh.triangles.end(), {mesh.triangles[0], mesh.triangles[1], tip});
    mesh.triangles.insert(mesh.triangles.end(), {mesh.triangles[1], mesh.triangles[0], tip});
    done = repair(mesh);
    EXPECT_EQ(done.back_sides, 0u);
    EXPECT_EQ(done.split_vertices, 2u);
    EXPECT_EQ(mesh.triangle_count(), good.triangle_count() + 2);
    EXPECT_EQ(component_count(mesh), 2u);
    // Two cells of one wall keep both sides of it.
    const TriangleMesh cube = {
        {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1},
        {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5}};
    mesh = cube;
    mesh.positions.insert(mesh.positions.end(), {2, 0, 0, 2, 1, 0, 2, 0, 1, 2, 1, 1});
    const uint32_t moved[] = {1, 8, 3, 9, 5, 10, 7, 11};
    for (const uint32_t v : cube.triangles) mesh.triangles.push_back(moved[v]);
    done = repair(mesh);
    EXPECT_EQ(done.back_sides, 0u);
    EXPECT_EQ(done.duplicates, 0u);
    EXPECT_EQ(mesh.triangle_count(), 24u);
}

TEST(Repair, JoinPoints) {
    // Every triangle with corners of its own.
    const TriangleMesh good = torus();
    TriangleMesh soup;
    for (const uint32_t v : good.triangles) {
        soup.triangles.push_back(static_cast<uint32_t>(soup.vertex_count()));
        const double* const p = &good.positions[3 * size_t{v}];
        soup.positions.insert(soup.positions.end(), p, p + 3);
    }
    TriangleMesh apart = soup;
    EXPECT_EQ(repair(apart).count(), 0u);
    EXPECT_EQ(component_count(apart), good.triangle_count());
    const Repairs done = repair(soup, 0);
    EXPECT_EQ(done.joined_vertices, 6 * good.vertex_count() - good.vertex_count());
    EXPECT_EQ(done.count(), done.joined_vertices);
    EXPECT_EQ(soup.vertex_count(), good.vertex_count());
    expect_surfaces(soup, 1, 1);
    EXPECT_EQ(places(soup), places(good));
    // Shells that touch in an edge stay what they are.
    TriangleMesh both = beside(torus(), torus(), 7);
    const size_t n = torus().vertex_count();
    for (size_t k = 0; k < 6; ++k) both.positions[3 * n + k] = both.positions[k];
    EXPECT_EQ(repair(both, 0).count(), 0u);
    expect_surfaces(both, 2, 1);
}

TEST(Repair, WhatIsLeft) {
    // A third sheet at an edge comes apart from the others.
    TriangleMesh mesh = torus();
    const size_t count = mesh.triangle_count();
    mesh.positions.insert(mesh.positions.end(), {9, 9, 9});
    mesh.triangles.insert(mesh.triangles.end(), {0, 1, static_cast<uint32_t>(mesh.vertex_count() - 1)});
    Repairs done = repair(mesh);
    EXPECT_EQ(done.crowded_edges, 0u);
    EXPECT_EQ(component_count(mesh), 2u);
    EXPECT_EQ(boundary_count(mesh), 1u);
    EXPECT_EQ(mesh.triangle_count(), count + 1);
    // Three triangles at an edge and nothing else.
    mesh = {{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1}, {0, 1, 2, 0, 1, 3, 0, 1, 4}};
    done = repair(mesh);
    EXPECT_EQ(done.cut_edges, 1u);
    EXPECT_EQ(done.split_vertices, 2u);
    EXPECT_EQ(mesh.vertex_count(), 9u);
    EXPECT_EQ(component_count(mesh), 3u);
    // A Moebius strip.
    mesh.positions.assign(18, 0);
    for (size_t k = 0; k < 18; ++k) mesh.positions[k] = static_cast<double>(k * k % 7);
    mesh.triangles = {0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5, 4, 5, 1, 1, 5, 0};
    const TriangleMesh strip = mesh;
    done = repair(mesh);
    EXPECT_EQ(done.one_sided_patches, 1u);
    EXPECT_EQ(done.count(), 0u);
    EXPECT_EQ(mesh.triangles, strip.triangles);
    EXPECT_EQ(boundary_count(mesh), 1u);
}

TEST(Repair, UndoesRandomDamage) {
    test::Random random(15);
    for (int round = 0; round < 200; ++round) {
        TriangleMesh mesh;
        const size_t shells = 1 + random.below(4);
        std::vector<uint32_t> first{0};
        for (size_t k = 0; k < shells; ++k) {
            const size_t m = 5 + random.below(5);
            mesh = beside(mesh, torus(6 + random.below(6), m), 7 * static_cast<double>(k));
            first.push_back(static_cast<uint32_t>(mesh.vertex_count()));
        }
        const auto good = mesh;
        // Vertices of different shells become one, at most one of each pair of shells.
        std::vector<uint32_t> merged(mesh.vertex_count());
        for (uint32_t v = 0; v < merged.size(); ++v) merged[v] = v;
        for (size_t k = 1; k < shells; ++k)
            if (random.below(2)) {
                const uint32_t from = first[k] + static_cast<uint32_t>(random.below(first[k + 1] - first[k]));
                const uint32_t to = static_cast<uint32_t>(random.below(first[k]));
                merged[from] = merged[to];
                for (size_t a = 0; a < 3; ++a)
                    mesh.positions[3 * size_t{from} + a] = mesh.positions[3 * size_t{merged[to]} + a];
            }
        for (uint32_t& v : mesh.triangles) v = merged[v];
        const auto damaged_places = places(mesh);
        // Some turn, some come twice, some have a vertex twice; then all are shuffled.
        std::vector<std::array<uint32_t, 3>> triangles;
        for (size_t t = 0; t < mesh.triangle_count(); ++t) {
            std::array<uint32_t, 3> c = {mesh.triangles[3 * t], mesh.triangles[3 * t + 1], mesh.triangles[3 * t + 2]};
            if (random.below(3) == 0) std::swap(c[0], c[1]);
            triangles.push_back(c);
            if (random.below(20) == 0) triangles.push_back({c[2], c[0], c[1]});
            if (random.below(20) == 0) triangles.push_back({c[2], c[0], c[2]});
        }
        for (size_t t = triangles.size(); t-- > 1;) std::swap(triangles[t], triangles[random.below(t + 1)]);
        mesh.triangles.clear();
        for (const auto& c : triangles) mesh.triangles.insert(mesh.triangles.end(), c.begin(), c.end());
        for (const bool join : {false, true}) {
            TriangleMesh repaired = mesh;
            const Repairs done = repair(repaired, joined(join));
            expect_surfaces(repaired, shells, 1);
            EXPECT_EQ(places(repaired), damaged_places);
            EXPECT_EQ(repaired.vertex_count(), good.vertex_count());
            EXPECT_EQ(done.crowded_edges + done.one_sided_patches, 0u);
            for (size_t v = 0; v < done.vertices.size(); ++v)
                for (size_t a = 0; a < 3; ++a)
                    EXPECT_EQ(repaired.positions[3 * v + a], mesh.positions[3 * size_t{done.vertices[v]} + a]);
            // A second time there is nothing to do.
            TriangleMesh again = repaired;
            EXPECT_EQ(repair(again, joined(join)).count(), 0u);
            EXPECT_EQ(again.triangles, repaired.triangles);
        }
    }
}

TEST(Repair, AnyTriangles) {
    // Whatever comes: it ends, the result says so of itself, and a second time only what is left is found.
    test::Random random(16);
    size_t crowded = 0;
    for (int round = 0; round < 3000; ++round) {
        TriangleMesh mesh;
        const size_t vertices = 3 + random.below(8), count = 1 + random.below(25);
        for (size_t k = 0; k < 3 * vertices; ++k) mesh.positions.push_back(static_cast<double>(random.below(2)));
        for (size_t k = 0; k < 3 * count; ++k) mesh.triangles.push_back(static_cast<uint32_t>(random.below(vertices)));
        for (const bool join : {false, true}) {
            TriangleMesh repaired = mesh;
            const Repairs done = repair(repaired, joined(join));
            ASSERT_EQ(done.vertices.size(), repaired.vertex_count());
            ASSERT_EQ(done.triangles.size(), repaired.triangle_count());
            ASSERT_EQ(done.triangles.size() + done.repeated_vertex + done.duplicates + done.back_sides, count);
            for (size_t t = 0; t < done.triangles.size(); ++t) {
                std::set<uint32_t> before, after;
                for (size_t s = 0; s < 3; ++s) {
                    before.insert(mesh.triangles[3 * size_t{done.triangles[t]} + s]);
                    after.insert(done.vertices[repaired.triangles[3 * t + s]]);
                }
                if (!join) { EXPECT_EQ(before, after); }
                EXPECT_EQ(after.size(), 3u);
            }
            const Edges edges = edges_of(repaired);
            std::vector<int> around(edges.count());
            for (const uint32_t e : edges.triangles) ++around[e];
            crowded += done.crowded_edges;
            ASSERT_EQ(std::count_if(around.begin(), around.end(), [](int k) { return k > 2; }), done.crowded_edges);
            if (done.crowded_edges > 0) continue;
            // A second time nothing changes.
            TriangleMesh again = repaired;
            const Repairs second = repair(again);
            EXPECT_EQ(second.count(), 0u);
            EXPECT_EQ(again.triangles, repaired.triangles);
        }
    }
    EXPECT_LT(crowded, 300u); // of 6000
}

TEST(Repair, SurfaceThatTouchesItself) {
    // One torus; the edges of two short paths of it, far from each other, become one path.
    const size_t n = 24, m = 9;
    const TriangleMesh good = torus(n, m);
    for (const uint32_t length : {1u, 2u, 5u}) {
        TriangleMesh mesh = good;
        for (uint32_t k = 0; k < length; ++k) {
            const uint32_t from = static_cast<uint32_t>(12 * m) + k, to = k;
            for (uint32_t& v : mesh.triangles)
                if (v == from) v = to;
            for (size_t a = 0; a < 3; ++a) mesh.positions[3 * size_t{from} + a] = mesh.positions[3 * size_t{to} + a];
        }
        const auto before = places(mesh);
        const Repairs done = repair(mesh);
        EXPECT_EQ(done.split_vertices, length);
        EXPECT_EQ(done.cut_edges + done.crowded_edges, 0u);
        EXPECT_EQ(done.unused_vertices, length);
        expect_surfaces(mesh, 1, 1);
        EXPECT_EQ(places(mesh), before);
    }
}

// --- Boundary ----------------------------------------------------------------------

TEST(Boundary, Count) {
    TriangleMesh mesh = torus();
    mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 3);
    EXPECT_EQ(boundary_count(mesh), 1u);
    mesh.triangles.erase(mesh.triangles.begin() + 150, mesh.triangles.begin() + 156);
    EXPECT_EQ(boundary_count(mesh), 2u);
}

} // namespace

} // namespace test_repair
