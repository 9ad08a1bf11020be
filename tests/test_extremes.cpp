// Meshes and moments at the limits: vertices of high degree, needles that
// rounding can be seen at, surfaces that are much longer than wide, a stop at any call of the progress function.
#include "support/meter.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../src/api/foliation_object.hpp"

using namespace test;

namespace {

Solution run(const Hierarchy& hierarchy, const hmf_control* control = nullptr) {
    return solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 1e-8), control);
}

uint64_t finest_linear_solves(const Solution& solution) { return solution.report.levels[0].linear_solves; }

// A wheel with n spokes in triangle f: it stays when the triangulation becomes Delaunay.
TriMesh with_hub(const TriMesh& mesh, size_t f, uint32_t n) {
    TriMesh made = mesh;
    const uint32_t corner[3] = {made.triangles[3 * f], made.triangles[3 * f + 1], made.triangles[3 * f + 2]};
    const uint32_t hub = static_cast<uint32_t>(made.vertex_count());
    double x[3], y[3]; // two sides, made orthonormal
    double xx = 0, xy = 0, yy = 0;
    for (size_t i = 0; i < 3; ++i) {
        x[i] = mesh.positions[3 * corner[1] + i] - mesh.positions[3 * corner[0] + i];
        y[i] = mesh.positions[3 * corner[2] + i] - mesh.positions[3 * corner[0] + i];
        xx += x[i] * x[i];
        xy += x[i] * y[i];
        made.positions.push_back(
            (mesh.positions[3 * corner[0] + i] + mesh.positions[3 * corner[1] + i] + mesh.positions[3 * corner[2] + i])
            / 3);
    }
    for (size_t i = 0; i < 3; ++i) {
        y[i] -= x[i] * xy / xx;
        yy += y[i] * y[i];
    }
    const double radius = 0.1 * std::sqrt(yy);
    const auto place = [&](const double* p) { // its direction from the hub
        double px = 0, py = 0;
        for (size_t i = 0; i < 3; ++i) {
            px += (p[i] - made.positions[3 * hub + i]) * x[i] / std::sqrt(xx);
            py += (p[i] - made.positions[3 * hub + i]) * y[i] / std::sqrt(yy);
        }
        return std::atan2(py, px);
    };
    double at[3];
    for (size_t c = 0; c < 3; ++c) at[c] = place(&made.positions[3 * corner[c]]);
    std::vector<size_t> near(n);
    for (uint32_t k = 0; k < n; ++k) {
        const double angle = 2 * 3.14159265358979323846 * k / n;
        double most = -2;
        for (size_t c = 0; c < 3; ++c)
            if (std::cos(angle - at[c]) > most) {
                most = std::cos(angle - at[c]);
                near[k] = c;
            }
        for (size_t i = 0; i < 3; ++i)
            made.positions.push_back(
                made.positions[3 * hub + i]
                + radius * (std::cos(angle) * x[i] / std::sqrt(xx) + std::sin(angle) * y[i] / std::sqrt(yy)));
    }
    made.triangles.erase(made.triangles.begin() + static_cast<long>(3 * f),
                         made.triangles.begin() + static_cast<long>(3 * f + 3));
    for (uint32_t k = 0; k < n; ++k) {
        const uint32_t here = hub + 1 + k, ahead = hub + 1 + (k + 1) % n, c = corner[near[k]],
                       d = corner[near[(k + 1) % n]];
        made.triangles.insert(made.triangles.end(), {hub, here, ahead, here, c, ahead});
        if (c != d) made.triangles.insert(made.triangles.end(), {ahead, c, d});
    }
    return made;
}

// A point close to an end of each of some edges.
TriMesh with_needles(const TriMesh& mesh, double share) {
    TriMesh made = mesh;
    for (size_t f = 0; f < mesh.triangle_count(); f += 9) {
        const uint32_t a = made.triangles[3 * f], b = made.triangles[3 * f + 1], c = made.triangles[3 * f + 2];
        const uint32_t v = static_cast<uint32_t>(made.vertex_count());
        for (size_t i = 0; i < 3; ++i)
            made.positions.push_back((1 - 2 * share) * made.positions[3 * a + i] + share * made.positions[3 * b + i]
                                     + share * made.positions[3 * c + i]);
        made.triangles[3 * f + 2] = v;
        made.triangles.insert(made.triangles.end(), {b, c, v, c, a, v});
    }
    return made;
}

TEST(Extremes, VertexOfHighDegree) {
    for (uint32_t degree : {40u, 64u, 65u, 130u, 500u})
        for (size_t f : {0u, 11u, 100u}) {
            const TriMesh mesh = with_hub(torus(14, 8, 3, 1), f, degree);
            ASSERT_EQ(mesh_defect(mesh), "");
            const Hierarchy hierarchy(mesh);
            ASSERT_TRUE(hierarchy);
            const Solution outcome = run(hierarchy);
            EXPECT_EQ(outcome.status, HMF_OK) << degree << ", " << f;
            EXPECT_LE(outcome.report.residual_max, 1e-8);
            EXPECT_EQ(outcome.report.poles, 0u);
            EXPECT_LE(finest_linear_solves(outcome), 4u);
        }
}

// The unit of the values becomes finer where steps do not help.
TEST(Extremes, NeedlesNeedAFinerUnitAndNotMoreSteps) {
    const Hierarchy hierarchy(with_needles(torus(14, 8, 3, 1), 1e-7));
    ASSERT_TRUE(hierarchy);
    const Solution outcome = run(hierarchy);
    EXPECT_EQ(outcome.status, HMF_OK);
    EXPECT_LE(outcome.report.residual_max, 1e-8);
    EXPECT_LE(finest_linear_solves(outcome), 7u);
}

// Short ways round the thin direction are very many: the search is not to get
// lost in their multiples.
TEST(Extremes, TunnelLoopsOfAStretchedSurface) {
    TriMesh mesh = pretzel(4, 2);
    for (size_t v = 0; v < mesh.vertex_count(); ++v) mesh.positions[3 * v + 1] *= 1000;
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0, HMF_LOOPS_TUNNEL);
    EXPECT_EQ(loops.count(), 4u);
    const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 1e-8));
    EXPECT_EQ(solution.status, HMF_OK);
    EXPECT_EQ(solution.report.zeros, 12u);
}

// A late cancellation gives a foliation; what is said of it is true.
TEST(Extremes, NoResidualAfterACancellation) {
    const Hierarchy hierarchy(plate(1), 0.5, 10);
    ASSERT_TRUE(hierarchy);
    Progress whole;
    hmf_control control = whole.control();
    ASSERT_EQ(run(hierarchy, &control).status, HMF_OK);
    size_t given = 0;
    for (uint64_t stop = 1; stop <= whole.calls; ++stop) {
        Progress progress;
        progress.stop = stop;
        control = progress.control();
        const Solution outcome = run(hierarchy, &control);
        if (outcome.status == HMF_OK || !outcome.foliation) continue;
        ++given;
        EXPECT_EQ(outcome.status, HMF_CANCELLED);
        EXPECT_LT(outcome.report.residual_max, 0) << stop;
    }
    EXPECT_GT(given, 0u);
}

} // namespace

// A double holds integers up to 2^53: beyond that equalities would be lost.
TEST(Extremes, ValuesThatADoubleCannotHold) {
    const Hierarchy hierarchy(pretzel(2, 1));
    ASSERT_TRUE(hierarchy);
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf_error error{};
    hmf::Call call(memory, &error, nullptr, nullptr);
    hmf::State state;
    ASSERT_TRUE(state.allocate(*hierarchy.get(), 0, memory));
    state.load(0, hmf::Side::input);
    for (size_t e = 0; e < hierarchy.edges(0); ++e) state.foliation.value[e] = int64_t{1} << 53;
    hmf::Making making;
    making.unit = 0.5;
    hmf_foliation* made = nullptr;
    ASSERT_EQ(hmf::make_foliation(state, making, call, &made), HMF_OK);
    for (const double x : values_of(Foliation(made))) ASSERT_EQ(x, std::ldexp(1.0, 52));
    state.foliation.value[3] += 2;
    made = nullptr;
    EXPECT_EQ(hmf::make_foliation(state, making, call, &made), HMF_ERROR_UNSUPPORTED);
    EXPECT_EQ(error.element, HMF_ELEMENT_EDGE);
    EXPECT_EQ(made, nullptr);
}
