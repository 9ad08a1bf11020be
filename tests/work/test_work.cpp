// Extreme inputs: how much work lies between two calls of the progress function, and how it grows with the input.
#include "support/extreme_surfaces.hpp"
#include "support/watched_host.hpp"
#include "support/surface.hpp"
#include "work/count_blocks.hpp"

#include <gtest/gtest.h>

namespace test_work {

using namespace test;

namespace {

// 50 ms for a million edges, and a millisecond for any.
uint64_t allowed(size_t edges) { return 1000000 + 50 * uint64_t{edges}; }

struct Extreme {
    const char* name;
    TriMesh mesh;
    std::vector<uint32_t> marks;
    Loops loops; // empty: those of the library

    size_t edges() const { return mesh.triangle_count() * 3 / 2; }
    hmf_hierarchy_options options() const { return with_marks(marks); }
};

// call(control) is a status.
template <class Call>
uint64_t expect_reports(const Extreme& on, const char* name, Call&& call) {
    Work work(blocks);
    const hmf_control control = work.control();
    const hmf_status status = call(&control);
    work.report();
    EXPECT_TRUE(status < HMF_ERROR_NULL || status >= HMF_ERROR_MESH_COUNTS || status == HMF_ERROR_UNSUPPORTED
                || status == HMF_ERROR_QUADS);
    EXPECT_LE(work.most, allowed(on.edges())) << name << " on " << on.name << ", " << on.edges() << " edges";
    return work.all();
}

template <class T, class Call>
uint64_t expect_reports_of(const Extreme& on, const char* name, Call&& call) {
    return expect_reports(on, name, [&](const hmf_control* control) {
        T* out = nullptr;
        const hmf_status status = call(control, &out);
        hmf_free(out);
        return status;
    });
}

uint64_t build(const Extreme& on, hmf_hierarchy*& h) {
    const hmf_hierarchy_options options = on.options();
    return expect_reports(on, "hmf_hierarchy_create", [&](const hmf_control* control) {
        return hmf_hierarchy_create(on.mesh.positions.data(), on.mesh.vertex_count(), on.mesh.triangles.data(),
                                    on.mesh.triangle_count(), &options, control, &h, nullptr);
    });
}

uint64_t find_loops(const Extreme& on, const hmf_hierarchy* h, int32_t kind, hmf_loop_set*& loops) {
    return expect_reports(on, "hmf_loops",
                          [&](const hmf_control* control) { return hmf_loops(h, 0, kind, control, &loops, nullptr); });
}

void every_call(const Extreme& on) {
    hmf_hierarchy* h = nullptr;
    build(on, h);
    ASSERT_NE(h, nullptr) << on.name;
    hmf_loop_set *found = nullptr, own = on.loops.view();
    if (on.loops.count() == 0) {
        hmf_loop_set* tunnel = nullptr;
        find_loops(on, h, HMF_LOOPS_TUNNEL, tunnel);
        hmf_free(tunnel);
        find_loops(on, h, HMF_LOOPS_CUT, found);
    }
    const hmf_loop_set* const loops = found ? found : &own;
    hmf_foliation* f = nullptr;
    expect_reports(on, "hmf_foliation_from_loops", [&](const hmf_control* control) {
        hmf_foliation* made = nullptr;
        const hmf_status status = hmf_foliation_from_loops(h, loops, control, &made, nullptr);
        hmf_foliation_destroy(made);
        return status;
    });
    expect_reports(on, "hmf_solve",
                   [&](const hmf_control* control) { return hmf_solve(h, loops, nullptr, control, &f, nullptr); });
    if (f) {
        expect_reports(on, "hmf_relax", [&](const hmf_control* control) {
            hmf_foliation* relaxed = nullptr;
            const hmf_status status = hmf_relax(f, nullptr, control, &relaxed, nullptr);
            hmf_foliation_destroy(relaxed);
            return status;
        });
        expect_reports_of<hmf_cylinder_set>(on, "hmf_cylinders", [&](auto control, auto out) {
            return hmf_cylinders(f, loops, control, out, nullptr);
        });
        expect_reports_of<hmf_singularity_set>(on, "hmf_singularities", [&](auto control, auto out) {
            return hmf_singularities(f, control, out, nullptr);
        });
        expect_reports_of<hmf_parameterization>(on, "hmf_parameterize", [&](auto control, auto out) {
            return hmf_parameterize(f, nullptr, control, out, nullptr);
        });
        for (const int32_t leaves : {HMF_LEAVES_FOLIATION, HMF_LEAVES_CONJUGATE}) {
            hmf_trace_options trace{};
            trace.struct_size = sizeof trace;
            trace.critical = 1;
            trace.leaves = leaves;
            trace.length_limit = 1000;
            expect_reports_of<hmf_lines>(
                on, "hmf_trace", [&](auto control, auto out) { return hmf_trace(f, &trace, control, out, nullptr); });
        }
        expect_reports_of<hmf_chart_set>(
            on, "hmf_atlas", [&](auto control, auto out) { return hmf_atlas(f, nullptr, control, out, nullptr); });
    }
    hmf_foliation_destroy(f);
    hmf_free(found);
    hmf_hierarchy_destroy(h);
}

std::vector<uint32_t> every_vertex(const TriMesh& mesh) {
    std::vector<uint32_t> marks(mesh.vertex_count());
    for (uint32_t v = 0; v < marks.size(); ++v) marks[v] = v;
    return marks;
}

Extreme of_polygon(size_t n) {
    const auto at = [n](size_t quarter) { return static_cast<uint32_t>(quarter * n / 4); };
    return {"fan of a polygon", fan_polygon(n), {at(0), at(1), at(2), at(3)}, {}};
}

// `count` parallel loops around the tube of a torus of n x m.
Extreme with_loops(size_t n, size_t m, size_t count) {
    Extreme extreme{"many loops", torus(n, m, 3, 1), {}, {}};
    extreme.loops.kind = HMF_PATH_VERTICES;
    for (size_t c = 0; c < count; ++c) {
        std::vector<uint32_t> loop;
        for (size_t j = 0; j < m; ++j) loop.push_back(static_cast<uint32_t>(c % n * m + j));
        extreme.loops.add(loop);
    }
    return extreme;
}

// Along a torus of n x n and `twists` times around its tube.
Extreme with_twists(size_t n, size_t twists) {
    Extreme extreme{"Dehn twists", torus(n, n, 3, 1.5), {}, {}};
    extreme.loops.kind = HMF_PATH_VERTICES;
    std::vector<uint32_t> loop;
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j <= twists; ++j) loop.push_back(static_cast<uint32_t>(i * n + (twists * i + j) % n));
    extreme.loops.add(loop);
    return extreme;
}

} // namespace

TEST(Work, ReportsOnWalls) { every_call({"walls", walled_ring(1000, Strips::fans), {}, {}}); }
TEST(Work, ReportsOnRings) { every_call({"rings", flat_ring(1024, Strips::fans), {}, {}}); }
TEST(Work, ReportsOnWheels) { every_call({"wheels", wheels(5000, 2), {}, {}}); }
TEST(Work, ReportsOnPolygons) { every_call(of_polygon(300)); }
TEST(Work, ReportsWithEveryVertexMarked) {
    const TriMesh mesh = torus(24, 16, 3, 1);
    every_call({"every vertex marked", mesh, every_vertex(mesh), {}});
}
TEST(Work, ReportsWithManyLoops) { every_call(with_loops(40, 40, 2000)); }
TEST(Work, ReportsWithTwists) { every_call(with_twists(60, 40)); }

namespace {

uint64_t of_build(const Extreme& extreme) {
    hmf_hierarchy* h = nullptr;
    const uint64_t work = build(extreme, h);
    EXPECT_NE(h, nullptr);
    hmf_hierarchy_destroy(h);
    return work;
}

} // namespace

TEST(Work, BuildIsLinearInValence) {
    expect_linear(
        "wheels",
        [](size_t n) {
            return of_build({"wheels", wheels(n, 8), {}, {}});
        },
        1000);
    expect_linear(
        "walls",
        [](size_t n) {
            return of_build({"walls", walled_ring(n, Strips::fans), {}, {}});
        },
        500);
    expect_linear(
        "rings",
        [](size_t n) {
            return of_build({"rings", flat_ring(n, Strips::fans), {}, {}});
        },
        2048);
    expect_linear(
        "polygons", [](size_t n) { return of_build(of_polygon(n)); }, 2000);
}

TEST(Work, SolveIsLinearInValence) {
    const auto work = [](size_t n) {
        const Extreme extreme{"walls", walled_ring(n, Strips::fans), {}, {}};
        hmf_hierarchy* h = nullptr;
        build(extreme, h);
        hmf_loop_set* loops = nullptr;
        find_loops(extreme, h, HMF_LOOPS_CUT, loops);
        hmf_foliation* f = nullptr;
        const uint64_t solved = expect_reports(extreme, "hmf_solve", [&](const hmf_control* control) {
            return hmf_solve(h, loops, nullptr, control, &f, nullptr);
        });
        EXPECT_NE(f, nullptr);
        hmf_foliation_destroy(f);
        hmf_free(loops);
        hmf_hierarchy_destroy(h);
        return solved;
    };
    expect_linear("walls", work, 500);
}

namespace {

// Of the atlas of the foliation of cut loops.
uint64_t of_atlas(const Extreme& extreme) {
    hmf_hierarchy* h = nullptr;
    build(extreme, h);
    hmf_loop_set* loops = nullptr;
    find_loops(extreme, h, HMF_LOOPS_CUT, loops);
    hmf_foliation* f = nullptr;
    EXPECT_EQ(hmf_solve(h, loops, nullptr, nullptr, &f, nullptr), HMF_OK);
    const uint64_t made = expect_reports_of<hmf_chart_set>(
        extreme, "hmf_atlas", [&](auto control, auto out) { return hmf_atlas(f, nullptr, control, out, nullptr); });
    hmf_foliation_destroy(f);
    hmf_free(loops);
    hmf_hierarchy_destroy(h);
    return made;
}

} // namespace

TEST(Work, AtlasIsLinearInValence) {
    expect_linear(
        "walls",
        [](size_t n) {
            return of_atlas({"walls", walled_ring(n, Strips::fans), {}, {}});
        },
        300);
}

namespace {

uint64_t of_loops(const Extreme& extreme, int32_t kind) {
    hmf_hierarchy* h = nullptr;
    build(extreme, h);
    hmf_loop_set* loops = nullptr;
    const uint64_t found = find_loops(extreme, h, kind, loops);
    EXPECT_NE(loops, nullptr);
    hmf_free(loops);
    hmf_hierarchy_destroy(h);
    return found;
}

} // namespace

TEST(Work, CutLoopsAreLinearInValence) {
    expect_linear(
        "wheels",
        [](size_t n) {
            return of_loops({"wheels", wheels(n, 2), {}, {}}, HMF_LOOPS_CUT);
        },
        1000);
}

namespace {

// On a plate with n holes, whose handles have the same size.
void expect_linear_in_genus(int32_t kind, size_t n) {
    expect_linear(
        "plate",
        [kind](size_t holes) {
            return of_loops({"plate", plate(holes), {}, {}}, kind);
        },
        n);
}

} // namespace

TEST(Work, CutLoopsAreLinearInGenus) { expect_linear_in_genus(HMF_LOOPS_CUT, 50); }
TEST(Work, TunnelLoopsAreLinearInGenus) { expect_linear_in_genus(HMF_LOOPS_TUNNEL, 100); }
TEST(Work, PantsAreLinearInGenus) { expect_linear_in_genus(HMF_LOOPS_PANTS, 25); }

} // namespace test_work
