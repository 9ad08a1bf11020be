// Meshes and moments at the limits: vertices of high degree, needles that
// rounding can be seen at, surfaces that are much longer than wide, a stop at any call of the progress function.
#include "support/extreme_surfaces.hpp"
#include "support/watched_host.hpp"
#include "support/read_obj.hpp"
#include "support/surface.hpp"

#include <algorithm>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>

#include "src/core/api/foliation_object.hpp"
#include "src/core/extreme/coarser_unit.hpp"

namespace test_extremes {

using namespace test;

namespace {

Solution run(const Hierarchy& hierarchy, const hmf_control* control = nullptr) {
    return solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 1e-8), control);
}

uint64_t finest_linear_solves(const Solution& solution) { return solution.report.levels[0].linear_solve_count; }

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

// More neighbors than can be solved for are refused before the work starts. Coarser levels have fewer.
TEST(Extremes, VertexOfTooHighDegree) {
    constexpr uint32_t degree = 50001, hub = 12 + degree;
    const Hierarchy hierarchy(wheels(degree, 1));
    ASSERT_TRUE(hierarchy);
    const Loops loops = library_loops(hierarchy, 0);
    const hmf_loop_set view = loops.view();
    const Foliation start = make<hmf_foliation>([&](hmf_foliation** out, hmf_error* error) {
        return hmf_foliation_from_loops(hierarchy.get(), &view, nullptr, out, error);
    });
    hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 1e-8);
    enum { by_solve, by_relax, by_cylinders, ways };
    for (int way = 0; way < ways; ++way) {
        SCOPED_TRACE(way);
        Progress progress;
        const hmf_control control = progress.control();
        hmf_foliation* out = nullptr;
        hmf_cylinder_set* set = nullptr;
        hmf_error error{};
        const hmf_status status = way == by_solve ? hmf_solve(hierarchy.get(), &view, &options, &control, &out, &error)
                                : way == by_relax ? hmf_relax(start.get(), &options, &control, &out, &error)
                                                  : hmf_cylinders(start.get(), nullptr, &control, &set, &error);
        EXPECT_EQ(status, HMF_ERROR_UNSUPPORTED);
        EXPECT_EQ(out, nullptr);
        EXPECT_EQ(set, nullptr);
        EXPECT_EQ(error.element, HMF_ELEMENT_VERTEX);
        EXPECT_EQ(error.index, hub);
        EXPECT_NE(std::string(error.message).find("50001 neighbors"), std::string::npos) << error.message;
        EXPECT_LT(progress.calls, 1000u);
        hmf_foliation_destroy(out);
    }
    options.stop_level = hierarchy.coarsest();
    EXPECT_EQ(solve(hierarchy, &loops, options).status, HMF_OK);
}

// Polygons of many corners, some of which come to lie at the pole of a marked vertex and have to leave it.
TEST(Extremes, VerticesLeaveThePoleOfAMarkedVertex) {
    for (const uint32_t corners : {1160u, 2000u, 3200u}) {
        SCOPED_TRACE(corners);
        const uint32_t marks[4] = {0, corners / 4, corners / 2, 3 * corners / 4};
        hmf_hierarchy_options build{};
        build.struct_size = sizeof build;
        build.marked_vertices = marks;
        build.marked_count = 4;
        const Hierarchy hierarchy(fan_polygon(corners), build);
        ASSERT_TRUE(hierarchy);
        const Solution outcome = run(hierarchy);
        EXPECT_EQ(outcome.status, HMF_OK);
        EXPECT_LE(outcome.report.residual_max, 1e-8);
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

// Limbs with zeros deep inside, which have far to go on level 0: where a step fails, all places that it broke are held.
TEST(Extremes, ZerosDeepInLimbs) {
    const char* const folder = std::getenv("HMF_MESHES");
    TriMesh mesh;
    if (!folder || !read_obj(std::string(folder) + "/boot_40k.obj", mesh))
        GTEST_SKIP() << "skipped: set HMF_MESHES to a folder with boot_40k.obj";
    // How many it takes in one position is chance.
    uint64_t solves = 0;
    for (const double angle : {2.2944, 5.95959}) {
        const Hierarchy hierarchy(transformed(mesh, rotation(0, 1, 0, angle)));
        ASSERT_TRUE(hierarchy);
        const Solution outcome = run(hierarchy);
        EXPECT_EQ(outcome.status, HMF_OK) << angle;
        EXPECT_LE(outcome.report.residual_max, 1e-8);
        solves += finest_linear_solves(outcome);
    }
    EXPECT_LE(solves, 26u); // 24 and 28 where only the first place was held
    // In three orders of its triangles: 32 solves together where a middle level made one step only, and no more.
    solves = 0;
    for (size_t k = 0; k < 3; ++k) {
        TriMesh turned = mesh;
        const ptrdiff_t quarter = static_cast<ptrdiff_t>(turned.triangles.size() / 12 * 3);
        std::rotate(turned.triangles.begin(), turned.triangles.begin() + static_cast<ptrdiff_t>(k) * quarter,
                    turned.triangles.end());
        const Hierarchy hierarchy(turned);
        ASSERT_TRUE(hierarchy);
        const Solution outcome = run(hierarchy);
        EXPECT_LE(outcome.report.residual_max, 1e-8);
        solves += finest_linear_solves(outcome);
    }
    EXPECT_LE(solves, 24u);
}

// Beside a needle of 1e-6 degrees a unit is a residual of 1e-8 and more: sweeps come to rest there, and go on with a
// finer unit.  Without that they end with HMF_LIMIT_STALLED at 1.7e-8, 1.5e-8 and 2.8e-8.
TEST(Extremes, SweepsGoOnBelowTheUnit) {
    for (const size_t n : {6, 10, 12}) {
        const Hierarchy hierarchy(with_bad_triangles(torus(n, 3 * n / 4, 3, 1), 2, 1e-6, 1), 0.5, 1000);
        ASSERT_TRUE(hierarchy);
        hmf_solve_options options = solve_options(HMF_METHOD_WHITEHEAD, 1e-6);
        options.tolerance = 1e-8;
        const Solution sweeps = solve(hierarchy, nullptr, options),
                       newton = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 1e-8));
        EXPECT_EQ(sweeps.status, HMF_OK) << n << ": " << sweeps.error.message;
        EXPECT_LE(sweeps.report.residual_max, 1e-8);
        EXPECT_NEAR(sweeps.report.energy / newton.report.energy, 1, 1e-10);
        const LevelMesh level = read_level(hierarchy, 0);
        expect_foliation(level, sweeps.foliation);
    }
}

// Short ways around the thin direction are very many: the search is not to get
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
        if (outcome.report.residual_max < 0) continue; // not evaluated
        // Cancelled after the last level was solved, while the class was looked at.
        const std::vector<double> residual =
            residuals(outcome.foliation, static_cast<size_t>(outcome.report.levels[0].vertex_count));
        EXPECT_NEAR(outcome.report.residual_max, *std::max_element(residual.begin(), residual.end()), 1e-13) << stop;
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
    state.load(0, hmf::Triangulation::input);
    for (size_t e = 0; e < hierarchy.edges(0); ++e) state.foliation.value[e] = int64_t{1} << 53;
    hmf::FoliationData data;
    data.unit = 0.5;
    hmf_foliation* made = nullptr;
    ASSERT_EQ(hmf::make_foliation(state, data, call, &made), HMF_OK);
    for (const double x : values_of(Foliation(made))) ASSERT_EQ(x, std::ldexp(1.0, 52));
    state.foliation.value[3] += 2;
    made = nullptr;
    EXPECT_EQ(hmf::make_foliation(state, data, call, &made), HMF_ERROR_UNSUPPORTED);
    EXPECT_EQ(error.element, HMF_ELEMENT_EDGE);
    EXPECT_EQ(made, nullptr);
}

// A finer unit, moves of a unit, and back: the same class, no pole, and every vertex has gone less than a unit.
TEST(CoarserUnit, RoundsPlacesAndNotValues) {
    constexpr uint32_t bits = 9;
    for (const TriMesh& mesh : {pretzel(3, 2), torus(20, 12, 3, 1), torus_with_finger(20, 14, 10, 4)}) {
        const Hierarchy hierarchy(mesh, 0.5, 200);
        ASSERT_TRUE(hierarchy);
        const hmf_hierarchy& h = *hierarchy.get();
        const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_WHITEHEAD, 1e-2));
        hmf::Memory memory(nullptr, nullptr, nullptr, 0);
        hmf_error error{};
        hmf::Call call(memory, &error, nullptr, nullptr);
        hmf::State state;
        double unit = 1;
        ASSERT_EQ(hmf::load_solved(*solution.foliation, state, unit, call), HMF_OK);
        hmf::Foliation& f = state.foliation;
        const uint32_t n = f.mesh.edge_count;
        bool exact = false;
        ASSERT_TRUE(hmf::to_coarser_unit(f, 0, memory, exact) && exact); // nothing to do
        for (uint32_t e = 0; e < n; ++e) f.value[e] <<= bits;
        hmf::Rings rings;
        hmf::Star star;
        ASSERT_TRUE(rings.build(f.mesh, h.levels[0].weight, memory) && star.allocate(memory, rings.max_degree));
        hmf::SweepResult result;
        hmf::Sweeps sweeps;
        for (int i = 0; i < 3; ++i) sweeps.sweep(f, rings, h.levels[0].weight, i % 2 != 0, star, result, call, 0);
        ASSERT_GT(result.moves, 0u);
        const std::vector<int64_t> fine(f.value, f.value + n);
        EXPECT_TRUE(hmf::to_coarser_unit(f, 58, memory, exact) && !exact); // not even the heights are
        EXPECT_EQ(std::vector<int64_t>(f.value, f.value + n), fine);
        ASSERT_TRUE(hmf::to_coarser_unit(f, bits, memory, exact) && exact);
        int64_t odd = 0;
        for (uint32_t e = 0; e < n; ++e) {
            odd |= fine[e] & ((1 << bits) - 1);
            EXPECT_LE(std::abs((f.value[e] << bits) - fine[e]), 1 << bits);
        }
        EXPECT_NE(odd, 0); // else nothing was rounded
        const hmf::SingularityCount count = hmf::count_singularities(f);
        EXPECT_EQ(count.broken_triangles, 0u);
        EXPECT_EQ(count.poles, 0u);
        EXPECT_EQ(count.index_sum, 4 - 4 * static_cast<int64_t>(mesh.genus));
    }
}

// Moves each zero at a vertex into triangles beside it: the vertex goes by `step` along one of the branches of the
// tree that meet there.
void move_zeros_into_triangles(hmf::Foliation& f, int64_t step) {
    const hmf::Mesh& mesh = f.mesh;
    const std::vector<int64_t> before(f.value, f.value + mesh.edge_count);
    std::vector<int64_t> after = before;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        std::vector<uint32_t> out;
        for (const uint32_t h : mesh.around(v)) out.push_back(h);
        // The branch of each neighbor: two beside each other are on the same one if their corner is not 0.
        std::map<uint32_t, size_t> place;
        for (size_t i = 0; i < out.size(); ++i) place[out[i]] = i;
        std::vector<size_t> branch(out.size());
        std::iota(branch.begin(), branch.end(), size_t{0});
        size_t branches = out.size();
        for (const uint32_t h : out) {
            const size_t a = branch[place[h]], b = branch[place[hmf::twin(mesh.prev(h))]];
            if (f.corner2(h) == 0 || a == b) continue;
            std::replace(branch.begin(), branch.end(), b, a);
            --branches;
        }
        if (branches < 3) continue;
        for (size_t i = 0; i < out.size(); ++i) after[hmf::edge_of(out[i])] += branch[i] == branch[0] ? -step : step;
    }
    std::copy(after.begin(), after.end(), f.value);
}

// Values that are multiples of the unit already stay what they are, wherever the walk over the mesh begins: at a
// vertex that is a zero, or in a triangle where no vertex is one.
TEST(CoarserUnit, MultiplesStay) {
    constexpr uint32_t bits = 5;
    for (const double stretch : {1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4}) {
        SCOPED_TRACE(stretch);
        const Hierarchy hierarchy(transformed(pretzel(2, 2), {stretch, 0, 0, 0, 1, 0, 0, 0, 1}), 0.5, 200);
        const Solution solution = solve(hierarchy, nullptr, solve_options(HMF_METHOD_NEWTON, 1e-6));
        hmf::Memory memory(nullptr, nullptr, nullptr, 0);
        hmf_error error{};
        hmf::Call call(memory, &error, nullptr, nullptr);
        hmf::State state;
        double unit = 1;
        ASSERT_EQ(hmf::load_solved(*solution.foliation, state, unit, call), HMF_OK);
        hmf::Foliation& f = state.foliation;
        for (const bool in_triangles : {false, true}) {
            SCOPED_TRACE(in_triangles);
            for (uint32_t e = 0; e < f.mesh.edge_count; ++e) f.value[e] *= 8;
            if (in_triangles) {
                move_zeros_into_triangles(f, 1);
                size_t corners = 0;
                for (uint32_t h = 0; h < 2 * f.mesh.edge_count; ++h)
                    corners += f.corner2(h) != 0 && f.corner2(f.mesh.next[h]) != 0 && f.corner2(f.mesh.prev(h)) != 0;
                ASSERT_EQ(corners, 3u * 4) << "one zero in a triangle for each of the index -4";
            }
            const std::vector<int64_t> before(f.value, f.value + f.mesh.edge_count);
            for (uint32_t e = 0; e < f.mesh.edge_count; ++e) f.value[e] <<= bits;
            bool exact = false;
            ASSERT_TRUE(hmf::to_coarser_unit(f, bits, memory, exact));
            EXPECT_TRUE(exact);
            EXPECT_EQ(std::vector<int64_t>(f.value, f.value + f.mesh.edge_count), before);
        }
    }
}

// Where doubles are too short for a residual of 1e-8 the solver has more bits: the values that leave are exact
// doubles in the same class, and what is measured is the minimum that the solver had.
TEST(CoarserUnit, ResidualBelowTheBitsOfADouble) {
    const TriMesh mesh = transformed(pretzel(3, 2), {10000, 0, 0, 0, 1, 0, 0, 0, 1});
    const Hierarchy hierarchy(mesh, 0.5, 200);
    ASSERT_TRUE(hierarchy);
    for (const size_t level : {size_t{0}, size_t{1}}) {
        SCOPED_TRACE(level);
        hmf_solve_options options = solve_options(HMF_METHOD_NEWTON, 1e-12);
        options.stop_level = level;
        const Solution solution = solve(hierarchy, nullptr, options);
        ASSERT_LT(solution.status, HMF_ERROR_NULL) << solution.error.message;
        EXPECT_EQ(solution.report.class_state, HMF_CLASS_PROVEN);
        EXPECT_LE(solution.report.residual_max, 1e-9);
        EXPECT_GT(solution.foliation->solved_bits, 0u) << "the mesh tests nothing";
        expect_foliation(read_level(hierarchy, level), solution.foliation);
        EXPECT_EQ(energy(solution.foliation), solution.report.energy);
        double most = 0;
        for (const double r : residuals(solution.foliation, read_level(hierarchy, level).vertex_count))
            most = std::max(most, r);
        EXPECT_NEAR(most, solution.report.residual_max, 1e-12);
        const Foliation values = create(hierarchy, level, values_of(solution.foliation));
        // The values that leave are in the same class: relaxed again they reach the same energy.
        for (const Foliation* from : {&values, &solution.foliation}) {
            const Solution again = relax(*from, solve_options(HMF_METHOD_NEWTON, 1e-9));
            EXPECT_EQ(again.status, HMF_OK) << again.error.message;
            EXPECT_NEAR(again.report.energy, solution.report.energy, 1e-12 * solution.report.energy);
        }
        if (level > 0) continue;
        hmf_error error{};
        hmf_cylinder_set* cylinders = nullptr;
        ASSERT_EQ(hmf_cylinders(solution.foliation.get(), nullptr, nullptr, &cylinders, &error), HMF_OK)
            << error.message;
        const Owned<hmf_cylinder_set> owner(cylinders);
        double area = 0;
        for (uint64_t c = 0; c < cylinders->count; ++c) {
            EXPECT_EQ(cylinders->list[c].height, 1);
            area += cylinders->list[c].area;
        }
        EXPECT_NEAR(area, solution.report.energy, 1e-7 * solution.report.energy);
    }
}

} // namespace test_extremes
