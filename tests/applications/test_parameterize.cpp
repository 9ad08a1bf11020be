// Parameterization: against the known conformal modulus of a torus, exact
// transitions and cone angles by independent sums, convergence under
// refinement, invariance under intrinsic flips, scaling laws, refusals.
#include "support/watched_host.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>

namespace test_parameterize {

using namespace test;

namespace {

constexpr double PI = 3.14159265358979323846;

struct Flat {
    hmf_status status = HMF_ERROR_INTERNAL;
    hmf_error error{};
    hmf_parameterization numbers{};
    std::vector<double> uv, transition, dilatation, differential;
    std::vector<uint8_t> seam;
    std::vector<int32_t> cone;
};

Flat parameterize(const Foliation& foliation, const hmf_parameterize_options* options = nullptr,
                  const hmf_control* control = nullptr) {
    Flat flat;
    hmf_parameterization* out = reinterpret_cast<hmf_parameterization*>(&flat); // must be overwritten
    flat.status = hmf_parameterize(foliation.get(), options, control, &out, &flat.error);
    const Owned<hmf_parameterization> p(out);
    EXPECT_EQ(out != nullptr, flat.status == HMF_OK);
    if (!p) return flat;
    flat.numbers = *p;
    EXPECT_GE(p->struct_size, sizeof *p);
    for (const void* array : {static_cast<const void*>(p->corner_uv), static_cast<const void*>(p->transition),
                              static_cast<const void*>(p->dilatation), static_cast<const void*>(p->differential)})
        EXPECT_EQ(reinterpret_cast<uintptr_t>(array) % alignof(double), 0u);
    flat.uv.assign(p->corner_uv, p->corner_uv + 6 * p->triangle_count);
    flat.transition.assign(p->transition, p->transition + 3 * p->edge_count);
    flat.seam.assign(p->seam, p->seam + p->edge_count);
    flat.cone.assign(p->cone, p->cone + p->vertex_count);
    flat.dilatation.assign(p->dilatation, p->dilatation + p->triangle_count);
    flat.differential.assign(p->differential, p->differential + 2 * p->triangle_count);
    return flat;
}

hmf_parameterize_options parameterize_options() {
    hmf_parameterize_options options{};
    options.struct_size = sizeof options;
    return options;
}

Solution harmonic(const Hierarchy& hierarchy, const Loops* loops = nullptr) {
    Solution s = solve(hierarchy, loops, solve_options(HMF_METHOD_NEWTON, 1e-8));
    EXPECT_EQ(s.status, HMF_OK) << s.error.message;
    return s;
}

// Around a vertex (u, v) comes back with the opposite sign exactly where the cone angle is an odd multiple of pi.
void expect_parity(const LevelMesh& mesh, const Flat& flat) {
    std::vector<int> turn(mesh.vertex_count, 1);
    for (size_t e = 0; e < mesh.edge_count; ++e)
        for (size_t end = 0; end < 2; ++end)
            if (flat.transition[3 * e] < 0) turn[mesh.edge_vertices[2 * e + end]] *= -1;
    for (size_t v = 0; v < mesh.vertex_count; ++v)
        EXPECT_EQ(turn[v] < 0, flat.cone[v] % 2 != 0) << "vertex " << v << ", cone " << flat.cone[v];
}

// Everything that holds for every parameterization.  share: of the vertices, at least, whose triangles are all sound.
void expect_flat_cone_metric(const LevelMesh& mesh, const Foliation& foliation, const Flat& flat, size_t genus,
                             double share = 0.9) {
    ASSERT_EQ(flat.status, HMF_OK) << flat.error.message;
    ASSERT_EQ(flat.numbers.vertex_count, mesh.vertex_count);
    ASSERT_EQ(flat.numbers.edge_count, mesh.edge_count);
    ASSERT_EQ(flat.numbers.triangle_count, mesh.triangle_count);
    const std::vector<double> values = values_of(foliation);
    // Transitions: the same points from both sides, to the bit; seams are where they are not the identity.
    std::vector<size_t> first(mesh.edge_count, SIZE_MAX);
    size_t seams = 0;
    for (size_t t = 0; t < mesh.triangle_count; ++t)
        for (size_t s = 0; s < 3; ++s) {
            const size_t e = mesh.triangle_edges[3 * t + s], here = 3 * t + s;
            if (first[e] == SIZE_MAX) {
                first[e] = here;
                continue;
            }
            const double* g = &flat.transition[3 * e];
            ASSERT_TRUE(g[0] == 1 || g[0] == -1);
            const size_t there = first[e];
            const size_t ends[2][2] = {{there, 3 * t + (s + 1) % 3}, {3 * (there / 3) + (there % 3 + 1) % 3, here}};
            for (const auto& end : ends)
                for (size_t x = 0; x < 2; ++x)
                    ASSERT_EQ(g[0] * flat.uv[2 * end[0] + x] + g[1 + x], flat.uv[2 * end[1] + x]) << "edge " << e;
            seams += flat.seam[e];
            if (!flat.seam[e]) { ASSERT_TRUE(g[0] == 1 && g[1] == 0 && g[2] == 0) << "edge " << e; }
        }
    EXPECT_EQ(seams, flat.numbers.seam_edge_count);
    // Gauss and Bonnet.
    long sum = 0;
    for (const int32_t c : flat.cone) sum += 2 - c;
    EXPECT_EQ(sum, 4 - 4 * static_cast<long>(genus));
    expect_parity(mesh, flat);
    // The angle in the plane is the cone angle where no triangle at the vertex is flipped; u is the foliation but near
    // the zeros.
    std::vector<double> angle(mesh.vertex_count, 0), area(mesh.vertex_count, 0);
    std::vector<uint8_t> sound(mesh.vertex_count, 1);
    double image = 0;
    size_t flipped = 0;
    for (size_t t = 0; t < mesh.triangle_count; ++t) {
        const double* p = &flat.uv[6 * t];
        const double twice = (p[2] - p[0]) * (p[5] - p[1]) - (p[4] - p[0]) * (p[3] - p[1]);
        image += twice / 2;
        flipped += flat.dilatation[t] < 0;
        ASSERT_TRUE(std::fabs(flat.dilatation[t]) >= 1 - 1e-12);
        for (size_t s = 0; s < 3; ++s) {
            const double* a = p + 2 * s;
            const double *b = p + 2 * ((s + 1) % 3), *c = p + 2 * ((s + 2) % 3);
            const double x1 = b[0] - a[0], y1 = b[1] - a[1], x2 = c[0] - a[0], y2 = c[1] - a[1];
            const uint32_t v = mesh.triangle_vertices[3 * t + s];
            angle[v] += std::atan2(x1 * y2 - x2 * y1, x1 * x2 + y1 * y2);
            if (!(flat.dilatation[t] > 0 && flat.dilatation[t] < 100)) sound[v] = 0;
        }
    }
    EXPECT_EQ(flipped, flat.numbers.flipped_count);
    EXPECT_NEAR(image, flat.numbers.area, 1e-9 * std::fabs(image));
    size_t compared = 0;
    for (size_t v = 0; v < mesh.vertex_count; ++v) {
        if (!sound[v]) continue;
        ++compared;
        EXPECT_NEAR(angle[v], PI * flat.cone[v], 1e-6) << "vertex " << v;
    }
    EXPECT_GT(static_cast<double>(compared), share * static_cast<double>(mesh.vertex_count));
    double difference = 0, total = 0;
    for (size_t e = 0; e < mesh.edge_count; ++e) {
        const size_t k = first[e], n = 3 * (k / 3) + (k % 3 + 1) % 3;
        difference += std::fabs(std::fabs(flat.uv[2 * k] - flat.uv[2 * n]) - values[e]);
        total += values[e];
    }
    EXPECT_LT(difference, 0.02 * total);
}

} // namespace

// Ratio of the singular values of the linear map of a triangle, by its invariants.
double dilatation_of(const double* p[3], const double u[3], const double v[3]) {
    double a[3], b[3];
    for (int x = 0; x < 3; ++x) a[x] = p[1][x] - p[0][x], b[x] = p[2][x] - p[0][x];
    const double e = a[0] * a[0] + a[1] * a[1] + a[2] * a[2], f = a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
                 g = b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
    const double du1 = u[1] - u[0], du2 = u[2] - u[0], dv1 = v[1] - v[0], dv2 = v[2] - v[0];
    // Squares of the singular values: roots of x^2 - trace x + determinant.
    const double det = e * g - f * f;
    const double E = du1 * du1 + dv1 * dv1, F = du1 * du2 + dv1 * dv2, G = du2 * du2 + dv2 * dv2;
    const double trace = (E * g - 2 * F * f + G * e) / det, determinant = (E * G - F * F) / det;
    const double root = std::sqrt(std::max(0.0, trace * trace / 4 - determinant));
    return std::sqrt((trace / 2 + root) / (trace / 2 - root));
}

// A torus of radii R, r is conformal to the rectangle of 2 pi by 2 pi r / sqrt(R^2 - r^2).
TEST(Parameterize, ModulusOfATorus) {
    const double R = 2, r = 0.8, modulus = r / std::sqrt(R * R - r * r);
    double before = 1;
    for (const size_t n : {24, 48, 96}) {
        SCOPED_TRACE(n);
        const Hierarchy hierarchy(torus(2 * n, n, R, r), 0.5, 300);
        ASSERT_TRUE(hierarchy);
        const Loops loops = meridian(hierarchy, hierarchy.coarsest());
        const Solution s = harmonic(hierarchy, &loops);
        const LevelMesh mesh = read_level(hierarchy, 0);
        const Flat flat = parameterize(s.foliation);
        expect_flat_cone_metric(mesh, s.foliation, flat, 1);
        // The period of u around the axis is 1, and the area the modulus.
        const double error = std::fabs(flat.numbers.area / modulus - 1);
        EXPECT_LT(error, 0.35 * before) << n; // second order: a quarter
        before = error;
        EXPECT_EQ(flat.numbers.flipped_count, 0u);
        for (const int32_t c : flat.cone) EXPECT_EQ(c, 2);
        // The exact conformal map, taken at the vertices, is linear in no triangle either: nothing can be much better.
        double exact = 0, found = 0;
        for (size_t t = 0; t < mesh.triangle_count; ++t) {
            const double* p[3];
            double u[3], v[3];
            for (size_t c = 0; c < 3; ++c) {
                p[c] = &mesh.positions[3 * mesh.triangle_vertices[3 * t + c]];
                u[c] = std::atan2(p[c][1], p[c][0]);
                const double tube = std::atan2(p[c][2], std::hypot(p[c][0], p[c][1]) - R);
                v[c] = 2 * modulus * std::atan2(std::sqrt((R - r) / (R + r)) * std::sin(tube / 2), std::cos(tube / 2));
                u[c] -= 2 * PI * std::round((u[c] - u[0]) / (2 * PI));
                v[c] -= 2 * PI * modulus * std::round((v[c] - v[0]) / (2 * PI * modulus));
            }
            exact += dilatation_of(p, u, v);
            found += std::fabs(flat.dilatation[t]);
        }
        EXPECT_LT(found / static_cast<double>(mesh.triangle_count) - 1,
                  1.1 * (exact / static_cast<double>(mesh.triangle_count) - 1))
            << n;
    }
    EXPECT_LT(before, 2e-3);
}

TEST(Parameterize, SurfacesOfSeveralGenera) {
    for (const size_t genus : {1, 2, 3, 5}) {
        SCOPED_TRACE(genus);
        const Hierarchy hierarchy(pretzel(genus, 3), 0.5, 300);
        ASSERT_TRUE(hierarchy);
        const Solution s = harmonic(hierarchy);
        const LevelMesh mesh = read_level(hierarchy, 0);
        const Flat flat = parameterize(s.foliation);
        expect_flat_cone_metric(mesh, s.foliation, flat, genus);
        EXPECT_NEAR(flat.numbers.area, s.report.energy, 2e-3 * s.report.energy);
        // The map is injective beside the zeros, and nearly conformal: flips only in triangles near one.
        std::vector<uint8_t> near(mesh.vertex_count, 0);
        for (size_t v = 0; v < mesh.vertex_count; ++v) near[v] = flat.cone[v] != 2;
        for (int ring = 0; ring < 2; ++ring) {
            const std::vector<uint8_t> inner = near;
            for (size_t e = 0; e < mesh.edge_count; ++e)
                for (size_t x = 0; x < 2; ++x)
                    near[mesh.edge_vertices[2 * e + x]] |= inner[mesh.edge_vertices[2 * e + 1 - x]];
        }
        // Near a zero of order k the map is z^(1 + k/2), and its linear interpolation on a triangle there may have any
        // dilatation: one triangle with 674 is enough to raise the mean of 2 000 from 1.08 to 1.23.
        double dilatation = 0;
        size_t regular = 0;
        for (size_t t = 0; t < mesh.triangle_count; ++t) {
            if (near[mesh.triangle_vertices[3 * t]]) continue;
            EXPECT_GT(flat.dilatation[t], 0) << "triangle " << t;
            dilatation += flat.dilatation[t];
            ++regular;
        }
        EXPECT_LT(dilatation, 1.2 * static_cast<double>(regular));
        EXPECT_GT(regular, mesh.triangle_count / 2);
    }
}

// Conformal in the limit (the same shape at three resolutions, [W] Fig. 13).
TEST(Parameterize, DilatationFallsUnderRefinement) {
    TriMesh mesh = pretzel(2, 2);
    double mean = 10, median = 10;
    for (int round = 0; round < 3; ++round) {
        const Hierarchy hierarchy(mesh, 0.5, 300);
        ASSERT_TRUE(hierarchy);
        const Loops loops = library_loops(hierarchy, hierarchy.coarsest());
        const Flat flat = parameterize(harmonic(hierarchy, &loops).foliation);
        ASSERT_EQ(flat.status, HMF_OK) << flat.error.message;
        EXPECT_LT(flat.numbers.dilatation_median - 1, 0.7 * (median - 1)) << round;
        EXPECT_LT(flat.numbers.dilatation_mean - 1, 0.9 * (mean - 1)) << round;
        mean = flat.numbers.dilatation_mean;
        median = flat.numbers.dilatation_median;
        mesh = smooth(subdivide(mesh), 2);
    }
    EXPECT_LT(median, 1.05);
}

// The quadratic differential has the directions and the size of the map: exact for a conformal one.
TEST(Parameterize, DifferentialOfTheMap) {
    const Hierarchy hierarchy(torus(96, 48, 2, 0.8), 0.5, 300);
    ASSERT_TRUE(hierarchy);
    const Loops loops = meridian(hierarchy, hierarchy.coarsest());
    const Flat flat = parameterize(harmonic(hierarchy, &loops).foliation);
    ASSERT_EQ(flat.status, HMF_OK);
    const LevelMesh mesh = read_level(hierarchy, 0);
    for (size_t t = 0; t < mesh.triangle_count; ++t) {
        // Along side 0: (du + i dv)^2 = phi dx^2 up to the dilatation.
        const double* p = &flat.uv[6 * t];
        double square = 0;
        for (size_t x = 0; x < 3; ++x) {
            const double d = mesh.positions[3 * mesh.triangle_vertices[3 * t + 1] + x]
                           - mesh.positions[3 * mesh.triangle_vertices[3 * t] + x];
            square += d * d;
        }
        const double du = p[2] - p[0], dv = p[3] - p[1];
        const double re = (du * du - dv * dv) / square, im = 2 * du * dv / square;
        const double size = std::hypot(flat.differential[2 * t], flat.differential[2 * t + 1]);
        EXPECT_LT(std::hypot(re - flat.differential[2 * t], im - flat.differential[2 * t + 1]), 0.15 * size) << t;
    }
}

// The same surface with other diagonals in its flat parts has the same intrinsic
// triangulation, up to co-circular points; the map is carried back to each.
TEST(Parameterize, BadTriangulationsGiveTheSameMap) {
    const TriMesh good = subdivide(subdivide(subdivide(plate(2))));
    const TriMesh bad = with_random_flips(good, 20000, 1 - 1e-12, 3);
    ASSERT_NE(good.triangles, bad.triangles);
    double area[2], energy[2];
    for (int i = 0; i < 2; ++i) {
        const Hierarchy hierarchy(i ? bad : good, 0.5, 300);
        ASSERT_TRUE(hierarchy);
        const Loops loops = plate_loops(hierarchy, 0, 2);
        const Solution s = harmonic(hierarchy, &loops);
        const Flat flat = parameterize(s.foliation);
        expect_flat_cone_metric(read_level(hierarchy, 0), s.foliation, flat, 2, i ? 0.5 : 0.9);
        area[i] = flat.numbers.area;
        energy[i] = s.report.energy;
    }
    EXPECT_NEAR(energy[0], energy[1], 1e-9 * energy[0]);
    EXPECT_NEAR(area[0], area[1], 1e-3 * area[0]); // a zero may take another corner
}

TEST(Parameterize, CoarseLevelsToo) {
    const Hierarchy hierarchy(pretzel(2, 4), 0.5, 400);
    ASSERT_TRUE(hierarchy);
    const Solution fine = harmonic(hierarchy);
    for (size_t level = 1; level < hierarchy.levels(); ++level) {
        SCOPED_TRACE(level);
        hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 1e-8);
        options.stop_level = level;
        const Solution s = solve(hierarchy, nullptr, options);
        ASSERT_EQ(s.status, HMF_OK);
        const LevelMesh mesh = read_level(hierarchy, level);
        expect_flat_cone_metric(mesh, s.foliation, parameterize(s.foliation), 2);
    }
}

TEST(Parameterize, Scaling) {
    const TriMesh mesh = pretzel(2, 3);
    const Hierarchy one(mesh, 0.5, 300), eight(scaled(mesh, 8), 0.5, 300);
    Loops loops = library_loops(one, one.coarsest());
    loops.weights.assign(loops.count(), 1);
    const Flat a = parameterize(harmonic(one, &loops).foliation);
    const Flat b = parameterize(harmonic(eight, &loops).foliation);
    loops.weights.assign(loops.count(), 4);
    const Flat c = parameterize(harmonic(one, &loops).foliation);
    ASSERT_EQ(a.status, HMF_OK);
    EXPECT_EQ(a.uv, b.uv);
    EXPECT_EQ(a.seam, b.seam);
    ASSERT_EQ(a.uv.size(), c.uv.size());
    for (size_t i = 0; i < a.uv.size(); ++i) ASSERT_EQ(4 * a.uv[i], c.uv[i]);
}

TEST(Parameterize, SeamsPreferTheEdgesGiven) {
    const Hierarchy hierarchy(pretzel(2, 3), 0.5, 300);
    ASSERT_TRUE(hierarchy);
    const Solution s = harmonic(hierarchy);
    const Flat plain = parameterize(s.foliation);
    ASSERT_EQ(plain.status, HMF_OK);
    // Every third edge, by a rule that has nothing to do with the seams.
    std::vector<uint32_t> wanted;
    for (uint32_t e = 0; e < plain.seam.size(); ++e)
        if (e % 3 != 0) wanted.push_back(e);
    hmf_parameterize_options options = parameterize_options();
    options.seam_edges = wanted.data();
    options.seam_edge_count = wanted.size();
    const Flat guided = parameterize(s.foliation, &options);
    expect_flat_cone_metric(read_level(hierarchy, 0), s.foliation, guided, 2);
    const auto off = [](const Flat& flat) {
        size_t count = 0;
        for (size_t e = 0; e < flat.seam.size(); e += 3) count += flat.seam[e];
        return count;
    };
    EXPECT_LT(off(guided), off(plain) / 4);
}

// A seam ends at cones only: elsewhere both sides of its end agree, and it can be healed.
TEST(Parameterize, SeamsEndAtCones) {
    for (const size_t genus : {1, 2, 3}) {
        SCOPED_TRACE(genus);
        const Hierarchy hierarchy(pretzel(genus, 3), 0.5, 300);
        ASSERT_TRUE(hierarchy);
        const Flat flat = parameterize(harmonic(hierarchy).foliation);
        ASSERT_EQ(flat.status, HMF_OK);
        const LevelMesh mesh = read_level(hierarchy, 0);
        std::vector<int> seams(mesh.vertex_count, 0);
        for (size_t e = 0; e < mesh.edge_count; ++e)
            for (size_t x = 0; x < 2; ++x) seams[mesh.edge_vertices[2 * e + x]] += flat.seam[e];
        size_t met = 0;
        for (size_t v = 0; v < mesh.vertex_count; ++v) {
            met += seams[v] > 0;
            if (seams[v] == 1) { EXPECT_NE(flat.cone[v], 2) << "vertex " << v; }
        }
        EXPECT_GT(met, 0u);
        // What is cut is one disk: a seam graph with V - E = 1 - 2 genus.
        EXPECT_EQ(static_cast<long>(met) - static_cast<long>(flat.numbers.seam_edge_count),
                  1 - 2 * static_cast<long>(genus));
    }
}

TEST(Parameterize, ArraysAreAligned) { // where the counts are odd
    const Hierarchy hierarchy(torus(15, 9, 2, 0.8));
    ASSERT_TRUE(hierarchy);
    EXPECT_EQ(parameterize(harmonic(hierarchy).foliation).status, HMF_OK);
}

// The second call finds what the first has left; calls at the same time, of
// which all but one are too late to leave anything, give the same and keep nothing.
TEST(Parameterize, IsSharedByCallsAtTheSameTime) {
    WatchedHost watched;
    {
        const Hierarchy hierarchy(pretzel(2, 3), watched.options(300));
        ASSERT_TRUE(hierarchy);
        const Solution s = harmonic(hierarchy);
        ASSERT_LE(s.report.residual_max, 1e-8);
        const uint64_t before = watched.used;
        Flat second;
        struct Beside {
            const Foliation& foliation;
            Flat& flat;
            bool done = false;
            static int32_t call(void* user, double fraction) {
                Beside& beside = *static_cast<Beside*>(user);
                if (fraction > 0.1 && !beside.done) {
                    beside.done = true; // this call waits until the other one has ended
                    std::thread([&] { beside.flat = parameterize(beside.foliation); }).join();
                }
                return HMF_PROGRESS_CONTINUE;
            }
        } beside{s.foliation, second};
        hmf_control control{};
        control.struct_size = sizeof control;
        control.progress = Beside::call;
        control.progress_user = &beside;
        const uint64_t calls = watched.calls;
        const Flat first = parameterize(s.foliation, nullptr, &control);
        ASSERT_TRUE(beside.done);
        const uint64_t both = watched.calls - calls, kept = watched.used - before;
        const Flat third = parameterize(s.foliation);
        EXPECT_EQ(first.uv, second.uv);
        EXPECT_EQ(first.uv, third.uv);
        EXPECT_EQ(watched.used - before, kept); // one flat surface
        EXPECT_LT(3 * (watched.calls - calls - both), both);
    }
    EXPECT_EQ(watched.used, 0u);
}

// A limb that no loop goes around: what is known there is less than rounding.
TEST(Parameterize, DeadLimbsAreDegenerateNotWrong) {
    const Hierarchy hierarchy(torus_with_finger(40, 20, 60, 30), 0.5, 300);
    ASSERT_TRUE(hierarchy);
    const Solution s = harmonic(hierarchy);
    const Flat flat = parameterize(s.foliation);
    ASSERT_EQ(flat.status, HMF_OK) << flat.error.message;
    EXPECT_GT(flat.numbers.degenerate_count, 100u);
    EXPECT_TRUE(std::isfinite(flat.numbers.dilatation_mean));
    long sum = 0;
    for (const int32_t c : flat.cone) sum += 2 - c;
    EXPECT_EQ(sum, 0);
    expect_parity(read_level(hierarchy, 0), flat);
}

// A few vertices above the tolerance may be the work of the flips; many say that the values are not harmonic,
// also where it would take little to make them so.
TEST(Parameterize, ManyVerticesAboveTheToleranceAreRefused) {
    const Hierarchy hierarchy(pretzel(2, 2), 0.5, 300);
    ASSERT_TRUE(hierarchy);
    const Foliation start = initialize(hierarchy, library_loops(hierarchy, 0));
    size_t tried = 0;
    for (const uint64_t sweeps : {1, 2, 4}) {
        const Solution some = relax(start, solve_options(HMF_METHOD_WHITEHEAD, 1e-15, sweeps));
        const LevelMesh mesh = read_level(hierarchy, 0);
        const std::vector<double> residual = residuals(some.foliation, mesh.vertex_count);
        for (const double tolerance : {0.1, 0.3, 0.6}) {
            const auto above = static_cast<size_t>(
                std::count_if(residual.begin(), residual.end(), [&](double r) { return r > tolerance; }));
            if (above <= 16 + mesh.vertex_count / 20) continue;
            ++tried;
            hmf_parameterize_options options = parameterize_options();
            options.tolerance = tolerance;
            EXPECT_EQ(parameterize(some.foliation, &options).status, HMF_ERROR_VALUE_NOT_HARMONIC)
                << sweeps << " sweeps, " << above << " above " << tolerance;
        }
    }
    EXPECT_GT(tried, 1u);
}

TEST(Parameterize, Refusals) {
    const Hierarchy hierarchy(pretzel(2, 3), 0.5, 300);
    ASSERT_TRUE(hierarchy);
    const Solution s = harmonic(hierarchy);
    Flat flat = parameterize(initialize(hierarchy, library_loops(hierarchy, 0)));
    EXPECT_EQ(flat.status, HMF_ERROR_VALUE_NOT_HARMONIC);
    EXPECT_EQ(flat.error.element, HMF_ELEMENT_VERTEX);

    hmf_parameterize_options options = parameterize_options();
    const uint32_t edge = static_cast<uint32_t>(hierarchy.edges(0));
    options.seam_edges = &edge;
    options.seam_edge_count = 1;
    flat = parameterize(s.foliation, &options);
    EXPECT_EQ(flat.status, HMF_ERROR_OPTIONS);
    EXPECT_EQ(flat.error.index, edge);
    options.seam_edges = nullptr;
    EXPECT_EQ(parameterize(s.foliation, &options).status, HMF_ERROR_OPTIONS);
    options = parameterize_options();
    options.tolerance = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(parameterize(s.foliation, &options).status, HMF_ERROR_OPTIONS);
}

} // namespace test_parameterize
