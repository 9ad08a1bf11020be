// Marked vertices: exact solutions, the branched double cover, indices on all
// levels, loops that go around them, leaves and parameterization.
#include "src/core/hierarchy/hierarchy.hpp"
#include "support/read_obj.hpp"
#include "support/sample.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>

namespace test_marked {

using namespace test;

namespace {

using Marks = std::vector<uint32_t>;

// A regular tetrahedron of edge length sqrt(8) with n edges on each of its own; corners 0 to 3.
TriMesh tetrahedron(size_t n) {
    const double corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    const size_t face[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
    TriMesh mesh;
    std::map<std::array<size_t, 4>, uint32_t> number; // by barycentric coordinates in the solid
    const auto vertex = [&](const std::array<size_t, 4>& b) {
        const auto made = number.insert({b, static_cast<uint32_t>(mesh.vertex_count())});
        for (size_t c = 0; c < 3 && made.second; ++c) {
            double x = 0;
            for (size_t k = 0; k < 4; ++k) x += static_cast<double>(b[k]) * corner[k][c];
            mesh.positions.push_back(x / static_cast<double>(n));
        }
        return made.first->second;
    };
    for (size_t k = 0; k < 4; ++k) {
        std::array<size_t, 4> b{};
        b[k] = n;
        vertex(b);
    }
    for (const auto& f : face)
        for (size_t i = 0; i < n; ++i)
            for (size_t j = 0; i + j < n; ++j) {
                const auto at = [&](size_t x, size_t y) {
                    std::array<size_t, 4> b{};
                    b[f[0]] = n - x - y;
                    b[f[1]] = x;
                    b[f[2]] = y;
                    return vertex(b);
                };
                mesh.triangles.insert(mesh.triangles.end(), {at(i, j), at(i + 1, j), at(i, j + 1)});
                if (i + j + 1 < n)
                    mesh.triangles.insert(mesh.triangles.end(), {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
            }
    mesh.genus = 0;
    return mesh;
}

// Moves the vertices inside the faces along them.
TriMesh jittered_tetrahedron(size_t n, double size, uint64_t seed) {
    TriMesh mesh = tetrahedron(n);
    const double normal[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    Random random(seed);
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        double* x = &mesh.positions[3 * v];
        double shift[3];
        for (double& s : shift) s = size / static_cast<double>(n) * (2 * random.unit() - 1);
        int faces = 0, last = 0;
        for (int k = 0; k < 4; ++k) // opposite to corner k: normal * x = -1
            if (std::fabs(normal[k][0] * x[0] + normal[k][1] * x[1] + normal[k][2] * x[2] + 1) < 1e-9) {
                ++faces;
                last = k;
            }
        if (faces != 1) continue;
        const double* m = normal[last];
        const double along = (shift[0] * m[0] + shift[1] * m[1] + shift[2] * m[2]) / 3;
        for (int c = 0; c < 3; ++c) x[c] += shift[c] - along * m[c];
    }
    return mesh;
}

TriMesh sphere(size_t refinements, double bumps, uint64_t seed) {
    TriMesh mesh;
    mesh.positions = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
    mesh.triangles = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    mesh.genus = 0;
    for (size_t r = 0; r < refinements; ++r) mesh = subdivide(mesh);
    Random random(seed);
    const double a = random.unit() * 3, b = random.unit() * 3, c = random.unit() * 3;
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        double* x = &mesh.positions[3 * v];
        const double r = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        for (int k = 0; k < 3; ++k) x[k] /= r;
        const double size = 1 + bumps * (std::sin(5 * x[0] + a) + std::sin(5 * x[1] + b) + std::sin(5 * x[2] + c)) / 3
                          + 0.01 * random.unit();
        for (int k = 0; k < 3; ++k) x[k] *= size;
    }
    return mesh;
}

Marks random_marks(size_t vertices, size_t count, Random& random) {
    Marks marks;
    while (marks.size() < count) {
        const uint32_t v = static_cast<uint32_t>(random.below(vertices));
        if (std::find(marks.begin(), marks.end(), v) == marks.end()) marks.push_back(v);
    }
    return marks;
}

// A pole outside of the marked vertices, a wrong sum of indices, values that are not closed.
void expect_marked_foliation(const Hierarchy& hierarchy, const Marks& marks, const Foliation& foliation) {
    const size_t level = hmf_foliation_level(foliation.get());
    const LevelMesh mesh = read_level(hierarchy, level);
    const std::vector<double> values = values_of(foliation);
    ASSERT_EQ(closedness_defect(mesh, values), "");
    // Counted from the definition: a marked vertex counts as a closed corner.
    Indices own = count_indices(mesh, values);
    own.sum -= static_cast<long>(marks.size());
    const long wanted =
        4 - 4 * static_cast<long>(hmf_hierarchy_describe(hierarchy.get())->genus) - static_cast<long>(marks.size());
    EXPECT_EQ(own.sum, wanted);
    EXPECT_LE(own.poles, marks.size());
    const auto set = singularities(foliation);
    ASSERT_TRUE(set);
    long sum = 0;
    for (size_t v = 0; v < mesh.vertex_count; ++v) {
        EXPECT_LE(set->vertex_index[v], 0);
        sum += set->vertex_index[v];
    }
    for (size_t t = 0; t < mesh.triangle_count; ++t) sum += set->triangle_index[t];
    EXPECT_EQ(sum, wanted);
    for (size_t i = 0; i < set->count; ++i) {
        const hmf_singularity& s = set->list[i];
        EXPECT_LE(s.index, 0);
        if (s.index == 0 && level == 0) { EXPECT_NE(std::find(marks.begin(), marks.end(), s.element), marks.end()); }
    }
}

void expect_report(const Solution& solution, size_t genus, size_t marks) {
    EXPECT_EQ(solution.status, HMF_OK) << solution.error.message;
    EXPECT_EQ(solution.report.poles, 0u);
    EXPECT_EQ(solution.report.bad_flips_left, 0u);
    const int64_t wanted = 4 - 4 * static_cast<int64_t>(genus) - static_cast<int64_t>(marks);
    EXPECT_EQ(solution.report.index_sum, wanted);
    EXPECT_EQ(static_cast<int64_t>(solution.report.zeros), -wanted);
    if (solution.report.method == HMF_METHOD_NEWTON) { EXPECT_EQ(solution.report.class_state, HMF_CLASS_PROVEN); }
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0;
    for (size_t e = 0; e < a.size(); ++e) largest = std::max(largest, std::fabs(a[e] - b[e]));
    return largest;
}

// Two sheets that meet in the marked vertices, an even number.
struct DoubleCover {
    TriMesh mesh;
    std::vector<size_t> below; // edge of the mesh below each edge

    DoubleCover(const TriMesh& base, const LevelMesh& level, const Marks& marks) {
        const size_t n = base.vertex_count();
        // The sheets change places across the edges of a tree behind which lies an odd number of marks.
        std::vector<std::vector<std::pair<uint32_t, size_t>>> neighbors(n);
        for (size_t e = 0; e < level.edge_count; ++e) {
            const uint32_t a = level.edge_vertices[2 * e], b = level.edge_vertices[2 * e + 1];
            neighbors[a].push_back({b, e});
            neighbors[b].push_back({a, e});
        }
        std::vector<uint32_t> order{0};
        std::vector<size_t> parent_edge(n, SIZE_MAX);
        std::vector<uint32_t> parent(n, 0);
        std::vector<char> seen(n, 0), odd(n, 0), swaps(level.edge_count, 0);
        seen[0] = 1;
        for (size_t i = 0; i < order.size(); ++i)
            for (const auto& to : neighbors[order[i]])
                if (!seen[to.first]) {
                    seen[to.first] = 1;
                    parent[to.first] = order[i];
                    parent_edge[to.first] = to.second;
                    order.push_back(to.first);
                }
        for (const uint32_t m : marks) odd[m] = 1;
        for (size_t i = order.size(); i-- > 1;) {
            const uint32_t v = order[i];
            swaps[parent_edge[v]] = odd[v];
            odd[parent[v]] = static_cast<char>(odd[parent[v]] ^ odd[v]);
        }
        // Corners of both sheets, joined around the vertices.
        const size_t corners = base.triangles.size();
        std::vector<uint32_t> root(2 * corners);
        for (uint32_t c = 0; c < root.size(); ++c) root[c] = c;
        const auto find = [&](uint32_t c) {
            while (root[c] != c) c = root[c] = root[root[c]];
            return c;
        };
        std::vector<size_t> first_side(level.edge_count, SIZE_MAX);
        for (size_t c = 0; c < corners; ++c) {
            const size_t e = level.triangle_edges[c];
            if (first_side[e] == SIZE_MAX) {
                first_side[e] = c;
                continue;
            }
            const size_t d = first_side[e], next_c = c - c % 3 + (c + 1) % 3, next_d = d - d % 3 + (d + 1) % 3;
            for (uint32_t s = 0; s < 2; ++s) {
                const uint32_t t = s ^ static_cast<uint32_t>(swaps[e]);
                root[find(static_cast<uint32_t>(2 * c + s))] = find(static_cast<uint32_t>(2 * next_d + t));
                root[find(static_cast<uint32_t>(2 * next_c + s))] = find(static_cast<uint32_t>(2 * d + t));
            }
        }
        std::map<uint32_t, uint32_t> number;
        for (uint32_t s = 0; s < 2; ++s)
            for (size_t c = 0; c < corners; ++c) {
                const auto made =
                    number.insert({find(static_cast<uint32_t>(2 * c + s)), static_cast<uint32_t>(mesh.vertex_count())});
                if (made.second)
                    for (size_t k = 0; k < 3; ++k)
                        mesh.positions.push_back(base.positions[3 * size_t{base.triangles[c]} + k]);
                mesh.triangles.push_back(made.first->second);
            }
        mesh.genus = marks.size() / 2 - 1 + 2 * base.genus;
    }

    void find_edges(const LevelMesh& base, const LevelMesh& cover) {
        below.assign(cover.edge_count, 0);
        for (size_t c = 0; c < cover.triangle_edges.size(); ++c)
            below[cover.triangle_edges[c]] = base.triangle_edges[c % base.triangle_edges.size()];
    }
};

} // namespace

TEST(Marked, UnusableMarksAreRefused) {
    const TriMesh mesh = sphere(2, 0.1, 1);
    const auto build = [&](const Marks& marks, uint64_t count, const uint32_t* data) {
        hmf_hierarchy_options options = with_marks(marks);
        options.marked_vertices = data;
        options.marked_count = count;
        hmf_hierarchy* hierarchy = nullptr;
        hmf_error error{};
        const hmf_status status =
            hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                 mesh.triangle_count(), &options, nullptr, &hierarchy, &error);
        hmf_hierarchy_destroy(hierarchy);
        return std::make_pair(status, std::string(error.message));
    };
    const Marks three = {1, 2, 3}, twice = {1, 2, 3, 4, 2}, beyond = {1, 2, 3, 4, 66}, four = {5, 9, 17, 33};
    EXPECT_EQ(build(three, 0, nullptr).first, HMF_ERROR_MESH_GENUS);
    EXPECT_EQ(build(three, 3, three.data()).first, HMF_ERROR_MESH_GENUS);
    EXPECT_NE(build(three, 3, three.data()).second.find("Mark four vertices or more"), std::string::npos);
    EXPECT_EQ(build(twice, 5, twice.data()).first, HMF_ERROR_OPTIONS);
    EXPECT_NE(build(twice, 5, twice.data()).second.find("Vertex 2 is marked twice"), std::string::npos);
    EXPECT_EQ(build(beyond, 5, beyond.data()).first, HMF_ERROR_MESH_INDEX);
    EXPECT_EQ(build(four, 4, nullptr).first, HMF_ERROR_NULL);
    EXPECT_EQ(build(four, 4, four.data()).first, HMF_OK);
}

TEST(Marked, StayInPlaceOnAllLevels) {
    const TriMesh mesh = sphere(5, 0.3, 2);
    Random random(3);
    const Marks marks = random_marks(mesh.vertex_count(), 30, random);
    for (const int32_t collapse : {HMF_COLLAPSE_MIDPOINT, HMF_COLLAPSE_ENDPOINT, HMF_COLLAPSE_QSLIM}) {
        hmf_hierarchy_options options = with_marks(marks, 0.5, 10);
        options.collapse = collapse;
        const Hierarchy hierarchy(mesh, options);
        ASSERT_TRUE(hierarchy);
        EXPECT_GT(hierarchy.levels(), 2u);
        std::set<std::array<double, 3>> wanted;
        for (const uint32_t m : marks)
            wanted.insert({mesh.positions[3 * m], mesh.positions[3 * m + 1], mesh.positions[3 * m + 2]});
        for (size_t level = 1; level < hierarchy.levels(); ++level) {
            const LevelMesh at = read_level(hierarchy, level);
            std::set<std::array<double, 3>> found;
            for (size_t m = 0; m < marks.size(); ++m)
                found.insert({at.positions[3 * m], at.positions[3 * m + 1], at.positions[3 * m + 2]});
            EXPECT_EQ(found, wanted) << "level " << level;
        }
    }
}

// |dx| across a flat cylinder, height sqrt(3) / 2 and circumference 2 in lengths of the edge.
TEST(Marked, PillowIsSolvedExactly) {
    const Marks marks = {0, 1, 2, 3};
    for (int variant = 0; variant < 3; ++variant) {
        const TriMesh mesh = variant == 0 ? tetrahedron(30)
                           : variant == 1 ? jittered_tetrahedron(37, 0.4, 5)
                                          : with_random_flips(jittered_tetrahedron(40, 0.3, 6), 20000, 1 - 1e-12, 7);
        ASSERT_EQ(mesh_defect(mesh), "");
        const Hierarchy hierarchy(mesh, with_marks(marks, 0.5, 60));
        ASSERT_TRUE(hierarchy);
        const LevelMesh level = read_level(hierarchy, 0);
        Loops loops;
        loops.add(section(
            level, [](const double* x) { return x[0] - 0.0123; }, [](const double*) { return 1.0; }));
        for (const int32_t method : {HMF_METHOD_NEWTON, HMF_METHOD_WHITEHEAD}) {
            const Solution solution =
                solve(hierarchy, &loops, solve_options(method, method == HMF_METHOD_NEWTON ? 0 : 1e-12));
            expect_report(solution, 0, 4);
            const double tolerance = method == HMF_METHOD_NEWTON ? 1e-9 : 1e-4;
            EXPECT_NEAR(solution.report.energy, 4 / std::sqrt(3.0), tolerance) << variant;
            if (method != HMF_METHOD_NEWTON) continue;
            EXPECT_LE(solution.report.residual_max, 1e-8);
            expect_marked_foliation(hierarchy, marks, solution.foliation);
            double largest = 0;
            for (size_t e = 0; e < level.edge_count; ++e) {
                const double d = level.positions[3 * level.edge_vertices[2 * e]]
                               - level.positions[3 * level.edge_vertices[2 * e + 1]];
                largest = std::max(largest, std::fabs(solution.values[e] - std::fabs(d) / 2));
            }
            EXPECT_LE(largest, 1e-8) << variant;
        }
    }
}

TEST(Marked, BranchedDoubleCoverAgrees) {
    Random random(11);
    for (const size_t count : {4, 6, 10, 16}) {
        SCOPED_TRACE(testing::Message() << count << " marks");
        const TriMesh mesh = sphere(4, 0.4, count);
        Marks marks;
        // No edge between two of them, or the cover would have two edges with the same ends.
        std::set<std::pair<uint32_t, uint32_t>> near;
        for (size_t c = 0; c < mesh.triangles.size(); ++c) {
            const uint32_t a = mesh.triangles[c], b = mesh.triangles[c - c % 3 + (c + 1) % 3];
            near.insert({a, b});
            near.insert({b, a});
        }
        while (marks.size() < count) {
            const uint32_t v = static_cast<uint32_t>(random.below(mesh.vertex_count()));
            bool free = true;
            for (const uint32_t m : marks) free = free && m != v && !near.count({m, v});
            if (free) marks.push_back(v);
        }
        const Hierarchy hierarchy(mesh, with_marks(marks, 0.5, 100));
        ASSERT_TRUE(hierarchy);
        const LevelMesh level = read_level(hierarchy, 0);
        Loops loops = library_loops(hierarchy, 0, HMF_LOOPS_PANTS);
        ASSERT_EQ(loops.count(), count - 3);
        for (size_t c = 0; c < loops.count(); ++c) loops.weights.push_back(1 + 0.125 * static_cast<double>(c));
        const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
        expect_report(solution, 0, count);

        DoubleCover cover(mesh, level, marks);
        ASSERT_EQ(mesh_defect(cover.mesh), "");
        const Hierarchy above(cover.mesh, 0.5, 100);
        ASSERT_TRUE(above);
        const LevelMesh level_above = read_level(above, 0);
        cover.find_edges(level, level_above);
        // The same initial foliation, lifted.
        const std::vector<double> start = values_of(initialize(hierarchy, loops));
        std::vector<double> lifted(level_above.edge_count);
        for (size_t e = 0; e < lifted.size(); ++e) lifted[e] = start[cover.below[e]];
        hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 0);
        const Foliation lifted_start = create(above, 0, lifted);
        options.start = lifted_start.get();
        const Solution double_solution = solve(above, nullptr, options);
        ASSERT_EQ(double_solution.status, HMF_OK) << double_solution.error.message;
        EXPECT_NEAR(solution.report.energy, 0.5 * double_solution.report.energy, 1e-10 * solution.report.energy);
        for (size_t e = 0; e < lifted.size(); ++e) lifted[e] = solution.values[cover.below[e]];
        EXPECT_LE(largest_difference(lifted, double_solution.values), 2e-8);
    }
}

// A pillow, and above it two sheets that meet in its corners and in two vertices more: genus 2, and both zeros are
// even, but (u, v) changes its sign around some loops, and what rounding leaves of the flux goes around one.
TEST(Marked, EvenZerosWithoutOrientation) {
    const TriMesh pillow = jittered_tetrahedron(24, 0.4, 5);
    const Marks corners = {0, 1, 2, 3};
    const Hierarchy below(pillow, with_marks(corners, 0.5, 60));
    ASSERT_TRUE(below);
    const LevelMesh level = read_level(below, 0);
    Loops loops;
    loops.add(section(
        level, [](const double* x) { return x[0] - 0.0123; }, [](const double*) { return 1.0; }));
    const Solution solution = solve(below, &loops, solve_options(HMF_METHOD_NEWTON, 0));
    expect_report(solution, 0, 4);
    // The two vertices nearest to two places inside of the faces, away from the critical leaves through the corners.
    Marks branches = corners;
    for (const double wanted : {-0.4, 0.3}) {
        uint32_t best = 0;
        const auto off = [&](uint32_t v) {
            const double* x = &pillow.positions[3 * size_t{v}];
            return std::fabs(x[0] - wanted) + std::fabs(x[1] - 0.2);
        };
        for (uint32_t v = 0; v < pillow.vertex_count(); ++v)
            if (off(v) < off(best)) best = v;
        branches.push_back(best);
    }
    DoubleCover cover(pillow, level, branches);
    ASSERT_EQ(mesh_defect(cover.mesh), "");
    ASSERT_EQ(cover.mesh.genus, 2u);
    const Hierarchy above(cover.mesh, 0.5, 60);
    ASSERT_TRUE(above);
    const LevelMesh level_above = read_level(above, 0);
    cover.find_edges(level, level_above);
    std::vector<double> lifted(level_above.edge_count);
    for (size_t e = 0; e < lifted.size(); ++e) lifted[e] = solution.values[cover.below[e]];
    const Foliation foliation = create(above, 0, lifted);
    const auto flat = make<hmf_parameterization>([&](hmf_parameterization** out, hmf_error* error) {
        return hmf_parameterize(foliation.get(), nullptr, nullptr, out, error);
    });
    ASSERT_TRUE(flat);
    EXPECT_NEAR(flat->area, 2 * solution.report.energy, 1e-4 * flat->area);
    EXPECT_NEAR(flat->dilatation_mean, 1, 1e-3);
    size_t turned = 0, zeros = 0;
    for (size_t e = 0; e < flat->edge_count; ++e) turned += flat->transition[3 * e] < 0;
    EXPECT_GT(turned, 0u);
    for (size_t v = 0; v < flat->vertex_count; ++v) {
        EXPECT_TRUE(flat->cone[v] == 2 || flat->cone[v] == 4) << v;
        zeros += flat->cone[v] == 4;
    }
    EXPECT_EQ(zeros, 2u);
    // Both sides of every edge are where its transition says, to the bit.
    std::vector<size_t> first(level_above.edge_count, SIZE_MAX);
    for (size_t c = 0; c < level_above.triangle_edges.size(); ++c) {
        const size_t e = level_above.triangle_edges[c], next = c - c % 3 + (c + 1) % 3;
        if (first[e] == SIZE_MAX) {
            first[e] = c;
            continue;
        }
        const size_t d = first[e], next_d = d - d % 3 + (d + 1) % 3;
        const double* g = &flat->transition[3 * e];
        for (size_t x = 0; x < 2; ++x) {
            ASSERT_EQ(g[0] * flat->corner_uv[2 * d + x] + g[1 + x], flat->corner_uv[2 * next + x]) << e;
            ASSERT_EQ(g[0] * flat->corner_uv[2 * next_d + x] + g[1 + x], flat->corner_uv[2 * c + x]) << e;
        }
    }
}

// A torus without zeros does not notice where it is marked.
TEST(Marked, OneMarkOnATorusChangesNothing) {
    const TriMesh mesh = torus(40, 20, 3, 1);
    const Marks marks = {123};
    const Hierarchy plain(mesh, 0.5, 100), marked(mesh, with_marks(marks, 0.5, 100));
    ASSERT_TRUE(plain);
    ASSERT_TRUE(marked);
    const Loops loops = meridian(plain, 0);
    const Solution a = solve(plain, &loops, solve_options(HMF_METHOD_NEWTON, 0));
    const Solution b = solve(marked, &loops, solve_options(HMF_METHOD_NEWTON, 0));
    expect_report(b, 1, 1);
    EXPECT_NEAR(a.report.energy, b.report.energy, 1e-11 * a.report.energy);
    EXPECT_LE(largest_difference(a.values, b.values), 1e-8);
}

// All leaves turn back at a marked vertex, so it is balanced wherever the foliation is: only the others can move.
TEST(Marked, ResidualIsOfTheOthers) {
    const Hierarchy hierarchy(sphere(3, 0.3, 4), with_marks({3, 40, 77, 90, 120, 131}, 0.5, 40));
    ASSERT_TRUE(hierarchy);
    const LevelMesh level = read_level(hierarchy, 0);
    const Foliation rough = interpolate(initialize(hierarchy, library_loops(hierarchy, hierarchy.coarsest())), 0);
    const Solution best = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
    const std::vector<double> before = residuals(rough, level.vertex_count);
    const std::vector<double> after = residuals(create(hierarchy, 0, best.values), level.vertex_count);
    for (const uint32_t mark : {3, 40, 77, 90, 120, 131}) {
        EXPECT_EQ(before[mark], 0) << mark;
        EXPECT_EQ(after[mark], 0) << mark;
    }
    EXPECT_GT(*std::max_element(before.begin(), before.end()), 0.01);
    EXPECT_LE(*std::max_element(after.begin(), after.end()), 1e-6);
}

TEST(Marked, LoopsAreChecked) {
    const TriMesh mesh = tetrahedron(12);
    const Marks marks = {0, 1, 2, 3};
    const Hierarchy hierarchy(mesh, with_marks(marks));
    ASSERT_TRUE(hierarchy);
    const LevelMesh level = read_level(hierarchy, 0);
    const auto everywhere = [](const double*) { return 1.0; };
    const auto at = [&](double x) {
        return section(
            level, [x](const double* p) { return p[0] - x; }, everywhere);
    };
    const auto round_corner = [&](double size) {
        return section(
            level, [size](const double* p) { return p[0] + p[1] + p[2] - size; }, everywhere);
    };
    const auto status = [&](const Loops& loops) {
        const hmf_loop_set view = loops.view();
        hmf_foliation* made = nullptr;
        const hmf_status found = hmf_foliation_from_loops(hierarchy.get(), &view, nullptr, &made, nullptr);
        hmf_foliation_destroy(made);
        return found;
    };
    Loops good, parallel, single, opposite;
    good.add(at(0.21));
    parallel.add(at(0.41));
    parallel.add(at(-0.41));
    single.add(round_corner(2.05));
    opposite.add(round_corner(-0.77)); // three on the other side
    EXPECT_EQ(status(good), HMF_OK);
    EXPECT_EQ(status(parallel), HMF_ERROR_LOOP_PARALLEL);
    EXPECT_EQ(status(single), HMF_ERROR_LOOP_TRIVIAL);
    EXPECT_EQ(status(opposite), HMF_ERROR_LOOP_TRIVIAL);
    // With a further mark between them, they are two classes.
    Marks five = marks;
    double least = 1e9;
    five.push_back(0);
    for (uint32_t v = 4; v < level.vertex_count; ++v) {
        const double* p = &mesh.positions[3 * v];
        if (std::fabs(p[0]) + std::fabs(p[1] - 0.4) < least) {
            least = std::fabs(p[0]) + std::fabs(p[1] - 0.4);
            five.back() = v;
        }
    }
    const Hierarchy more(mesh, with_marks(five));
    ASSERT_TRUE(more);
    const Solution solution = solve(more, &parallel, solve_options(HMF_METHOD_NEWTON, 0));
    expect_report(solution, 0, 5);
    expect_marked_foliation(more, five, solution.foliation);
    // A path of vertices passes a mark on one side.
    Loops path;
    path.kind = HMF_PATH_VERTICES;
    path.add({level.edge_vertices[0], level.edge_vertices[1], 0});
    EXPECT_EQ(status(path), HMF_ERROR_LOOP_CROSSING);
}

TEST(Marked, LibraryLoops) {
    Random random(21);
    for (const size_t count : {4, 5, 6, 9, 24}) {
        const TriMesh mesh = sphere(4, 0.3, count);
        const Marks marks = random_marks(mesh.vertex_count(), count, random);
        const Hierarchy hierarchy(mesh, with_marks(marks, 0.5, 150));
        ASSERT_TRUE(hierarchy);
        for (size_t level = 0; level < hierarchy.levels(); ++level) {
            EXPECT_EQ(library_loops(hierarchy, level, HMF_LOOPS_CUT).count(), count == 4 ? 1 : count / 2);
            EXPECT_EQ(library_loops(hierarchy, level, HMF_LOOPS_PANTS).count(), count - 3);
        }
        hmf_loop_set* none = nullptr;
        EXPECT_EQ(hmf_loops(hierarchy.get(), 0, HMF_LOOPS_HANDLE, nullptr, &none, nullptr), HMF_ERROR_MESH_GENUS);
        // By default, and from the same loops given on the finest level.
        const Solution by_default = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
        expect_report(by_default, 0, count);
        const Loops cut = library_loops(hierarchy, 0, HMF_LOOPS_CUT);
        const Solution given = solve(hierarchy, &cut, solve_options(HMF_METHOD_NEWTON, 0));
        EXPECT_NEAR(by_default.report.energy, given.report.energy, 1e-10 * given.report.energy);
    }
    const TriMesh mesh = pretzel(2, 2);
    for (const size_t count : {1, 2, 7}) {
        const Marks marks = random_marks(mesh.vertex_count(), count, random);
        const Hierarchy hierarchy(mesh, with_marks(marks, 0.5, 150));
        ASSERT_TRUE(hierarchy);
        EXPECT_EQ(library_loops(hierarchy, 0, HMF_LOOPS_CUT).count(), 2u);
        EXPECT_EQ(library_loops(hierarchy, 0, HMF_LOOPS_HANDLE).count(), 2u);
        const Loops pants = library_loops(hierarchy, 0, HMF_LOOPS_PANTS);
        EXPECT_EQ(pants.count(), 3 + count);
        const Solution solution = solve(hierarchy, &pants, solve_options(HMF_METHOD_NEWTON, 0));
        expect_report(solution, 2, count);
    }
}

// Energies must not depend on the hierarchy, and the values go through all levels.
// HMF_MARKED_CASES: number of cases; 500 take a few minutes.
TEST(Marked, RandomMarks) {
    const size_t cases = std::getenv("HMF_MARKED_CASES") ? std::strtoul(std::getenv("HMF_MARKED_CASES"), nullptr, 10)
                                                         : sample<size_t>(24, 8);
    Random random(31);
    for (size_t n = 0; n < cases; ++n) {
        const size_t count = 4 + random.below(n % 4 == 3 ? 97 : 20);
        SCOPED_TRACE(testing::Message() << "case " << n << ", " << count << " marks");
        TorusOptions shape;
        shape.jitter = 0.3;
        shape.seed = n;
        shape.random_diagonals = true;
        const TriMesh mesh = n % 2 ? torus(36, 18, 3, 1 + random.unit(), shape) : sphere(4, 0.5 * random.unit(), n);
        const Marks marks = random_marks(mesh.vertex_count(), count, random);
        Loops loops;
        Solution first;
        for (const double ratio : {0.5, 0.25}) {
            const Hierarchy hierarchy(mesh, with_marks(marks, ratio, 60));
            ASSERT_TRUE(hierarchy);
            if (loops.count() == 0)
                loops = library_loops(hierarchy, 0, random.below(2) ? HMF_LOOPS_PANTS : HMF_LOOPS_CUT);
            Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
            expect_report(solution, mesh.genus, count);
            EXPECT_LE(solution.report.residual_max, 1e-8);
            if (first.values.empty()) {
                expect_marked_foliation(hierarchy, marks, solution.foliation);
                // Down and up again.
                const Foliation coarse = interpolate(solution.foliation, hierarchy.coarsest());
                expect_marked_foliation(hierarchy, marks, coarse);
                const Foliation fine = interpolate(coarse, 0);
                expect_marked_foliation(hierarchy, marks, fine);
                if (n % 6 == 0) {
                    const Solution moved = relax(fine, solve_options(HMF_METHOD_NEWTON, 0));
                    EXPECT_NEAR(moved.report.energy, solution.report.energy, 1e-10 * solution.report.energy);
                }
                for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
                    if (n % 8 > 1) continue;
                    const Solution swept = solve(hierarchy, &loops, solve_options(method, 1e-5));
                    expect_report(swept, mesh.genus, count);
                    EXPECT_GE(swept.report.energy, solution.report.energy * (1 - 1e-9));
                    EXPECT_LE(swept.report.energy, solution.report.energy * 1.05);
                }
                first = std::move(solution);
            } else {
                EXPECT_NEAR(solution.report.energy, first.report.energy, 1e-10 * first.report.energy);
                EXPECT_LE(largest_difference(solution.values, first.values), 1e-7);
            }
        }
    }
}

TEST(Marked, LeavesAndParameterization) {
    Random random(41);
    for (const size_t count : {4, 7, 12}) {
        SCOPED_TRACE(testing::Message() << count << " marks");
        const TriMesh mesh = sphere(5, 0.4, count);
        const Marks marks = random_marks(mesh.vertex_count(), count, random);
        const Hierarchy hierarchy(mesh, with_marks(marks));
        ASSERT_TRUE(hierarchy);
        Loops loops = library_loops(hierarchy, 0, HMF_LOOPS_PANTS);
        for (size_t c = 0; c < loops.count(); ++c) loops.weights.push_back(1 + 0.0625 * static_cast<double>(c));
        const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
        expect_report(solution, 0, count);
        const hmf_foliation* f = solution.foliation.get();
        // Cylinders as high as the loops weigh.
        const hmf_loop_set view = loops.view();
        const auto cylinders = make<hmf_cylinder_set>(
            [&](hmf_cylinder_set** out, hmf_error* error) { return hmf_cylinders(f, &view, nullptr, out, error); });
        ASSERT_TRUE(cylinders);
        ASSERT_EQ(cylinders->count, loops.count());
        double area = 0;
        for (size_t c = 0; c < cylinders->count; ++c) {
            EXPECT_DOUBLE_EQ(cylinders->list[c].height, loops.weights[cylinders->list[c].loop]);
            area += cylinders->list[c].height * cylinders->list[c].circumference;
        }
        EXPECT_NEAR(area, solution.report.energy, 1e-9 * area);
        // Critical leaves: half of the prongs, each marked vertex one and each zero three.
        hmf_trace_options trace{};
        trace.struct_size = sizeof trace;
        trace.critical = 1;
        const auto lines = make<hmf_lines>(
            [&](hmf_lines** out, hmf_error* error) { return hmf_trace(f, &trace, nullptr, out, error); });
        ASSERT_TRUE(lines);
        EXPECT_LE(lines->line_count, (count + 3 * (count - 4)) / 2);
        EXPECT_GE(lines->line_count, loops.count());
        // A flat metric of that area whose cone angles add up.
        const auto flat = make<hmf_parameterization>([&](hmf_parameterization** out, hmf_error* error) {
            return hmf_parameterize(f, nullptr, nullptr, out, error);
        });
        ASSERT_TRUE(flat);
        EXPECT_NEAR(flat->area, solution.report.energy, 5e-3 * flat->area);
        EXPECT_LT(flat->dilatation_median, 1.3);
        long sum = 0, of_marks = 0;
        for (size_t v = 0; v < flat->vertex_count; ++v) sum += 2 - flat->cone[v];
        for (const uint32_t m : marks) of_marks += flat->cone[m] == 1;
        EXPECT_EQ(sum, 4);
        EXPECT_GE(of_marks, static_cast<long>(count) - 1);
        // Quads: closed, and no vertex has two of them.
        const auto quads = make<hmf_quad_mesh>(
            [&](hmf_quad_mesh** out, hmf_error* error) { return hmf_quads(f, nullptr, nullptr, out, error); });
        ASSERT_TRUE(quads);
        std::set<std::pair<uint32_t, uint32_t>> sides;
        std::vector<int> valence(quads->vertex_count, 0);
        for (size_t c = 0; c < 4 * quads->quad_count; ++c) {
            ++valence[quads->quads[c]];
            EXPECT_TRUE(sides.insert({quads->quads[c], quads->quads[c - c % 4 + (c + 1) % 4]}).second);
        }
        for (const auto& side : sides) EXPECT_TRUE(sides.count({side.second, side.first}));
        EXPECT_EQ(quads->vertex_count + quads->quad_count - sides.size() / 2, 2u);
        for (const int v : valence) EXPECT_GE(v, 3);
    }
}

// Spikes on a sphere are the tips; each gets two marks, and the loops of the library go around the spikes.
TEST(Marked, SuggestedMarksAreAtTips) {
    TriMesh mesh = sphere(5, 0, 3);
    const double spike[5][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6, -0.64, -0.48}};
    const auto spike_at = [&](const double* x) {
        int best = -1;
        const double r = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        for (int k = 0; k < 5; ++k)
            if ((x[0] * spike[k][0] + x[1] * spike[k][1] + x[2] * spike[k][2]) / r > 0.97) best = k;
        return best;
    };
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        double* x = &mesh.positions[3 * v];
        const int k = spike_at(x);
        if (k < 0) continue;
        const double c = x[0] * spike[k][0] + x[1] * spike[k][1] + x[2] * spike[k][2];
        const double grown = 1 + 60 * (c - 0.97) / std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        for (int a = 0; a < 3; ++a) x[a] *= std::max(1.0, grown);
    }
    const auto suggest = [](const TriMesh& m) {
        const auto set = make<hmf_mark_set>([&](hmf_mark_set** out, hmf_error* error) {
            return hmf_suggest_marks(m.positions.data(), m.vertex_count(), m.triangles.data(), m.triangle_count(),
                                     nullptr, nullptr, out, error);
        });
        return set ? Marks(set->marked_vertices, set->marked_vertices + set->marked_count) : Marks();
    };
    const Marks marks = suggest(mesh);
    EXPECT_EQ(marks, suggest(mesh));
    ASSERT_EQ(marks.size(), 10u);
    std::vector<int> at(5, 0);
    for (const uint32_t m : marks) {
        const int k = spike_at(&mesh.positions[3 * m]);
        ASSERT_GE(k, 0);
        ++at[static_cast<size_t>(k)];
    }
    EXPECT_EQ(at, std::vector<int>(5, 2));
    const Hierarchy hierarchy(mesh, with_marks(marks));
    const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 0));
    expect_report(solution, 0, 10);
    // Four at least, on any sphere; none where there are handles.
    EXPECT_EQ(suggest(sphere(3, 0, 1)).size(), 4u);
    EXPECT_EQ(suggest(tetrahedron(1)).size(), 4u);
    EXPECT_TRUE(suggest(torus(20, 10, 3, 1)).empty());
}

// Real meshes of genus 0, where there are any: HMF_SURFACES names the folder.
TEST(Marked, RealSurfaces) {
    const char* folder = std::getenv("HMF_SURFACES");
    if (!folder) GTEST_SKIP() << "skipped: set HMF_SURFACES to a folder of OBJ meshes";
    std::error_code failure;
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder, failure))
        if (entry.path().extension() == ".obj") paths.push_back(entry.path().string());
    std::sort(paths.begin(), paths.end());
    Random random(51);
    for (const std::string& path : paths) {
        TriMesh mesh;
        if (!read_obj(path, mesh) || mesh.triangle_count() + 4 != 2 * mesh.vertex_count()
            || mesh.vertex_count() > sample<size_t>(SIZE_MAX, 5000))
            continue;
        for (const size_t count : {4, 12}) {
            SCOPED_TRACE(path + ", " + std::to_string(count) + " marks");
            const Marks marks = random_marks(mesh.vertex_count(), count, random);
            const hmf_hierarchy_options options = with_marks(marks);
            hmf_hierarchy* probe = nullptr;
            if (hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                     mesh.triangle_count(), &options, nullptr, &probe, nullptr))
                break; // no closed sphere
            hmf_hierarchy_destroy(probe);
            const Hierarchy hierarchy(mesh, options);
            for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
                const Loops loops = library_loops(hierarchy, 0, kind);
                const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
                expect_report(solution, 0, count);
                EXPECT_LE(solution.report.residual_max, 1e-8);
            }
        }
    }
}

} // namespace test_marked
