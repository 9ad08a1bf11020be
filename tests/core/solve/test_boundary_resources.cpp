// Surfaces with boundary: limits of memory, failing allocations, cancellation.
#include "support/boundary.hpp"
#include "support/watched_host.hpp"
#include "support/sample.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace test_boundary_resources {

using namespace test;

namespace {

// The calls of the interface on a surface with boundary, one after the other.
struct Calls {
    const TriMesh& mesh;
    const hmf_hierarchy_options& options;
    hmf_hierarchy* hierarchy = nullptr;
    hmf_loop_set* loops = nullptr;
    hmf_foliation* foliation = nullptr;

    Calls(const TriMesh& m, const hmf_hierarchy_options& o) : mesh(m), options(o) {}
    ~Calls() {
        hmf_free(loops);
        hmf_foliation_destroy(foliation);
        hmf_hierarchy_destroy(hierarchy);
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
                return hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
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
        if (!status) { // its flat surface stays with the foliation
            hmf_parameterization* flat = nullptr;
            status = hmf_parameterize(foliation, nullptr, nullptr, &flat, &error);
            hmf_free(flat);
        }
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
        if (!status)
            status = visit([&](const hmf_control* control) {
                hmf_chart_set* charts = nullptr;
                const hmf_status s = hmf_atlas(foliation, nullptr, control, &charts, &error);
                EXPECT_EQ(charts != nullptr, s == HMF_OK);
                hmf_free(charts);
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
        WatchedHost watched;
        {
            hmf_hierarchy_options options = watched.options();
            options.memory_limit = limit;
            Calls calls(mesh, options);
            size_t number = 0;
            const hmf_status status = calls.run([&](const std::function<hmf_status(const hmf_control*)>& call) {
                const uint64_t kept =
                    calls.hierarchy ? watched.used - hmf_hierarchy_describe(calls.hierarchy)->memory_bytes : 0;
                watched.peak = watched.used;
                const hmf_status s = call(nullptr);
                EXPECT_LE(watched.peak - kept, limit) << "call " << number;
                ++number;
                return s;
            });
            done = status == HMF_OK;
            refused += !done;
            if (!done) { ASSERT_EQ(status, HMF_ERROR_MEMORY_LIMIT) << limit; }
        }
        ASSERT_EQ(watched.used, 0u);
        ASSERT_LT(limit, uint64_t{1} << 32) << "no limit is enough";
    }
    EXPECT_GT(refused, 10u);
}

// Cancels at a report, and notes what had been allocated until then.
struct Stop {
    const WatchedHost& watched;
    uint64_t left, allocations = 0;

    static int32_t call(void* user, double) {
        Stop& s = *static_cast<Stop*>(user);
        if (--s.left > 0) return HMF_PROGRESS_CONTINUE;
        s.allocations = s.watched.calls;
        return HMF_PROGRESS_CANCEL;
    }
};

// The double is loaded after the surface: a build that is cancelled there allocates no more either.
TEST(Boundary, ACancelledBuildStopsAtOnce) {
    const TriMesh mesh = mesh_with_boundary();
    WatchedHost watched;
    const hmf_hierarchy_options options = watched.options();
    hmf_hierarchy* hierarchy = nullptr;
    uint64_t report = 0;
    for (;;) {
        Stop stop{watched, ++report};
        hmf_control control{};
        control.struct_size = sizeof control;
        control.progress = Stop::call;
        control.progress_user = &stop;
        const hmf_status status =
            hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                 mesh.triangle_count(), &options, &control, &hierarchy, nullptr);
        if (status == HMF_OK) break;
        ASSERT_EQ(status, HMF_CANCELLED) << "report " << report;
        EXPECT_EQ(watched.calls, stop.allocations) << "report " << report;
        EXPECT_EQ(watched.used, 0u) << "report " << report;
    }
    EXPECT_GT(report, 10u);
    hmf_hierarchy_destroy(hierarchy);
}

TEST(Boundary, EveryAllocationMayFailAndEveryCallStop) {
    const TriMesh mesh = mesh_with_boundary();
    WatchedHost watched;
    {
        const hmf_hierarchy_options options = watched.options();
        Calls calls(mesh, options);
        size_t number = 0;
        const hmf_status status = calls.run([&](const std::function<hmf_status(const hmf_control*)>& call) {
            SCOPED_TRACE(testing::Message() << "call " << number);
            // First in vain, then as it is.
            const uint64_t held = watched.used;
            const auto fails = [&](uint64_t fail, uint64_t stop, uint64_t& allocations, uint64_t& reports) {
                Progress progress;
                progress.stop = stop;
                const hmf_control control = progress.control();
                watched.calls = 0;
                watched.fail = fail;
                const hmf_status s = call(&control);
                allocations = watched.calls;
                reports = progress.calls;
                watched.fail = 0;
                EXPECT_TRUE(progress.rising);
                return s;
            };
            uint64_t allocations = 0, reports = 0, ignored = 0;
            const bool keeps = number == 1 || number == 2 || number == 3;
            if (!keeps) { // the counts of a call that leaves nothing
                EXPECT_EQ(fails(0, 0, allocations, reports), HMF_OK);
                EXPECT_EQ(watched.used, held);
            } else allocations = 4000, reports = 2000;
            for (uint64_t n = 1; n <= allocations; n += 1 + allocations / sample(48, 8)) {
                const hmf_status s = fails(n, 0, ignored, ignored);
                if (s == HMF_OK && keeps) return ++number, s; // there were fewer
                EXPECT_EQ(s, HMF_ERROR_MEMORY) << "allocation " << n;
                EXPECT_EQ(watched.used, held);
            }
            for (uint64_t n = 1; n < reports; n += 1 + reports / sample(24, 5)) {
                const hmf_status s = fails(0, n, ignored, ignored);
                if (s == HMF_OK && keeps) return ++number, s;
                EXPECT_EQ(s, HMF_CANCELLED) << "report " << n;
                if (keeps && calls.foliation) { // had been found
                    hmf_foliation_destroy(calls.foliation);
                    calls.foliation = nullptr;
                }
                EXPECT_EQ(watched.used, held);
            }
            ++number;
            return call(nullptr);
        });
        EXPECT_EQ(status, HMF_OK);
        EXPECT_EQ(number, 7u);
    }
    EXPECT_EQ(watched.used, 0u);
}

} // namespace test_boundary_resources
