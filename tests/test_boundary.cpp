// Surfaces with boundary: closed forms, the linear problem, what the double is made of, loops and arcs.
#include "../src/api/foliation_object.hpp"
#include "support/meter.hpp"
#include "support/read_obj.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Sparse>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <set>

using namespace test;

namespace {

const double pi = std::acos(-1.0);

using Path = std::vector<uint32_t>;

// Paths of vertices on level 0.
struct Curves {
    Loops loops;
    std::vector<uint8_t> arcs;

    Curves() { loops.kind = HMF_LOOP_VERTICES; }
    void add(const Path& path, bool is_arc, double weight = 1) {
        loops.add(path);
        loops.weights.push_back(weight);
        arcs.push_back(is_arc);
    }
    hmf_loop_set view() const {
        hmf_loop_set set = loops.view();
        set.arcs = arcs.data();
        return set;
    }
};

Solution solve_curves(const Hierarchy& hierarchy, const Curves& curves,
                      hmf_solve_options options = solve_options(0, 0)) {
    const hmf_loop_set set = curves.view();
    Solution s;
    hmf_foliation* raw = nullptr;
    s.status = hmf_solve(hierarchy.get(), &set, &options, nullptr, &raw, &s.error);
    s.foliation.reset(raw);
    if (!raw) return s;
    s.values = values_of(s.foliation);
    s.report = *hmf_foliation_report(raw);
    return s;
}

// Part of a disk with a hole: n round, m across; vertex i * (m + 1) + j at radius j.
TriMesh annulus(size_t n, size_t m, double R, double jitter, uint64_t seed) {
    TriMesh mesh;
    Random random(seed);
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j <= m; ++j) {
            const bool inner = j > 0 && j < m;
            const double a =
                2 * pi * (static_cast<double>(i) + (inner ? jitter * (random.unit() - 0.5) : 0)) / double(n);
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

// A rectangle of a x b with n x m cells, with jittered vertices inside.
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

hmf_build_options with_marks(const Path& marks) {
    hmf_build_options options{};
    options.struct_size = sizeof options;
    options.marked_vertices = marks.data();
    options.marked_count = marks.size();
    return options;
}

// Number of triangles of each edge.
std::vector<int> triangles_of_edges(const LevelMesh& mesh) {
    std::vector<int> count(mesh.edge_count, 0);
    for (const uint32_t e : mesh.triangle_edges) ++count[e];
    return count;
}

// Energy of the function that is harmonic on the caller's triangles and has the values 0 and 1 where fixed tells.
double linear_energy(const LevelMesh& mesh, const std::map<uint32_t, double>& fixed) {
    std::vector<int> unknown(mesh.vertex_count, -1);
    int n = 0;
    for (size_t v = 0; v < mesh.vertex_count; ++v)
        if (!fixed.count(uint32_t(v))) unknown[v] = n++;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (size_t e = 0; e < mesh.edge_count; ++e)
        for (size_t k = 0; k < 2; ++k) {
            const uint32_t v = mesh.edge_vertices[2 * e + k], w = mesh.edge_vertices[2 * e + 1 - k];
            if (unknown[v] < 0) continue;
            entries.emplace_back(unknown[v], unknown[v], mesh.weights[e]);
            if (unknown[w] >= 0) entries.emplace_back(unknown[v], unknown[w], -mesh.weights[e]);
            else right[unknown[v]] += mesh.weights[e] * fixed.at(w);
        }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    const Eigen::VectorXd x = solver.solve(right);
    double sum = 0;
    for (size_t e = 0; e < mesh.edge_count; ++e) {
        double u[2];
        for (size_t k = 0; k < 2; ++k) {
            const uint32_t v = mesh.edge_vertices[2 * e + k];
            u[k] = unknown[v] < 0 ? fixed.at(v) : x[unknown[v]];
        }
        sum += mesh.weights[e] * (u[0] - u[1]) * (u[0] - u[1]);
    }
    return sum;
}

// The back has the values of the front, so that they can be read again: closed, without poles, the same.
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
    ASSERT_EQ(hmf_foliation_create(&h, 0, s.values.data(), s.values.size(), nullptr, &raw, &error), HMF_OK)
        << error.message;
    const Foliation again(raw);
    EXPECT_EQ(values_of(again), s.values);
    EXPECT_EQ(raw->poles, 0u);
}

// What holds for every result on a surface with boundary.
void expect_result(const Hierarchy& hierarchy, const Solution& s, int64_t boundaries, int64_t marks_inside = 0,
                   int64_t marks_on_boundary = 0) {
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    const LevelMesh mesh = read_level(hierarchy, 0);
    ASSERT_EQ(s.values.size(), mesh.edge_count);
    EXPECT_EQ(closedness_defect(mesh, s.values), "");
    EXPECT_LE(s.report.residual_max, 1e-8);
    EXPECT_EQ(s.report.poles, 0u);
    EXPECT_EQ(s.report.bad_flips_left, 0u);
    const int64_t genus = static_cast<int64_t>(hmf_genus(hierarchy.get()));
    EXPECT_EQ(s.report.index_sum, 8 - 8 * genus - 4 * boundaries - 2 * marks_inside - marks_on_boundary);
    EXPECT_NE(s.report.class_state, HMF_CLASS_LOST);
    EXPECT_NE(s.report.class_state, HMF_CLASS_UNKNOWN);
    const auto set = singularities(s.foliation);
    ASSERT_TRUE(set);
    EXPECT_EQ(set->vertex_count, mesh.vertex_count);
    EXPECT_EQ(set->triangle_count, mesh.triangle_count);
    for (size_t v = 0; v < mesh.vertex_count; ++v) EXPECT_LE(set->vertex_index[v], 0);
    EXPECT_EQ(residuals(s.foliation, mesh.vertex_count).size(), mesh.vertex_count);
    expect_symmetric(s);
}

} // namespace

TEST(Boundary, LevelZeroIsTheCallersMesh) {
    const TriMesh mesh = annulus(12, 4, 3, 0.3, 1);
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    EXPECT_EQ(hmf_genus(hierarchy.get()), 0u);
    const LevelMesh level = read_level(hierarchy, 0);
    EXPECT_EQ(level.vertex_count, mesh.vertex_count());
    EXPECT_EQ(level.triangle_vertices, mesh.triangles);
    EXPECT_EQ(level.positions, mesh.positions);
    EXPECT_EQ(level.vertex_count + level.triangle_count, level.edge_count); // Euler characteristic 0
    std::map<std::set<uint32_t>, uint32_t> first;
    for (size_t c = 0; c < mesh.triangles.size(); ++c) {
        const std::set<uint32_t> ends{mesh.triangles[c], mesh.triangles[c - c % 3 + (c + 1) % 3]};
        const uint32_t e = first.insert({ends, uint32_t(first.size())}).first->second;
        EXPECT_EQ(level.triangle_edges[c], e);
        EXPECT_EQ((std::set<uint32_t>{level.edge_vertices[2 * e], level.edge_vertices[2 * e + 1]}), ends);
    }
}

TEST(Boundary, AnnulusRoundAndAcross) {
    const double R = 3;
    for (const double jitter : {0.0, 0.5}) {
        const size_t n = 40, m = 12;
        const TriMesh mesh = annulus(n, m, R, jitter, 5);
        const Hierarchy hierarchy(mesh);
        ASSERT_TRUE(hierarchy);
        const LevelMesh level = read_level(hierarchy, 0);
        std::map<uint32_t, double> fixed;
        Path inner, outer, middle;
        for (size_t i = 0; i < n; ++i) {
            inner.push_back(uint32_t(i * (m + 1)));
            outer.push_back(uint32_t(i * (m + 1) + m));
            middle.push_back(uint32_t(i * (m + 1) + m / 2));
            fixed[inner.back()] = 0;
            fixed[outer.back()] = 1;
        }
        const double linear = linear_energy(level, fixed);
        for (const Path& round : {inner, outer, middle}) {
            Curves curves;
            curves.add(round, false);
            const Solution s = solve_curves(hierarchy, curves);
            expect_result(hierarchy, s, 2);
            // Diagonals of the regular mesh have the weight 0, which is raised to the floor of 1e-9.
            EXPECT_NEAR(s.report.energy, linear, jitter == 0 ? 1e-8 : 0.02) << jitter;
            EXPECT_LE(s.report.energy, linear + 1e-8);
            EXPECT_NEAR(s.report.energy, 2 * pi / std::log(R), 0.1);
        }
        Curves across;
        Path arc;
        for (size_t j = 0; j <= m; ++j) arc.push_back(uint32_t(j));
        across.add(arc, true);
        const Solution s = solve_curves(hierarchy, across);
        expect_result(hierarchy, s, 2);
        EXPECT_NEAR(s.report.energy, std::log(R) / (2 * pi), 0.003);
        EXPECT_NEAR(energy(s.foliation), s.report.energy, 1e-12);
    }
}

TEST(Boundary, RectangleIsExact) {
    const double a = 3, b = 1.25;
    const size_t n = 24, m = 10;
    for (const double jitter : {0.0, 0.6}) {
        const TriMesh mesh = rectangle(n, m, a, b, jitter, 7);
        const Path corners = {0, uint32_t(m), uint32_t(n * (m + 1)), uint32_t(n * (m + 1) + m)};
        const Hierarchy hierarchy(mesh, with_marks(corners));
        ASSERT_TRUE(hierarchy);
        Path along, across; // from side to side
        for (size_t i = 0; i <= n; ++i) along.push_back(uint32_t(i * (m + 1) + m / 2));
        for (size_t j = 0; j <= m; ++j) across.push_back(uint32_t(n / 2 * (m + 1) + j));
        for (int way = 0; way < 2; ++way) {
            Curves curves;
            curves.add(way == 0 ? along : across, true);
            const Solution s = solve_curves(hierarchy, curves);
            expect_result(hierarchy, s, 1, 0, 4);
            EXPECT_NEAR(s.report.energy, way == 0 ? a / b : b / a, jitter == 0 ? 1e-8 : 1e-12); // the floor of weights
            const LevelMesh level = read_level(hierarchy, 0);
            for (size_t e = 0; e < level.edge_count; ++e) {
                const size_t c = way == 0 ? 1 : 0;
                const double d = level.positions[3 * level.edge_vertices[2 * e] + c]
                               - level.positions[3 * level.edge_vertices[2 * e + 1] + c];
                EXPECT_NEAR(s.values[e], std::fabs(d) / (way == 0 ? b : a), 1e-9);
            }
        }
    }
}

namespace {

// Removes the triangles near some places; keeps the largest part, without unused vertices.
TriMesh with_holes(const TriMesh& mesh, size_t holes, size_t rings, uint64_t seed) {
    Random random(seed);
    std::vector<char> gone(mesh.triangle_count(), 0);
    for (size_t k = 0; k < holes; ++k) {
        std::set<uint32_t> vertices{uint32_t(random.below(mesh.vertex_count()))};
        for (size_t r = 0; r < rings; ++r) {
            std::set<uint32_t> more = vertices;
            for (size_t t = 0; t < mesh.triangle_count(); ++t) {
                bool touches = false;
                for (size_t s = 0; s < 3; ++s) touches = touches || vertices.count(mesh.triangles[3 * t + s]);
                if (!touches) continue;
                gone[t] = 1;
                for (size_t s = 0; s < 3; ++s) more.insert(mesh.triangles[3 * t + s]);
            }
            vertices = more;
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

// Holes may have met at a vertex, cut off a part, or left a disk.
bool is_sound(const TriMesh& mesh) {
    hmf_hierarchy* raw = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_build(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                        mesh.triangle_count(), nullptr, nullptr, &raw, &error);
    hmf_destroy(raw);
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

} // namespace

TEST(Boundary, RandomHolesWithLoopsOfTheLibrary) {
    size_t solved = 0;
    for (uint64_t seed = 1; seed <= 24; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const TriMesh base = seed % 3 == 0 ? pretzel(2, 2) : torus(24, 12, 3, 1, {true, 1, 0.3, seed});
        const TriMesh mesh = with_holes(base, 1 + seed % 5, 1 + seed % 3, seed);
        if (!is_sound(mesh)) continue; // bad luck
        const Hierarchy hierarchy(mesh);
        for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
            const auto set = make<hmf_loop_set>(
                [&](hmf_loop_set** out, hmf_error* e) { return hmf_loops(hierarchy.get(), 0, kind, nullptr, out, e); });
            ASSERT_TRUE(set);
            Solution s;
            hmf_foliation* made = nullptr;
            s.status = hmf_solve(hierarchy.get(), set.get(), nullptr, nullptr, &made, &s.error);
            s.foliation.reset(made);
            ASSERT_TRUE(made) << s.error.message;
            s.values = values_of(s.foliation);
            s.report = *hmf_foliation_report(made);
            expect_result(hierarchy, s, boundary_count(mesh));
            const auto cylinders = make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* e) {
                return hmf_cylinders(s.foliation.get(), set.get(), nullptr, out, e);
            });
            ASSERT_TRUE(cylinders);
            ASSERT_EQ(cylinders->count, set->count);
            for (size_t c = 0; c < set->count; ++c) EXPECT_EQ(cylinders->list[c].height, 1); // exactly
            const int64_t genus = int64_t(hmf_genus(hierarchy.get())), b = boundary_count(mesh);
            EXPECT_EQ(int64_t(set->count), kind == HMF_LOOPS_CUT ? genus + b : 3 * genus - 3 + 2 * b);
        }
        ++solved;
    }
    EXPECT_GE(solved, 12u);
}

namespace {

Owned<hmf_lines> levels(const Solution& s, double spacing, int32_t leaves = HMF_LEAVES_FOLIATION) {
    hmf_trace_options options{};
    options.struct_size = sizeof options;
    options.spacing = spacing;
    options.leaves = leaves;
    return make<hmf_lines>(
        [&](hmf_lines** out, hmf_error* error) { return hmf_trace(s.foliation.get(), &options, nullptr, out, error); });
}

} // namespace

// Straight lines from side to side, and circles.
TEST(Boundary, LeavesEndAtTheBoundary) {
    const size_t n = 24, m = 10;
    const TriMesh mesh = rectangle(n, m, 3, 1.25, 0.5, 7);
    const Path corners = {0, uint32_t(m), uint32_t(n * (m + 1)), uint32_t(n * (m + 1) + m)};
    const Hierarchy hierarchy(mesh, with_marks(corners));
    Curves curves;
    Path along;
    for (size_t i = 0; i <= n; ++i) along.push_back(uint32_t(i * (m + 1) + m / 2));
    curves.add(along, true);
    const Solution s = solve_curves(hierarchy, curves);
    for (const int32_t way : {HMF_LEAVES_FOLIATION, HMF_LEAVES_CONJUGATE}) {
        const auto lines = levels(s, 0.125, way);
        ASSERT_TRUE(lines);
        EXPECT_GE(lines->line_count, 8u);
        for (size_t k = 0; k < lines->line_count; ++k) {
            const hmf_line& line = lines->lines[k];
            EXPECT_FALSE(line.closed);
            if (way == HMF_LEAVES_FOLIATION) {
                EXPECT_EQ(line.begin, HMF_END_BOUNDARY);
                EXPECT_EQ(line.end, HMF_END_BOUNDARY);
            }
            EXPECT_NEAR(line.length, way == HMF_LEAVES_FOLIATION ? 3 : 1.25, 1e-6);
            const size_t c = way == HMF_LEAVES_FOLIATION ? 1 : 0;
            for (uint64_t p = lines->offsets[k]; p < lines->offsets[k + 1]; ++p)
                EXPECT_NEAR(lines->points[3 * p + c], lines->points[3 * lines->offsets[k] + c], 1e-6);
        }
    }
    const hmf_loop_set set = curves.view();
    const auto cylinders = make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* error) {
        return hmf_cylinders(s.foliation.get(), &set, nullptr, out, error);
    });
    ASSERT_TRUE(cylinders);
    ASSERT_EQ(cylinders->count, 1u);
    EXPECT_EQ(cylinders->list[0].loop, 0u);
    EXPECT_EQ(cylinders->list[0].height, 1);
    EXPECT_NEAR(cylinders->list[0].circumference, 3 / 1.25, 1e-6);
    EXPECT_NEAR(cylinders->list[0].area, s.report.energy, 1e-6);
    // Its leaf in the middle is an arc of the same class.
    EXPECT_EQ(cylinders->leaves->arcs[0], 1);
    Solution again;
    hmf_foliation* raw = nullptr;
    again.status = hmf_solve(hierarchy.get(), cylinders->leaves, nullptr, nullptr, &raw, &again.error);
    again.foliation.reset(raw);
    ASSERT_TRUE(raw) << again.error.message;
    EXPECT_NEAR(hmf_foliation_report(raw)->energy, s.report.energy, 1e-9);
}

TEST(Boundary, CylindersOfTheSurface) {
    const TriMesh mesh = with_holes(torus(32, 16, 3, 1, {true, 1, 0.3, 3}), 3, 2, 4);
    const Hierarchy hierarchy(mesh);
    const auto set = make<hmf_loop_set>([&](hmf_loop_set** out, hmf_error* e) {
        return hmf_loops(hierarchy.get(), 0, HMF_LOOPS_PANTS, nullptr, out, e);
    });
    ASSERT_TRUE(set);
    Solution s;
    hmf_foliation* raw = nullptr;
    s.status = hmf_solve(hierarchy.get(), set.get(), nullptr, nullptr, &raw, &s.error);
    s.foliation.reset(raw);
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    s.report = *hmf_foliation_report(raw);
    const auto cylinders = make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* error) {
        return hmf_cylinders(s.foliation.get(), set.get(), nullptr, out, error);
    });
    ASSERT_TRUE(cylinders);
    ASSERT_EQ(cylinders->count, set->count);
    std::set<uint32_t> loops;
    double area = 0, sum = 0;
    for (size_t c = 0; c < cylinders->count; ++c) {
        loops.insert(cylinders->list[c].loop);
        EXPECT_EQ(cylinders->list[c].height, 1);
        area += cylinders->list[c].area;
        sum += cylinders->list[c].height * cylinders->list[c].circumference;
    }
    EXPECT_EQ(loops.size(), set->count);
    EXPECT_NEAR(area / s.report.energy, 1, 1e-6);
    EXPECT_NEAR(sum / s.report.energy, 1, 1e-6);
    hmf_foliation* second = nullptr;
    hmf_error error{};
    hmf_solve(hierarchy.get(), cylinders->leaves, nullptr, nullptr, &second, &error);
    const Foliation again(second);
    ASSERT_TRUE(second) << error.message;
    EXPECT_NEAR(hmf_foliation_report(second)->energy / s.report.energy, 1, 1e-9);
}

namespace {

Owned<hmf_quad_mesh> quads_of(const Solution& s, const hmf_quad_options& options) {
    return make<hmf_quad_mesh>(
        [&](hmf_quad_mesh** out, hmf_error* e) { return hmf_quads(s.foliation.get(), &options, nullptr, out, e); });
}

hmf_quad_options quad_options(uint64_t count, bool merge = false, uint64_t relax = 0) {
    hmf_quad_options options{};
    options.struct_size = sizeof options;
    options.count = count;
    options.merge = merge;
    options.relax = relax;
    return options;
}

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

// An oriented manifold of the same genus and with as many boundary curves, which lie on those of the surface.
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
    double size = 0, worst = 0;
    for (const double x : mesh.positions) size = std::max(size, std::fabs(x));
    for (const auto& step : next) {
        double nearest = HUGE_VAL;
        for (const auto& side : of_mesh)
            if (!of_mesh.count({side.first.second, side.first.first}))
                nearest = std::min(nearest, distance_to_segment(quads.positions + 3 * step.first,
                                                                &mesh.positions[3 * side.first.first],
                                                                &mesh.positions[3 * side.first.second]));
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

} // namespace

// From a coarser level it is far from symmetric: made so or left, in a time that the size of the mesh bounds.
TEST(Boundary, InterpolatedFromACoarserLevel) {
    const TriMesh mesh = with_holes(torus(96, 48, 3, 1, {true, 1, 0.3, 3}), 3, 1, 4);
    const Hierarchy hierarchy(mesh);
    ASSERT_GE(hmf_level_count(hierarchy.get()), 2u);
    const Solution s = solve(hierarchy, nullptr, solve_options(0, 0));
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    hmf_foliation *coarse = nullptr, *fine = nullptr;
    ASSERT_EQ(hmf_interpolate(s.foliation.get(), 1, nullptr, &coarse, nullptr), HMF_OK);
    const Foliation owned(coarse);
    ASSERT_EQ(hmf_interpolate(coarse, 0, nullptr, &fine, nullptr), HMF_OK);
    const Foliation back(fine);
    EXPECT_EQ(closedness_defect(read_level(hierarchy, 0), values_of(back)), "");
    EXPECT_EQ(fine->poles, 0u);
    hmf_foliation* raw = nullptr;
    ASSERT_EQ(hmf_relax(fine, nullptr, nullptr, &raw, nullptr), HMF_OK);
    const Foliation relaxed(raw);
    EXPECT_NEAR(hmf_foliation_report(raw)->energy, s.report.energy, 1e-9 * s.report.energy);
}

TEST(Boundary, QuadsOfARectangleAreAGrid) {
    const double a = 3, b = 1.25;
    const size_t n = 24, m = 10;
    const TriMesh mesh = rectangle(n, m, a, b, 0.6, 7);
    const Path corners = {0, uint32_t(m), uint32_t(n * (m + 1)), uint32_t(n * (m + 1) + m)};
    const Hierarchy hierarchy(mesh, with_marks(corners));
    ASSERT_TRUE(hierarchy);
    for (int way = 0; way < 2; ++way) {
        Curves curves;
        Path path;
        if (way == 0)
            for (size_t i = 0; i <= n; ++i) path.push_back(uint32_t(i * (m + 1) + m / 2));
        else
            for (size_t j = 0; j <= m; ++j) path.push_back(uint32_t(n / 2 * (m + 1) + j));
        curves.add(path, true);
        const Solution s = solve_curves(hierarchy, curves);
        for (const uint64_t relax : {0, 5}) {
            const auto quads = quads_of(s, quad_options(240, false, relax));
            ASSERT_TRUE(quads);
            expect_quads_conform(mesh, *quads, 0);
            EXPECT_EQ(quads->irregular_count, 4u); // the corners
            EXPECT_EQ(quads->inverted_count, 0u);
            EXPECT_NEAR(double(quads->quad_count), 240, 24);
            // Rows and columns at equal distances.
            std::set<int64_t> xs, ys;
            for (size_t v = 0; v < quads->vertex_count; ++v) {
                xs.insert(std::llround(quads->positions[3 * v] * 1e6));
                ys.insert(std::llround(quads->positions[3 * v + 1] * 1e6));
            }
            EXPECT_EQ((xs.size() - 1) * (ys.size() - 1), quads->quad_count);
            EXPECT_EQ(xs.size() * ys.size(), quads->vertex_count);
            for (const auto* lines : {&xs, &ys}) {
                const double step = double(*lines->rbegin() - *lines->begin()) / double(lines->size() - 1);
                double k = 0;
                for (const int64_t x : *lines) EXPECT_NEAR(double(x), step * k++, 2);
            }
        }
    }
}

TEST(Boundary, QuadsOfAnAnnulusBothWays) {
    const TriMesh mesh = annulus(40, 12, 3, 0.5, 5);
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    for (int way = 0; way < 2; ++way) {
        Curves curves;
        Path path;
        for (size_t k = 0; k < (way == 0 ? 40u : 13u); ++k) path.push_back(uint32_t(way == 0 ? k * 13 : k));
        curves.add(path, way == 1);
        const Solution s = solve_curves(hierarchy, curves);
        ASSERT_EQ(s.status, HMF_OK);
        for (const uint64_t count : {100u, 400u}) {
            const auto quads = quads_of(s, quad_options(count));
            ASSERT_TRUE(quads);
            expect_quads_conform(mesh, *quads, 0);
            EXPECT_EQ(quads->irregular_count, 0u);
            EXPECT_EQ(quads->inverted_count, 0u);
            EXPECT_NEAR(double(quads->quad_count), double(count), 0.2 * double(count));
        }
    }
}

TEST(Boundary, QuadsOfSurfacesWithHoles) {
    for (uint64_t seed = 1; seed <= 12; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const TriMesh base = seed % 3 == 0 ? pretzel(2, 2) : torus(24, 12, 3, 1, {true, 1, 0.3, seed});
        const TriMesh mesh = with_holes(base, 1 + seed % 5, 1 + seed % 3, seed);
        if (!is_sound(mesh)) continue; // bad luck
        const Hierarchy hierarchy(mesh);
        ASSERT_TRUE(hierarchy);
        for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
            const auto set = make<hmf_loop_set>(
                [&](hmf_loop_set** out, hmf_error* e) { return hmf_loops(hierarchy.get(), 0, kind, nullptr, out, e); });
            ASSERT_TRUE(set);
            Solution s;
            hmf_foliation* made = nullptr;
            s.status = hmf_solve(hierarchy.get(), set.get(), nullptr, nullptr, &made, &s.error);
            s.foliation.reset(made);
            ASSERT_TRUE(made);
            for (const bool merge : {false, true}) {
                const auto quads = quads_of(s, quad_options(1500, merge, merge ? 10 : 0));
                ASSERT_TRUE(quads);
                expect_quads_conform(mesh, *quads, int64_t(hmf_genus(hierarchy.get())));
            }
        }
    }
}

namespace {

// A shortest path between two vertices of the boundary whose other vertices lie inside and are free.
Path shortest_arc(const LevelMesh& level, const std::vector<char>& on_boundary, const std::vector<char>& taken,
                  uint32_t from, uint32_t to) {
    std::vector<std::vector<uint32_t>> neighbours(level.vertex_count);
    for (size_t e = 0; e < level.edge_count; ++e)
        for (size_t k = 0; k < 2; ++k)
            neighbours[level.edge_vertices[2 * e + k]].push_back(level.edge_vertices[2 * e + 1 - k]);
    std::vector<uint32_t> before(level.vertex_count, HMF_NONE);
    Path queue{from};
    before[from] = from;
    for (size_t i = 0; i < queue.size(); ++i)
        for (const uint32_t w : neighbours[queue[i]]) {
            if (before[w] != HMF_NONE || taken[w] || (on_boundary[w] && (w != to || queue[i] == from))) continue;
            before[w] = queue[i];
            queue.push_back(w);
        }
    if (before[to] == HMF_NONE || from == to) return {};
    Path path{to};
    while (path.back() != from) path.push_back(before[path.back()]);
    return path;
}

// Arcs between random vertices of the boundary, as far as they go together.
Curves random_arcs(const Hierarchy& hierarchy, size_t wished, Random& random) {
    const LevelMesh level = read_level(hierarchy, 0);
    std::vector<char> on_boundary(level.vertex_count, 0), taken(level.vertex_count, 0);
    const std::vector<int> triangles = triangles_of_edges(level);
    Path boundary;
    for (size_t e = 0; e < level.edge_count; ++e)
        for (size_t k = 0; k < 2 && triangles[e] == 1; ++k) {
            const uint32_t v = level.edge_vertices[2 * e + k];
            if (!on_boundary[v]) boundary.push_back(v);
            on_boundary[v] = 1;
        }
    Curves curves;
    for (size_t tries = 0; tries < 12 && curves.arcs.size() < wished; ++tries) {
        const Path path = shortest_arc(level, on_boundary, taken, boundary[random.below(boundary.size())],
                                       boundary[random.below(boundary.size())]);
        if (path.size() < 3 || taken[path.front()] || taken[path.back()]) continue;
        Curves more = curves;
        more.add(path, true, 1 + double(random.below(4)) / 4);
        const hmf_loop_set set = more.view();
        hmf_foliation* raw = nullptr;
        const hmf_status status = hmf_initialize(hierarchy.get(), &set, nullptr, &raw, nullptr);
        hmf_foliation_destroy(raw);
        if (status != HMF_OK) {
            EXPECT_TRUE(status == HMF_ERROR_LOOP_TRIVIAL || status == HMF_ERROR_LOOP_PARALLEL
                        || status == HMF_ERROR_LOOP_CROSSING)
                << status;
            continue;
        }
        curves = more;
        for (const uint32_t v : path) taken[v] = 1;
    }
    return curves;
}

} // namespace

TEST(Boundary, RandomArcs) {
    size_t solved = 0, made = 0, refused = 0;
    for (uint64_t seed = 1; seed <= 24; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Random random(seed);
        const TriMesh base =
            seed % 3 == 0 ? torus(24, 12, 3, 1, {true, 1, 0.3, seed}) : rectangle(24, 16, 3, 2, 0.6, seed);
        const TriMesh mesh = with_holes(base, 1 + seed % 4, 1 + seed % 2, seed);
        if (!is_sound(mesh)) continue;
        const Hierarchy hierarchy(mesh);
        const Curves curves = random_arcs(hierarchy, 1 + seed % 5, random);
        if (curves.arcs.empty()) continue;
        const Solution s = solve_curves(hierarchy, curves);
        expect_result(hierarchy, s, boundary_count(mesh));
        ++solved;
        const hmf_loop_set set = curves.view();
        const auto cylinders = make<hmf_cylinder_set>([&](hmf_cylinder_set** out, hmf_error* e) {
            return hmf_cylinders(s.foliation.get(), &set, nullptr, out, e);
        });
        ASSERT_TRUE(cylinders);
        for (size_t c = 0; c < cylinders->count; ++c)
            EXPECT_EQ(cylinders->list[c].height, curves.loops.weights[cylinders->list[c].loop]);
        for (const bool merge : {false, true}) {
            hmf_quad_mesh* raw = nullptr;
            hmf_error error{};
            const hmf_quad_options options = quad_options(800, merge, merge ? 10 : 0);
            const hmf_status status = hmf_quads(s.foliation.get(), &options, nullptr, &raw, &error);
            const Owned<hmf_quad_mesh> quads(raw);
            if (status == HMF_ERROR_UNSUPPORTED) { // a handle that no arc crosses
                ++refused;
                continue;
            }
            ASSERT_EQ(status, HMF_OK) << error.message;
            expect_quads_conform(mesh, *quads, int64_t(hmf_genus(hierarchy.get())));
            ++made;
        }
    }
    EXPECT_GE(solved, 12u);
    EXPECT_GE(made, 3 * refused);
}

namespace {

// The calls of the interface on a surface with boundary, one after the other.
struct Calls {
    const TriMesh& mesh;
    const hmf_build_options& options;
    hmf_hierarchy* hierarchy = nullptr;
    hmf_loop_set* loops = nullptr;
    hmf_foliation* foliation = nullptr;

    Calls(const TriMesh& m, const hmf_build_options& o) : mesh(m), options(o) {}
    ~Calls() {
        hmf_free(loops);
        hmf_foliation_destroy(foliation);
        hmf_destroy(hierarchy);
    }
    // visit(call) runs it; anything but HMF_OK ends.
    template <class Visit>
    hmf_status run(Visit visit) {
        hmf_error error{};
        hmf_status status = visit([&](const hmf_control* control) {
            hmf_design* design = nullptr;
            hmf_design_options wish{};
            wish.struct_size = sizeof wish;
            wish.build = &options;
            wish.solve_limit = 3;
            const hmf_status s = hmf_even_design(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                                 mesh.triangle_count(), &wish, control, &design, &error);
            EXPECT_EQ(design != nullptr, s == HMF_OK);
            hmf_free(design);
            return s;
        });
        if (!status)
            status = visit([&](const hmf_control* control) {
                return hmf_build(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                 mesh.triangle_count(), &options, control, &hierarchy, &error);
            });
        if (!status)
            status = visit([&](const hmf_control* control) {
                return hmf_loops(hierarchy, 0, HMF_LOOPS_PANTS, control, &loops, &error);
            });
        if (!status)
            status = visit([&](const hmf_control* control) {
                return hmf_solve(hierarchy, loops, nullptr, control, &foliation, &error);
            });
        if (!status)
            status = visit([&](const hmf_control* control) {
                hmf_quad_options wish = quad_options(0, true, 2);
                hmf_quad_mesh* quads = nullptr;
                const hmf_status s = hmf_quads(foliation, &wish, control, &quads, &error);
                EXPECT_EQ(quads != nullptr, s == HMF_OK);
                hmf_free(quads);
                return s;
            });
        if (!status)
            status = visit([&](const hmf_control* control) {
                hmf_cylinder_set* cylinders = nullptr;
                const hmf_status s = hmf_cylinders(foliation, loops, control, &cylinders, &error);
                hmf_free(cylinders);
                return s;
            });
        return status;
    }
};

TriMesh mesh_with_boundary() { return with_holes(torus(24, 12, 3, 1, {true, 1, 0.3, 3}), 2, 2, 3); }

} // namespace

// Closed meshes that the library makes for itself count as well.
TEST(Boundary, MemoryLimitIsKept) {
    const TriMesh mesh = mesh_with_boundary();
    uint64_t refused = 0;
    bool done = false;
    for (uint64_t limit = 4096; !done; limit += limit / 16 + 1) {
        Meter meter;
        {
            hmf_build_options options = meter.options();
            options.memory_limit = limit;
            Calls calls(mesh, options);
            size_t number = 0;
            const hmf_status status = calls.run([&](const std::function<hmf_status(const hmf_control*)>& call) {
                const uint64_t kept = calls.hierarchy ? meter.used - hmf_hierarchy_memory(calls.hierarchy) : 0;
                meter.peak = meter.used;
                const hmf_status s = call(nullptr);
                EXPECT_LE(meter.peak - kept, limit) << "call " << number;
                ++number;
                return s;
            });
            done = status == HMF_OK;
            refused += !done;
            if (!done) { ASSERT_EQ(status, HMF_ERROR_MEMORY_LIMIT) << limit; }
        }
        ASSERT_EQ(meter.used, 0u);
        ASSERT_LT(limit, uint64_t{1} << 32) << "no limit is enough";
    }
    EXPECT_GT(refused, 10u);
}

TEST(Boundary, EveryAllocationMayFailAndEveryCallStop) {
    const TriMesh mesh = mesh_with_boundary();
    Meter meter;
    {
        const hmf_build_options options = meter.options();
        Calls calls(mesh, options);
        size_t number = 0;
        const hmf_status status = calls.run([&](const std::function<hmf_status(const hmf_control*)>& call) {
            SCOPED_TRACE(testing::Message() << "call " << number);
            // First in vain, then as it is.
            const uint64_t held = meter.used;
            const auto fails = [&](uint64_t fail, uint64_t stop, uint64_t& allocations, uint64_t& reports) {
                Progress progress;
                progress.stop = stop;
                const hmf_control control = progress.control();
                meter.calls = 0;
                meter.fail = fail;
                const hmf_status s = call(&control);
                allocations = meter.calls;
                reports = progress.calls;
                meter.fail = 0;
                EXPECT_TRUE(progress.rising);
                return s;
            };
            uint64_t allocations = 0, reports = 0, ignored = 0;
            const bool keeps = number == 1 || number == 2 || number == 3;
            if (!keeps) { // the counts of a call that leaves nothing
                EXPECT_EQ(fails(0, 0, allocations, reports), HMF_OK);
                EXPECT_EQ(meter.used, held);
            } else allocations = 4000, reports = 2000;
            for (uint64_t n = 1; n <= allocations; n += 1 + allocations / 48) {
                const hmf_status s = fails(n, 0, ignored, ignored);
                if (s == HMF_OK && keeps) return ++number, s; // there were fewer
                EXPECT_EQ(s, HMF_ERROR_MEMORY) << "allocation " << n;
                EXPECT_EQ(meter.used, held);
            }
            for (uint64_t n = 1; n < reports; n += 1 + reports / 24) {
                const hmf_status s = fails(0, n, ignored, ignored);
                if (s == HMF_OK && keeps) return ++number, s;
                EXPECT_EQ(s, HMF_CANCELLED) << "report " << n;
                if (keeps && calls.foliation) { // had been found
                    hmf_foliation_destroy(calls.foliation);
                    calls.foliation = nullptr;
                }
                EXPECT_EQ(meter.used, held);
            }
            ++number;
            return call(nullptr);
        });
        EXPECT_EQ(status, HMF_OK);
        EXPECT_EQ(number, 6u);
    }
    EXPECT_EQ(meter.used, 0u);
}

namespace {

// Two rectangles a x b, one on the other, glued along their sides: flat, with four cone points at the corners.
TriMesh flat_pillow(size_t n, size_t m, double a, double b, uint64_t seed) {
    TriMesh mesh = rectangle(n, m, a, b, 0.6, seed);
    const size_t count = mesh.triangles.size() / 3;
    const uint32_t vertices = uint32_t(mesh.vertex_count());
    std::vector<uint32_t> behind(vertices);
    uint32_t next = vertices;
    for (uint32_t v = 0; v < vertices; ++v) {
        const size_t i = v / (m + 1), j = v % (m + 1);
        behind[v] = i == 0 || j == 0 || i == n || j == m ? v : next++;
        if (behind[v] != v)
            for (size_t c = 0; c < 3; ++c) mesh.positions.push_back(mesh.positions[3 * size_t{v} + c]);
    }
    // No triangle with two sides on the edge of the rectangle: at the corners the diagonal ends there.
    const auto corner = [&](size_t i, size_t j) { return uint32_t(i * (m + 1) + j); };
    for (size_t t = 0; t + 1 < count; t += 2) {
        const size_t cell = t / 2, i = cell / m, j = cell % m;
        const uint32_t p = corner(i, j), q = corner(i, j + 1), r = corner(i + 1, j), s = corner(i + 1, j + 1);
        const bool rising = (i == 0 && j == 0) || (i == n - 1 && j == m - 1);
        const bool falling = (i == 0 && j == m - 1) || (i == n - 1 && j == 0);
        if (!rising && !falling) continue;
        const Path cut = rising ? Path{p, r, s, p, s, q} : Path{p, r, q, r, s, q};
        std::copy(cut.begin(), cut.end(), mesh.triangles.begin() + long(3 * t));
    }
    for (size_t t = 0; t < count; ++t) {
        const uint32_t* c = &mesh.triangles[3 * t];
        const Path back{behind[c[0]], behind[c[2]], behind[c[1]]};
        mesh.triangles.insert(mesh.triangles.end(), back.begin(), back.end());
    }
    return mesh;
}

// The mesh cut open along a closed leaf that crosses no edge twice; rims: the new vertices on either side.
TriMesh cut_along(const TriMesh& mesh, const LevelMesh& level, const hmf_lines& lines, size_t line, bool& simple) {
    TriMesh out = mesh;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> at; // of an edge and one of its ends
    simple = lines.lines[line].closed == 1;
    for (uint64_t p = lines.offsets[line]; p < lines.offsets[line + 1]; ++p) {
        const uint32_t e = lines.point_edges[p];
        for (size_t k = 0; k < 2; ++k) {
            const auto added = at.insert({{e, level.edge_vertices[2 * e + k]}, uint32_t(out.vertex_count())});
            simple = simple && added.second;
            for (size_t c = 0; c < 3; ++c) out.positions.push_back(lines.points[3 * p + c]);
        }
    }
    out.triangles.clear();
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        const uint32_t *v = &mesh.triangles[3 * t], *e = &level.triangle_edges[3 * t];
        size_t tip = 3; // the corner that is cut off
        for (size_t s = 0; s < 3; ++s)
            if (at.count({e[s], v[s]}) && at.count({e[(s + 2) % 3], v[s]})) tip = s;
        if (tip == 3) {
            out.triangles.insert(out.triangles.end(), v, v + 3);
            continue;
        }
        const uint32_t a = v[tip], b = v[(tip + 1) % 3], c = v[(tip + 2) % 3], ab = e[tip], ca = e[(tip + 2) % 3];
        const Path parts{a, at.at({ab, a}), at.at({ca, a}), at.at({ab, b}), b, c, at.at({ab, b}), c, at.at({ca, c})};
        out.triangles.insert(out.triangles.end(), parts.begin(), parts.end());
    }
    return out;
}

// The part that a vertex belongs to; number: of each of its vertices in the mesh.
TriMesh part_of(const TriMesh& mesh, uint32_t vertex, Path& number) {
    std::vector<char> inside(mesh.vertex_count(), 0);
    inside[vertex] = 1;
    for (bool grown = true; grown;) {
        grown = false;
        for (size_t t = 0; t < mesh.triangle_count(); ++t) {
            const uint32_t* v = &mesh.triangles[3 * t];
            const int n = inside[v[0]] + inside[v[1]] + inside[v[2]];
            if (n == 0 || n == 3) continue;
            inside[v[0]] = inside[v[1]] = inside[v[2]] = 1;
            grown = true;
        }
    }
    TriMesh out;
    std::vector<uint32_t> to(mesh.vertex_count(), HMF_NONE);
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (size_t s = 0; s < 3 && inside[mesh.triangles[3 * t]]; ++s) {
            const uint32_t v = mesh.triangles[3 * t + s];
            if (to[v] == HMF_NONE) {
                to[v] = uint32_t(number.size());
                number.push_back(v);
                for (size_t c = 0; c < 3; ++c) out.positions.push_back(mesh.positions[3 * size_t{v} + c]);
            }
            out.triangles.push_back(to[v]);
        }
    return out;
}

// One of the boundary curves.
Path boundary_curve(const TriMesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> sides;
    for (size_t c = 0; c < mesh.triangles.size(); ++c)
        ++sides[{mesh.triangles[c], mesh.triangles[c - c % 3 + (c + 1) % 3]}];
    std::map<uint32_t, uint32_t> next;
    for (const auto& s : sides)
        if (!sides.count({s.first.second, s.first.first})) next[s.first.first] = s.first.second;
    Path curve;
    for (uint32_t v = next.begin()->first; curve.empty() || v != curve.front(); v = next.at(v)) curve.push_back(v);
    return curve;
}

} // namespace

// Cut along a leaf of its solution, a flat surface falls into parts whose solutions are its own.
TEST(Boundary, CutAlongALeafIsExactOnAPillow) {
    const double a = 3, b = 1.25;
    const size_t n = 20, m = 9;
    const TriMesh mesh = flat_pillow(n, m, a, b, 3);
    const Path corners = {0, uint32_t(m), uint32_t(n * (m + 1)), uint32_t(n * (m + 1) + m)};
    const Hierarchy hierarchy(mesh, with_marks(corners));
    ASSERT_TRUE(hierarchy);
    const LevelMesh level = read_level(hierarchy, 0);
    Curves curves; // round the rectangle, half-way up: there and back
    Path round;
    for (size_t i = 0; i <= n; ++i) round.push_back(uint32_t(i * (m + 1) + m / 2));
    for (size_t i = n - 1; i >= 1; --i)
        for (uint32_t v = uint32_t((n + 1) * (m + 1)); v < mesh.vertex_count(); ++v)
            if (std::equal(&mesh.positions[3 * size_t{v}], &mesh.positions[3 * size_t{v}] + 3,
                           &mesh.positions[3 * (i * (m + 1) + m / 2)]))
                round.push_back(v);
    curves.add(round, false);
    const hmf_loop_set set = curves.loops.view();
    Solution s;
    hmf_foliation* raw = nullptr;
    s.status = hmf_solve(hierarchy.get(), &set, nullptr, nullptr, &raw, &s.error);
    s.foliation.reset(raw);
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    const double whole = hmf_foliation_report(raw)->energy;
    ASSERT_NEAR(whole, 2 * a / b, 1e-9);
    const auto lines = levels(s, 1.0 / 3);
    ASSERT_TRUE(lines);
    ASSERT_EQ(lines->line_count, 3u);
    for (size_t line = 0; line < 3; ++line) {
        bool simple = false;
        const TriMesh open = cut_along(mesh, level, *lines, line, simple);
        ASSERT_TRUE(simple);
        double sum = 0, heights = 0;
        for (const uint32_t from : {corners[0], corners[1]}) {
            Path number, marks;
            const TriMesh part = part_of(open, from, number);
            for (size_t v = 0; v < number.size(); ++v)
                if (std::count(corners.begin(), corners.end(), number[v])) marks.push_back(uint32_t(v));
            ASSERT_EQ(marks.size(), 2u);
            const Hierarchy half(part, with_marks(marks));
            ASSERT_TRUE(half);
            EXPECT_EQ(hmf_boundary_count(half.get()), 1u);
            const Path rim = boundary_curve(part);
            double height =
                std::fabs(part.positions[3 * size_t{marks[0]} + 1] - part.positions[3 * size_t{rim[0]} + 1]) / b;
            Curves along;
            along.add(rim, false, height);
            const Solution found = solve_curves(half, along);
            expect_result(half, found, 1, 2, 0);
            EXPECT_NEAR(found.report.energy, height * whole, 1e-8);
            sum += found.report.energy;
            heights += height;
        }
        EXPECT_NEAR(heights, 1, 1e-9);
        EXPECT_NEAR(sum, whole, 1e-8);
    }
}

// On a curved one up to discretisation.
TEST(Boundary, CutAlongALeafOfATorus) {
    const TriMesh mesh = torus(48, 24, 3, 1, {true, 1, 0.2, 5});
    const Hierarchy hierarchy(mesh);
    const LevelMesh level = read_level(hierarchy, 0);
    Solution s = solve(hierarchy, nullptr, solve_options(0, 0));
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    const auto lines = levels(s, 1);
    ASSERT_TRUE(lines);
    bool simple = false;
    TriMesh open = cut_along(mesh, level, *lines, 0, simple);
    open.genus = 0;
    ASSERT_TRUE(simple);
    const Hierarchy annulus(open);
    ASSERT_TRUE(annulus);
    EXPECT_EQ(hmf_boundary_count(annulus.get()), 2u);
    Curves along;
    along.add(boundary_curve(open), false);
    const Solution found = solve_curves(annulus, along);
    expect_result(annulus, found, 2);
    EXPECT_NEAR(found.report.energy, s.report.energy, 0.01 * s.report.energy);
}

// Random holes cut into real meshes, those of HMF_MESHES and HMF_SURFACES: HMF_HOLES says how many cases (60 take some
// minutes), each with 1 to 50 holes.
TEST(Boundary, HolesInRealMeshes) {
    const char* wished = std::getenv("HMF_HOLES");
    std::vector<std::string> paths;
    for (const char* name : {"HMF_MESHES", "HMF_SURFACES"}) {
        std::error_code failure;
        if (const char* folder = std::getenv(name))
            for (const auto& entry : std::filesystem::directory_iterator(folder, failure))
                if (entry.path().extension() == ".obj" && count_obj_vertices(entry.path().string()) < 12000)
                    paths.push_back(entry.path().string());
    }
    if (!wished || paths.empty()) GTEST_SKIP() << "skipped: set HMF_HOLES to a number and HMF_MESHES to a folder";
    std::sort(paths.begin(), paths.end());
    size_t solved = 0, unlucky = 0;
    const uint64_t cases = std::strtoull(wished, nullptr, 10);
    for (uint64_t k = 0; k < cases; ++k) {
        SCOPED_TRACE(testing::Message() << paths[k % paths.size()] << " case " << k);
        TriMesh whole;
        ASSERT_TRUE(read_obj(paths[k % paths.size()], whole));
        TriMesh mesh;
        hmf_status status = HMF_ERROR_MESH_GENUS;
        for (uint64_t tries = 0; tries < 8 && status != HMF_OK; ++tries) { // holes may meet
            const size_t holes = 1 + k * 7 % 50;
            mesh = with_holes(whole, std::max(holes >> tries, size_t{1}), 1 + k % 3, 8 * k + tries);
            hmf_hierarchy* h = nullptr;
            status = hmf_build(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                               nullptr, nullptr, &h, nullptr);
            if (h) mesh.genus = hmf_genus(h);
            hmf_destroy(h);
        }
        if (status != HMF_OK) { // no surface in one piece before, or a sphere
            ++unlucky;
            continue;
        }
        const Hierarchy hierarchy(mesh);
        Solution s = solve(hierarchy, nullptr, solve_options(0, 0));
        ASSERT_TRUE(s.foliation) << s.error.message;
        expect_result(hierarchy, s, boundary_count(mesh));
        const auto quads = quads_of(s, quad_options(2000, k % 2 != 0));
        ASSERT_TRUE(quads);
        ++solved;
    }
    std::printf("%zu of %zu cases solved, %zu without a surface\n", solved, size_t(cases), unlucky);
    EXPECT_GE(2 * solved, size_t(cases));
}
