// Limits for input that nobody has checked: the estimate of memory is a bound, and the work of a solve, counted and
// not timed, stays within a multiple of the usual.
#include "support/watched_host.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace test_limits {

using namespace test;

namespace {

TriMesh stretched(TriMesh mesh, double factor) {
    for (size_t i = 0; i < mesh.positions.size(); i += 3) mesh.positions[i] *= factor;
    return mesh;
}

// Two to four boundaries or none, and vertices that stay.
TriMesh with_holes(TriMesh mesh, size_t holes) {
    const size_t gap = mesh.triangle_count() / (holes + 1);
    for (size_t k = holes; k > 0; --k) {
        const auto at = mesh.triangles.begin() + static_cast<ptrdiff_t>(3 * gap * k);
        mesh.triangles.erase(at, at + 3);
    }
    return mesh;
}

TriMesh any_mesh(Random& random) {
    const uint64_t seed = random.bits();
    switch (random.below(8)) {
    case 0: {
        const size_t m = 4 + random.below(40);
        return torus(6 + random.below(60), m, 3, 1, {true, 1, 0.3, seed});
    }
    case 1: {
        const size_t refinements = 1 + random.below(2);
        return pretzel(1 + random.below(4), refinements);
    }
    case 2: {
        const double aspect = std::pow(10, 3 * random.unit());
        return thin_plate(1 + random.below(5), aspect);
    }
    case 3: return subdivide(plate(1 + random.below(30)));
    case 4: return with_bad_triangles(torus(30, 16, 3, 1), 1 + random.below(40), 0.01, seed);
    case 5: return stretched(torus(40, 20, 3, 1), std::pow(10, 4 * random.unit()));
    case 6: return with_random_flips(torus(40, 20, 3, 1), 1000, 0.9, seed);
    default: return torus_with_finger(20, 10, 5 + random.below(60), 10);
    }
}

} // namespace

TEST(Limits, EstimateOfMemoryIsABound) {
    Random random(20);
    size_t built = 0;
    double tightest = 1e300, loosest = 0;
    for (int round = 0; round < 150; ++round) {
        TriMesh mesh = any_mesh(random);
        const size_t holes = random.below(3) == 0 ? 1 + random.below(4) : 0;
        mesh = with_holes(mesh, holes);
        WatchedHost watched;
        hmf_hierarchy_options options = watched.options();
        options.collapse = static_cast<int32_t>(random.below(4));
        options.ratio = random.below(4) ? 0.05 + 0.9 * random.unit() : 0;
        options.coarsest = random.below(3) ? 1 + random.below(600) : 0;
        options.mollify = random.below(3) ? 0 : 0.1 * random.unit() * random.unit();
        std::vector<uint32_t> marks;
        for (size_t k = random.below(2) * random.below(40); k > 0; --k)
            marks.push_back(static_cast<uint32_t>(random.below(mesh.vertex_count())));
        std::sort(marks.begin(), marks.end());
        marks.erase(std::unique(marks.begin(), marks.end()), marks.end());
        options.marked_vertices = marks.data();
        options.marked_count = marks.size();
        hmf_hierarchy* h = nullptr;
        hmf_error error{};
        const hmf_status status =
            hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                 mesh.triangle_count(), &options, nullptr, &h, &error);
        hmf_hierarchy_destroy(h);
        const size_t copies = holes > 0 ? 2 : 1; // the double is built
        const uint64_t bound =
            hmf_hierarchy_memory_estimate(copies * mesh.vertex_count(), copies * mesh.triangle_count(), &options);
        ASSERT_LE(watched.peak, bound) << "round " << round << ", " << mesh.vertex_count() << " vertices, " << holes
                                       << " holes, collapse " << options.collapse << ", ratio " << options.ratio
                                       << ", coarsest " << options.coarsest << ", marks " << marks.size();
        EXPECT_EQ(watched.used, 0u);
        if (status != HMF_OK) continue; // bounded all the same
        ++built;
        tightest = std::min(tightest, static_cast<double>(bound) / static_cast<double>(watched.peak));
        if (mesh.vertex_count() > 1000)
            loosest = std::max(loosest, static_cast<double>(bound) / static_cast<double>(watched.peak));
    }
    EXPECT_GE(built, 100u);
    EXPECT_LT(loosest, 6) << "a bound that no host can give is none"; // from 1000 vertices on
    RecordProperty("tightest", std::to_string(tightest));
    RecordProperty("loosest", std::to_string(loosest));
}

// Linear solves and sweeps of all levels, each as many as its edges, per edge of the mesh.
TEST(Limits, WorkOfASolveIsBounded) {
    Random random(21);
    std::vector<double> work;
    size_t stopped = 0;
    for (int round = 0; round < 30; ++round) {
        const TriMesh mesh = any_mesh(random);
        const Hierarchy hierarchy(mesh, 0, 40);
        ASSERT_TRUE(hierarchy);
        Loops loops = library_loops(hierarchy, 0, random.below(2) ? HMF_LOOPS_CUT : HMF_LOOPS_PANTS);
        for (size_t c = 0; c < loops.count(); ++c) loops.weights.push_back(std::pow(1000, random.unit()));
        size_t ticks = 0;
        hmf_control control{};
        control.struct_size = sizeof control;
        control.progress = [](void* user, double) -> int32_t {
            ++*static_cast<size_t*>(user);
            return HMF_PROGRESS_CONTINUE;
        };
        control.progress_user = &ticks;
        const hmf_loop_set set = loops.view();
        hmf_foliation* made = nullptr;
        hmf_error error{};
        const hmf_status status = hmf_solve(hierarchy.get(), &set, nullptr, &control, &made, &error);
        const Foliation f(made);
        ASSERT_TRUE(made) << error.message;
        stopped += status != HMF_OK;
        const hmf_report& report = *hmf_foliation_report(made);
        double sum = 0;
        for (size_t k = 0; k < report.level_count; ++k)
            sum += static_cast<double>((report.levels[k].linear_solve_count + report.levels[k].sweep_count)
                                       * report.levels[k].edge_count);
        work.push_back(sum / static_cast<double>(hierarchy.edges(0)));
        // A host is asked all the time: at least once for each solve and sweep.
        EXPECT_GE(static_cast<double>(ticks), sum / static_cast<double>(hierarchy.edges(0)));
    }
    std::sort(work.begin(), work.end());
    const double median = work[work.size() / 2];
    EXPECT_LE(work.back(), 10 * median);
    EXPECT_LE(stopped, 1u);
}

namespace {

// Fresh memory is full of one byte.
template <int fill>
struct Filled {
    static void* take(void*, size_t size) {
        void* const block = std::malloc(size ? size : 1);
        if (block) std::memset(block, fill, size);
        return block;
    }
    static void give(void*, void* block, size_t) { std::free(block); }
};

// All that comes out of a mesh, as bytes.
template <int fill>
std::vector<unsigned char> everything(const TriMesh& mesh, const std::vector<uint32_t>& marks) {
    std::vector<unsigned char> bytes;
    const auto add = [&bytes](const auto* array, size_t count) {
        const auto* const from = reinterpret_cast<const unsigned char*>(array);
        if (array) bytes.insert(bytes.end(), from, from + count * sizeof *array);
    };
    hmf_hierarchy_options build{};
    build.struct_size = sizeof build;
    build.coarsest = 60;
    build.allocate = Filled<fill>::take;
    build.release = Filled<fill>::give;
    build.marked_vertices = marks.data();
    build.marked_count = marks.size();
    const Hierarchy h(mesh, build);
    for (const int32_t kind : {HMF_LOOPS_CUT, HMF_LOOPS_PANTS}) {
        const auto loops =
            make<hmf_loop_set>([&](auto out, hmf_error* e) { return hmf_loops(h.get(), 0, kind, nullptr, out, e); });
        add(loops->elements, static_cast<size_t>(loops->offsets[loops->count]));
        const auto f = make<hmf_foliation>(
            [&](auto out, hmf_error* e) { return hmf_solve(h.get(), loops.get(), nullptr, nullptr, out, e); });
        size_t count = 0;
        const double* const values = hmf_foliation_values(f.get(), &count);
        add(values, count);
        const auto map = make<hmf_parameterization>(
            [&](auto out, hmf_error* e) { return hmf_parameterize(f.get(), nullptr, nullptr, out, e); });
        add(map->corner_uv, 6 * static_cast<size_t>(map->triangle_count));
        add(map->cone, static_cast<size_t>(map->vertex_count));
        hmf_trace_options trace{};
        trace.struct_size = sizeof trace;
        trace.critical = 1;
        trace.spacing = 0.2;
        for (const int32_t leaves : {HMF_LEAVES_FOLIATION, HMF_LEAVES_CONJUGATE}) {
            trace.leaves = leaves;
            const auto lines =
                make<hmf_lines>([&](auto out, hmf_error* e) { return hmf_trace(f.get(), &trace, nullptr, out, e); });
            add(lines->points, 3 * static_cast<size_t>(lines->point_count));
        }
        for (const uint64_t relax : {0, 3}) {
            hmf_quad_options wish{};
            wish.struct_size = sizeof wish;
            wish.count = 600;
            wish.relax = relax;
            const auto quads =
                make<hmf_quad_mesh>([&](auto out, hmf_error* e) { return hmf_quads(f.get(), &wish, nullptr, out, e); });
            add(quads->positions, 3 * static_cast<size_t>(quads->vertex_count));
            add(quads->quads, 4 * static_cast<size_t>(quads->quad_count));
        }
        const auto cylinders = make<hmf_cylinder_set>(
            [&](auto out, hmf_error* e) { return hmf_cylinders(f.get(), loops.get(), nullptr, out, e); });
        for (size_t c = 0; c < cylinders->count; ++c) add(&cylinders->list[c].circumference, 1);
    }
    return bytes;
}

} // namespace

// Nothing is read that was not written: results do not depend on what fresh memory holds.
TEST(Limits, FreshMemoryDoesNotMatter) {
    for (const std::vector<uint32_t>& marks : {std::vector<uint32_t>{}, std::vector<uint32_t>{3, 100, 200}}) {
        const TriMesh mesh = with_bad_triangles(pretzel(2, 2), 6, 1, 4);
        const std::vector<unsigned char> zeros = everything<0>(mesh, marks);
        ASSERT_FALSE(HasFailure());
        EXPECT_GT(zeros.size(), 100000u);
        EXPECT_EQ(zeros, everything<255>(mesh, marks));
        EXPECT_EQ(zeros, everything<1>(mesh, marks));
    }
}

} // namespace test_limits
