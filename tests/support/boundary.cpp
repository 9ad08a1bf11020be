#include "boundary.hpp"

#include "../../src/core/api/foliation_object.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace test {

namespace {

double distance_to_segment(const double* p, const double* a, const double* b) {
    double ab = 0, ap = 0, sum = 0;
    for (size_t c = 0; c < 3; ++c) {
        ab += (b[c] - a[c]) * (b[c] - a[c]);
        ap += (b[c] - a[c]) * (p[c] - a[c]);
    }
    const double t = std::min(1.0, std::max(0.0, ap / ab));
    for (size_t c = 0; c < 3; ++c) sum += std::pow(p[c] - a[c] - t * (b[c] - a[c]), 2);
    return std::sqrt(sum);
}

} // namespace

Solution solve_curves(const Hierarchy& hierarchy, const Curves& curves) { return solve(hierarchy, curves.view()); }

TriMesh annulus(size_t n, size_t m, double R, double jitter, uint64_t seed) {
    TriMesh mesh;
    Random random(seed);
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j <= m; ++j) {
            const bool inner = j > 0 && j < m;
            const double a =
                2 * PI * (static_cast<double>(i) + (inner ? jitter * (random.unit() - 0.5) : 0)) / double(n);
            const double t = (static_cast<double>(j) + (inner ? jitter * (random.unit() - 0.5) : 0)) / double(m);
            const double r = std::pow(R, t);
            mesh.positions.insert(mesh.positions.end(), {r * std::cos(a), r * std::sin(a), 0});
        }
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < m; ++j) {
            const uint32_t a = uint32_t(i * (m + 1) + j), b = a + 1, c = uint32_t((i + 1) % n * (m + 1) + j), d = c + 1;
            mesh.triangles.insert(mesh.triangles.end(), {a, b, d, a, d, c});
        }
    return mesh;
}

TriMesh rectangle(size_t n, size_t m, double a, double b, double jitter, uint64_t seed) {
    TriMesh mesh;
    Random random(seed);
    for (size_t i = 0; i <= n; ++i)
        for (size_t j = 0; j <= m; ++j) {
            const double dx = i > 0 && i < n ? jitter * (random.unit() - 0.5) : 0;
            const double dy = j > 0 && j < m ? jitter * (random.unit() - 0.5) : 0;
            mesh.positions.insert(mesh.positions.end(),
                                  {a * (double(i) + dx) / double(n), b * (double(j) + dy) / double(m), 0});
        }
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < m; ++j) {
            const uint32_t p = uint32_t(i * (m + 1) + j), q = p + 1, r = uint32_t((i + 1) * (m + 1) + j), s = r + 1;
            if (random.below(2)) mesh.triangles.insert(mesh.triangles.end(), {p, r, s, p, s, q});
            else mesh.triangles.insert(mesh.triangles.end(), {p, r, q, r, s, q});
        }
    return mesh;
}

std::vector<int> triangles_of_edges(const LevelMesh& mesh) {
    std::vector<int> count(mesh.edge_count, 0);
    for (const uint32_t e : mesh.triangle_edges) ++count[e];
    return count;
}

void expect_symmetric(const Solution& s) {
    const hmf_foliation& f = *s.foliation.get();
    const hmf_hierarchy& h = *f.hierarchy;
    size_t wrong = 0;
    for (size_t t = 0; t < h.surface_triangles; ++t)
        for (size_t side = 0; side < 3; ++side)
            wrong += f.values[h.triangle_edges[3 * t + side]]
                  != f.values[h.triangle_edges[3 * (h.surface_triangles + t) + 2 - side]];
    EXPECT_EQ(wrong, 0u);
    hmf_foliation* raw = nullptr;
    hmf_error error{};
    ASSERT_EQ(hmf_foliation_from_values(&h, 0, s.values.data(), s.values.size(), nullptr, &raw, &error), HMF_OK)
        << error.message;
    const Foliation again(raw);
    EXPECT_EQ(values_of(again), s.values);
    EXPECT_EQ(raw->poles, 0u);
}

void expect_result(const Hierarchy& hierarchy, const Solution& s, int64_t boundaries, int64_t marks_inside,
                   int64_t marks_on_boundary) {
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    const LevelMesh mesh = read_level(hierarchy, 0);
    ASSERT_EQ(s.values.size(), mesh.edge_count);
    EXPECT_EQ(closedness_defect(mesh, s.values), "");
    EXPECT_LE(s.report.residual_max, 1e-8);
    EXPECT_EQ(s.report.poles, 0u);
    EXPECT_EQ(s.report.bad_flips_left, 0u);
    const int64_t genus = static_cast<int64_t>(hmf_hierarchy_describe(hierarchy.get())->genus);
    EXPECT_EQ(s.report.index_sum, 8 - 8 * genus - 4 * boundaries - 2 * marks_inside - marks_on_boundary);
    EXPECT_NE(s.report.class_state, HMF_CLASS_LOST);
    EXPECT_NE(s.report.class_state, HMF_CLASS_UNKNOWN);
    const auto set = singularities(s.foliation);
    ASSERT_TRUE(set);
    EXPECT_EQ(set->vertex_count, mesh.vertex_count);
    EXPECT_EQ(set->triangle_count, mesh.triangle_count);
    for (size_t v = 0; v < mesh.vertex_count; ++v) EXPECT_LE(set->vertex_index[v], 0);
    for (size_t k = 0; k < set->count; ++k) { // a cluster along a hole is not in the middle of the hole
        const hmf_singularity& at = set->list[k];
        if (at.kind != HMF_SINGULAR_CLUSTER) continue;
        bool is_vertex = false;
        for (size_t v = 0; v < mesh.vertex_count; ++v)
            is_vertex |= set->vertex_cluster[v] == at.element
                      && std::equal(at.position, at.position + 3, &mesh.positions[3 * v]);
        EXPECT_TRUE(is_vertex) << at.element;
    }
    EXPECT_EQ(residuals(s.foliation, mesh.vertex_count).size(), mesh.vertex_count);
    expect_symmetric(s);
}

TriMesh with_holes(const TriMesh& mesh, size_t holes, size_t rings, uint64_t seed) {
    Random random(seed);
    std::vector<char> gone(mesh.triangle_count(), 0);
    for (size_t k = 0; k < holes; ++k) {
        std::vector<char> inside(mesh.vertex_count(), 0), more;
        inside[random.below(mesh.vertex_count())] = 1;
        for (size_t r = 0; r < rings; ++r) {
            more = inside;
            for (size_t t = 0; t < mesh.triangle_count(); ++t) {
                const uint32_t* v = &mesh.triangles[3 * t];
                if (!inside[v[0]] && !inside[v[1]] && !inside[v[2]]) continue;
                gone[t] = 1;
                for (size_t s = 0; s < 3; ++s) more[v[s]] = 1;
            }
            inside = more;
        }
    }
    TriMesh out;
    out.genus = mesh.genus;
    std::vector<uint32_t> number(mesh.vertex_count(), HMF_NONE);
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (size_t s = 0; s < 3 && !gone[t]; ++s) {
            const uint32_t v = mesh.triangles[3 * t + s];
            if (number[v] == HMF_NONE) {
                number[v] = uint32_t(out.vertex_count());
                for (size_t c = 0; c < 3; ++c) out.positions.push_back(mesh.positions[3 * v + c]);
            }
            out.triangles.push_back(number[v]);
        }
    return out;
}

bool is_sound(const TriMesh& mesh) {
    hmf_hierarchy* raw = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                                   mesh.triangle_count(), nullptr, nullptr, &raw, &error);
    hmf_hierarchy_destroy(raw);
    const bool unlucky = status == HMF_ERROR_MESH_NON_MANIFOLD_VERTEX || status == HMF_ERROR_MESH_COMPONENTS
                      || status == HMF_ERROR_MESH_GENUS;
    if (!unlucky) EXPECT_EQ(status, HMF_OK) << error.message;
    return !unlucky;
}

int64_t boundary_count(const TriMesh& mesh) {
    std::map<uint32_t, uint32_t> next;
    std::set<std::pair<uint32_t, uint32_t>> sides;
    for (size_t c = 0; c < mesh.triangles.size(); ++c)
        sides.insert({mesh.triangles[c], mesh.triangles[c - c % 3 + (c + 1) % 3]});
    for (const auto& s : sides)
        if (!sides.count({s.second, s.first})) next[s.first] = s.second;
    int64_t count = 0;
    while (!next.empty()) {
        ++count;
        for (uint32_t v = next.begin()->first; next.count(v);) {
            const uint32_t to = next[v];
            next.erase(v);
            v = to;
        }
    }
    return count;
}

Owned<hmf_lines> levels(const Solution& s, double spacing, int32_t leaves) {
    hmf_trace_options options{};
    options.struct_size = sizeof options;
    options.spacing = spacing;
    options.leaves = leaves;
    return make<hmf_lines>(
        [&](hmf_lines** out, hmf_error* error) { return hmf_trace(s.foliation.get(), &options, nullptr, out, error); });
}

Owned<hmf_quad_mesh> quads_of(const Solution& s, const hmf_quad_options& options) {
    return make<hmf_quad_mesh>(
        [&](hmf_quad_mesh** out, hmf_error* e) { return hmf_quads(s.foliation.get(), &options, nullptr, out, e); });
}

hmf_quad_options quad_options(uint64_t count, bool merge, uint64_t relax) {
    hmf_quad_options options{};
    options.struct_size = sizeof options;
    options.count = count;
    options.merge = merge;
    options.relax = relax;
    return options;
}

void expect_quads_conform(const TriMesh& mesh, const hmf_quad_mesh& quads, int64_t genus) {
    std::map<std::pair<uint32_t, uint32_t>, int> sides;
    for (size_t i = 0; i < 4 * quads.quad_count; ++i) ++sides[{quads.quads[i], quads.quads[i / 4 * 4 + (i + 1) % 4]}];
    std::map<uint32_t, uint32_t> next;
    size_t edges = 0;
    std::set<uint32_t> used(quads.quads, quads.quads + 4 * quads.quad_count);
    EXPECT_EQ(used.size(), quads.vertex_count);
    for (const auto& side : sides) {
        EXPECT_EQ(side.second, 1);
        EXPECT_NE(side.first.first, side.first.second);
        const bool outer = !sides.count({side.first.second, side.first.first});
        edges += outer || side.first.first < side.first.second;
        if (!outer) continue;
        EXPECT_TRUE(next.insert(side.first).second); // one fan at each vertex
    }
    const int64_t boundaries = boundary_count(mesh);
    EXPECT_EQ(int64_t(quads.vertex_count) - int64_t(edges) + int64_t(quads.quad_count), 2 - 2 * genus - boundaries);
    std::map<std::pair<uint32_t, uint32_t>, int> of_mesh;
    for (size_t c = 0; c < mesh.triangles.size(); ++c)
        ++of_mesh[{mesh.triangles[c], mesh.triangles[c - c % 3 + (c + 1) % 3]}];
    std::vector<std::pair<uint32_t, uint32_t>> rim;
    for (const auto& side : of_mesh)
        if (!of_mesh.count({side.first.second, side.first.first})) rim.push_back(side.first);
    double size = 0, worst = 0;
    for (const double x : mesh.positions) size = std::max(size, std::fabs(x));
    for (const auto& step : next) {
        double nearest = HUGE_VAL;
        for (const auto& side : rim)
            nearest = std::min(nearest, distance_to_segment(quads.positions + 3 * step.first,
                                                            &mesh.positions[3 * size_t{side.first}],
                                                            &mesh.positions[3 * size_t{side.second}]));
        worst = std::max(worst, nearest);
    }
    EXPECT_LE(worst, 1e-9 * size);
    int64_t curves = 0;
    while (!next.empty()) {
        ++curves;
        for (uint32_t v = next.begin()->first; next.count(v);) {
            const uint32_t to = next[v];
            next.erase(v);
            v = to;
        }
    }
    EXPECT_EQ(curves, boundaries);
}

} // namespace test
