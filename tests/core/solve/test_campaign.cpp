// Random problems, each solved with three hierarchies.  The harmonic foliation
// of a class is unique, so three results have one energy; each is certified; a
// solve that does not converge says why.
//
// Surfaces from formulas and from volumes, of genus 1 to 200, stretched by 1 to
// 100 000, with needles and caps, with random flips, decimated; all kinds of
// loops; weights that span a factor of 100 000.
//
//     HMF_CAMPAIGN_PROBLEMS   default 14, a sample (4 under sanitizers); ./test.sh campaign runs 2 000
//     HMF_CAMPAIGN_SEED       of the first problem, default 1; problem k has seed + k
//     HMF_CAMPAIGN_VERBOSE    a line for each solve
//
// A line is printed for each solve that ends at a limit, and a table at the end.
#include "support/implicit_surface.hpp"
#include "support/sample.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "src/core/api/foliation_object.hpp"
#include "src/core/solve/twisted_model.hpp"

namespace test_campaign {

using namespace test;

namespace {

size_t number(const char* name, size_t otherwise) {
    const char* text = std::getenv(name);
    return text ? static_cast<size_t>(std::strtoull(text, nullptr, 10)) : otherwise;
}

double log_uniform(Random& random, double decades) { return std::pow(10, decades * random.unit()); }

// Plate of a x b holes, pulled out of symmetry.
TriMesh holed_plate(size_t a, size_t b, Random& random) {
    const auto cuts = [&](size_t n) {
        std::vector<double> x(2 * n + 2);
        for (size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i) + 0.3 * random.unit();
        return x;
    };
    TriMesh mesh =
        voxel_surface(cuts(a), cuts(b), {0, 0.8}, [](size_t i, size_t j, size_t) { return i % 2 == 0 || j % 2 == 0; });
    mesh.genus = a * b;
    return mesh;
}

// Level k of a hierarchy as a mesh of its own; the mesh itself if two edges have the same ends there.
TriMesh decimated(const TriMesh& mesh, size_t k, int32_t collapse) {
    const Hierarchy hierarchy(mesh, 0.5, 40 * mesh.genus + 100, collapse);
    if (!hierarchy) return mesh;
    const LevelMesh level = read_level(hierarchy, std::min(k, hierarchy.coarsest()));
    TriMesh coarse;
    coarse.positions = level.positions;
    coarse.triangles = level.triangle_vertices;
    coarse.genus = mesh.genus;
    return mesh_defect(coarse).empty() ? coarse : mesh;
}

enum Kind : size_t { formula, plates, volume, kinds };

struct Problem {
    TriMesh mesh;
    Kind kind = formula;
    double stretch = 1, mollify = 0;
    bool bad_triangles = false, flipped = false, decimated = false;
    std::vector<uint32_t> marks; // vertices
    int32_t loop_kind = HMF_LOOPS_CUT;
    Loops loops;
    double decades = 0; // of the weights
};

TriMesh random_formula(Random& random) {
    const size_t which = random.below(4);
    if (which == 0) {
        const size_t smoothings = random.below(6), refinements = 2 + random.below(2);
        return pretzel(1 + random.below(8), refinements, smoothings);
    }
    if (which == 1) {
        const size_t m = 8 + random.below(30);
        return torus(12 + random.below(60), m, 3, 1);
    }
    if (which == 2) {
        const size_t rings = 3 + random.below(9), m = 12 + random.below(8);
        return joined_tori(20 + random.below(20), m, 8, rings);
    }
    const double length = 1 + 20 * random.unit();
    return torus_with_finger(24, 16, 3 + random.below(30), length);
}

enum class Family { usual, marked, lattices, flat };

hmf_hierarchy_options build_options_of(const Problem& p, double ratio, uint64_t coarsest = 0, int32_t collapse = 0) {
    hmf_hierarchy_options options{};
    options.struct_size = sizeof options;
    options.ratio = ratio;
    options.coarsest = coarsest;
    options.collapse = collapse;
    options.mollify = p.mollify;
    options.marked_vertices = p.marks.data();
    options.marked_count = p.marks.size();
    return options;
}

// Loops and weights.  False if the library makes no loops of the kind on this surface: said in an error of its own.
bool make_loops(uint64_t seed, Problem& p, Random& random) {
    const Hierarchy hierarchy(p.mesh, build_options_of(p, 0.5));
    if (!hierarchy) return false;
    const int32_t choice[] = {HMF_LOOPS_CUT, HMF_LOOPS_HANDLE, HMF_LOOPS_TUNNEL, HMF_LOOPS_PANTS, HMF_LOOPS_PANTS};
    p.loop_kind = choice[random.below(5)];
    if (p.mesh.genus == 0) p.loop_kind = HMF_LOOPS_PANTS;
    const size_t level = random.below(3) ? 0 : hierarchy.coarsest();
    hmf_loop_set* made = nullptr;
    hmf_error error{};
    hmf_status status = hmf_loops(hierarchy.get(), level, p.loop_kind, nullptr, &made, &error);
    if (status == HMF_ERROR_MESH_NOT_EMBEDDED) { // bad triangles and flips may make it meet itself
        p.loop_kind = HMF_LOOPS_PANTS;
        status = hmf_loops(hierarchy.get(), level, p.loop_kind, nullptr, &made, &error);
    }
    const Owned<hmf_loop_set> owner(made);
    EXPECT_EQ(status, HMF_OK) << "seed " << seed << ": loops of kind " << p.loop_kind << ": " << error.message;
    if (status != HMF_OK) return false;
    // Loops are of the input, whatever hierarchy solves.
    Loops loops;
    loops.kind = made->element_kind;
    loops.level = made->level;
    loops.offsets.assign(made->offsets, made->offsets + made->count + 1);
    loops.elements.assign(made->elements, made->elements + made->offsets[made->count]);
    if (level > 0) loops = library_loops(hierarchy, 0, p.loop_kind);
    p.decades = random.below(2) ? 0 : 5 * random.unit();
    if (random.below(3))
        for (size_t c = 0; c < loops.count(); ++c) loops.weights.push_back(log_uniform(random, p.decades));
    p.loops = loops;
    return true;
}

// Bars from one place of a grid to the next, as many as a tree has and some more.
struct Bars {
    std::array<size_t, 3> size; // in boxes, those between the places included
    std::vector<bool> filled;
    size_t at(std::array<size_t, 3> box) const { return (box[2] * size[1] + box[1]) * size[0] + box[0]; }

    Bars(const std::array<size_t, 3>& places, Random& random) {
        for (size_t a = 0; a < 3; ++a) size[a] = 2 * places[a] - 1;
        filled.assign(size[0] * size[1] * size[2], false);
        std::vector<std::array<size_t, 3>> found{{0, 0, 0}};
        filled[0] = true;
        const size_t all = places[0] * places[1] * places[2];
        const size_t wanted =
            std::max<size_t>(4, static_cast<size_t>((0.3 + 0.7 * random.unit()) * static_cast<double>(all)));
        while (found.size() < std::min(wanted, all)) {
            std::array<size_t, 3> between = found[random.below(found.size())], next = between;
            const size_t a = random.below(3);
            const bool back = random.below(2);
            if (back ? next[a] == 0 : next[a] + 1 == size[a]) continue;
            next[a] += back ? size_t{0} - 2 : 2;
            between[a] += back ? size_t{0} - 1 : 1;
            if (filled[at(next)]) continue;
            filled[at(next)] = filled[at(between)] = true;
            found.push_back(next);
        }
        const double share = random.unit() * random.unit();
        for (const std::array<size_t, 3>& from : found)
            for (size_t a = 0; a < 3; ++a) {
                std::array<size_t, 3> between = from, next = from;
                ++between[a];
                next[a] += 2;
                if (next[a] >= size[a] || !filled[at(next)] || filled[at(between)]) continue;
                if (closed > 0 && random.unit() >= share) continue;
                filled[at(between)] = true;
                ++closed;
            }
    }
    size_t closed = 0; // ways, which is the genus
};

// Bars of all lengths and widths, stretched along an axis: right-angled triangles, some of them a million times as long
// as wide, in rings around the bars.  No flip makes them rounder.
bool make_lattice(uint64_t seed, Problem& p) {
    Random random(seed);
    p.kind = plates;
    do {
        const Bars bars({1 + random.below(4), 2 + random.below(3), 1 + random.below(2)}, random);
        const double decades = 1.75 * static_cast<double>(random.below(3));
        const auto cuts = [&](size_t n) {
            std::vector<double> x(1, 0.0);
            while (x.size() < n + 1) x.push_back(x.back() + log_uniform(random, -decades));
            return x;
        };
        const std::vector<double> xs = cuts(bars.size[0]), ys = cuts(bars.size[1]), zs = cuts(bars.size[2]);
        p.mesh = voxel_surface(xs, ys, zs, [&](size_t i, size_t j, size_t k) {
            return bars.filled[bars.at({i, j, k})];
        });
        p.mesh.genus = bars.closed;
    } while (p.mesh.genus == 0);
    for (size_t refinements = 1 + random.below(2); refinements > 0; --refinements) p.mesh = subdivide(p.mesh);
    p.stretch = std::sqrt(10) * log_uniform(random, 3);
    std::array<double, 9> along = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    along[4 * random.below(3)] = p.stretch;
    p.mesh = transformed(p.mesh, along);
    return make_loops(seed, p, random);
}

TriMesh thin_plate_with_flat_triangles(size_t holes, double aspect, size_t refinements, size_t flat, Random& random) {
    TriMesh mesh = thin_plate(holes, aspect);
    for (; refinements > 0; --refinements) mesh = subdivide(mesh);
    for (; flat > 0; --flat) {
        const size_t triangle = random.below(mesh.triangle_count());
        flatten(mesh, triangle, random.below(2));
    }
    return mesh;
}

// Plates with triangles up to a hundred thousand times as long as wide, some of them without area (mollify).
bool make_flat(uint64_t seed, Problem& p) {
    Random random(seed);
    p.kind = plates;
    p.bad_triangles = true;
    p.mollify = 1e-5;
    p.stretch = 1000 * log_uniform(random, 2);
    const size_t holes = 2 + random.below(5), refinements = 1 + random.below(2), flat = 1 + random.below(8);
    p.mesh = thin_plate_with_flat_triangles(holes, p.stretch, refinements, flat, random);
    return make_loops(seed, p, random);
}

bool make_problem(uint64_t seed, Problem& p, Family family = Family::usual) {
    if (family == Family::lattices) return make_lattice(seed, p);
    if (family == Family::flat) return make_flat(seed, p);
    Random random(seed);
    const bool is_marked = family == Family::marked;
    p.kind = static_cast<Kind>(random.below(kinds));
    do {
        switch (p.kind) {
        case formula: p.mesh = random_formula(random); break;
        case plates: {
            const size_t a = 1 + random.below(random.below(4) ? 5 : 20), b = 1 + random.below(random.below(4) ? 3 : 10);
            p.mesh = holed_plate(a, b, random);
            for (size_t i = 0; i < 3 && p.mesh.vertex_count() < 1200; ++i) p.mesh = subdivide(p.mesh);
            p.mesh = smooth(p.mesh, random.below(6));
            break;
        }
        default: {
            const double frequency = 0.6 + 3 * random.unit();
            const size_t n = 8 + random.below(random.below(3) ? 10 : 22);
            p.mesh = random_implicit_surface(n, frequency, random);
        }
        }
    } while ((p.mesh.genus == 0 && !is_marked) || p.mesh.genus > 200);
    if (random.below(4) == 0 && p.mesh.genus > 0) {
        p.decimated = true;
        const int32_t method = static_cast<int32_t>(1 + random.below(3));
        p.mesh = decimated(p.mesh, 1 + random.below(3), method);
    }
    if (random.below(6) == 0) {
        p.bad_triangles = true;
        const uint64_t seed_of_places = random.bits();
        const double height = log_uniform(random, -5);
        p.mesh = with_bad_triangles(p.mesh, 1 + random.below(40), height, seed_of_places);
    }
    if (random.below(6) == 0) {
        p.flipped = true;
        p.mesh = with_random_flips(p.mesh, p.mesh.triangle_count() / 4, 0.9, random.bits());
    }
    p.stretch = random.below(3) == 0 ? 1 : log_uniform(random, 5);
    p.mesh = transformed(p.mesh, random_rotation(random));
    p.mesh = transformed(p.mesh, {p.stretch, 0, 0, 0, log_uniform(random, 0.5), 0, 0, 0, 1});
    if (std::string defect = mesh_defect(p.mesh); !defect.empty()) {
        ADD_FAILURE() << "seed " << seed << ": " << defect;
        return false;
    }
    while (is_marked && p.marks.size() < (p.mesh.genus == 0 ? 4 : 1) + random.below(9)) {
        const uint32_t v = static_cast<uint32_t>(random.below(p.mesh.vertex_count()));
        if (std::find(p.marks.begin(), p.marks.end(), v) == p.marks.end()) p.marks.push_back(v);
    }
    return make_loops(seed, p, random);
}

struct Row {
    size_t solves = 0, converged = 0, class_limit = 0, stalled = 0, other = 0, repeats = 0;
    double worst = 0;
};

struct Tally {
    size_t problems = 0, missed = 0, wrong = 0, errors = 0; // missed: 1e-8, with one of the hierarchies or more
    Row all, by_stretch[6], by_kind[kinds], bad, flipped, decimated;
    struct Use {
        size_t made = 0, refused = 0;
    } maps, lines, quads, atlases;
};

void count(Row& row, const Solution& s) {
    ++row.solves;
    row.repeats += s.report.class_repeats;
    if (s.status == HMF_OK) ++row.converged;
    else if (s.status == HMF_LIMIT_CLASS) ++row.class_limit;
    else if (s.status == HMF_LIMIT_STALLED) ++row.stalled;
    else ++row.other;
    if (s.status < HMF_ERROR_NULL) row.worst = std::max(row.worst, s.report.residual_max);
}

void print(const char* name, const Row& row) {
    if (row.solves == 0) return;
    std::printf("  %-18s %6zu %9zu %7.2f%% %6zu %6zu %6zu %7zu   %.1e\n", name, row.solves, row.converged,
                100.0 * static_cast<double>(row.converged) / static_cast<double>(row.solves), row.stalled,
                row.class_limit, row.other, row.repeats, row.worst);
}

// What follows from a foliation: residuals as reported, heights are weights, areas add up to the energy, no internal
// errors.
void check_uses(uint64_t seed, const Problem& p, const Solution& s, Tally& tally) {
    hmf_error error{};
    const std::vector<double> residual = residuals(s.foliation, p.mesh.vertex_count());
    EXPECT_NEAR(*std::max_element(residual.begin(), residual.end()), s.report.residual_max,
                1e-6 * s.report.residual_max + 1e-15)
        << "seed " << seed;
    hmf_cylinder_set* cylinders = nullptr;
    hmf_status status = hmf_cylinders(s.foliation.get(), nullptr, nullptr, &cylinders, &error);
    const Owned<hmf_cylinder_set> cylinder_owner(cylinders);
    if (status == HMF_OK) {
        std::vector<double> heights, weights = p.loops.weights;
        double area = 0;
        for (uint64_t i = 0; i < cylinders->count; ++i) {
            heights.push_back(cylinders->list[i].height);
            area += cylinders->list[i].area;
        }
        weights.resize(p.loops.count(), 1);
        std::sort(heights.begin(), heights.end());
        std::sort(weights.begin(), weights.end());
        EXPECT_EQ(heights.size(), weights.size()) << "seed " << seed;
        // Weights are rounded to the unit of the largest.
        for (size_t i = 0; i < heights.size() && i < weights.size(); ++i)
            if (std::abs(heights[i] - weights[i]) > 1e-13 * weights.back()) {
                ++tally.wrong;
                ADD_FAILURE() << "seed " << seed << ": height " << heights[i] << ", weight " << weights[i];
                break;
            }
        EXPECT_NEAR(area, s.report.energy, 1e-6 * s.report.energy) << "seed " << seed;
    } else {
        ++tally.errors;
        ADD_FAILURE() << "seed " << seed << ": cylinders: " << status << " " << error.message;
    }
    const auto use = [&](const char* name, Tally::Use& count, hmf_status got) {
        ++(got == HMF_OK ? count.made : count.refused);
        if (got != HMF_OK && number("HMF_CAMPAIGN_VERBOSE", 0) != 0)
            std::printf("seed %llu: %s: %d %s\n", static_cast<unsigned long long>(seed), name, got, error.message);
        if (got != HMF_ERROR_INTERNAL) return;
        ++tally.errors;
        ADD_FAILURE() << "seed " << seed << ": " << name << ": " << error.message;
    };
    hmf_parameterization* uv = nullptr;
    use("map", tally.maps, hmf_parameterize(s.foliation.get(), nullptr, nullptr, &uv, &error));
    const Owned<hmf_parameterization> uv_owner(uv);
    if (uv) {
        int64_t turns = 0;
        for (size_t v = 0; v < uv->vertex_count; ++v) turns += 2 - uv->cone[v];
        EXPECT_EQ(turns, 4 - 4 * static_cast<int64_t>(p.mesh.genus)) << "seed " << seed;
    }
    hmf_lines* lines = nullptr;
    use("lines", tally.lines, hmf_trace(s.foliation.get(), nullptr, nullptr, &lines, &error));
    const Owned<hmf_lines> line_owner(lines);
    hmf_quad_mesh* quads = nullptr;
    use("quads", tally.quads, hmf_quads(s.foliation.get(), nullptr, nullptr, &quads, &error));
    const Owned<hmf_quad_mesh> quad_owner(quads);
    if (p.mesh.vertex_count() > 1000) return; // packing takes longer than all the rest
    hmf_chart_set* charts = nullptr;
    use("atlas", tally.atlases, hmf_atlas(s.foliation.get(), nullptr, nullptr, &charts, &error));
    const Owned<hmf_chart_set> chart_owner(charts);
}

void solve_problem(uint64_t seed, Tally& tally, Family family = Family::usual) {
    Problem p;
    if (!make_problem(seed, p, family)) {
        ++tally.errors;
        return;
    }
    ++tally.problems;
    Random random(seed ^ 0x5eed);
    std::vector<double> energies;
    const bool verbose = number("HMF_CAMPAIGN_VERBOSE", 0) != 0;
    const double ratios[] = {0.25, 0.5, 0.75};
    const size_t turn = random.below(3);
    for (size_t way = 0; way < 3; ++way) {
        const double ratio = ratios[way];
        const int32_t collapse = static_cast<int32_t>(1 + (way + turn) % 3);
        const Hierarchy hierarchy(p.mesh,
                                  build_options_of(p, ratio, 40 * p.mesh.genus + 100 + random.below(1500), collapse));
        ASSERT_TRUE(hierarchy);
        const Solution s = solve(hierarchy, &p.loops, solve_options(HMF_METHOD_NEWTON, 0));
        const size_t decade = std::min<size_t>(5, p.stretch > 1 ? 1 + static_cast<size_t>(std::log10(p.stretch)) : 0);
        for (Row* row :
             {&tally.all, &tally.by_stretch[decade], &tally.by_kind[p.kind], p.bad_triangles ? &tally.bad : nullptr,
              p.flipped ? &tally.flipped : nullptr, p.decimated ? &tally.decimated : nullptr})
            if (row) count(*row, s);
        if (verbose || s.status != HMF_OK)
            std::printf(
                "seed %llu ratio %.2f collapse %d: %zu vertices, genus %zu, %zu marks, kind %d, stretch %.0f%s%s%s, "
                "loops %d, "
                "weights 1e%.1f: status %d class %d residual %.1e poles %llu energy %.12g repeats %u, %.2f s: %s\n",
                static_cast<unsigned long long>(seed), ratio, collapse, p.mesh.vertex_count(), p.mesh.genus,
                p.marks.size(), static_cast<int>(p.kind), p.stretch, p.bad_triangles ? ", bad triangles" : "",
                p.flipped ? ", flipped" : "", p.decimated ? ", decimated" : "", p.loop_kind, p.decades, s.status,
                s.report.class_state, s.report.residual_max, static_cast<unsigned long long>(s.report.poles),
                s.report.energy, s.report.class_repeats, s.report.solve_seconds, s.error.message);
        if (s.status >= HMF_ERROR_NULL) {
            ++tally.errors;
            ADD_FAILURE() << "seed " << seed << " ratio " << ratio << ": " << s.status << " " << s.error.message;
            continue;
        }
        EXPECT_EQ(s.report.poles, 0u) << "seed " << seed;
        EXPECT_EQ(s.report.converged, s.report.residual_max <= 1e-8) << "seed " << seed;
        if (s.report.class_state != HMF_CLASS_PROVEN) {
            ++tally.wrong;
            ADD_FAILURE() << "seed " << seed << " ratio " << ratio << ": class " << s.report.class_state;
        }
        if (s.status == HMF_OK) {
            EXPECT_LE(s.report.residual_max, 1e-8) << "seed " << seed;
            energies.push_back(s.report.energy);
        } else {
            EXPECT_GT(std::string(s.error.message).size(), 0u);
        }
        if (way == turn) check_uses(seed, p, s, tally);
        // A closed way that crosses a loop once crosses its cylinder.
        if (way == turn && p.mesh.vertex_count() < 3000 && p.marks.empty()) {
            const LevelMesh level = read_level(hierarchy, 0);
            const size_t c = random.below(p.loops.count());
            std::vector<uint32_t> crossed = crossed_edges(level, p.loops, c);
            std::sort(crossed.begin(), crossed.end());
            // Through an edge that the loop crosses there and back there is a way that does not count.
            if (std::adjacent_find(crossed.begin(), crossed.end()) != crossed.end()) continue;
            const double weight = p.loops.weights.empty() ? 1 : p.loops.weights[c];
            EXPECT_GE(shortest_crossing(level, p.loops, c, s.values), weight * (1 - 1e-9)) << "seed " << seed;
        }
    }
    tally.missed += energies.size() < 3;
    for (const double energy : energies)
        if (std::abs(energy - energies[0]) > 1e-8 * energies[0]) {
            ++tally.wrong;
            ADD_FAILURE() << "seed " << seed << ": energies " << testing::PrintToString(energies);
            break;
        }
}

// One problem in so many may miss 1e-8: if it is hard, it is so with every hierarchy.
void run(size_t usual, Family family, size_t one_in = 200) {
    const size_t problems = number("HMF_CAMPAIGN_PROBLEMS", usual), seed = number("HMF_CAMPAIGN_SEED", 1);
    Tally tally;
    for (size_t i = 0; i < problems; ++i) {
        solve_problem(seed + i, tally, family);
        std::fflush(stdout);
    }
    std::printf("%zu problems, seeds %zu to %zu: %zu wrong, %zu errors\n", tally.problems, seed, seed + problems - 1,
                tally.wrong, tally.errors);
    std::printf("  %-18s %6s %9s %8s %6s %6s %6s %7s   %s\n", "", "solves", "converged", "", "stall", "class", "other",
                "repeats", "worst residual");
    print("all", tally.all);
    const char* const stretch[] = {"stretch 1", "stretch to 10", "to 100", "to 1000", "to 10 000", "to 100 000"};
    for (size_t i = 0; i < 6; ++i) print(stretch[i], tally.by_stretch[i]);
    const char* const kind[] = {"formula", "plates", "volumes"};
    for (size_t i = 0; i < kinds; ++i) print(kind[i], tally.by_kind[i]);
    print("bad triangles", tally.bad);
    print("flipped", tally.flipped);
    print("decimated", tally.decimated);
    std::printf("  what follows, made and refused: maps %zu %zu, lines %zu %zu, quads %zu %zu, atlases %zu %zu\n",
                tally.maps.made, tally.maps.refused, tally.lines.made, tally.lines.refused, tally.quads.made,
                tally.quads.refused, tally.atlases.made, tally.atlases.refused);
    EXPECT_EQ(tally.wrong, 0u);
    EXPECT_EQ(tally.errors, 0u);
    // In a small sample one may.
    EXPECT_LE(tally.missed, 1 + tally.problems / one_in);
}

} // namespace

TEST(Campaign, SameMinimumOrAStatusThatSaysWhyNot) { run(sample(14, 2), Family::usual); }

// One to nine marked vertices at random, four at least on a sphere.
TEST(Campaign, MarkedVertices) { run(sample(10, 4), Family::marked); }

// One in twenty stalled while there was a multigrid alone (sparse_factor.hpp).
TEST(Campaign, Lattices) { run(sample(20, 4), Family::lattices); }

// One in eight stalled while a step whose energy rose was halved until nothing was left of it. 1e-8 on 99 % is what
// they have now: some zeros on heavy edges need parts of a unit that no move has.
TEST(Campaign, FlatTriangles) { run(sample(20, 4), Family::flat, 100); }

// Of these the first two needed a step that is solved for again wherever its energy rises, the third one moves of zeros
// after exact steps.
TEST(Campaign, ThinPlatesThatStalled) {
    const struct {
        size_t holes;
        double aspect;
        size_t refinements;
        uint64_t seed;
        int32_t loops;
    } cases[] = {{3, 1e5, 1, 2, HMF_LOOPS_PANTS}, {3, 1e5, 2, 5, HMF_LOOPS_PANTS}, {4, 1e4, 2, 4, HMF_LOOPS_CUT}};
    for (const auto& c : cases) {
        SCOPED_TRACE(c.seed);
        Random random(c.seed);
        Problem p;
        p.mesh = thin_plate_with_flat_triangles(c.holes, c.aspect, c.refinements, 5, random);
        p.mollify = 1e-5;
        const Hierarchy hierarchy(p.mesh, build_options_of(p, 0.5));
        ASSERT_TRUE(hierarchy);
        const Loops loops = library_loops(hierarchy, 0, c.loops);
        const Solution s = solve(hierarchy, &loops, solve_options(HMF_METHOD_NEWTON, 0));
        EXPECT_EQ(s.status, HMF_OK) << s.report.residual_max;
        EXPECT_LE(s.report.residual_max, 1e-8);
    }
}

// Once these ended in an internal error (cylinders of equal height not told apart; all zeros in triangles when the
// unit got coarser) or had lost the class (the second try with other walks than the first).
// 9008: 60 bits are too short.  30077: a height had more than 63.  719732: edges from a vertex to itself round pants of
// zero triangles, of which none was known to open (test_self_edges.cpp).  870826: less than a unit was missing at two
// zeros with a heavy edge between them.  970250: each step took some of 600 zeros off vertices, the residual stayed.
TEST(Campaign, SeedsThatFailed) {
    Tally tally;
    for (const uint64_t seed : {9008, 719732, 870826, 30077, 1201, 2180, 2328, 970250})
        if (tally.problems < sample<size_t>(8, 3)) solve_problem(seed, tally);
    EXPECT_EQ(tally.wrong, 0u);
    EXPECT_EQ(tally.errors, 0u);
    EXPECT_EQ(tally.all.converged, tally.all.solves);
}

// 14: parameterization wrote outside of its memory, as a zero had no vertex but a marked one.  2052: it needs 120
// steps, and ended after 60, although each had gained.
TEST(Campaign, SeedsThatFailedWithMarkedVertices) {
    Tally tally;
    for (const uint64_t seed : {14, 2052}) solve_problem(seed, tally, Family::marked);
    EXPECT_EQ(tally.wrong, 0u);
    EXPECT_EQ(tally.errors, 0u);
    EXPECT_EQ(tally.all.converged, tally.all.solves);
}

// Values of a few units on edges that are 1e6 times as heavy as others: (u, v) was refused with an internal error,
// because the rounding to the unit was taken for a foliation that is not harmonic.
TEST(Campaign, MapsOfValuesOfAFewUnits) {
    Tally tally;
    solve_problem(110260, tally, Family::lattices);
    EXPECT_EQ(tally.errors, 0u);
    EXPECT_EQ(tally.maps.made, 1u);
}

// Zeros without a corner of their own.  Two maps are refused.  9: nothing is left of the foliation at two thirds of the
// vertices, and the image covers 4.8 times its area.  1: 444 vertices of genus 8, where the circumference of a cylinder
// is off by a factor of 2.03.  941059 has 572 zeros on 1360 vertices.
TEST(Campaign, EveryZeroHasAVertex) {
    Tally tally;
    solve_problem(941059, tally);
    EXPECT_EQ(tally.maps.made, 1u);
    for (const uint64_t seed : {9, 1}) solve_problem(seed, tally);
    EXPECT_EQ(tally.errors, 0u);
}

// 942007: the length of a chart was scaled twice.  943566: a chart many times as long as the square had so many columns
// that there was no end, and no memory.
TEST(Campaign, AtlasesWithLongCharts) {
    Tally tally;
    for (const uint64_t seed : {942007, 943566})
        if (tally.problems < sample<size_t>(2, 1)) solve_problem(seed, tally);
    EXPECT_EQ(tally.errors, 0u);
    EXPECT_EQ(tally.atlases.made, tally.problems);
}

// A cylinder 45 000 times as long as high: v along it went beyond 63 bits, and the packing asked for all memory.
TEST(Campaign, AtlasOfACylinderThatIsTooLong) {
    Tally tally;
    solve_problem(110710, tally);
    EXPECT_EQ(tally.errors, 0u);
    EXPECT_EQ(tally.atlases.refused, 1u);
}

// Which flips come first depends on the numbers of the edges.  Triangles 40 000 times as long as wide have areas that
// lengths in doubles know to 6 digits: three hierarchies had weights up to 68 % apart and energies 3e-5 apart.
TEST(Campaign, WeightsDoNotDependOnTheOrderOfFlips) {
    Problem p;
    ASSERT_TRUE(make_problem(486, p));
    std::vector<double> reference;
    for (const double ratio : {0.25, 0.5, 0.75}) {
        const Hierarchy hierarchy(p.mesh, ratio);
        ASSERT_TRUE(hierarchy);
        EXPECT_GT(hierarchy.get()->intrinsic_flip_count, p.mesh.vertex_count());
        const hmf::Level& level = hierarchy.get()->levels[0];
        std::vector<double> weights(level.weight, level.weight + level.mesh.edge_count);
        std::sort(weights.begin(), weights.end());
        if (reference.empty()) reference = weights;
        ASSERT_EQ(weights.size(), reference.size());
        for (size_t e = 0; e < weights.size(); ++e) ASSERT_NEAR(weights[e], reference[e], 1e-12 * (1 + reference[e]));
    }
}

// Integers alone miss this tolerance.  Parts of a unit, three bits of them, are integers in a finer unit: a foliation,
// of a smaller residual.
TEST(Campaign, FractionsBelongToAFoliation) {
    constexpr double tolerance = 1e-11;
    Problem p;
    ASSERT_TRUE(make_problem(9008, p));
    const Hierarchy hierarchy(p.mesh, 0.5, 1000);
    const Solution s = solve(hierarchy, &p.loops, solve_options(HMF_METHOD_NEWTON, tolerance));
    ASSERT_EQ(s.status, HMF_OK);
    ASSERT_TRUE(s.foliation->fraction);
    hmf_error error{};
    hmf::Memory memory(nullptr, nullptr, nullptr, 0);
    hmf::Call call(memory, &error, nullptr, nullptr);
    hmf::State state;
    double unit = 1;
    ASSERT_FALSE(hmf::load_solved(*s.foliation, state, unit, call));
    hmf::Foliation& f = state.foliation;
    const hmf::Mesh& mesh = f.mesh;
    const double* const weight = hierarchy.get()->levels[0].weight;
    hmf::Rings rings;
    hmf::Star star;
    hmf::TwistedModel model;
    ASSERT_TRUE(rings.build(mesh, weight, memory) && star.allocate(memory, rings.max_degree));
    std::vector<double> whole(mesh.vertex_count); // of the integers alone
    EXPECT_GT(hmf::residuals(f, rings, weight, star, whole.data(), call).max, 10 * tolerance);
    const std::vector<double> of_call = residuals(s.foliation, p.mesh.vertex_count());
    EXPECT_DOUBLE_EQ(*std::max_element(of_call.begin(), of_call.end()), s.report.residual_max);
    ASSERT_TRUE(model.allocate(mesh, memory) && model.linearize(f, rings, weight, star, call));
    const hmf::SingularityCount zeros = hmf::count_singularities(f);
    constexpr int64_t finer = 8;
    const auto place = [&](uint32_t h) {
        return model.sign[h] * static_cast<int64_t>(std::floor(finer * s.foliation->fraction[mesh.origin[h]] + 0.5));
    };
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        ASSERT_LT(f.value[e], INT64_MAX / (4 * finer));
        f.value[e] = std::abs(finer * f.value[e] - place(2 * e) - place(2 * e + 1));
    }
    const hmf::SingularityCount fine = hmf::count_singularities(f);
    EXPECT_EQ(fine.broken_triangles, 0u);
    EXPECT_EQ(fine.poles, 0u);
    EXPECT_EQ(fine.index_sum, zeros.index_sum);
    // A place is rounded by half of a finer unit, so a value by one, and what one side of a vertex pulls more than all
    // others by its weights.  The integers alone are further from balance than that.
    std::vector<double> rounded(mesh.vertex_count);
    hmf::residuals(f, rings, weight, star, rounded.data(), call);
    double total = 0, beyond = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) total += weight[e] * static_cast<double>(f.value[e]);
    const double floor = hmf::pull_floor(total, mesh.vertex_count);
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        double pull = 0, error = 0;
        for (uint32_t t = rings.offset[v]; t < rings.offset[v + 1]; ++t) {
            const uint32_t e = hmf::edge_of(rings.side[t].half_edge);
            pull += weight[e] * static_cast<double>(f.value[e]);
            error += weight[e];
        }
        const double bound = s.report.residual_max + error / std::max(floor, pull);
        EXPECT_LE(rounded[v], 1.001 * bound);
        beyond = std::max(beyond, whole[v] / bound);
    }

    EXPECT_GT(beyond, 1.001);
}

} // namespace test_campaign
