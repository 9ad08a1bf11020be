// Loops that the library makes: handle and tunnel loops against linking
// integrals, lengths against a search on the level itself.
#include "support/implicit_surface.hpp"
#include "support/read_obj.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>

#include "src/core/base/disjoint_sets.hpp"
#include "src/applications/loops/carry_loops.hpp"
#include "src/core/curves/cut_surface.hpp"
#include "src/core/curves/disjoint.hpp"
#include "src/applications/loops/handle_system.hpp"
#include "src/applications/loops/library_loops.hpp"
#include "src/applications/loops/linking.hpp"

namespace test_library_loops {

using namespace test;

namespace {

using Point = std::array<double, 3>;
Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point operator+(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Point operator*(double s, const Point& a) { return {s * a[0], s * a[1], s * a[2]}; }
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Point unit(const Point& a) { return (1 / std::sqrt(dot(a, a))) * a; }

// A loop as a polygon over centers of triangles and middles of edges; pushed
// off by `offset` times the shortest height of the triangles along it.
std::vector<Point> polygon(const LevelMesh& mesh, const Loops& loops, size_t c, double offset) {
    const auto position = [&](uint32_t v) {
        return Point{mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]};
    };
    const auto corner = [&](uint32_t t, size_t s) { return position(mesh.triangle_vertices[3 * t + s]); };
    const std::vector<uint32_t> edges = crossed_edges(mesh, loops, c);
    std::vector<Point> points;
    double height = 1e300;
    const size_t first = loops.offsets[c], n = edges.size();
    const auto normal = [&](uint32_t t) {
        return unit(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
    };
    for (size_t i = 0; i < n; ++i) {
        const uint32_t t = loops.elements[first + i];
        const Point n2 = cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
        for (size_t s = 0; s < 3; ++s) {
            const Point side = corner(t, (s + 1) % 3) - corner(t, s);
            height = std::min(height, std::sqrt(dot(n2, n2) / dot(side, side)));
        }
    }
    for (size_t i = 0; i < n; ++i) {
        const uint32_t t = loops.elements[first + i], next = loops.elements[first + (i + 1) % n], e = edges[i];
        points.push_back(1.0 / 3 * (corner(t, 0) + corner(t, 1) + corner(t, 2)) + (offset * height) * normal(t));
        const Point middle = 0.5 * (position(mesh.edge_vertices[2 * e]) + position(mesh.edge_vertices[2 * e + 1]));
        points.push_back(middle + (offset * height) * unit(normal(t) + normal(next)));
    }
    return points;
}

// Solid angle over 4 pi of two segments (Gauss), summed.
double linking_integral(const std::vector<Point>& a, const std::vector<Point>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i)
        for (size_t j = 0; j < b.size(); ++j) {
            const Point p = a[i], q = a[(i + 1) % a.size()], r = b[j], s = b[(j + 1) % b.size()];
            // Signed area of the spherical quadrilateral of the directions from one segment to the other.
            const Point v[4] = {unit(r - p), unit(s - p), unit(s - q), unit(r - q)};
            const auto triangle = [](const Point& x, const Point& y, const Point& z) {
                return 2 * std::atan2(dot(x, cross(y, z)), 1 + dot(x, y) + dot(y, z) + dot(z, x));
            };
            sum += triangle(v[0], v[1], v[2]) + triangle(v[0], v[2], v[3]);
        }
    return sum / (4 * 3.14159265358979323846);
}

double volume(const LevelMesh& mesh) {
    double sum = 0;
    for (size_t t = 0; t < mesh.triangle_count; ++t) {
        Point p[3];
        for (size_t s = 0; s < 3; ++s)
            for (size_t k = 0; k < 3; ++k) p[s][k] = mesh.positions[3 * mesh.triangle_vertices[3 * t + s] + k];
        sum += dot(p[0], cross(p[1], p[2]));
    }
    return sum;
}

double determinant(std::vector<std::vector<double>> m) {
    double result = 1;
    for (size_t k = 0; k < m.size(); ++k) {
        size_t pivot = k;
        for (size_t i = k; i < m.size(); ++i)
            if (std::fabs(m[i][k]) > std::fabs(m[pivot][k])) pivot = i;
        if (m[pivot][k] == 0) return 0;
        if (pivot != k) result = -result;
        std::swap(m[pivot], m[k]);
        result *= m[k][k];
        for (size_t i = k + 1; i < m.size(); ++i)
            for (size_t j = m.size(); j-- > k;) m[i][j] -= m[i][k] / m[k][k] * m[k][j];
    }
    return result;
}

double length(const LevelMesh& mesh, const Loops& loops) {
    double sum = 0;
    for (size_t c = 0; c < loops.count(); ++c) {
        const std::vector<Point> p = polygon(mesh, loops, c, 0);
        for (size_t i = 0; i < p.size(); ++i) {
            const Point d = p[(i + 1) % p.size()] - p[i];
            sum += std::sqrt(dot(d, d));
        }
    }
    return sum;
}

// A status, and loops unless it is a failure.
hmf_status loops_status(const hmf_hierarchy* hierarchy, int32_t kind, hmf_error& error) {
    hmf_loop_set* set = nullptr;
    const hmf_status status = hmf_loops(hierarchy, 0, kind, nullptr, &set, &error);
    EXPECT_EQ(set != nullptr, status == HMF_OK);
    hmf_free(set);
    return status;
}

// Every handle loop bounds inside: its linking number with everything pushed
// outside is 0.  Handle and tunnel loops together span the homology, so that
// is enough to try; and pushed inside the linking matrix of the two must be
// invertible over the integers.
void expect_handles(const TriMesh& mesh) {
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    const LevelMesh fine = read_level(hierarchy, 0);
    const Loops handle = library_loops(hierarchy, 0, HMF_LOOPS_HANDLE),
                tunnel = library_loops(hierarchy, 0, HMF_LOOPS_TUNNEL);
    const size_t g = mesh.genus;
    ASSERT_EQ(handle.count(), g);
    ASSERT_EQ(tunnel.count(), g);
    EXPECT_TRUE(initialize(hierarchy, handle));
    EXPECT_TRUE(initialize(hierarchy, tunnel));
    const double out = volume(fine) > 0 ? 0.01 : -0.01;
    std::vector<std::vector<Point>> h, t, h_out, h_in, t_out, t_in;
    for (size_t c = 0; c < g; ++c) {
        h.push_back(polygon(fine, handle, c, 0));
        h_out.push_back(polygon(fine, handle, c, out));
        h_in.push_back(polygon(fine, handle, c, -out));
        t.push_back(polygon(fine, tunnel, c, 0));
        t_out.push_back(polygon(fine, tunnel, c, out));
        t_in.push_back(polygon(fine, tunnel, c, -out));
    }
    std::vector<std::vector<double>> linked(g, std::vector<double>(g));
    for (size_t i = 0; i < g; ++i)
        for (size_t j = 0; j < g; ++j) {
            EXPECT_NEAR(linking_integral(h[i], h_out[j]), 0, 1e-3) << i << " " << j;
            EXPECT_NEAR(linking_integral(h[i], t_out[j]), 0, 1e-3) << i << " " << j;
            EXPECT_NEAR(linking_integral(t[i], t_in[j]), 0, 1e-3) << i << " " << j;
            EXPECT_NEAR(linking_integral(t[i], h_in[j]), 0, 1e-3) << i << " " << j;
            linked[i][j] = linking_integral(h[i], t_in[j]);
            EXPECT_NEAR(linked[i][j], std::round(linked[i][j]), 1e-3);
            linked[i][j] = std::round(linked[i][j]);
        }
    EXPECT_NEAR(std::fabs(determinant(linked)), 1, 1e-6);
}

TriMesh flipped(TriMesh mesh) { // inside out
    for (size_t t = 0; t < mesh.triangle_count(); ++t) std::swap(mesh.triangles[3 * t], mesh.triangles[3 * t + 1]);
    return mesh;
}

TEST(HandleLoops, Torus) {
    expect_handles(torus(40, 16, 3, 1));
    // Longer around the tube than around the hole.
    expect_handles(torus(16, 40, 3, 2.7));
}

TEST(HandleLoops, InsideOut) { expect_handles(flipped(torus(40, 16, 3, 1))); }

TEST(HandleLoops, ShortestAreTheWrongOnes) {
    // A tall tube wall: the way through the hole is shorter than around the wall.
    const TriMesh mesh = torus(16, 40, 3, 2.7);
    const Hierarchy hierarchy(mesh);
    const LevelMesh fine = read_level(hierarchy, 0);
    EXPECT_LT(length(fine, library_loops(hierarchy, 0)),
              0.9 * length(fine, library_loops(hierarchy, 0, HMF_LOOPS_HANDLE)));
}

TEST(HandleLoops, Plates) {
    for (size_t g : {1, 2, 5}) expect_handles(plate(g));
    expect_handles(pretzel(3, 2));
}

TEST(HandleLoops, Trefoil) { expect_handles(trefoil(160, 10, 0.4)); }

TEST(HandleLoops, SurfaceThatMeetsItself) {
    // Two tori joined by a tube; one of them is pushed through the other.
    TriMesh mesh = joined_tori(24, 12, 8, 10);
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        if (mesh.positions[3 * v] > 4) mesh.positions[3 * v] -= 5.5;
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    hmf_error error{};
    const hmf_status status = loops_status(hierarchy.get(), HMF_LOOPS_HANDLE, error);
    EXPECT_TRUE(status == HMF_OK || status == HMF_ERROR_MESH_NOT_EMBEDDED) << error.message;
}

TEST(HandleLoops, SurfacesWithRandomPlaces) {
    // They meet themselves in all ways: there are loops, or the right reason why not.
    size_t made = 0, refused = 0;
    for (uint64_t seed = 250; seed < 360; ++seed) { // 256, 323 and 351 have linking numbers that fit, and no loops
        TriMesh mesh = plate(2);
        Random random(seed);
        for (int i = 0; i < 40; ++i) mesh.positions[random.below(mesh.positions.size())] += 4 * random.unit() - 2;
        hmf_hierarchy* hierarchy = nullptr;
        hmf_error error{};
        if (hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                 mesh.triangle_count(), nullptr, nullptr, &hierarchy, &error))
            continue;
        for (const int32_t kind : {HMF_LOOPS_HANDLE, HMF_LOOPS_TUNNEL}) {
            const hmf_status status = loops_status(hierarchy, kind, error);
            EXPECT_TRUE(status == HMF_OK || status == HMF_ERROR_MESH_NOT_EMBEDDED) << seed << ": " << error.message;
            ++(status ? refused : made);
        }
        hmf_hierarchy_destroy(hierarchy);
    }
    EXPECT_GT(made, 20u);
    EXPECT_GT(refused, 20u);
}

// Carried loops against a search on the fine level itself.
TEST(CarriedLoops, AsShortAsSearched) {
    for (const TriMesh& mesh : {pretzel(2, 3), torus(120, 48, 3, 1), trefoil(300, 16, 0.4)}) {
        const Hierarchy hierarchy(mesh, 0.5, 200), alone(mesh, 0, mesh.vertex_count());
        ASSERT_EQ(alone.levels(), 1u);
        ASSERT_GT(hierarchy.levels(), 3u);
        const LevelMesh fine = read_level(hierarchy, 0);
        // The first loop of a coarse level is not always the shortest on the fine one.
        EXPECT_LT(length(fine, library_loops(hierarchy, 0)), 1.05 * length(fine, library_loops(alone, 0)));
    }
}

TEST(CarriedLoops, SameClassOnEveryLevel) {
    const TriMesh mesh = pretzel(3, 3);
    const Hierarchy hierarchy(mesh, 0.5, 200);
    ASSERT_GT(hierarchy.levels(), 3u);
    for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_HANDLE, HMF_LOOPS_TUNNEL, HMF_LOOPS_PANTS}) {
        double first = 0;
        for (size_t level = 0; level < hierarchy.levels(); ++level) {
            Loops loops = library_loops(hierarchy, level, kind);
            EXPECT_TRUE(initialize(hierarchy, loops));
            for (size_t c = 0; c < loops.count(); ++c) loops.weights.push_back(1 + 0.25 * static_cast<double>(c));
            const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 1e-10));
            ASSERT_LT(solution.status, HMF_CANCELLED) << solution.error.message;
            if (level == 0) first = solution.report.energy;
            EXPECT_NEAR(solution.report.energy, first, 1e-10 * first) << "level " << level << " kind " << kind;
        }
    }
}

// Loops of the coarsest level on each finer one, without being shortened on the way.
struct Carried {
    hmf_error error{};
    hmf::Memory memory{nullptr, nullptr, nullptr, 0};
    hmf::Call call{memory, &error, nullptr, nullptr};
    hmf::LoopCarrier carrier;
    hmf::Loops loops;

    Carried(const hmf_hierarchy& h, int32_t kind) {
        const size_t level = h.level_count - 1;
        EXPECT_EQ(hmf::library_loops(h, level, kind, call, loops), HMF_OK) << error.message;
        EXPECT_TRUE(carrier.load(h, level, 0, loops, memory));
    }
    void refine() {
        EXPECT_TRUE(carrier.refine(call));
        EXPECT_TRUE(carrier.read(0, loops.count(), loops, call));
    }
    // Per edge, with signs: positive from the left of half-edge 2e.
    std::vector<int> crossings(size_t c) const {
        std::vector<int> sum(carrier.mesh().edge_count, 0);
        for (uint64_t i = loops.offsets[c]; i < loops.offsets[c + 1]; ++i) {
            const uint32_t h = loops.crossings[i];
            sum[hmf::edge_of(h)] += h % 2 ? -1 : 1;
        }
        return sum;
    }
    // How often a loop of another system crosses each of these from one side to the other: a walk along their left
    // sides meets its crossings.
    std::vector<int> intersections(const std::vector<int>& crossing) const {
        const hmf::Mesh& mesh = carrier.mesh();
        std::vector<int> sums;
        for (size_t c = 0; c < loops.count(); ++c) {
            const uint64_t begin = loops.offsets[c], end = loops.offsets[c + 1];
            sums.push_back(0);
            for (uint64_t i = begin; i < end; ++i) {
                const uint32_t in = hmf::twin(loops.crossings[i]);
                if (loops.crossings[i + 1 < end ? i + 1 : begin] != mesh.next[in]) continue;
                const uint32_t along = hmf::twin(mesh.prev(in));
                sums.back() += along % 2 ? -crossing[hmf::edge_of(along)] : crossing[hmf::edge_of(along)];
            }
        }
        return sums;
    }
};

TEST(CarriedLoops, KeepTheirDirections) {
    const Hierarchy hierarchy(with_random_flips(pretzel(3, 3), 1000, 0.2, 5), 0.5, 200);
    Carried handles(*hierarchy.get(), HMF_LOOPS_HANDLE), tunnels(*hierarchy.get(), HMF_LOOPS_TUNNEL);
    const auto matrix = [&] {
        std::vector<std::vector<int>> all;
        for (size_t c = 0; c < handles.loops.count(); ++c) all.push_back(tunnels.intersections(handles.crossings(c)));
        return all;
    };
    const std::vector<std::vector<int>> expected = matrix();
    for (size_t c = 0; c < expected.size(); ++c) EXPECT_NE(expected[c], std::vector<int>(expected.size(), 0)) << c;
    for (size_t level = hierarchy.coarsest(); level-- > 0;) {
        handles.refine();
        tunnels.refine();
        EXPECT_EQ(matrix(), expected) << "level " << level;
    }
}

TEST(CarriedLoops, Deterministic) {
    const Hierarchy a(pretzel(2, 3)), b(pretzel(2, 3));
    for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_HANDLE, HMF_LOOPS_TUNNEL, HMF_LOOPS_PANTS}) {
        const Loops x = library_loops(a, 0, kind), y = library_loops(b, 0, kind);
        EXPECT_EQ(x.offsets, y.offsets);
        EXPECT_EQ(x.elements, y.elements);
    }
}

// The loops of any hierarchy are those of the default one, found there and brought to it: also where its coarsest level
// is told to have as many vertices as by default, as it has others on the way there.
TEST(CutLoops, DoNotDependOnTheHierarchy) {
    const TriMesh mesh = with_random_flips(pretzel(2, 3), 2000, 0.3, 9);
    const uint64_t n = mesh.vertex_count();
    const Hierarchy usual(mesh);
    for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
        const auto energy_of = [&](const Hierarchy& hierarchy) {
            Loops loops = library_loops(hierarchy, 0, kind);
            for (size_t c = 0; c < loops.count(); ++c) loops.weights.push_back(1 + 0.25 * static_cast<double>(c));
            return solve(usual, &loops, solve_options(HMF_METHOD_NEWTON, 1e-10)).report.energy;
        };
        const double expected = energy_of(usual);
        for (const double ratio : {0.3, 0.5})
            for (const uint64_t coarsest : {uint64_t{0}, n / 16, n / 2}) {
                SCOPED_TRACE(coarsest);
                EXPECT_NEAR(energy_of(Hierarchy(mesh, ratio, coarsest)), expected, 1e-8 * expected) << ratio;
            }
        EXPECT_NEAR(energy_of(Hierarchy(mesh, 0, 0, HMF_COLLAPSE_QSLIM)), expected, 1e-8 * expected);
    }
}

// The loops cut the surface into pieces of Euler characteristic -1, all of
// them pairs of pants, as there are 2 genus - 2 and none is closed.
void expect_pants(const TriMesh& mesh) {
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    const size_t g = mesh.genus;
    for (const size_t level : {size_t{0}, hierarchy.coarsest()}) {
        hmf::Memory memory(nullptr, nullptr, nullptr, 0);
        hmf_error error{};
        hmf::Call call(memory, &error, nullptr, nullptr);
        hmf::Loops loops;
        const hmf::Mesh& on = hmf::loop_mesh(*hierarchy.get(), level);
        ASSERT_EQ(hmf::library_loops(*hierarchy.get(), level, HMF_LOOPS_PANTS, call, loops), HMF_OK) << error.message;
        ASSERT_EQ(loops.count(), g == 1 ? 1 : 3 * g - 3);
        EXPECT_EQ(hmf::check_loops(on, loops, call), HMF_OK) << error.message;
        hmf::Multicurve curves;
        hmf::CutSurface cut;
        ASSERT_TRUE(curves.allocate(on, memory));
        bool are_disjoint = false;
        ASSERT_TRUE(hmf::disjoint(on, loops, 0, loops.count(), curves, nullptr, call, are_disjoint));
        ASSERT_TRUE(are_disjoint);
        ASSERT_TRUE(cut.build(on, curves, false, call));
        std::vector<uint32_t> parent(cut.region_count);
        for (uint32_t r = 0; r < cut.region_count; ++r) parent[r] = r;
        for (size_t s = 0; s < cut.segment_count; ++s)
            hmf::unite(parent.data(), cut.region[2 * s], cut.region[2 * s + 1]);
        std::vector<long> euler(cut.region_count, 0);
        size_t pieces = 0;
        for (uint32_t r = 0; r < cut.region_count; ++r) {
            pieces += parent[r] == r;
            ++euler[hmf::find_root(parent.data(), r)];
        }
        for (size_t s = 0; s < cut.segment_count; ++s) --euler[hmf::find_root(parent.data(), cut.region[2 * s])];
        std::vector<bool> counted(on.vertex_count, false);
        for (size_t s = 0; s < cut.segment_count; ++s)
            for (size_t end = 0; end < 2; ++end) {
                const uint32_t point = cut.point[2 * s + end];
                if (point >= on.vertex_count || counted[point]) continue;
                counted[point] = true;
                ++euler[hmf::find_root(parent.data(), cut.region[2 * s])];
            }
        EXPECT_EQ(pieces, g == 1 ? 1 : 2 * g - 2);
        for (uint32_t r = 0; r < cut.region_count; ++r)
            if (parent[r] == r) { EXPECT_EQ(euler[r], g == 1 ? 0 : -1); }
    }
    const Loops loops = library_loops(hierarchy, 0, HMF_LOOPS_PANTS);
    const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
    EXPECT_EQ(solution.status, HMF_OK) << solution.error.message;
    EXPECT_EQ(solution.report.poles, 0u);
}

// How often cut loops of a plate report progress, which they do a few times for each search of the surface.
size_t reports_of_cut_loops(size_t holes) {
    const Hierarchy hierarchy(pretzel(holes, 1, 3));
    size_t calls = 0;
    hmf_control control{};
    control.struct_size = sizeof control;
    control.progress_user = &calls;
    control.progress = [](void* user, double) -> int32_t {
        ++*static_cast<size_t*>(user);
        return HMF_PROGRESS_CONTINUE;
    };
    hmf_loop_set* loops = nullptr;
    EXPECT_EQ(hmf_loops(hierarchy.get(), hierarchy.coarsest(), HMF_LOOPS_CUT, &control, &loops, nullptr), HMF_OK);
    if (loops) { EXPECT_EQ(loops->count, holes); }
    hmf_free(loops);
    return calls;
}

// One search serves for a batch of loops, so that ten times as many handles are at most ten times the work.  With a
// search of the whole surface for each loop it was 19 times.
TEST(CutLoops, SearchesAreSharedByManyLoops) {
    const size_t few = reports_of_cut_loops(12), many = reports_of_cut_loops(120);
    EXPECT_LT(many, 10 * few) << few << " " << many;
}

TEST(PantsLoops, Torus) { expect_pants(torus(40, 16, 3, 1)); }

TEST(PantsLoops, Plates) {
    for (size_t g : {2, 3, 6}) expect_pants(plate(g));
    expect_pants(pretzel(3, 2));
    expect_pants(joined_tori(24, 12, 8, 10));
}

// A ring with a small handle on it where it is narrowest, one foot on either side of that place: the
// shortest loop around the ring passes under the handle.
TriMesh ring_with_handle() {
    return implicit_surface(64, 0.1, [](double x, double y, double z) {
        const double u = x - 0.5, v = y - 0.5, w = z - 0.5, around = std::sqrt(u * u + v * v);
        const double narrow = around > 0 ? u / around : 0; // 1: in the middle between the feet
        const double ring = 0.12 - 0.04 * narrow - std::hypot(around - 0.3, w);
        const double handle = 0.022 - std::hypot(std::hypot(v, w - 0.08) - 0.055, u - 0.3);
        return std::max(ring, handle);
    });
}

// Does a loop of triangles cut the surface in two?  Then the vertices have two colors, which change at the
// edges that it crosses.
bool separates(const TriMesh& mesh, const uint32_t* loop, size_t n) {
    std::map<std::pair<uint32_t, uint32_t>, bool> crossed;
    std::vector<std::vector<uint32_t>> beside(mesh.vertex_count());
    for (size_t t = 0; t < mesh.triangles.size(); t += 3)
        for (size_t s = 0; s < 3; ++s) beside[mesh.triangles[t + s]].push_back(mesh.triangles[t + (s + 1) % 3]);
    for (size_t i = 0; i < n; ++i) {
        const uint32_t *const a = &mesh.triangles[3 * loop[i]], *const b = &mesh.triangles[3 * loop[(i + 1) % n]];
        for (size_t s = 0; s < 3; ++s)
            for (size_t r = 0; r < 3; ++r)
                if (a[s] == b[(r + 1) % 3] && a[(s + 1) % 3] == b[r]) {
                    bool& odd = crossed[std::minmax(a[s], a[(s + 1) % 3])];
                    odd = !odd;
                }
    }
    std::vector<int> color(mesh.vertex_count(), -1);
    std::vector<uint32_t> stack{0};
    color[0] = 0;
    while (!stack.empty()) {
        const uint32_t v = stack.back();
        stack.pop_back();
        for (const uint32_t w : beside[v]) {
            const auto found = crossed.find(std::minmax(v, w));
            const int expected = color[v] ^ (found != crossed.end() && found->second ? 1 : 0);
            if (color[w] == -1) stack.push_back(w);
            else if (color[w] != expected) return false;
            color[w] = expected;
        }
    }
    return true;
}

// The cut system crosses the neck of the handle, and pants have it all the same.
TEST(PantsLoops, NeckOfAHandleThatACutLoopPassesUnder) {
    const TriMesh mesh = ring_with_handle();
    ASSERT_EQ(mesh_defect(mesh), "");
    ASSERT_EQ(mesh.genus, 2u);
    expect_pants(mesh);
    const Hierarchy hierarchy(mesh);
    const Loops loops = library_loops(hierarchy, 0, HMF_LOOPS_PANTS);
    size_t necks = 0;
    for (size_t c = 0; c + 1 < loops.offsets.size(); ++c)
        necks += separates(mesh, &loops.elements[loops.offsets[c]], loops.offsets[c + 1] - loops.offsets[c]);
    EXPECT_EQ(necks, 1u);
}

// A finger of a triangle loop: over a side of one of its triangles, around the
// vertex beyond, and back.  Empty if the triangles there belong to the loops.
std::vector<uint32_t> with_finger(const LevelMesh& mesh, const Loops& loops, size_t c, size_t place) {
    std::vector<bool> used(mesh.triangle_count, false);
    for (const uint32_t t : loops.elements) used[t] = true;
    std::vector<std::vector<uint32_t>> beside(mesh.edge_count);
    for (uint32_t i = 0; i < 3 * mesh.triangle_count; ++i) beside[mesh.triangle_edges[i]].push_back(i / 3);
    const auto beyond = [&](uint32_t t, size_t s) {
        const std::vector<uint32_t>& two = beside[mesh.triangle_edges[3 * t + s]];
        return two[0] == t ? two[1] : two[0];
    };
    const std::vector<uint32_t> loop(loops.elements.begin() + static_cast<long>(loops.offsets[c]),
                                     loops.elements.begin() + static_cast<long>(loops.offsets[c + 1]));
    const uint32_t t = loop[place % loop.size()];
    for (size_t s = 0; s < 3; ++s) {
        const uint32_t first = beyond(t, s), edge = mesh.triangle_edges[3 * t + s];
        if (used[first]) continue;
        size_t side = 0;
        while (mesh.triangle_edges[3 * first + side] != edge) ++side;
        // Out on the side where the loop comes from: clockwise on its left.
        size_t before = 0;
        while (beyond(t, before) != loop[(place + loop.size() - 1) % loop.size()]) ++before;
        const bool clockwise = s == (before + 2) % 3;
        const uint32_t apex = mesh.triangle_vertices[3 * first + (side + 2) % 3];
        std::vector<uint32_t> fan = {t, first};
        bool free = true;
        for (uint32_t at = first;;) {
            size_t corner = 0;
            while (mesh.triangle_vertices[3 * at + corner] != apex) ++corner;
            at = beyond(at, clockwise ? corner : (corner + 2) % 3);
            fan.push_back(at);
            free = free && !used[at];
            if (at == first) break;
        }
        if (!free) continue;
        fan.push_back(t);
        std::vector<uint32_t> longer(loop.begin(), loop.begin() + static_cast<long>(place % loop.size()));
        longer.insert(longer.end(), fan.begin(), fan.end());
        longer.insert(longer.end(), loop.begin() + static_cast<long>(place % loop.size()) + 1, loop.end());
        return longer;
    }
    return {};
}

TEST(DrawnLoops, FingersDoNotMatter) {
    const TriMesh mesh = pretzel(2, 3);
    const Hierarchy hierarchy(mesh, 0.5, 200);
    const LevelMesh fine = read_level(hierarchy, 0);
    const Loops straight = library_loops(hierarchy, 0);
    const Solution expected = solve(hierarchy, &straight, solve_options(HMF_METHOD_NEWTON, 1e-11));
    size_t tried = 0;
    for (size_t place = 0; place < 60; place += 7) {
        Loops wiggly;
        for (size_t c = 0; c < straight.count(); ++c) {
            std::vector<uint32_t> longer = with_finger(fine, straight, c, place);
            if (longer.empty())
                longer.assign(straight.elements.begin() + static_cast<long>(straight.offsets[c]),
                              straight.elements.begin() + static_cast<long>(straight.offsets[c + 1]));
            else ++tried;
            wiggly.add(longer);
        }
        // The initial foliation of a loop with a finger would have a pole.
        expect_foliation(fine, initialize(hierarchy, wiggly));
        const Solution solution = solve(hierarchy, &wiggly, solve_options(HMF_METHOD_NEWTON, 1e-11));
        EXPECT_LT(solution.status, HMF_CANCELLED) << solution.error.message;
        EXPECT_NEAR(solution.report.energy, expected.report.energy, 1e-10 * expected.report.energy);
    }
    EXPECT_GT(tried, 6u);
}

TEST(DrawnLoops, CrossingIsNamed) {
    // Vertex i * 16 + j: around the tube at i = 2, and around the hole at j = 5.
    const Hierarchy hierarchy(torus(40, 16, 3, 1));
    Loops loops;
    loops.kind = HMF_PATH_VERTICES;
    std::vector<uint32_t> tube, hole;
    for (uint32_t j = 0; j < 16; ++j) tube.push_back(2 * 16 + j);
    for (uint32_t i = 0; i < 40; ++i) hole.push_back(i * 16 + 5);
    loops.add(tube);
    loops.add(hole);
    hmf_error error{};
    hmf_foliation* none = nullptr;
    const hmf_loop_set set = loops.view();
    EXPECT_EQ(hmf_foliation_from_loops(hierarchy.get(), &set, nullptr, &none, &error), HMF_ERROR_LOOP_CROSSING);
    EXPECT_EQ(none, nullptr);
    EXPECT_EQ(error.index, 1u);
    EXPECT_NE(std::string(error.message).find("Loop 1 crosses loop 0, which it meets at vertex 37."), std::string::npos)
        << error.message;
}

// Loops of the caller's triangles when these are far from Delaunay: a loop winds so
// much that several fingers, also of several loops, go around the same vertices.
void expect_pants_on_the_input(const TriMesh& mesh, double ratio) {
    const Hierarchy hierarchy(mesh, ratio);
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0, HMF_LOOPS_PANTS);
    EXPECT_EQ(loops.count(), 3 * mesh.genus - 3);
    const Foliation foliation = initialize(hierarchy, loops);
    ASSERT_NE(foliation, nullptr);
    expect_foliation(read_level(hierarchy, 0), foliation);
}

TEST(PantsLoops, NestedFingersOnStretchedPlates) {
    for (const uint64_t seed : {44, 45, 56, 57}) {
        SCOPED_TRACE(seed);
        Random random(seed);
        TriMesh mesh = plate(6 + seed % 2);
        while (mesh.vertex_count() < 1500) mesh = subdivide(mesh);
        mesh = transformed(mesh, random_rotation(random));
        mesh = transformed(mesh, {40 + 100 * random.unit(), 0, 0, 0, 1 + 4 * random.unit(), 0, 0, 0, 1});
        expect_pants_on_the_input(mesh, 0.5);
    }
}

// Meshes in the folder HMF_CASES on which this once failed.
TEST(PantsLoops, CasesOnTheInput) {
    const char* folder = std::getenv("HMF_CASES");
    if (!folder) GTEST_SKIP() << "skipped: set HMF_CASES to the folder of the cases";
    for (const char* name : {"pants-900", "pants-403"}) {
        SCOPED_TRACE(name);
        const std::string path = std::string(folder) + "/" + name + ".obj";
        TriMesh mesh;
        if (!read_obj(path, mesh)) GTEST_SKIP() << "skipped: no " << path;
        for (const double ratio : {0.25, 0.5, 0.75}) expect_pants_on_the_input(mesh, ratio);
    }
}

// Of several loops the first that crosses an earlier one.
TEST(DrawnLoops, FirstCrossingIsNamed) {
    const Hierarchy hierarchy(torus(40, 16, 3, 1));
    const uint32_t tubes[] = {2, 10, 20, 25, 30, 35};
    std::vector<uint32_t> hole;
    for (uint32_t i = 0; i < 40; ++i) hole.push_back(i * 16 + 5);
    for (size_t place = 1; place <= 6; ++place) {
        Loops loops;
        loops.kind = HMF_PATH_VERTICES;
        for (size_t k = 0; k < 6; ++k) {
            if (k == place) loops.add(hole);
            std::vector<uint32_t> tube;
            for (uint32_t j = 0; j < 16; ++j) tube.push_back(tubes[k] * 16 + j);
            loops.add(tube);
        }
        if (place == 6) loops.add(hole);
        hmf_error error{};
        hmf_foliation* none = nullptr;
        const hmf_loop_set set = loops.view();
        EXPECT_EQ(hmf_foliation_from_loops(hierarchy.get(), &set, nullptr, &none, &error), HMF_ERROR_LOOP_CROSSING);
        EXPECT_EQ(error.index, place);
        const std::string wanted = "Loop " + std::to_string(place) + " crosses loop 0, which it meets at vertex 37.";
        EXPECT_NE(std::string(error.message).find(wanted), std::string::npos) << error.message;
    }
}

class RealHandles : public testing::TestWithParam<const char*> {};

TEST_P(RealHandles, LinkingIntegrals) {
    const char* folder = std::getenv("HMF_MESHES");
    const std::string path = std::string(folder ? folder : "") + "/" + GetParam() + ".obj";
    TriMesh mesh;
    if (!folder || !read_obj(path, mesh)) GTEST_SKIP() << "skipped: no " << path;
    expect_handles(mesh);
}

class RealPants : public testing::TestWithParam<const char*> {};

TEST_P(RealPants, AreSolved) {
    const char* folder = std::getenv("HMF_MESHES");
    const std::string path = std::string(folder ? folder : "") + "/" + GetParam() + ".obj";
    TriMesh mesh;
    if (!folder || !read_obj(path, mesh)) GTEST_SKIP() << "skipped: no " << path;
    expect_pants(mesh);
}

std::string mesh_name(const testing::TestParamInfo<const char*>& info) {
    std::string name = info.param;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(Meshes, RealPants,
                         testing::Values("fertility_9.0k", "botijo_23k", "sf129110_10k", "heptoroid_36k"), mesh_name);
INSTANTIATE_TEST_SUITE_P(Meshes, RealHandles,
                         testing::Values("fertility_9.0k", "botijo_23k", "rocker-arm_5.0k", "kitten_16k",
                                         "heptoroid_36k", "entangled-double-torus_35k", "knot1_6.4k"),
                         mesh_name);

} // namespace

// Each crossing of two loops is looked at: where they are long that takes long, so it reports in between, and any of
// these reports may cancel it.
TEST(Linking, ReportsWhileItCounts) {
    const Hierarchy hierarchy(torus(150, 100, 2, 0.8));
    const hmf::Mesh& mesh = hierarchy.get()->input;
    const double* const position = hierarchy.get()->levels[0].position;
    struct Reports {
        size_t count = 0, end = SIZE_MAX;
    };
    const auto report = [](void* user, double) -> int32_t {
        Reports& r = *static_cast<Reports*>(user);
        return ++r.count < r.end ? HMF_PROGRESS_CONTINUE : HMF_PROGRESS_CANCEL;
    };
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf_error error{};
    hmf::Loops handle, tunnel;
    {
        hmf::Call call(memory, &error, nullptr, nullptr);
        ASSERT_EQ(hmf::handle_system(*hierarchy.get(), 0, true, call, handle), HMF_OK) << error.message;
        ASSERT_EQ(hmf::handle_system(*hierarchy.get(), 0, false, call, tunnel), HMF_OK) << error.message;
    }
    const size_t crossings = 2 * handle.crossings.size() + tunnel.crossings.size();
    Reports all;
    hmf::SeifertForm form;
    hmf::Call whole(memory, &error, report, &all);
    ASSERT_EQ(hmf::seifert_form(mesh, position, handle, tunnel, whole, form), HMF_OK) << error.message;
    EXPECT_GE(all.count, crossings / 100);
    EXPECT_GT(crossings, 500u);
    for (size_t end = 1; end <= all.count; ++end) {
        Reports some;
        some.end = end;
        hmf::Call call(memory, &error, report, &some);
        EXPECT_EQ(hmf::seifert_form(mesh, position, handle, tunnel, call, form), HMF_CANCELLED) << end;
        EXPECT_EQ(some.count, end);
    }
}

} // namespace test_library_loops
