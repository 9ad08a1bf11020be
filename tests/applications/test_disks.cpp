// What the library proposes by itself for surfaces with boundary: marked vertices and arcs of a disk, and what it
// refuses there.
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Sparse>

#include <algorithm>
#include <cmath>
#include <utility>
#include <set>
#include <map>

namespace test_disks {

using namespace test;

namespace {

// A sheet of n x m cells over a x b, bent by `height` along a, its inner vertices shifted by up to jitter / 2.
TriMesh sheet(size_t n, size_t m, double a, double b, double height, double jitter, uint64_t seed = 5) {
    TriMesh mesh;
    Random random(seed);
    for (size_t i = 0; i <= n; ++i)
        for (size_t j = 0; j <= m; ++j) {
            const bool inside = i > 0 && i < n && j > 0 && j < m;
            const double x = static_cast<double>(i) + (inside ? jitter * (random.unit() - 0.5) : 0);
            const double y = static_cast<double>(j) + (inside ? jitter * (random.unit() - 0.5) : 0);
            mesh.positions.insert(mesh.positions.end(), {a * x / static_cast<double>(n), b * y / static_cast<double>(m),
                                                         height * std::sin(3 * x / static_cast<double>(n))});
        }
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < m; ++j) {
            const uint32_t p = static_cast<uint32_t>(i * (m + 1) + j), q = p + 1,
                           r = static_cast<uint32_t>((i + 1) * (m + 1) + j), s = r + 1;
            mesh.triangles.insert(mesh.triangles.end(), {p, r, s, p, s, q});
        }
    return mesh;
}

// The boundary, one vertex after the other.
std::vector<uint32_t> boundary_of(const TriMesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> sides;
    for (size_t c = 0; c < mesh.triangles.size(); ++c)
        ++sides[{mesh.triangles[c], mesh.triangles[c - c % 3 + (c + 1) % 3]}];
    std::map<uint32_t, uint32_t> next;
    for (const auto& side : sides)
        if (!sides.count({side.first.second, side.first.first})) next[side.first.first] = side.first.second;
    std::vector<uint32_t> walk{next.begin()->first};
    while (next[walk.back()] != walk.front()) walk.push_back(next[walk.back()]);
    EXPECT_EQ(walk.size(), next.size());
    return walk;
}

double distance(const TriMesh& mesh, uint32_t v, uint32_t w) {
    double sum = 0;
    for (size_t c = 0; c < 3; ++c) {
        const double d = mesh.positions[3 * v + c] - mesh.positions[3 * w + c];
        sum += d * d;
    }
    return std::sqrt(sum);
}

// Energy of the harmonic function that is 0 and 1 on two parts of the boundary, free on the rest.
double linear_energy(const LevelMesh& mesh, const std::map<uint32_t, double>& fixed) {
    std::vector<Eigen::Triplet<double>> entries;
    const auto n = static_cast<int>(mesh.vertex_count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (const auto& f : fixed) {
        entries.emplace_back(static_cast<int>(f.first), static_cast<int>(f.first), 1);
        right[f.first] = f.second;
    }
    for (size_t e = 0; e < mesh.edge_count; ++e)
        for (size_t k = 0; k < 2; ++k) {
            const uint32_t v = mesh.edge_vertices[2 * e + k], w = mesh.edge_vertices[2 * e + 1 - k];
            if (fixed.count(v)) continue;
            entries.emplace_back(static_cast<int>(v), static_cast<int>(v), mesh.weights[e]);
            entries.emplace_back(static_cast<int>(v), static_cast<int>(w), -mesh.weights[e]);
        }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
    const Eigen::VectorXd u = solver.solve(right);
    double sum = 0;
    for (size_t e = 0; e < mesh.edge_count; ++e) {
        const double d = u[mesh.edge_vertices[2 * e]] - u[mesh.edge_vertices[2 * e + 1]];
        sum += mesh.weights[e] * d * d;
    }
    return sum;
}

} // namespace

// Four of a boundary without corners, as far from one another along it as whole edges allow; the first is a vertex
// farthest from the middle.
TEST(Disks, SuggestedMarksDivideTheBoundary) {
    for (const double height : {0.0, 0.7}) {
        TriMesh mesh = sheet(20, 14, 2, 2, 0, 0.5);
        for (size_t v = 0; v < mesh.vertex_count(); ++v) { // the square becomes an ellipse
            double* const p = &mesh.positions[3 * v];
            const double x = p[0] - 1, y = p[1] - 1;
            p[0] = 1.5 * x * std::sqrt(1 - y * y / 2);
            p[1] = y * std::sqrt(1 - x * x / 2);
            p[2] = height * std::sin(p[0]);
        }
        const std::vector<uint32_t> marks = suggested_marks(mesh), walk = boundary_of(mesh);
        ASSERT_EQ(marks.size(), 4u);
        EXPECT_EQ(suggested_marks(mesh), marks);
        std::vector<double> at; // along the boundary, from its first vertex on
        double length = 0, longest = 0;
        std::vector<double> place(mesh.vertex_count(), -1);
        for (size_t k = 0; k < walk.size(); ++k) {
            place[walk[k]] = length;
            const double side = distance(mesh, walk[k], walk[(k + 1) % walk.size()]);
            length += side;
            longest = std::max(longest, side);
        }
        double middle[3] = {0, 0, 0};
        for (const uint32_t v : walk)
            for (size_t c = 0; c < 3; ++c) middle[c] += mesh.positions[3 * v + c] / static_cast<double>(walk.size());
        const auto from_middle = [&](uint32_t v) {
            return std::hypot(mesh.positions[3 * v] - middle[0], mesh.positions[3 * v + 1] - middle[1],
                              mesh.positions[3 * v + 2] - middle[2]);
        };
        double farthest = 0;
        for (const uint32_t v : walk) farthest = std::max(farthest, from_middle(v));
        bool has_farthest = false;
        for (const uint32_t v : marks) {
            ASSERT_GE(place[v], 0) << "vertex " << v << " is not on the boundary";
            at.push_back(place[v]);
            has_farthest |= from_middle(v) >= farthest - 1e-12;
        }
        EXPECT_TRUE(has_farthest);
        std::sort(at.begin(), at.end());
        for (size_t k = 0; k < 4; ++k) {
            const double gap = k < 3 ? at[k + 1] - at[k] : at[0] + length - at[3];
            EXPECT_NEAR(gap, length / 4, longest * 1.001);
        }
    }
}

// A hexagon of triangles with unit sides, n along each side.
TriMesh hexagon(int n) {
    TriMesh mesh;
    std::map<std::pair<int, int>, uint32_t> number;
    const auto vertex = [&](int i, int j) {
        const auto [place, is_new] = number.try_emplace({i, j}, static_cast<uint32_t>(number.size()));
        if (is_new) mesh.positions.insert(mesh.positions.end(), {i + 0.5 * j, std::sqrt(0.75) * j, 0.0});
        return place->second;
    };
    const auto inside = [n](int i, int j) { return std::max({std::abs(i), std::abs(j), std::abs(i + j)}) <= n; };
    for (int i = -n; i <= n; ++i)
        for (int j = -n; j <= n; ++j) {
            if (!inside(i + 1, j) || !inside(i, j + 1)) continue;
            if (inside(i, j))
                mesh.triangles.insert(mesh.triangles.end(), {vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
            if (inside(i + 1, j + 1))
                mesh.triangles.insert(mesh.triangles.end(), {vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    return mesh;
}

// All corners where they are four, however far apart; of six some.
TEST(Disks, SuggestedMarksAreCorners) {
    for (const double width : {3.0, 12.0}) {
        const TriMesh mesh = sheet(24, 12, width, 2, 0, 0.5);
        std::set<std::pair<double, double>> places;
        for (const uint32_t v : suggested_marks(mesh))
            places.insert({mesh.positions[3 * v], mesh.positions[3 * v + 1]});
        EXPECT_EQ(places, (std::set<std::pair<double, double>>{{0, 0}, {width, 0}, {0, 2}, {width, 2}}));
    }
    const TriMesh six = hexagon(12);
    const std::vector<uint32_t> marks = suggested_marks(six);
    EXPECT_EQ(std::set<uint32_t>(marks.begin(), marks.end()).size(), 4u);
    for (const uint32_t v : marks) EXPECT_NEAR(std::hypot(six.positions[3 * v], six.positions[3 * v + 1]), 12, 1e-9);
}

// A bag: its boundary is short, so the marks are tips and lie inside as on a sphere.
TEST(Disks, ShortBoundaryHasNoCorners) {
    TriMesh mesh = sheet(30, 30, 1, 1, 0, 0.5);
    // Pulled over a sphere: the square becomes all of it but a hole around the pole.
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        double* const p = &mesh.positions[3 * v];
        const double x = 2 * p[0] - 1, y = 2 * p[1] - 1, r = std::max(std::fabs(x), std::fabs(y));
        const double round = r > 0 ? r / std::hypot(x, y) : 0, angle = 2.9 * r; // of pi at the pole
        p[0] = (r > 0 ? x * round / r : 1) * std::sin(angle);
        p[1] = (r > 0 ? y * round / r : 0) * std::sin(angle);
        p[2] = 3 * std::cos(angle); // a long egg
    }
    const std::vector<uint32_t> marks = suggested_marks(mesh), walk = boundary_of(mesh);
    size_t on_boundary = 0;
    for (const uint32_t v : marks) on_boundary += static_cast<size_t>(std::count(walk.begin(), walk.end(), v));
    EXPECT_LT(on_boundary, marks.size());
    EXPECT_GE(2 * marks.size() - on_boundary, 4u); // one inside counts as two
    const Hierarchy hierarchy(mesh, with_marks(marks));
    ASSERT_TRUE(hierarchy);
    const auto f = make<hmf_foliation>(
        [&](auto out, hmf_error* e) { return hmf_solve_cut_system(hierarchy.get(), nullptr, nullptr, out, e); });
    ASSERT_TRUE(f);
    EXPECT_EQ(hmf_foliation_report(f.get())->poles, 0u);
}

// The arc that the library makes for four marked vertices goes from side to side: the energy is that of the linear
// problem between two opposite sides.  The cells are rectangles, so that the caller's triangles are Delaunay.
TEST(Disks, ArcsOfTheLibraryAreTheLinearProblem) {
    for (const double height : {0.0, 0.7}) {
        const TriMesh mesh = sheet(20, 14, 3, 2, height, 0);
        const std::vector<uint32_t> walk = boundary_of(mesh);
        const size_t n = walk.size(), corner[4] = {0, n / 5, n / 2, 3 * n / 4};
        std::vector<uint32_t> marks;
        for (const size_t k : corner) marks.push_back(walk[k]);
        const Hierarchy hierarchy(mesh, with_marks(marks));
        ASSERT_TRUE(hierarchy);
        const LevelMesh level = read_level(hierarchy, 0);
        double possible[2];
        for (size_t way = 0; way < 2; ++way) {
            std::map<uint32_t, double> fixed;
            for (size_t side = way; side < 4; side += 2)
                for (size_t k = corner[side]; k <= (side < 3 ? corner[side + 1] : n); ++k)
                    fixed[walk[k % n]] = side < 2 ? 0 : 1;
            possible[way] = linear_energy(level, fixed);
        }
        for (const int32_t kind :
             std::initializer_list<int32_t>{0, HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) { // 0: those of hmf_solve_cut_system
            Owned<hmf_loop_set> set;
            if (kind)
                set = make<hmf_loop_set>(
                    [&](auto out, hmf_error* e) { return hmf_loops(hierarchy.get(), 0, kind, nullptr, out, e); });
            if (set) {
                ASSERT_EQ(set->count, 1u);
                ASSERT_TRUE(set->arcs && set->arcs[0]);
            }
            const auto f = make<hmf_foliation>([&](auto out, hmf_error* e) {
                return set ? hmf_solve(hierarchy.get(), set.get(), nullptr, nullptr, out, e)
                           : hmf_solve_cut_system(hierarchy.get(), nullptr, nullptr, out, e);
            });
            ASSERT_TRUE(f);
            const double found = hmf_foliation_report(f.get())->energy;
            EXPECT_LT(std::min(std::fabs(found - possible[0]), std::fabs(found - possible[1])), 1e-7 * found)
                << found << " is none of " << possible[0] << " and " << possible[1];
            EXPECT_EQ(hmf_foliation_report(f.get())->poles, 0u);
        }
    }
}

TEST(Disks, Refusals) {
    const TriMesh mesh = sheet(20, 14, 3, 2, 0, 0.5);
    const std::vector<uint32_t> marks = suggested_marks(mesh);
    const Hierarchy disk(mesh, with_marks(marks)), closed(torus(12, 8, 3, 1));
    ASSERT_TRUE(disk && closed);
    const auto refused = [](const Hierarchy& h, const hmf_loop_set& set, hmf_status expected) {
        hmf_foliation* made = nullptr;
        hmf_error error{};
        EXPECT_EQ(hmf_solve(h.get(), &set, nullptr, nullptr, &made, &error), expected) << error.message;
        EXPECT_EQ(made, nullptr);
    };
    Loops loops;
    loops.add({0, 1, 2});
    const uint8_t arc = 1;
    hmf_loop_set set = loops.view();
    set.level = 1;
    if (disk.levels() > 1) refused(disk, set, HMF_ERROR_LEVEL); // levels of the double
    set.level = 0;
    const uint64_t empty[2] = {0, 0};
    set.offsets = empty;
    refused(disk, set, HMF_ERROR_LOOP_COUNT);
    Loops ring = meridian(closed, 0);
    hmf_loop_set closed_set = ring.view();
    closed_set.arcs = &arc;
    refused(closed, closed_set, HMF_ERROR_LOOP_NOT_CLOSED); // no boundary to end at
    hmf_loop_set* made = nullptr;
    hmf_error error{};
    EXPECT_EQ(hmf_loops(disk.get(), 0, 99, nullptr, &made, &error), HMF_ERROR_OPTIONS);
    EXPECT_EQ(hmf_loops(disk.get(), 0, HMF_LOOPS_HANDLE, nullptr, &made, &error), HMF_ERROR_MESH_BOUNDARY);
    EXPECT_EQ(made, nullptr);
}

} // namespace test_disks
