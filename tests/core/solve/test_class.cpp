// The certificate of the class: that it says yes to results in the class of
// their loops, no to others, and that no solve ends in another class unnoticed.
// Random problems with three hierarchies each: test_campaign.cpp.
#include "src/applications/loops/library_loops.hpp"
#include "src/core/solve/solve.hpp"
#include "support/read_obj.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace test_class {

using namespace test;

namespace {

size_t number(const char* name, size_t otherwise) {
    const char* text = std::getenv(name);
    return text ? static_cast<size_t>(std::strtoull(text, nullptr, 10)) : otherwise;
}

// Cells of a grid, most of them filled, without two that touch along an edge or in a corner only.
TriMesh random_blocks(size_t nx, size_t ny, size_t nz, Random& random) {
    const auto at = [&](size_t x, size_t y, size_t z) { return (x * ny + y) * nz + z; };
    std::vector<char> solid(nx * ny * nz, 1);
    // Straight tunnels through the block, at odd places, so that they meet in whole faces only.
    for (size_t tunnel = 0; tunnel < 1 + random.below(nx + ny); ++tunnel) {
        const size_t axis = random.below(3), n[3] = {nx, ny, nz};
        const size_t u = 1 + 2 * random.below((n[(axis + 1) % 3] - 1) / 2);
        const size_t v = 1 + 2 * random.below((n[(axis + 2) % 3] - 1) / 2);
        for (size_t i = 0; i < n[axis]; ++i) {
            size_t p[3];
            p[axis] = i;
            p[(axis + 1) % 3] = u;
            p[(axis + 2) % 3] = v;
            solid[at(p[0], p[1], p[2])] = 0;
        }
    }
    std::vector<double> xs, ys, zs;
    for (size_t i = 0; i <= nx; ++i) xs.push_back(static_cast<double>(i));
    for (size_t i = 0; i <= ny; ++i) ys.push_back(static_cast<double>(i));
    for (size_t i = 0; i <= nz; ++i) zs.push_back(static_cast<double>(i));
    TriMesh mesh = voxel_surface(xs, ys, zs, [&](size_t x, size_t y, size_t z) { return solid[at(x, y, z)] != 0; });
    std::vector<uint64_t> edges;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (size_t s = 0; s < 3; ++s) {
            const uint64_t a = mesh.triangles[3 * t + s], b = mesh.triangles[3 * t + (s + 1) % 3];
            if (a < b) edges.push_back(a << 32 | b);
        }
    const long euler = static_cast<long>(mesh.vertex_count()) - static_cast<long>(edges.size())
                     + static_cast<long>(mesh.triangle_count());
    mesh.genus = static_cast<size_t>((2 - euler) / 2);
    return mesh;
}

double log_uniform(Random& random, double decades) { return std::pow(10, decades * random.unit()); }

TriMesh random_surface(Random& random) {
    TriMesh mesh;
    switch (random.below(4)) {
    case 0: {
        const size_t refinements = 2 + random.below(2);
        mesh = pretzel(1 + random.below(7), refinements);
        break;
    }
    case 1: {
        const size_t m = 10 + random.below(30);
        mesh = torus(16 + random.below(60), m, 3, 1);
        break;
    }
    case 2: {
        const size_t rings = 3 + random.below(9), m = 12 + random.below(8);
        mesh = joined_tori(20 + random.below(20), m, 8, rings);
        break;
    }
    default:
        do {
            const size_t nz = 3 + 2 * random.below(2), ny = 3 + 2 * random.below(2);
            mesh = random_blocks(3 + 2 * random.below(4), ny, nz, random);
        } while (mesh.genus == 0 || !mesh_defect(mesh).empty());
        while (mesh.vertex_count() < 1500) mesh = subdivide(mesh);
        mesh = smooth(mesh, random.below(6));
    }
    Matrix stretch{log_uniform(random, random.below(2) ? 1.3 : 0.3), 0, 0, 0, log_uniform(random, 0.5), 0, 0, 0, 1};
    if (random.below(16) == 0) stretch[0] *= log_uniform(random, 2);
    mesh = transformed(mesh, random_rotation(random));
    mesh = transformed(mesh, stretch);
    if (random.below(8) == 0) {
        const uint64_t seed = random.bits();
        mesh = with_bad_triangles(mesh, 1 + random.below(20), 1, seed);
    }
    if (random.below(8) == 0) mesh = with_random_flips(mesh, mesh.triangle_count() / 8, 0.95, random.bits());
    return mesh;
}

// A foliation on the coarsest level, made from some of the library's loops.
struct Start {
    Start(const TriMesh& mesh, int32_t kind, double ratio = 0.5) : Start(mesh, kind, options_of(ratio)) {}
    Start(const TriMesh& mesh, int32_t kind, const hmf_hierarchy_options& options) :
        hierarchy(mesh, options), memory(nullptr, nullptr, nullptr, 0), call(memory, &error, nullptr, nullptr) {
        const hmf_hierarchy& h = *hierarchy.get();
        EXPECT_TRUE(state.allocate(h, 0, memory));
        EXPECT_EQ(hmf::library_loops(h, h.level_count - 1, kind, call, loops), HMF_OK);
    }
    static hmf_hierarchy_options options_of(double ratio) {
        hmf_hierarchy_options options{};
        options.struct_size = sizeof options;
        options.ratio = ratio;
        options.coarsest = 300;
        return options;
    }
    // weight[c] of loop c, in 2^-bits; 0: not there.
    void load(const std::vector<int64_t>& weight) {
        state.load(hierarchy.coarsest(), hmf::Triangulation::intrinsic);
        weights.start(memory);
        std::vector<int64_t> all(loops.count(), 0);
        for (size_t c = 0; c < weight.size() && c < all.size(); ++c) all[c] = weight[c] << bits;
        for (const int64_t w : all) EXPECT_TRUE(weights.push(w));
        hmf::initial_foliation(state.foliation.mesh, loops, weights.data(), state.foliation.value);
    }
    void reload(const std::vector<int64_t>& weight) {
        load(weight);
        // The walks go with the mesh of the state.
        guard.listen(state);
        ASSERT_TRUE(guard.words.start(state.foliation.mesh, h().levels[0].mesh.edge_count, call));
    }
    const hmf_hierarchy& h() const { return *hierarchy.get(); }
    hmf::ClassCheck look() {
        EXPECT_EQ(guard.certify(state, 1, call), HMF_OK);
        return guard.result;
    }

    int bits = 40; // of the weight 1
    Hierarchy hierarchy;
    hmf_error error{};
    hmf::Memory memory;
    hmf::Call call;
    hmf::State state;
    hmf::Loops loops;
    hmf::Array<int64_t> weights;
    hmf::ClassGuard guard;
};

} // namespace

TEST(ClassCertificate, SaysYesOnEveryLevel) {
    for (const TriMesh& mesh : {pretzel(3, 3), plate(2), torus(40, 20, 3, 1)}) {
        Start start(mesh, HMF_LOOPS_PANTS);
        start.load({5, 3, 3, 7, 1, 3});
        ASSERT_EQ(start.guard.start(start.state, 1, &start.loops, start.weights, start.call), HMF_OK);
        EXPECT_TRUE(start.guard.started);
        EXPECT_EQ(start.look().state, hmf::ClassState::proven);
        while (start.state.level > 0) {
            ASSERT_TRUE(start.state.refine(start.call));
            EXPECT_EQ(start.look().state, hmf::ClassState::proven) << "level " << start.state.level;
        }
        ASSERT_TRUE(start.state.to_intrinsic(start.call));
        EXPECT_EQ(start.look().state, hmf::ClassState::proven);
    }
}

TEST(ClassCertificate, SaysWhichHeightIsWrong) {
    Start start(pretzel(3, 3), HMF_LOOPS_PANTS);
    start.load({5, 3, 3, 7, 1, 3});
    ASSERT_EQ(start.guard.start(start.state, 1, &start.loops, start.weights, start.call), HMF_OK);
    const std::vector<int64_t> weights = {5, 3, 3, 7, 1, 3};
    for (size_t c = 0; c < weights.size(); ++c) {
        std::vector<int64_t> others = weights;
        others[c] += 1;
        start.reload(others);
        const hmf::ClassCheck result = start.look();
        EXPECT_EQ(result.state, hmf::ClassState::lost);
        EXPECT_EQ(result.loss, hmf::ClassLoss::height);
        EXPECT_EQ(result.loop, c);
        EXPECT_TRUE(start.guard.started);
        EXPECT_EQ(result.wanted, std::ldexp(static_cast<double>(weights[c]), 40));
        EXPECT_EQ(result.found, std::ldexp(static_cast<double>(others[c]), 40));
    }
}

// A start that is not that of its loops: each weight in turn is another one, two change places, a loop has no cylinder.
TEST(ClassCertificate, SaysWhetherTheStartAgrees) {
    Start start(pretzel(3, 3), HMF_LOOPS_PANTS);
    const auto agrees = [&](bool by_class) {
        EXPECT_EQ(start.guard.start(start.state, 1, by_class ? &start.loops : nullptr, start.weights, start.call),
                  HMF_OK);
        return start.guard.started;
    };
    start.load({5, 3, 4, 7, 1, 2});
    for (const bool by_class : {false, true}) {
        EXPECT_TRUE(agrees(by_class));
        for (int64_t& w : start.weights) {
            const int64_t before = w;
            w += 1;
            EXPECT_FALSE(agrees(by_class));
            w = before;
        }
        std::swap(start.weights[0], start.weights[3]);
        EXPECT_EQ(agrees(by_class), !by_class);
        std::swap(start.weights[0], start.weights[3]);
    }
    start.load({5, 3, 4, 7, 1, 0});
    EXPECT_FALSE(agrees(true));
    EXPECT_FALSE(agrees(false));
}

// Heights are compared in the unit of the reference: four times the values in a quarter of the unit are the same.
TEST(ClassCertificate, KnowsAFinerUnit) {
    Start start(pretzel(3, 3), HMF_LOOPS_PANTS);
    start.load({5, 3, 3, 7, 1, 3});
    ASSERT_EQ(start.guard.start(start.state, 1, &start.loops, start.weights, start.call), HMF_OK);
    start.reload({20, 12, 12, 28, 4, 12});
    EXPECT_EQ(start.guard.certify(start.state, 0.25, start.call), HMF_OK);
    EXPECT_EQ(start.guard.result.state, hmf::ClassState::proven);
    start.reload({20, 12, 12, 28, 5, 12});
    EXPECT_EQ(start.guard.certify(start.state, 0.25, start.call), HMF_OK);
    EXPECT_EQ(start.guard.result.state, hmf::ClassState::lost);
    EXPECT_EQ(start.guard.result.loop, 4u);
    EXPECT_EQ(start.guard.result.found, 1.25 * start.guard.result.wanted);
}

// All loops have their cylinders, and there is one more.
TEST(ClassCertificate, SaysThatThereIsACylinderTooMany) {
    Start start(pretzel(3, 3), HMF_LOOPS_PANTS);
    start.load({5, 3, 3, 7, 1});
    const hmf::Array<int64_t> not_all; // of the loops
    ASSERT_EQ(start.guard.start(start.state, 1, &start.loops, not_all, start.call), HMF_OK);
    start.reload({5, 3, 3, 7, 1});
    EXPECT_EQ(start.look().state, hmf::ClassState::proven);
    start.reload({5, 3, 3, 7, 1, 2});
    EXPECT_EQ(start.look().state, hmf::ClassState::lost);
    EXPECT_EQ(start.guard.result.loss, hmf::ClassLoss::leaves);
}

// With a marked vertex pants have a pair of loops that only the mark lies between.
TEST(ClassCertificate, TellsLoopsOnBothSidesOfAMarkApart) {
    const uint32_t mark = 17;
    hmf_hierarchy_options options = Start::options_of(0.5);
    options.marked_vertices = &mark;
    options.marked_count = 1;
    Start start(pretzel(2, 3), HMF_LOOPS_PANTS, options);
    ASSERT_EQ(start.loops.count(), 4u);
    const hmf::Array<int64_t> not_all;
    const auto expect = [&](const std::vector<int64_t>& weight, hmf::ClassState state, hmf::ClassLoss loss) {
        SCOPED_TRACE(testing::PrintToString(weight));
        start.reload(weight);
        EXPECT_EQ(start.look().state, state);
        EXPECT_EQ(start.guard.result.loss, loss);
    };
    start.load({5, 3, 3});
    ASSERT_EQ(start.guard.start(start.state, 1, nullptr, not_all, start.call), HMF_OK);
    ASSERT_TRUE(start.guard.started);
    expect({5, 3, 3}, hmf::ClassState::proven, hmf::ClassLoss::none);
    expect({5, 3, 2}, hmf::ClassState::lost, hmf::ClassLoss::height);
    expect({5, 3, 3, 1}, hmf::ClassState::lost, hmf::ClassLoss::leaves);
    // Of the loops one is left out: all heights are right.
    for (size_t without = 0; without < 4; ++without) {
        std::vector<int64_t> weight(4, 2);
        weight[without] = 0;
        start.load(weight);
        ASSERT_EQ(start.guard.start(start.state, 1, nullptr, not_all, start.call), HMF_OK);
        expect(weight, hmf::ClassState::proven, hmf::ClassLoss::none);
        for (size_t other = 0; other < 4; ++other) {
            if (other == without) continue;
            std::vector<int64_t> another(4, 2);
            another[other] = 0;
            expect(another, hmf::ClassState::lost, hmf::ClassLoss::core);
        }
    }
}

// All heights are right, one curve is another one.
TEST(ClassCertificate, SaysWhichCurveIsWrong) {
    Start start(pretzel(3, 3), HMF_LOOPS_PANTS);
    start.load({2, 2, 2, 0, 2});
    const hmf::Array<int64_t> not_all; // of the loops
    ASSERT_EQ(start.guard.start(start.state, 1, &start.loops, not_all, start.call), HMF_OK);
    start.reload({2, 2, 2, 0, 2});
    EXPECT_EQ(start.look().state, hmf::ClassState::proven);
    start.reload({2, 2, 0, 2, 2});
    const hmf::ClassCheck result = start.look();
    EXPECT_EQ(result.state, hmf::ClassState::lost);
    EXPECT_EQ(result.loss, hmf::ClassLoss::core);
    EXPECT_EQ(result.loop, 2u);
}

namespace {

// Puts a foliation of another class on each level that a solve enters, as steps that leave the class would.
struct ClassBreaker {
    ClassBreaker(Start& from, std::vector<int64_t> weight) : start(from) {
        for (int64_t& w : weight) ++w;
        start.load(weight);
        hmf::State& state = start.state;
        state.listener = nullptr;
        for (values.resize(state.level + 1);;) {
            if (state.level == 0) EXPECT_TRUE(state.to_intrinsic(start.call));
            values[state.level].assign(state.foliation.value, state.foliation.value + state.foliation.mesh.edge_count);
            if (state.level == 0) return;
            EXPECT_TRUE(state.refine(start.call));
        }
    }
    // A callback for progress. The last event of a log is of kind 0 when a level has been entered.
    static int32_t on_progress(void* user, double) {
        ClassBreaker& self = *static_cast<ClassBreaker*>(user);
        const hmf::Array<hmf_history_entry>& history = self.log->history;
        if (history.empty() || history.back().kind != 0 || self.seen == history.size()) return HMF_PROGRESS_CONTINUE;
        self.seen = history.size();
        const std::vector<int64_t>& other = self.values[self.start.state.level];
        std::copy(other.begin(), other.end(), self.start.state.foliation.value);
        return HMF_PROGRESS_CONTINUE;
    }

    Start& start;
    std::vector<std::vector<int64_t>> values; // of the other class, per level
    const hmf::SolveLog* log = nullptr;
    size_t seen = 0; // events of the log when it was last broken
};

} // namespace

// A level that ends in another class is noticed by the certificate, and the guarded solve ends in the class all the
// same.
TEST(ClassGuard, SolvesWhereTheClassIsBrokenOnPurpose) {
    const size_t problems = number("HMF_CLASS_BREAKS", 3);
    for (uint64_t seed = number("HMF_CLASS_BREAK_SEED", 1), problem = 0; problem < problems; ++seed, ++problem) {
        Random random(seed);
        const Matrix stretch{3, 0, 0, 0, 1, 0, 0, 0, 1};
        Start start(transformed(random_surface(random), stretch), HMF_LOOPS_PANTS);
        std::vector<int64_t> weight;
        for (size_t c = 0; c < start.loops.count(); ++c) weight.push_back(static_cast<int64_t>(log_uniform(random, 4)));
        start.bits = 14; // too coarse for the tolerance: the unit gets finer, and goes back with the values
        ClassBreaker breaker(start, weight);
        hmf::SolveOptions options;
        options.tolerance = 1e-8;
        double energies[3] = {0, 0, 0};
        for (const uint32_t way : {0u, 1u, 2u}) { // as it is; broken; broken, and guarded
            start.load(weight);
            ASSERT_EQ(start.guard.start(start.state, 1, &start.loops, start.weights, start.call), HMF_OK);
            start.guard.repeats = 0;
            hmf::Call call(start.memory, &start.error, way > 0 ? ClassBreaker::on_progress : nullptr, &breaker);
            hmf::SolveLog log(true, call, 1);
            breaker.log = &log;
            breaker.seen = 0;
            const hmf_status status = way == 1 ? hmf::run_cascade(start.state, options, call, log, &start.guard)
                                               : hmf::solve_in_class(start.state, options, call, log, start.guard);
            ASSERT_LT(status, HMF_ERROR_NULL);
            if (way == 1) {
                EXPECT_EQ(start.guard.certify(start.state, log.unit(), start.call), HMF_OK);
                EXPECT_EQ(start.guard.result.state, hmf::ClassState::lost);
                continue;
            }
            EXPECT_EQ(status, HMF_OK) << "seed " << seed << " way " << way;
            EXPECT_EQ(start.guard.result.state, hmf::ClassState::proven);
            EXPECT_EQ(start.guard.repeats, way == 0 ? 0 : start.hierarchy.levels());
            energies[way] = hmf::energy(start.state.foliation, start.h().levels[0].weight) * log.unit() * log.unit();
        }
        EXPECT_NEAR(energies[2], energies[0], 1e-10 * energies[0]) << "seed " << seed;
    }
}

// A solve that starts outside of the class cannot come back: it says so.
TEST(ClassGuard, SaysWhichLoopIsLost) {
    Start start(pretzel(2, 2), HMF_LOOPS_PANTS);
    start.load({5, 3, 1});
    ASSERT_EQ(start.guard.start(start.state, 1, &start.loops, start.weights, start.call), HMF_OK);
    start.reload({5, 4, 1});
    hmf::SolveOptions options;
    options.tolerance = 1e-8;
    hmf::SolveLog log(false, start.call, 1);
    EXPECT_EQ(hmf::solve_in_class(start.state, options, start.call, log, start.guard), HMF_LIMIT_CLASS);
    EXPECT_EQ(start.guard.result.state, hmf::ClassState::lost);
    EXPECT_EQ(start.guard.lost.loss, hmf::ClassLoss::height);
    EXPECT_EQ(start.guard.lost.loop, 1u);
    EXPECT_EQ(start.guard.repeats, start.hierarchy.levels());
}

// A level that the host ended is not looked at, and none is solved once more.
TEST(ClassGuard, NothingIsRepeatedAfterAFinish) {
    Start start(pretzel(2, 2), HMF_LOOPS_PANTS);
    start.load({5, 3, 1});
    ASSERT_EQ(start.guard.start(start.state, 1, &start.loops, start.weights, start.call), HMF_OK);
    start.reload({5, 4, 1}); // which is another class
    hmf::SolveOptions options;
    options.tolerance = 1e-8;
    start.guard.checks = hmf::ClassGuard::Checks::levels;
    hmf::Call ending(
        start.memory, &start.error, [](void*, double) -> int32_t { return HMF_PROGRESS_FINISH; }, nullptr);
    hmf::SolveLog log(false, ending, 1);
    EXPECT_EQ(hmf::run_cascade(start.state, options, ending, log, &start.guard), HMF_CANCELLED);
    EXPECT_EQ(start.state.level, options.stop_level);
    EXPECT_EQ(start.guard.repeats, 0u);
}

// hmf_relax: what was known of the class is handed on, and Newton steps are certified.
TEST(ClassRelax, KeepsWhatWasKnown) {
    for (const TriMesh& mesh : {pretzel(3, 2), torus(40, 20, 3, 1)}) {
        const Hierarchy hierarchy(mesh, 0.5, 300);
        const Loops loops = library_loops(hierarchy, 0, HMF_LOOPS_PANTS);
        hmf_solve_options options = solve_options(HMF_METHOD_WHITEHEAD, 1e-2);
        const Solution rough = solve(hierarchy, &loops, options);
        ASSERT_EQ(rough.report.class_state, HMF_CLASS_PROVEN);
        const Foliation values = create(hierarchy, 0, rough.values), initial = initialize(hierarchy, loops);
        for (const int32_t method : {HMF_METHOD_NEWTON, HMF_METHOD_WHITEHEAD, HMF_METHOD_SINGLE_LEVEL}) {
            SCOPED_TRACE(method);
            const bool newton = method == HMF_METHOD_NEWTON;
            options = solve_options(method, 0);
            const Solution known = relax(rough.foliation, options);
            EXPECT_EQ(known.status, HMF_OK) << known.error.message;
            EXPECT_EQ(known.report.class_state, HMF_CLASS_PROVEN);
            EXPECT_EQ(known.report.class_seconds > 0, newton);
            EXPECT_LT(known.report.energy, rough.report.energy);
            // Without a report the foliation itself says which class it is.
            for (const Foliation* from : {&values, &initial}) {
                const Solution relaxed = relax(*from, options);
                EXPECT_EQ(relaxed.status, HMF_OK) << relaxed.error.message;
                EXPECT_EQ(relaxed.report.class_state, newton ? HMF_CLASS_PROVEN : HMF_CLASS_UNKNOWN);
                // With one that does not know, neither does the next one.
                if (!newton) {
                    EXPECT_EQ(relax(relaxed.foliation, solve_options(HMF_METHOD_NEWTON, 0)).report.class_state,
                              HMF_CLASS_UNKNOWN);
                }
            }
        }
    }
}

// Meshes NAME.obj with NAME.loops.txt (lines `t: triangle triangle ..`) and
// NAME.weights.txt in the folder HMF_CASES, on which solves once ended in another class.
TEST(ClassCases, SameEnergyWithEachRatio) {
    const char* folder = std::getenv("HMF_CASES");
    if (!folder) GTEST_SKIP() << "skipped: set HMF_CASES to the folder of the cases";
    for (const char* name :
         {"class-five-torus-x3-a", "class-five-torus-x3-b", "class-block-x30", "class-plate-x3000"}) {
        const std::string path = std::string(folder) + "/" + name;
        TriMesh mesh;
        if (!read_obj(path + ".obj", mesh)) GTEST_SKIP() << "skipped: no " << path << ".obj";
        Loops loops;
        std::ifstream lines(path + ".loops.txt"), numbers(path + ".weights.txt");
        for (std::string line; std::getline(lines, line);) {
            std::istringstream words(line.substr(line.find(':') + 1));
            std::vector<uint32_t> loop;
            for (uint32_t t; words >> t;) loop.push_back(t);
            loops.add(loop);
        }
        for (std::string word; std::getline(numbers, word, ',');) loops.weights.push_back(std::stod(word));
        ASSERT_EQ(loops.weights.size(), loops.count());
        double first = 0;
        for (const double ratio : {0.25, 0.5, 0.75}) {
            const Hierarchy hierarchy(mesh, ratio);
            const Solution solution = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
            EXPECT_EQ(solution.status, HMF_OK) << name << ": " << solution.error.message;
            EXPECT_EQ(solution.report.class_state, HMF_CLASS_PROVEN);
            if (first == 0) first = solution.report.energy;
            EXPECT_NEAR(solution.report.energy, first, 1e-8 * first) << name << " ratio " << ratio;
        }
    }
}

} // namespace test_class
