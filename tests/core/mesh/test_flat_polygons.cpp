// Triangulations far from Delaunay of surfaces that have a good one: flips one by one would need the square of their
// size, polygons are triangulated at once.  The surface is the same, and so is the energy.
#include "src/core/hierarchy/hierarchy.hpp"
#include "src/core/mesh/intrinsic.hpp"
#include "src/core/mesh/polygon_delaunay.hpp"
#include "src/core/mesh/weights.hpp"
#include "support/check_mesh.hpp"
#include "support/extreme_surfaces.hpp"
#include "support/implicit_surface.hpp"
#include "support/sample.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_flat_polygons {

using namespace test;

namespace {

struct Energies {
    double meridian = 0, longitude = 0;
};

Energies energies(const TriMesh& mesh, const std::vector<uint32_t>& meridian, const std::vector<uint32_t>& longitude) {
    const Hierarchy hierarchy(mesh);
    Energies found;
    if (!hierarchy) return found;
    EXPECT_EQ(read_level(hierarchy, 0).raised_count, 0u);
    EXPECT_EQ(hmf::check(hierarchy.get()->levels[0].mesh), nullptr);
    EXPECT_LE(hierarchy.get()->intrinsic_flip_count, hmf::INTRINSIC_FLIPS_PER_EDGE * hierarchy.edges(0));
    for (const bool which : {false, true}) {
        Loops loops;
        loops.kind = HMF_PATH_VERTICES;
        loops.add(which ? longitude : meridian);
        const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
        EXPECT_EQ(solution.status, HMF_OK) << solution.error.message;
        EXPECT_EQ(solution.report.class_state, HMF_CLASS_PROVEN);
        (which ? found.longitude : found.meridian) = solution.report.energy;
    }
    return found;
}

void expect_equal(const Energies& a, const Energies& b) {
    EXPECT_GT(a.meridian, 0);
    EXPECT_NEAR(a.meridian / b.meridian, 1, 1e-8);
    EXPECT_NEAR(a.longitude / b.longitude, 1, 1e-8);
}

} // namespace

TEST(FlatPolygons, WallsAsTwoFans) {
    for (const size_t n : {50, 200, 500, 2000}) {
        SCOPED_TRACE(n);
        std::vector<uint32_t> meridian{0};
        for (uint32_t j = 0; j < n; ++j) meridian.push_back(16 + j);
        meridian.insert(meridian.end(), {1, 2, 3});
        const TriMesh good = walled_ring(n, Strips::ladder), bad = walled_ring(n, Strips::fans);
        ASSERT_EQ(mesh_defect(good), "");
        ASSERT_EQ(mesh_defect(bad), "");
        expect_equal(energies(bad, meridian, walled_ring_longitude()),
                     energies(good, meridian, walled_ring_longitude()));
    }
}

// The polygons are concave along the inner circle.
TEST(FlatPolygons, RingsOfFans) {
    for (const size_t n : {64, 512, 2048}) {
        SCOPED_TRACE(n);
        std::vector<uint32_t> longitude;
        for (uint32_t i = 0; i < n; ++i) longitude.push_back(4 * i);
        const TriMesh good = flat_ring(n, Strips::ladder), bad = flat_ring(n, Strips::fans);
        ASSERT_EQ(mesh_defect(good), "");
        ASSERT_EQ(mesh_defect(bad), "");
        expect_equal(energies(bad, {0, 1, 2, 3}, longitude), energies(good, {0, 1, 2, 3}, longitude));
    }
}

namespace {

struct Flipped {
    hmf::Memory memory{nullptr, nullptr, nullptr, 0};
    hmf::Call call{memory, nullptr, nullptr, nullptr};
    Hierarchy hierarchy;
    hmf::Mesh mesh;
    hmf::Array<uint32_t> next, origin, face, out;
    hmf::Metric metric;
    std::vector<double> sum;
    std::vector<uint32_t> edges;
    hmf::FlipLog log;

    explicit Flipped(const TriMesh& surface) : hierarchy(surface), mesh(hierarchy.get()->input) {
        const auto copy = [&](hmf::Array<uint32_t>& to, uint32_t*& from, size_t count) {
            EXPECT_TRUE(to.allocate(memory, count));
            std::copy(from, from + count, to.begin());
            from = to.data();
        };
        copy(next, mesh.next, 2 * mesh.edge_count);
        copy(origin, mesh.origin, 2 * mesh.edge_count);
        copy(face, mesh.face, 2 * mesh.edge_count);
        copy(out, mesh.out, mesh.vertex_count);
        sum.resize(mesh.edge_count);
        edges.resize(hmf::INTRINSIC_FLIPS_PER_EDGE * mesh.edge_count);
        log = {edges.data(), edges.size(), 0};
        const double* const position = hierarchy.get()->levels[0].position;
        EXPECT_TRUE(hmf::measure(mesh, position, nullptr, metric, sum.data(), call));
        EXPECT_TRUE(hmf::measure_thin(mesh, position, metric, sum.data(), call));
    }
    void flip() { EXPECT_EQ(hmf::intrinsic_delaunay(mesh, metric, sum.data(), log, call, 0, 1), HMF_OK); }
    // Sum of the angles at each vertex.
    std::vector<double> cone_angles() const {
        std::vector<double> angles(mesh.vertex_count, 0);
        for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
            const uint32_t a = hmf::edge_of(h), b = hmf::edge_of(mesh.prev(h)), c = hmf::edge_of(mesh.next[h]);
            const auto square = [&](uint32_t e) {
                return metric.square.empty() ? hmf::TwoDoubles::of_product(metric.length[e], metric.length[e])
                                             : metric.square[e];
            };
            const double area =
                metric.square.empty() ? metric.four_areas[mesh.face[h]] : metric.fine_area[mesh.face[h]].value();
            angles[mesh.origin[h]] += std::atan2(area, (square(a) + square(b) - square(c)).value());
        }
        return angles;
    }
    uint32_t bad() {
        uint32_t edge = 0;
        EXPECT_TRUE(hmf::find_bad_flip(mesh, metric, sum.data(), log, call, 1, edge));
        return edge;
    }
};

} // namespace

// Triangles with angles near 180 degrees, as stretching makes them: a polygon that grows by one of these may not close
// around a corner and cover itself.  The angles around each vertex stay.
TEST(FlatPolygons, AnglesAroundVerticesStay) {
    size_t with_polygons = 0;
    for (uint64_t seed = 1; seed <= 12; ++seed) {
        SCOPED_TRACE(seed);
        Random random(seed);
        TriMesh surface;
        do { surface = random_implicit_surface(10, 1.5, random); } while (surface.genus == 0);
        const double stretch = std::pow(10, 5 * random.unit());
        surface = transformed(transformed(surface, random_rotation(random)), {stretch, 0, 0, 0, 1, 0, 0, 0, 1});
        Flipped flipped(surface);
        const std::vector<double> before = flipped.cone_angles();
        flipped.flip();
        with_polygons += flipped.log.count > hmf::FLIPS_PER_EDGE_ALONE * flipped.mesh.edge_count;
        const std::vector<double> after = flipped.cone_angles();
        for (size_t v = 0; v < before.size(); ++v) ASSERT_NEAR(after[v], before[v], 1e-6) << v;
    }
    EXPECT_GT(with_polygons, 2u);
}

// Stretched walls between fans, where polygons would grow along chains of needles. Without a bound of the errors of
// their corners an edge stays that is not Delaunay.
TEST(FlatPolygons, ErrorsOfCornersAreBounded) {
    for (const uint64_t seed : {141, 217}) {
        SCOPED_TRACE(seed);
        Random random(seed);
        const uint64_t heights = random.bits();
        const Strips strips = random.below(2) ? Strips::fans : Strips::ladder;
        const size_t n = 10 + random.below(200);
        TriMesh surface = walled_ring(n, strips, heights);
        const double stretch = std::pow(10, 8 * random.unit());
        surface = transformed(transformed(surface, random_rotation(random)), {stretch, 0, 0, 0, 1, 0, 0, 0, 1});
        if (random.below(2)) {
            const Matrix turn = random_rotation(random);
            const double more = std::pow(10, 4 * random.unit());
            surface = transformed(transformed(surface, turn), {more, 0, 0, 0, 1, 0, 0, 0, 1});
        }
        hmf_hierarchy* made = nullptr;
        hmf_error error{};
        EXPECT_EQ(hmf_hierarchy_create(surface.positions.data(), surface.vertex_count(), surface.triangles.data(),
                                       surface.triangle_count(), nullptr, nullptr, &made, &error),
                  HMF_OK)
            << error.message;
        hmf_hierarchy_destroy(made);
    }
}

// The certificate of the flips fails where a length, an area or a sum of cotangents is not that of the surface.
TEST(FlatPolygons, EveryFlipIsChecked) {
    for (const size_t n : {50, 500}) {
        SCOPED_TRACE(n);
        Flipped flipped(walled_ring(n, Strips::fans));
        std::vector<double> before = flipped.sum;
        EXPECT_GT(hmf::clamp_weights(flipped.mesh, hmf::INTRINSIC_WEIGHTS, before.data()), 0u)
            << "what no flip was made for is counted";
        flipped.flip();
        ASSERT_GT(flipped.log.count, 100u);
        EXPECT_EQ(flipped.bad(), hmf::NONE);
        Random random(n);
        size_t by_sides = 0;
        for (int round = 0; round < 40; ++round) {
            const uint32_t edge = flipped.edges[random.below(flipped.log.count)], face = flipped.mesh.face[2 * edge];
            double* const broken[] = {&flipped.sum[edge], &flipped.metric.length[edge],
                                      &flipped.metric.four_areas[face]};
            hmf::TwoDoubles* const fine[] = {nullptr,
                                             flipped.metric.square.empty() ? nullptr : &flipped.metric.square[edge],
                                             flipped.metric.square.empty() ? nullptr : &flipped.metric.fine_area[face]};
            const size_t k = random.below(3);
            const double whole = *broken[k];
            *broken[k] += 1e-4 * std::abs(whole) + 1e-4 * (k == 0);
            const hmf::TwoDoubles whole_fine = fine[k] ? *fine[k] : hmf::TwoDoubles{};
            if (fine[k]) *fine[k] = 1.0001 * whole_fine;
            EXPECT_NE(flipped.bad(), hmf::NONE) << k;
            if (k == 2) { // and sums of cotangents that follow the area
                const std::vector<double> sums = flipped.sum;
                for (uint32_t e = 0; e < flipped.mesh.edge_count; ++e)
                    flipped.sum[e] = hmf::cotangent_sum(flipped.mesh, flipped.metric, e);
                by_sides += flipped.bad() != hmf::NONE; // where rounding leaves it open how thin the triangle is: not
                flipped.sum = sums;
            }
            *broken[k] = whole;
            if (fine[k]) *fine[k] = whole_fine;
        }
        EXPECT_EQ(flipped.bad(), hmf::NONE);
        EXPECT_GT(by_sides, 0u);
    }
}

// Random polygons: the triangles are right, and no other corner lies in the circle of one.
TEST(FlatPolygons, PolygonsInThePlane) {
    Random random(4);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    for (int round = 0; round < 300; ++round) {
        const size_t n = 3 + random.below(60);
        std::vector<double> angle(n);
        for (double& x : angle) x = 6.283185307179586 * random.unit();
        std::sort(angle.begin(), angle.end());
        std::vector<hmf::PlanePoint> corner;
        for (const double x : angle) corner.push_back({{3 * std::cos(x), 0}, {std::sin(x), 0}});
        hmf::PolygonDelaunay delaunay;
        ASSERT_TRUE(delaunay.triangulate(memory, corner.data(), static_cast<uint32_t>(n)));
        if (!delaunay.is_valid()) continue; // a triangle too thin for doubles
        for (uint32_t side = 0; side < 3 * (n - 2); ++side) {
            const uint32_t other = delaunay.across(side);
            if (other == hmf::PolygonDelaunay::OUTSIDE) continue;
            EXPECT_EQ(delaunay.across(other), side);
            const auto cotangent = [&](uint32_t s) {
                const hmf::PlanePoint apex = corner[delaunay.apex(s)];
                const hmf::PlanePoint u = corner[delaunay.begin(s)] - apex,
                                      v = corner[delaunay.begin(hmf::PolygonDelaunay::after(s))] - apex;
                return (hmf::dot(u, v) / hmf::cross(u, v)).value();
            };
            EXPECT_GE(cotangent(side) + cotangent(other), -1e-9);
        }
    }
}

} // namespace test_flat_polygons
