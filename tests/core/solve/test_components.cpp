// Meshes of several components: how they are divided, what is said of each, and that each is solved as if it were
// alone.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace test_components {

using namespace test;

namespace {

TriMesh octahedron() {
    TriMesh mesh;
    mesh.positions = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    mesh.triangles = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    return mesh;
}

// Several meshes as one, their triangles and vertices mixed, and one vertex without a triangle in front.
struct Mixture {
    TriMesh mesh;
    std::vector<std::vector<uint32_t>> vertices; // of each part: the number in the mixture
};
Mixture mix(const std::vector<TriMesh>& parts) {
    Mixture all;
    all.vertices.resize(parts.size());
    all.mesh.positions = {7, 7, 7};
    size_t most = 0;
    for (const TriMesh& part : parts) most = std::max({most, part.vertex_count(), part.triangle_count()});
    for (size_t n = 0; n < most; ++n)
        for (size_t k = 0; k < parts.size(); ++k) {
            if (n >= parts[k].vertex_count()) continue;
            all.vertices[k].push_back(static_cast<uint32_t>(all.mesh.vertex_count()));
            const double* const p = &parts[k].positions[3 * n];
            all.mesh.positions.insert(all.mesh.positions.end(), p, p + 3);
        }
    for (size_t n = 0; n < most; ++n)
        for (size_t k = 0; k < parts.size(); ++k)
            for (size_t s = 0; s < 3 && n < parts[k].triangle_count(); ++s)
                all.mesh.triangles.push_back(all.vertices[k][parts[k].triangles[3 * n + s]]);
    return all;
}

Owned<hmf_component_set> divide(const TriMesh& mesh, const hmf_hierarchy_options* options = nullptr) {
    return make<hmf_component_set>([&](hmf_component_set** out, hmf_error* e) {
        return hmf_components(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                              options, nullptr, out, e);
    });
}

TriMesh part_of(const hmf_component_set& set, size_t k) {
    const hmf_component& c = set.list[k];
    TriMesh mesh;
    mesh.genus = static_cast<size_t>(c.genus);
    mesh.positions.assign(set.part_positions + 3 * c.first_vertex,
                          set.part_positions + 3 * (c.first_vertex + c.vertex_count));
    mesh.triangles.assign(set.part_triangles + 3 * c.first_triangle,
                          set.part_triangles + 3 * (c.first_triangle + c.triangle_count));
    return mesh;
}

std::vector<uint32_t> suggested(const TriMesh& mesh) {
    const auto set = make<hmf_mark_set>([&](hmf_mark_set** out, hmf_error* e) {
        return hmf_suggest_marks(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                 mesh.triangle_count(), nullptr, nullptr, out, e);
    });
    return std::vector<uint32_t>(set->marked_vertices, set->marked_vertices + set->marked_count);
}

// A strip of two triangles, one turned the wrong way.
TriMesh turned_strip() {
    TriMesh mesh;
    mesh.positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    mesh.triangles = {0, 1, 2, 0, 3, 2};
    return mesh;
}

// Two octahedra that share a vertex, the first of the one.
TriMesh pinched() {
    TriMesh mesh = octahedron();
    const TriMesh other = mesh;
    for (size_t v = 1; v < other.vertex_count(); ++v)
        for (size_t c = 0; c < 3; ++c) mesh.positions.push_back((c == 0 ? 2 : 0) - other.positions[3 * v + c]);
    for (const uint32_t v : other.triangles) mesh.triangles.push_back(v == 0 ? 0 : v + 5);
    return mesh;
}

TriMesh without_triangle(TriMesh mesh) {
    mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.begin() + 3);
    return mesh;
}

TEST(Components, AreDividedWithTheirOrder) {
    const std::vector<TriMesh> parts = {torus(12, 9, 3, 1), octahedron(), without_triangle(torus(8, 7, 2, 1)),
                                        plate(2)};
    const Mixture whole = mix(parts);
    const auto set = divide(whole.mesh);
    ASSERT_EQ(set->count, parts.size());
    EXPECT_EQ(set->vertex_count, whole.mesh.vertex_count());
    EXPECT_EQ(set->used_vertex_count, whole.mesh.vertex_count() - 1);
    EXPECT_EQ(set->vertex_component[0], HMF_NONE);
    EXPECT_EQ(set->vertex_part[0], HMF_NONE);
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> edges; // of the mixture, by their first side
    for (size_t c = 0; c < whole.mesh.triangles.size(); ++c) {
        const uint32_t v = whole.mesh.triangles[c], w = whole.mesh.triangles[c - c % 3 + (c + 1) % 3];
        edges.emplace(std::minmax(v, w), static_cast<uint32_t>(edges.size()));
    }
    EXPECT_EQ(set->edge_count, edges.size());
    std::set<uint32_t> seen;
    for (size_t k = 0; k < parts.size(); ++k) {
        const hmf_component& c = set->list[k];
        const TriMesh own = part_of(*set, k);
        EXPECT_EQ(own.positions, parts[k].positions);
        EXPECT_EQ(own.triangles, parts[k].triangles);
        for (uint32_t v = 0; v < c.vertex_count; ++v) {
            const uint32_t at = set->whole_vertices[c.first_vertex + v];
            EXPECT_EQ(at, whole.vertices[k][v]);
            EXPECT_EQ(set->vertex_component[at], k);
            EXPECT_EQ(set->vertex_part[at], v);
        }
        for (uint32_t t = 0; t < c.triangle_count; ++t) {
            const uint32_t at = set->whole_triangles[c.first_triangle + t];
            EXPECT_EQ(set->triangle_component[at], k);
            EXPECT_EQ(set->triangle_part[at], t);
            EXPECT_EQ(whole.mesh.triangles[3 * at], whole.vertices[k][own.triangles[3 * t]]);
        }
        if (c.status != HMF_OK) continue;
        const Hierarchy hierarchy(own);
        const LevelMesh level = read_level(hierarchy, 0);
        ASSERT_EQ(level.edge_count, c.edge_count);
        for (uint32_t e = 0; e < c.edge_count; ++e) {
            const uint32_t v = whole.vertices[k][level.edge_vertices[2 * e]],
                           w = whole.vertices[k][level.edge_vertices[2 * e + 1]];
            EXPECT_EQ(set->whole_edges[c.first_edge + e], edges.at(std::minmax(v, w)));
            EXPECT_TRUE(seen.insert(set->whole_edges[c.first_edge + e]).second);
        }
    }
}

TEST(Components, SayWhatEachIs) {
    TriMesh flat = octahedron();
    for (size_t c = 0; c < 3; ++c) flat.positions[6 + c] = flat.positions[c];
    const std::vector<TriMesh> parts = {torus(12, 9, 3, 1), octahedron(), without_triangle(plate(3)),
                                        turned_strip(),     flat,         without_triangle(octahedron()),
                                        pinched()};
    const Mixture whole = mix(parts);
    const auto set = divide(whole.mesh);
    ASSERT_EQ(set->count, parts.size());
    const hmf_status expected[] = {HMF_OK,
                                   HMF_ERROR_MESH_GENUS,
                                   HMF_OK,
                                   HMF_ERROR_MESH_ORIENTATION,
                                   HMF_ERROR_MESH_DEGENERATE,
                                   HMF_ERROR_MESH_GENUS,
                                   HMF_ERROR_MESH_NON_MANIFOLD_VERTEX};
    const uint64_t genus[] = {1, 0, 3, 0, 0, 0, 0}, boundaries[] = {0, 0, 1, 0, 0, 1, 0};
    for (size_t k = 0; k < parts.size(); ++k) {
        const hmf_component& c = set->list[k];
        EXPECT_EQ(c.status, expected[k]) << k;
        EXPECT_EQ(c.genus, genus[k]) << k;
        EXPECT_EQ(c.boundary_count, boundaries[k]) << k;
        // The same as the build, with the element in the whole mesh.
        hmf_hierarchy* out = nullptr;
        hmf_error error{};
        EXPECT_EQ(hmf_hierarchy_create(parts[k].positions.data(), parts[k].vertex_count(), parts[k].triangles.data(),
                                       parts[k].triangle_count(), nullptr, nullptr, &out, &error),
                  c.status);
        hmf_hierarchy_destroy(out);
        EXPECT_EQ(c.element, error.element);
        if (c.element == HMF_ELEMENT_TRIANGLE) {
            EXPECT_EQ(set->triangle_component[c.index], k);
            EXPECT_EQ(set->triangle_part[c.index], error.index);
        }
        if (c.element == HMF_ELEMENT_VERTEX) {
            EXPECT_EQ(set->vertex_component[c.index], k);
            EXPECT_EQ(set->vertex_part[c.index], error.index);
        }
    }
}

TEST(Components, MarksGoToTheirComponents) {
    const Mixture whole = mix({octahedron(), torus(9, 8, 3, 1), octahedron()});
    const std::vector<uint32_t> marks = {whole.vertices[2][5], whole.vertices[1][3], whole.vertices[2][0], 0,
                                         whole.vertices[2][1], whole.vertices[2][4]};
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    options.marked_vertices = marks.data();
    options.marked_count = marks.size();
    const auto set = divide(whole.mesh, &options);
    ASSERT_EQ(set->count, 3u);
    EXPECT_EQ(set->marked_count, 5u); // not the vertex without a triangle
    EXPECT_EQ(set->list[0].status, HMF_ERROR_MESH_GENUS);
    EXPECT_EQ(set->list[1].status, HMF_OK);
    EXPECT_EQ(set->list[2].status, HMF_OK);
    EXPECT_EQ(set->list[0].marked_count, 0u);
    EXPECT_EQ(set->list[1].marked_count, 1u);
    EXPECT_EQ(set->part_marks[set->list[1].first_mark], 3u);
    const uint32_t* const own = set->part_marks + set->list[2].first_mark;
    EXPECT_EQ(std::vector<uint32_t>(own, own + set->list[2].marked_count), (std::vector<uint32_t>{5, 0, 1, 4}));
}

TEST(Components, MarksAreSuggestedForEach) {
    const std::vector<TriMesh> parts = {octahedron(), torus(9, 8, 3, 1), subdivide(octahedron()),
                                        without_triangle(subdivide(octahedron())), turned_strip()};
    const Mixture whole = mix(parts);
    std::set<uint32_t> expected;
    for (const size_t k : {0, 2, 3})
        for (const uint32_t v : suggested(parts[k])) expected.insert(whole.vertices[k][v]);
    EXPECT_GE(expected.size(), 10u); // of a disk two inside are enough
    const std::vector<uint32_t> marks = suggested(whole.mesh);
    EXPECT_EQ(std::set<uint32_t>(marks.begin(), marks.end()), expected);
    EXPECT_EQ(marks.size(), expected.size());
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    options.marked_vertices = marks.data();
    options.marked_count = marks.size();
    const auto set = divide(whole.mesh, &options);
    for (size_t k = 0; k < 4; ++k) EXPECT_EQ(set->list[k].status, HMF_OK) << k;
}

TEST(Components, AreSolvedAsIfAlone) {
    const std::vector<TriMesh> parts = {torus(14, 9, 3, 1), pretzel(2, 0)};
    const Mixture whole = mix(parts);
    const auto set = divide(whole.mesh);
    std::vector<double> values(set->edge_count, -1);
    for (size_t k = 0; k < parts.size(); ++k) {
        const hmf_component& c = set->list[k];
        const Hierarchy hierarchy(part_of(*set, k));
        const std::vector<double> own = values_of(solve(hierarchy, nullptr, solve_options(0, 0)).foliation);
        ASSERT_EQ(own.size(), c.edge_count);
        for (uint64_t e = 0; e < c.edge_count; ++e) values[set->whole_edges[c.first_edge + e]] = own[e];
        const Hierarchy alone(parts[k]);
        EXPECT_EQ(own, values_of(solve(alone, nullptr, solve_options(0, 0)).foliation));
    }
    EXPECT_EQ(std::count(values.begin(), values.end(), -1), 0);
}

TEST(Components, OneIsTheMesh) {
    const TriMesh mesh = torus(12, 9, 3, 1);
    const auto set = divide(mesh);
    ASSERT_EQ(set->count, 1u);
    EXPECT_EQ(part_of(*set, 0).positions, mesh.positions);
    EXPECT_EQ(part_of(*set, 0).triangles, mesh.triangles);
}

TEST(Components, ErrorsOfTheCall) {
    const TriMesh mesh = octahedron();
    const auto status = [&](const TriMesh& m, const hmf_hierarchy_options* options, hmf_error& error) {
        hmf_component_set* out = nullptr;
        const hmf_status s = hmf_components(m.positions.data(), m.vertex_count(), m.triangles.data(),
                                            m.triangle_count(), options, nullptr, &out, &error);
        EXPECT_EQ(out == nullptr, s != HMF_OK);
        hmf_free(out);
        return s;
    };
    hmf_error error{};
    EXPECT_EQ(hmf_components(nullptr, 6, mesh.triangles.data(), 8, nullptr, nullptr, nullptr, &error), HMF_ERROR_NULL);
    EXPECT_EQ(status(TriMesh(), nullptr, error), HMF_ERROR_NULL);
    TriMesh wrong = mesh;
    wrong.triangles[7] = 6;
    EXPECT_EQ(status(wrong, nullptr, error), HMF_ERROR_MESH_INDEX);
    EXPECT_EQ(error.index, 2u);
    const uint32_t twice[] = {1, 1}, beyond[] = {6};
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    options.marked_vertices = twice;
    options.marked_count = 2;
    EXPECT_EQ(status(mesh, &options, error), HMF_ERROR_OPTIONS);
    options.marked_vertices = beyond;
    options.marked_count = 1;
    EXPECT_EQ(status(mesh, &options, error), HMF_ERROR_MESH_INDEX);
    options.marked_count = 0;
    options.memory_limit = 2000;
    EXPECT_EQ(status(mesh, &options, error), HMF_ERROR_MEMORY_LIMIT);
}

} // namespace

} // namespace test_components
