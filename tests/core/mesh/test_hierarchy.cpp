// The hierarchy from the inside: validation, exact reversal, numbering,
// Delaunay property, memory, cancellation.
#include "src/core/hierarchy/hierarchy.hpp"
#include "src/core/hierarchy/simplify.hpp"
#include "src/core/mesh/mesh_copy.hpp"
#include "src/core/mesh/spatial_order.hpp"
#include "src/core/mesh/weights.hpp"
#include "support/check_mesh.hpp"
#include "support/meshes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

namespace test_hierarchy {

using namespace hmf;
using test::TriMesh;

namespace {

struct Built {
    hmf_hierarchy h{nullptr, nullptr, nullptr, 0};
    hmf_error error{};
    hmf_status status;
    explicit Built(const TriMesh& mesh, const BuildOptions& options = {}, hmf_progress_fn progress = nullptr,
                   void* user = nullptr) {
        Call call(h.memory, &error, progress, user);
        status = build_hierarchy(h, mesh.positions.data(), mesh.vertex_count(), 0, mesh.triangles.data(),
                                 mesh.triangle_count(), options, call);
    }
};

// A mesh with room for level 0, loaded with any level.
struct Copy {
    Mesh mesh;
    std::vector<uint32_t> origin, next, face, out;
    Copy(const Mesh& from, const Mesh& largest) :
        origin(2 * largest.edge_count, 77), next(2 * largest.edge_count, 77), face(2 * largest.edge_count, 77),
        out(largest.vertex_count, 77) {
        std::copy_n(from.origin, 2 * from.edge_count, origin.begin());
        std::copy_n(from.next, 2 * from.edge_count, next.begin());
        std::copy_n(from.face, 2 * from.edge_count, face.begin());
        std::copy_n(from.out, from.vertex_count, out.begin());
        mesh = {from.vertex_count, from.edge_count, from.face_count, origin.data(),
                next.data(),       face.data(),     out.data()};
    }
    void count_as(const Mesh& other) {
        mesh.vertex_count = other.vertex_count;
        mesh.edge_count = other.edge_count;
        mesh.face_count = other.face_count;
    }
};

bool same(const Mesh& a, const Mesh& b) {
    const size_t bytes = 2 * size_t{b.edge_count} * sizeof(uint32_t);
    return a.vertex_count == b.vertex_count && a.edge_count == b.edge_count && a.face_count == b.face_count
        && std::memcmp(a.origin, b.origin, bytes) == 0 && std::memcmp(a.next, b.next, bytes) == 0
        && std::memcmp(a.face, b.face, bytes) == 0;
}

const Mesh& simplicial(const hmf_hierarchy& h, size_t level) { return level == 0 ? h.input : h.levels[level].mesh; }

std::set<std::pair<uint32_t, uint32_t>> vertex_pairs(const Mesh& mesh) {
    std::set<std::pair<uint32_t, uint32_t>> pairs;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const uint32_t a = mesh.origin[2 * e], b = mesh.origin[2 * e + 1];
        if (a != b) pairs.insert({std::min(a, b), std::max(a, b)});
    }
    return pairs;
}

void expect_sound(const TriMesh& mesh, const BuildOptions& options) {
    Built built(mesh, options);
    const hmf_hierarchy& h = built.h;
    ASSERT_EQ(built.status, HMF_OK) << built.error.message;
    EXPECT_EQ(h.genus, mesh.genus);
    const size_t last = h.level_count - 1;

    // Backwards from the coarsest level, then forwards again.
    Copy work(simplicial(h, last), h.input);
    for (size_t k = last; k > 0; --k) {
        EXPECT_TRUE(same(work.mesh, h.levels[k].mesh)) << "level " << k;
        EXPECT_EQ(check(h.levels[k].mesh), nullptr) << "level " << k;
        const Level& finer = h.levels[k - 1];
        for (size_t n = finer.flip_end; n-- > finer.flip_begin;) unflip(work.mesh, h.flips[n]);
        work.count_as(simplicial(h, k - 1));
        for (size_t n = finer.collapse_end; n-- > finer.collapse_begin;) split(work.mesh, h.collapses[n]);
    }
    EXPECT_TRUE(same(work.mesh, h.input));
    EXPECT_EQ(check(work.mesh), nullptr);
    for (size_t k = 0; k < last; ++k) {
        const Level& finer = h.levels[k];
        for (size_t n = finer.collapse_begin; n < finer.collapse_end; ++n) {
            const Collapse c = collapse(work.mesh, h.collapses[n].h);
            EXPECT_EQ(std::memcmp(&c, &h.collapses[n], sizeof c), 0);
        }
        work.count_as(h.levels[k + 1].mesh);
        for (size_t n = finer.flip_begin; n < finer.flip_end; ++n) flip(work.mesh, h.flips[n]);
        EXPECT_TRUE(same(work.mesh, h.levels[k + 1].mesh)) << "level " << k + 1;
        EXPECT_EQ(vertex_pairs(h.levels[k + 1].mesh).size(), h.levels[k + 1].mesh.edge_count) << "not simplicial";
    }
    Copy intrinsic(h.input, h.input);
    for (size_t n = 0; n < h.intrinsic_flip_count; ++n) flip(intrinsic.mesh, h.intrinsic_flips[n]);
    EXPECT_TRUE(same(intrinsic.mesh, h.levels[0].mesh));
    EXPECT_EQ(check(h.levels[0].mesh), nullptr);
    EXPECT_EQ(h.levels[0].raised_count, 0u);

    // The maps lead back to the caller's triangles and positions.
    uint32_t seen = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (size_t s = 0; s < 3; ++s) {
            const uint32_t e = h.triangle_edges[3 * t + s];
            ASSERT_LE(e, seen);
            seen = std::max(seen, e + 1);
            const uint32_t a = h.vertex_internal[mesh.triangles[3 * t + s]],
                           b = h.vertex_internal[mesh.triangles[3 * t + (s + 1) % 3]];
            const uint32_t g = 2 * h.edge_internal[e], from = h.input.origin[g], to = h.input.origin[g + 1];
            EXPECT_TRUE((from == a && to == b) || (from == b && to == a));
            for (size_t c = 0; c < 3; ++c)
                EXPECT_EQ(h.levels[0].position[3 * a + c], mesh.positions[3 * mesh.triangles[3 * t + s] + c]);
        }
    EXPECT_EQ(seen, h.input.edge_count);
    for (size_t k = 0; k <= last; ++k) {
        for (uint32_t e = 0; e < h.levels[k].mesh.edge_count; ++e) ASSERT_GT(h.levels[k].weight[e], 0);
        for (uint32_t v = 0; v < 3 * h.levels[k].mesh.vertex_count; ++v)
            ASSERT_TRUE(std::isfinite(h.levels[k].position[v]));
    }
    EXPECT_LE(h.memory.peak(), build_memory_bound(mesh.vertex_count(), mesh.triangle_count(), options));
}

// Triangles of length 1 and height h, in any position and unit: without area below 2e-15.
void expect_area(double length, double height, bool expected) {
    for (int axis = 0; axis < 3; ++axis)
        for (const int other : {(axis + 1) % 3, (axis + 2) % 3})
            for (const double foot : {0.0, 0.25, 0.5, 1.0})
                for (int turn = 0; turn < 3; ++turn) {
                    TriMesh mesh;
                    mesh.positions.assign(9, 0);
                    double* const p[3] = {&mesh.positions[3 * turn], &mesh.positions[3 * ((turn + 1) % 3)],
                                          &mesh.positions[3 * ((turn + 2) % 3)]};
                    p[1][axis] = length;
                    p[2][axis] = foot * length;
                    p[2][other] = height * length;
                    mesh.triangles = {0, 1, 2};
                    const Built built(mesh);
                    EXPECT_EQ(built.status != HMF_ERROR_MESH_DEGENERATE, expected)
                        << "length " << length << " along " << axis << ", height " << height << " along " << other
                        << ", foot " << foot << ", from corner " << turn << ": " << built.error.message;
                }
}

BuildOptions small(double ratio = 0.5, int32_t collapse = HMF_COLLAPSE_MIDPOINT) {
    BuildOptions options;
    options.ratio = ratio;
    options.coarsest = 40;
    options.collapse = collapse;
    return options;
}

// How many vertices of a torus of 96 x 96 are left on level 1 in each twelfth of it.
void expect_evenly_coarse(const test::TorusOptions& shape) {
    constexpr size_t n = 96, parts = 12;
    const Built built(test::torus(n, n, 3, 1, shape));
    ASSERT_EQ(built.status, HMF_OK) << built.error.message;
    const Level& level = built.h.levels[1];
    std::vector<size_t> left(parts, 0);
    for (uint32_t v = 0; v < level.mesh.vertex_count; ++v) {
        const double angle = std::atan2(level.position[3 * v + 1], level.position[3 * v]) / 6.283185307179586;
        ++left[std::min(parts - 1, static_cast<size_t>((angle + 0.5) * parts))];
    }
    const auto [least, most] = std::minmax_element(left.begin(), left.end());
    EXPECT_LT(*most, 2 * *least) << level.mesh.vertex_count << " vertices on level 1";
}

// Flat, from radius 1 to 2, with random triangles.
TriMesh flat_annulus(uint32_t around, uint32_t across) {
    TriMesh mesh;
    test::Random random(4);
    for (uint32_t i = 0; i < around; ++i)
        for (uint32_t j = 0; j <= across; ++j) {
            const bool inside = j > 0 && j < across;
            const double angle = 6.283185307179586 * (i + 0.8 * random.unit()) / around;
            const double r = 1 + (j + (inside ? 0.8 * random.unit() - 0.4 : 0)) / across;
            for (const double x : {r * std::cos(angle), r * std::sin(angle), 0.0}) mesh.positions.push_back(x);
        }
    for (uint32_t i = 0; i < around; ++i)
        for (uint32_t j = 0; j < across; ++j) {
            const uint32_t a = i * (across + 1) + j, b = (i + 1) % around * (across + 1) + j;
            for (const uint32_t v : {a, a + 1, b + 1, a, b + 1, b}) mesh.triangles.push_back(v);
        }
    return mesh;
}

TriMesh plain_torus(size_t n = 12, size_t m = 8) { return test::torus(n, m, 3, 1); }

TriMesh tetrahedron() {
    TriMesh mesh;
    mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    mesh.triangles = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    return mesh;
}

// b beside a, as another component.
TriMesh both(const TriMesh& a, const TriMesh& b) {
    TriMesh mesh = a;
    for (size_t n = 0; n < b.positions.size(); ++n) mesh.positions.push_back(b.positions[n] + (n % 3 == 0 ? 100 : 0));
    for (const uint32_t v : b.triangles) mesh.triangles.push_back(v + static_cast<uint32_t>(a.vertex_count()));
    return mesh;
}

void expect_defect(const TriMesh& mesh, hmf_status status, int32_t element, uint64_t index) {
    Built built(mesh);
    EXPECT_EQ(built.status, status) << built.error.message;
    EXPECT_EQ(built.error.status, status);
    EXPECT_EQ(built.error.element, element);
    EXPECT_EQ(built.error.index, index);
    EXPECT_NE(built.error.message[0], 0);
}

} // namespace

TEST(Hierarchy, ReversalIsExact) {
    for (const double ratio : {0.25, 0.5, 0.75, 0.95})
        for (const int32_t collapse : {HMF_COLLAPSE_MIDPOINT, HMF_COLLAPSE_ENDPOINT, HMF_COLLAPSE_QSLIM}) {
            SCOPED_TRACE(testing::Message() << "ratio " << ratio << " collapse " << collapse);
            expect_sound(test::torus(40, 20, 3, 1), small(ratio, collapse));
            expect_sound(test::pretzel(3, 2), small(ratio, collapse));
        }
}

TEST(Hierarchy, HardMeshes) {
    test::TorusOptions stretched;
    stretched.stretch = 20;
    stretched.random_diagonals = true;
    stretched.jitter = 0.3;
    expect_sound(test::torus(60, 30, 3, 1, stretched), small());
    expect_sound(test::thin_plate(2, 100), small());
    expect_sound(test::with_bad_triangles(test::torus(40, 20, 3, 1), 100, 0.001, 5), small());
    expect_sound(test::with_random_flips(test::torus(40, 20, 3, 1), 1000, 0.5, 5), small());
    expect_sound(test::torus_with_finger(20, 12, 60, 30), small());
    expect_sound(test::joined_tori(20, 12, 40, 50), small());
    expect_sound(test::trefoil(100, 10, 0.4), small());
}

TEST(Hierarchy, SmallestMeshes) {
    expect_sound(plain_torus(3, 3), small());
    expect_sound(test::plate(1), small());
    expect_sound(test::plate(9), small());
}

TEST(Hierarchy, ShearedTorusBecomesDelaunay) {
    // The same connectivity, but each ring is turned by 20 of its 120 cells
    // against the one before: several flips per edge.
    const size_t n = 60, m = 120, shear = 20;
    const TriMesh straight = test::torus(n, m, 3, 1);
    TriMesh mesh = straight;
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < m; ++j)
            for (size_t c = 0; c < 3; ++c)
                mesh.positions[3 * (i * m + j) + c] = straight.positions[3 * (i * m + (j + shear * i) % m) + c];
    expect_sound(mesh, small());
    Built built(mesh, small());
    EXPECT_GT(built.h.intrinsic_flip_count, built.h.input.edge_count);
}

TEST(Hierarchy, IntrinsicDelaunayBelongsToTheSurface) {
    // Flips inside the flat faces of a plate do not change the surface, so the
    // weights of its Delaunay triangulation must come out again.
    for (const TriMesh& mesh : {test::subdivide(test::plate(2)), test::subdivide(test::thin_plate(2, 7))}) {
        const TriMesh flipped = test::with_random_flips(mesh, 3000, 1 - 1e-12, 3);
        EXPECT_NE(mesh.triangles, flipped.triangles);
        Built a(mesh), b(flipped);
        ASSERT_EQ(a.status, HMF_OK);
        ASSERT_EQ(b.status, HMF_OK) << b.error.message;
        std::vector<double> first(a.h.levels[0].weight, a.h.levels[0].weight + a.h.input.edge_count);
        std::vector<double> second(b.h.levels[0].weight, b.h.levels[0].weight + b.h.input.edge_count);
        std::sort(first.begin(), first.end());
        std::sort(second.begin(), second.end());
        for (size_t e = 0; e < first.size(); ++e) ASSERT_NEAR(first[e], second[e], 2e-8) << e;
    }
}

TEST(Hierarchy, UnitsDoNotMatter) {
    // A power of two scales everything exactly, up to the limits of double.
    const TriMesh mesh = test::pretzel(2, 2);
    Built plain(mesh, small());
    ASSERT_EQ(plain.status, HMF_OK);
    for (const int exponent : {-700, -20, 20, 700}) {
        const double factor = std::ldexp(1.0, exponent);
        const TriMesh other = test::scaled(mesh, factor);
        Built built(other, small());
        ASSERT_EQ(built.status, HMF_OK) << built.error.message;
        ASSERT_EQ(built.h.level_count, plain.h.level_count);
        for (size_t k = 0; k < plain.h.level_count; ++k) {
            const Level &a = plain.h.levels[k], &b = built.h.levels[k];
            EXPECT_TRUE(same(a.mesh, b.mesh)) << exponent << " level " << k;
            for (uint32_t e = 0; e < a.mesh.edge_count; ++e) ASSERT_NEAR(a.weight[e], b.weight[e], 1e-9 * a.weight[e]);
            for (uint32_t v = 0; v < 3 * a.mesh.vertex_count; ++v)
                ASSERT_EQ(a.position[v] * factor, b.position[v] / built.h.scale);
        }
    }
}

TEST(Hierarchy, CoarsestLevelIsOfTheSizeAsked) {
    BuildOptions options = small();
    options.coarsest = 100;
    Built built(test::torus(60, 30, 3, 1), options);
    ASSERT_EQ(built.status, HMF_OK);
    const uint32_t vertices = built.h.levels[built.h.level_count - 1].mesh.vertex_count;
    EXPECT_GE(vertices, 100u);
    EXPECT_LE(vertices, 135u);
    EXPECT_GT(built.h.level_count, 3u);
}

// And at least 40 for each handle and 10 for each marked vertex, whatever is asked for.
TEST(Hierarchy, CoarsestLevelHasRoomForMarks) {
    std::vector<uint32_t> marks;
    for (uint32_t k = 0; k < 20; ++k) marks.push_back(90 * k);
    BuildOptions options = small();
    options.coarsest = 1;
    options.marked_vertices = marks.data();
    options.marked_count = marks.size();
    const Built built(test::torus(60, 30, 3, 1), options);
    ASSERT_EQ(built.status, HMF_OK) << built.error.message;
    const uint32_t vertices = built.h.levels[built.h.level_count - 1].mesh.vertex_count;
    EXPECT_GE(vertices, 240u);
    EXPECT_LE(vertices, 321u);
}

// A sixteenth of the vertices, 1000 at most; and on the way there the levels of a hierarchy that ends at 1000, as loops
// are searched on these.
TEST(Hierarchy, CoarsestLevelByDefault) {
    for (const auto& [width, expected] : {std::pair{24u, 36u}, std::pair{60u, 225u}, std::pair{136u, 1000u}}) {
        const TriMesh mesh = test::torus(width, width, 3, 1);
        const Built built(mesh);
        ASSERT_EQ(built.status, HMF_OK) << built.error.message;
        const uint32_t last = built.h.levels[built.h.level_count - 1].mesh.vertex_count;
        EXPECT_GE(last, expected);
        EXPECT_LE(last, std::max(40u, expected + expected / 3 + 1)) << width;
        BuildOptions usual;
        usual.coarsest = USUAL_COARSEST;
        const Built shorter(mesh, usual);
        ASSERT_LE(shorter.h.level_count, built.h.level_count);
        for (size_t n = 0; n < shorter.h.level_count; ++n) {
            const Level &a = built.h.levels[n], &b = shorter.h.levels[n];
            ASSERT_EQ(a.mesh.vertex_count, b.mesh.vertex_count);
            ASSERT_EQ(a.raised_count, b.raised_count);
            double sums[2] = {0, 0}; // in another order
            for (uint32_t e = 0; e < a.mesh.edge_count; ++e) sums[0] += a.weight[e], sums[1] += b.weight[e];
            EXPECT_NEAR(sums[0], sums[1], 1e-9 * sums[0]) << "level " << n;
        }
    }
}

// Blocks collapse edges at the same time, so each vertex with a neighbor in another block has to be known, also where
// a collapse at a border has just made it one.
TEST(Hierarchy, BordersOfBlocksAreKnown) {
    BuildOptions one_level; // which leaves the vertices in their order in space
    one_level.coarsest = 1000000;
    const Built built(test::with_random_flips(test::torus(150, 120, 3, 1), 4000, 0.2, 5), one_level);
    ASSERT_EQ(built.status, HMF_OK) << built.error.message;
    Memory memory(nullptr, nullptr, nullptr, 0);
    Call call(memory, nullptr, nullptr, nullptr);
    const Mesh& mesh = built.h.input;
    MeshCopy copy;
    WorkMesh work;
    Array<Collapse> log;
    Array<CollapseRun> runs;
    runs.start(memory);
    std::vector<uint32_t> scratch(mesh.edge_count);
    ASSERT_TRUE(copy.allocate(mesh, memory) && work.allocate(memory, copy.of(mesh), false)
                && log.allocate(memory, mesh.vertex_count));
    ASSERT_GE(work.block_count, 4u);
    std::vector<double> positions(built.h.levels[0].position, built.h.levels[0].position + 3 * mesh.vertex_count);
    work.position = positions.data();
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) work.degree[v] = work.mesh.degree(v);
    size_t count = 0;
    ASSERT_EQ(collapse_level(work, HMF_COLLAPSE_MIDPOINT, mesh.edge_count / 2, 4, log.data(), count, runs,
                             scratch.data(), call, 0, 1),
              HMF_OK);
    ASSERT_GT(count, mesh.vertex_count / 3);
    uint32_t crossing = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (work.removed(e)) continue;
        const uint32_t v = work.mesh.origin[2 * e], w = work.mesh.origin[2 * e + 1];
        if (v >> work.block_shift == w >> work.block_shift) continue;
        ++crossing;
        ASSERT_TRUE(work.at_border[v] && work.at_border[w]) << v << ", " << w;
    }
    EXPECT_GT(crossing, 0u);
    EXPECT_LT(crossing, mesh.edge_count / 20);
}

TEST(Hierarchy, StridedPositions) {
    const TriMesh mesh = plain_torus();
    std::vector<double> strided;
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        for (size_t c = 0; c < 3; ++c) strided.push_back(mesh.positions[3 * v + c]);
        strided.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    Built packed(mesh);
    hmf_hierarchy h(nullptr, nullptr, nullptr, 0);
    Call call(h.memory, nullptr, nullptr, nullptr);
    ASSERT_EQ(build_hierarchy(h, strided.data(), mesh.vertex_count(), 32, mesh.triangles.data(), mesh.triangle_count(),
                              {}, call),
              HMF_OK);
    EXPECT_EQ(std::memcmp(h.levels[0].position, packed.h.levels[0].position, mesh.positions.size() * sizeof(double)),
              0);
}

TEST(Validation, Arguments) {
    const TriMesh mesh = plain_torus();
    const double* x = mesh.positions.data();
    const uint32_t* t = mesh.triangles.data();
    const size_t V = mesh.vertex_count(), F = mesh.triangle_count();
    const auto status = [](const double* positions, size_t vertices, size_t stride, const uint32_t* triangles,
                           size_t count) {
        hmf_hierarchy h(nullptr, nullptr, nullptr, 0);
        Call call(h.memory, nullptr, nullptr, nullptr);
        return build_hierarchy(h, positions, vertices, stride, triangles, count, {}, call);
    };
    EXPECT_EQ(status(nullptr, V, 0, t, F), HMF_ERROR_NULL);
    EXPECT_EQ(status(x, V, 0, nullptr, F), HMF_ERROR_NULL);
    EXPECT_EQ(status(x, V, 16, t, F), HMF_ERROR_OPTIONS);
    EXPECT_EQ(status(x, V, 28, t, F), HMF_ERROR_OPTIONS);
    EXPECT_EQ(status(x, 0, 0, t, F), HMF_ERROR_MESH_COUNTS);
    EXPECT_EQ(status(x, V, 0, t, 0), HMF_ERROR_MESH_COUNTS);
    EXPECT_EQ(status(x, SIZE_MAX, 0, t, F), HMF_ERROR_MESH_COUNTS);
    EXPECT_EQ(status(x, V, 0, t, SIZE_MAX / 3), HMF_ERROR_MESH_COUNTS);
}

TEST(Validation, Corners) {
    TriMesh mesh = plain_torus();
    mesh.triangles[3 * 5 + 1] = static_cast<uint32_t>(mesh.vertex_count());
    expect_defect(mesh, HMF_ERROR_MESH_INDEX, HMF_ELEMENT_TRIANGLE, 5);
    for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        mesh = plain_torus();
        mesh.positions[3 * 7 + 2] = bad;
        expect_defect(mesh, HMF_ERROR_MESH_NOT_FINITE, HMF_ELEMENT_VERTEX, 7);
    }
    mesh = plain_torus();
    mesh.triangles[3 * 9 + 2] = mesh.triangles[3 * 9];
    expect_defect(mesh, HMF_ERROR_MESH_REPEATED_VERTEX, HMF_ELEMENT_TRIANGLE, 9);
    mesh = plain_torus();
    for (size_t c = 0; c < 3; ++c) // coincident
        mesh.positions[3 * mesh.triangles[1] + c] = mesh.positions[3 * mesh.triangles[0] + c];
    expect_defect(mesh, HMF_ERROR_MESH_DEGENERATE, HMF_ELEMENT_TRIANGLE, 0);
    mesh = plain_torus();
    for (size_t c = 0; c < 3; ++c) // collinear up to rounding
        mesh.positions[3 * mesh.triangles[2] + c] =
            0.3 * mesh.positions[3 * mesh.triangles[0] + c] + 0.7 * mesh.positions[3 * mesh.triangles[1] + c];
    Built built(mesh);
    EXPECT_TRUE(built.status == HMF_OK || built.status == HMF_ERROR_MESH_DEGENERATE);
}

TEST(Validation, Edges) {
    TriMesh mesh = plain_torus();
    mesh.triangles.resize(mesh.triangles.size() - 3);
    Built open(mesh);
    EXPECT_EQ(open.status, HMF_OK);
    EXPECT_EQ(open.h.genus, 2u); // of the double
    EXPECT_EQ(open.h.surface_genus, 1u);
    EXPECT_EQ(open.h.boundary_count, 1u);

    mesh = plain_torus();
    std::swap(mesh.triangles[3 * 4], mesh.triangles[3 * 4 + 1]);
    Built turned(mesh);
    EXPECT_EQ(turned.status, HMF_ERROR_MESH_ORIENTATION);

    mesh = plain_torus();
    const uint32_t top = static_cast<uint32_t>(mesh.vertex_count());
    mesh.positions.insert(mesh.positions.end(), {0, 0, 9});
    mesh.triangles.insert(mesh.triangles.end(), {mesh.triangles[0], mesh.triangles[1], top});
    expect_defect(mesh, HMF_ERROR_MESH_NON_MANIFOLD_EDGE, HMF_ELEMENT_TRIANGLE, mesh.triangle_count() - 1);
}

TEST(Validation, Vertices) {
    TriMesh mesh = plain_torus();
    mesh.positions.insert(mesh.positions.end(), {0, 0, 9});
    expect_defect(mesh, HMF_ERROR_MESH_UNUSED_VERTEX, HMF_ELEMENT_VERTEX, mesh.vertex_count() - 1);

    // Two tori that share vertex 0.
    mesh = both(plain_torus(), plain_torus());
    const uint32_t shared = static_cast<uint32_t>(plain_torus().vertex_count());
    const uint32_t last = static_cast<uint32_t>(mesh.vertex_count() - 1);
    for (size_t n = plain_torus().triangles.size(); n < mesh.triangles.size(); ++n) {
        uint32_t& v = mesh.triangles[n];
        v = v == shared ? 0 : v == last ? shared : v; // the last vertex fills the gap
    }
    for (size_t c = 0; c < 3; ++c) mesh.positions[3 * shared + c] = mesh.positions[3 * last + c];
    mesh.positions.resize(3 * last);
    expect_defect(mesh, HMF_ERROR_MESH_NON_MANIFOLD_VERTEX, HMF_ELEMENT_VERTEX, 0);
}

TEST(Validation, Surface) {
    expect_defect(both(plain_torus(), plain_torus()), HMF_ERROR_MESH_COMPONENTS, HMF_ELEMENT_TRIANGLE,
                  plain_torus().triangle_count());
    expect_defect(tetrahedron(), HMF_ERROR_MESH_GENUS, HMF_ELEMENT_NONE, 0);
}

namespace {

// The same surface with its vertices and triangles in another order, and the
// triangles turned: new_number[v] is where vertex v went.
TriMesh shuffled(const TriMesh& mesh, uint64_t seed, std::vector<uint32_t>& new_number) {
    std::mt19937_64 random(seed);
    const auto below = [&random](size_t n) { return static_cast<size_t>(random() % n); };
    new_number.resize(mesh.vertex_count());
    for (size_t v = 0; v < new_number.size(); ++v) new_number[v] = static_cast<uint32_t>(v);
    for (size_t v = new_number.size(); v-- > 1;) std::swap(new_number[v], new_number[below(v + 1)]);
    TriMesh out = mesh;
    for (size_t v = 0; v < new_number.size(); ++v)
        std::copy_n(&mesh.positions[3 * v], 3, &out.positions[3 * new_number[v]]);
    std::vector<size_t> order(mesh.triangle_count());
    for (size_t t = 0; t < order.size(); ++t) order[t] = t;
    for (size_t t = order.size(); t-- > 1;) std::swap(order[t], order[below(t + 1)]);
    for (size_t t = 0; t < order.size(); ++t) {
        const size_t turn = below(3);
        for (size_t s = 0; s < 3; ++s)
            out.triangles[3 * t + s] = new_number[mesh.triangles[3 * order[t] + (s + turn) % 3]];
    }
    return out;
}

} // namespace

TEST(SpatialOrder, FollowsTheCurve) {
    std::vector<uint32_t> unused;
    TriMesh mesh = shuffled(test::torus(60, 40, 3, 1), 1, unused);
    for (const double factor : {1.0, std::ldexp(1.0, 900), std::ldexp(1.0, -900)}) {
        const size_t V = mesh.vertex_count(), F = mesh.triangle_count();
        std::vector<double> x = mesh.positions;
        for (double& c : x) c *= factor;
        Memory memory(nullptr, nullptr, nullptr, 0);
        Call call(memory, nullptr, nullptr, nullptr);
        std::vector<uint32_t> internal(V, NONE);
        Array<double> position;
        ASSERT_TRUE(position.allocate(memory, 3 * V));
        double scale = 0;
        ASSERT_EQ(order_vertices(x.data(), V, 0, internal.data(), position.data(), scale, call), HMF_OK);
        // The cell of each vertex, bit by bit from the highest, in its order.
        double low[3], extent = 0;
        for (size_t c = 0; c < 3; ++c) {
            double high = low[c] = x[c];
            for (size_t v = 0; v < V; ++v) low[c] = std::min(low[c], x[3 * v + c]), high = std::max(high, x[3 * v + c]);
            extent = std::max(extent, high - low[c]);
        }
        std::vector<std::pair<uint32_t, size_t>> place(V, {NONE, V});
        for (size_t v = 0; v < V; ++v) {
            uint32_t cell = 0;
            for (int bit = 9; bit >= 0; --bit)
                for (size_t c = 3; c-- > 0;) {
                    const double at = (x[3 * v + c] - low[c]) / extent * 1023;
                    cell = 2 * cell + (static_cast<uint32_t>(at + 1e-9) >> bit & 1u);
                }
            ASSERT_LT(internal[v], V);
            ASSERT_EQ(place[internal[v]].second, V) << "two vertices have one number";
            place[internal[v]] = {cell, v};
            for (size_t c = 0; c < 3; ++c) EXPECT_EQ(position[3 * internal[v] + c], scale * x[3 * v + c]);
        }
        size_t inversions = 0;
        for (size_t n = 1; n < V; ++n) inversions += place[n] < place[n - 1];
        EXPECT_LE(inversions, V / 200) << "not more than rounding at the bounds of cells explains";
        OrderedTriangles ordered;
        std::vector<uint32_t> sides(3 * size_t{F});
        ASSERT_EQ(order_triangles(mesh.triangles.data(), F, internal.data(), V, sides.data(), ordered, call), HMF_OK);
        std::vector<char> seen(F, 0);
        uint32_t before = 0;
        for (uint32_t f = 0; f < F; ++f) {
            const uint32_t* words = &ordered.words[4 * size_t{f}];
            ASSERT_LT(ordered.number(f), F);
            EXPECT_EQ(seen[ordered.number(f)]++, 0);
            for (size_t s = 0; s < 3; ++s)
                EXPECT_EQ(words[s], internal[mesh.triangles[3 * size_t{ordered.number(f)} + s]]);
            const uint32_t lowest = std::min({words[0], words[1], words[2]});
            EXPECT_LE(before, lowest);
            if (f > 0 && before == lowest) { EXPECT_LT(ordered.number(f - 1), ordered.number(f)); }
            before = lowest;
        }
    }
}

TEST(SpatialOrder, AnyOrderOfTheInput) {
    std::vector<uint32_t> unused;
    for (const uint64_t seed : {1, 2, 3}) expect_sound(shuffled(test::pretzel(3, 2), seed, unused), small());
    // An outlier: the others share a cell and keep the caller's order.
    TriMesh mesh = plain_torus();
    mesh.positions[0] = 1e9;
    expect_sound(mesh, small());
}

TEST(SpatialOrder, DefectsAreFoundInAnyOrder) {
    const auto expect_status = [](const TriMesh& mesh, hmf_status status) {
        for (uint64_t seed = 0; seed < 20; ++seed) {
            std::vector<uint32_t> number;
            const TriMesh other = shuffled(mesh, seed, number);
            Built built(other);
            EXPECT_EQ(built.status, status) << built.error.message << " seed " << seed;
        }
    };
    TriMesh mesh = plain_torus();
    mesh.triangles.resize(mesh.triangles.size() - 3);
    expect_status(mesh, HMF_OK);
    mesh = plain_torus();
    std::swap(mesh.triangles[3 * 4], mesh.triangles[3 * 4 + 1]);
    expect_status(mesh, HMF_ERROR_MESH_ORIENTATION);
    // A bubble on an edge: two more triangles meet it, and each other.
    mesh = plain_torus();
    const uint32_t a = mesh.triangles[0], b = mesh.triangles[1], top = static_cast<uint32_t>(mesh.vertex_count());
    mesh.positions.insert(mesh.positions.end(), {0, 0, 9});
    mesh.triangles.insert(mesh.triangles.end(), {a, b, top, b, a, top});
    expect_status(mesh, HMF_ERROR_MESH_NON_MANIFOLD_EDGE);
    expect_status(both(plain_torus(), plain_torus()), HMF_ERROR_MESH_COMPONENTS);
    expect_status(plain_torus(), HMF_OK);
}

TEST(Memory, EveryAllocationMayFail) {
    struct Failing {
        size_t left, live = 0;
        static void* allocate(void* user, size_t size) {
            Failing& f = *static_cast<Failing*>(user);
            if (f.left == 0) return nullptr;
            --f.left;
            ++f.live;
            return std::malloc(size);
        }
        static void release(void* user, void* block, size_t) {
            --static_cast<Failing*>(user)->live;
            std::free(block);
        }
    };
    test::TorusOptions options;
    options.random_diagonals = true;
    const TriMesh mesh = test::torus(16, 12, 3, 1, options);
    bool succeeded = false;
    size_t n = 0;
    for (; n < 1000 && !succeeded; ++n) {
        Failing failing{n};
        {
            hmf_hierarchy h(Failing::allocate, Failing::release, &failing, 0);
            hmf_error error{};
            Call call(h.memory, &error, nullptr, nullptr);
            const hmf_status status = build_hierarchy(
                h, mesh.positions.data(), mesh.vertex_count(), 0, mesh.triangles.data(), mesh.triangle_count(),
                small(0.5, n % 2 ? HMF_COLLAPSE_QSLIM : HMF_COLLAPSE_MIDPOINT), call);
            succeeded = status == HMF_OK;
            if (!succeeded) {
                EXPECT_EQ(status, HMF_ERROR_MEMORY);
                EXPECT_EQ(error.status, HMF_ERROR_MEMORY);
            }
        }
        EXPECT_EQ(failing.live, 0u);
    }
    EXPECT_TRUE(succeeded);
    EXPECT_GT(n, 30u);
}

TEST(Memory, WorkIsReturned) {
    Built built(test::torus(60, 40, 3, 1));
    ASSERT_EQ(built.status, HMF_OK);
    EXPECT_LE(built.h.memory.used(), 250u * built.h.input.edge_count);
}

TEST(Progress, RisesAndCancels) {
    struct Progress {
        std::vector<double> seen;
        size_t cancel_at = SIZE_MAX;
        static int32_t call(void* user, double fraction) {
            Progress& p = *static_cast<Progress*>(user);
            p.seen.push_back(fraction);
            return p.seen.size() > p.cancel_at ? HMF_PROGRESS_CANCEL : HMF_PROGRESS_CONTINUE;
        }
    };
    const TriMesh mesh = test::torus(80, 60, 3, 1);
    Progress all;
    {
        Built built(mesh, small(), Progress::call, &all);
        ASSERT_EQ(built.status, HMF_OK);
    }
    ASSERT_GT(all.seen.size(), 10u);
    for (size_t n = 1; n < all.seen.size(); ++n) EXPECT_LE(all.seen[n - 1], all.seen[n]);
    EXPECT_GE(all.seen.front(), 0);
    EXPECT_LE(all.seen.back(), 1);
    for (size_t n = 0; n < all.seen.size(); ++n) {
        Progress some;
        some.cancel_at = n;
        Built built(mesh, small(), Progress::call, &some);
        EXPECT_EQ(built.status, HMF_CANCELLED);
        EXPECT_EQ(built.error.status, HMF_CANCELLED);
        EXPECT_EQ(some.seen.size(), n + 1);
    }
}

TEST(Weights, OfACoarseLevelAreBounded) {
    Mesh mesh;
    double sum[] = {-2, 0, 1e-9, 2e-3, 8, 2e3, 1e7};
    mesh.edge_count = 7;
    EXPECT_EQ(clamp_weights(mesh, COARSE_WEIGHTS, sum), 1u);
    const double expected[] = {1e-3, 1e-3, 1e-3, 1e-3, 4, 1e3, 1e3};
    for (int e = 0; e < 7; ++e) EXPECT_EQ(sum[e], expected[e]) << e;
}

TEST(Hierarchy, TrianglesHaveAreaInAnyPosition) {
    for (const double length : {1e-70, 1e-20, 1.0, 1e3, 1e50}) {
        expect_area(length, 1.5e-15, false);
        expect_area(length, 2.5e-15, true);
        expect_area(length, 1e-13, true);
    }
}

// Its blocks are coarsened alike.
TEST(Hierarchy, LargeMeshesBecomeEvenlyCoarse) {
    expect_evenly_coarse({});
    test::TorusOptions shape;
    shape.jitter = 0.3;
    expect_evenly_coarse(shape);
}

// No flip joins what lies on each other in the two halves of a double: its edges would have no length.
TEST(Hierarchy, DoublesAreNotFlippedWhereTheyAreFolded) {
    for (const uint32_t across : {2u, 4u, 8u}) {
        const Built built(flat_annulus(60, across), small(0.7));
        ASSERT_EQ(built.status, HMF_OK) << built.error.message;
        ASSERT_GT(built.h.level_count, 2u);
        for (size_t k = 1; k < built.h.level_count; ++k) {
            const Level& level = built.h.levels[k];
            for (uint32_t e = 0; e < level.mesh.edge_count; ++e) {
                const double *a = &level.position[3 * level.mesh.origin[2 * e]],
                             *b = &level.position[3 * level.mesh.origin[2 * e + 1]];
                EXPECT_GT(std::hypot(a[0] - b[0], a[1] - b[1]), 1e-3) << across << ", level " << k << ", edge " << e;
            }
        }
    }
}

TEST(Weights, Cotangent) {
    const double o[3] = {0, 0, 0}, x[3] = {2, 0, 0}, y[3] = {0, 3, 0}, d[3] = {1, 1, 0}, back[3] = {-1, 0, 0};
    EXPECT_EQ(cotangent(o, x, y), 0);
    EXPECT_NEAR(cotangent(o, x, d), 1, 1e-15);
    EXPECT_LT(cotangent(o, x, back), -1e10);
    EXPECT_TRUE(std::isfinite(cotangent(o, o, o)));
    // Whatever the unit, also where products of lengths leave the range of double.
    for (const double unit : {1e-200, 1e-70, 1e70, 1e200}) {
        const double p[3] = {2 * unit, 0, 0}, q[3] = {unit, 3 * unit, 0};
        EXPECT_NEAR(cotangent(o, p, q), 1.0 / 3, 1e-15) << unit;
    }
}

} // namespace test_hierarchy
