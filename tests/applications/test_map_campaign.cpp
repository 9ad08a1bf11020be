// (u, v) of random coarse surfaces: tubes whose radius varies by up to e^6, closed, open and as spheres, with marked
// vertices, with small handles, and with loops twisted around them. Each map is judged by its arrays alone.
//
//     HMF_MAPS        number of surfaces of each family, default 40, a sample (10 under sanitizers)
//     HMF_MAPS_SEED   of the first one, default 0
//
// A line is printed for each map that is refused, and a table at the end.
#include "support/map_judge.hpp"
#include "support/map_problems.hpp"
#include "support/sample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace test_map_campaign {

using namespace test;
using namespace test::map_problems;

namespace {

uint64_t number(const char* name, uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

struct Tally {
    size_t maps = 0, refused = 0, unlucky = 0;
    double least = HUGE_VAL, most = 0, folded = 0, off_lattice = 0;

    void print(const char* family) const {
        std::printf("%-18s %5zu maps, %3zu refused, %3zu left out; area / energy %.6f to %.6f, without signs up to "
                    "%.3f; off the lattice %.1e\n",
                    family, maps, refused, unlucky, least, most, folded, off_lattice);
    }
};

// exact: there are no zeros.
void run(Problem p, bool exact, Tally& tally) {
    if (p.is_sphere) p.marks = suggested_marks(p.mesh);
    Loops drawn;
    if (!p.path.empty()) {
        drawn.kind = HMF_PATH_VERTICES;
        drawn.add(p.path);
    }
    const hmf_hierarchy_options options = with_marks(p.marks);
    hmf_hierarchy* raw = nullptr;
    if (p.mesh.vertex_count() == 0
        || hmf_hierarchy_create(p.mesh.positions.data(), p.mesh.vertex_count(), p.mesh.triangles.data(),
                                p.mesh.triangle_count(), &options, nullptr, &raw, nullptr)
               != HMF_OK) {
        ++tally.unlucky; // too few vertices
        return;
    }
    hmf_hierarchy_destroy(raw);
    const Hierarchy hierarchy(p.mesh, options);
    const auto set = drawn.count() ? nullptr : loops_of(hierarchy, p.kind);
    if (set) {
        drawn.kind = set->element_kind;
        drawn.level = set->level;
        drawn.offsets.assign(set->offsets, set->offsets + set->count + 1);
        drawn.elements.assign(set->elements, set->elements + set->offsets[set->count]);
    }
    drawn.weights = p.weights;
    const hmf_loop_set loops = drawn.view();
    const Solution s = solve(hierarchy, set && p.weights.empty() ? *set : loops);
    ASSERT_EQ(s.status, HMF_OK) << s.error.message;
    hmf_parameterization* made = nullptr;
    hmf_error error{};
    const hmf_status status = hmf_parameterize(s.foliation.get(), nullptr, nullptr, &made, &error);
    const Owned<hmf_parameterization> map(made);
    if (status == HMF_ERROR_UNSUPPORTED && !exact) {
        ++tally.refused;
        std::printf("%s\n", error.message);
        return;
    }
    ASSERT_EQ(status, HMF_OK) << error.message;
    ++tally.maps;
    const LevelMesh mesh = read_level(hierarchy, 0);
    const bool crosses = drawn.kind == HMF_PATH_TRIANGLES && !p.has_boundary;
    const MapJudgment judged = judge_map(mesh, s.foliation, crosses ? drawn : Loops(), *map);
    EXPECT_EQ(judged.defect, "");
    EXPECT_NEAR(judged.area, map->area, 1e-9 * map->area);
    const double ratio = judged.area / s.report.energy;
    if (exact) EXPECT_NEAR(ratio, 1, 1e-4);
    EXPECT_GT(ratio, 0.9);
    EXPECT_LT(ratio, 1.5);
    EXPECT_NEAR(map->energy_ratio, ratio, 1e-4);
    EXPECT_GT(map->circumference_least, 0.5);
    EXPECT_LT(map->circumference_most, 2);
    tally.least = std::min(tally.least, ratio);
    tally.most = std::max(tally.most, ratio);
    EXPECT_LT(judged.absolute_area, 1.5 * s.report.energy);
    tally.folded = std::max(tally.folded, judged.absolute_area / s.report.energy);
    if (p.has_boundary) return;
    EXPECT_EQ(judged.turns, 4 - 4 * static_cast<long>(p.mesh.genus));
    if (!p.weights.empty()) return;
    EXPECT_LT(judged.off_lattice, 1e-5);
    tally.off_lattice = std::max(tally.off_lattice, judged.off_lattice);
}

// one_of: of so many maps one may be refused.
void run_family(const char* name, Problem (*make)(Random&), bool exact, uint64_t one_of = 10) {
    const uint64_t first = number("HMF_MAPS_SEED", 0), count = number("HMF_MAPS", sample<uint64_t>(40, 10));
    Tally tally;
    for (uint64_t seed = first; seed < first + count; ++seed) {
        SCOPED_TRACE(testing::Message() << name << ", seed " << seed);
        Random random(seed);
        const size_t refused = tally.refused;
        run(make(random), exact, tally);
        if (tally.refused > refused) std::printf("refused: %s, %llu\n", name, static_cast<unsigned long long>(seed));
    }
    tally.print(name);
    EXPECT_GT(tally.maps, 0u);
    // A wrong place of zeros is refused as a mesh that is too coarse: few of these are.
    EXPECT_LE(one_of * tally.refused, tally.maps + tally.refused);
}

} // namespace

TEST(MapCampaign, ClosedTubes) { run_family("closed", closed, true); }
TEST(MapCampaign, OpenTubes) { run_family("open", open, true); }
TEST(MapCampaign, Spheres) { run_family("spheres", sphere, false); }
TEST(MapCampaign, TwistedLoops) { run_family("twisted loops", twisted, true); }
TEST(MapCampaign, MarkedTori) { run_family("marked tori", marked, false); }
TEST(MapCampaign, GenusTwo) { run_family("genus 2", genus_two, false); }
TEST(MapCampaign, GenusTwoPants) { run_family("genus 2, pants", genus_two_pants, false); }
TEST(MapCampaign, GenusThreePants) { run_family("genus 3, pants", genus_three_pants, false); }
TEST(MapCampaign, ThinCylinders) { run_family("thin cylinders", thin_cylinders, false, 100); }

// With the nearest corners as places of the zeros a circumference is off by more than a factor of 2.
TEST(MapCampaign, OtherCorners) {
    Tally tally;
    Random random(5411);
    run(genus_three_pants(random), false, tally);
    EXPECT_EQ(tally.maps, 1u);
}

// Sides longer than 2^52 units: the layout is moved by multiples of that, so that periods stay what they are.
TEST(MapCampaign, LongSides) {
    Tally tally;
    Random sphere_of(604), torus_of(1765);
    run(sphere(sphere_of), false, tally);
    run(marked(torus_of), false, tally);
    EXPECT_EQ(tally.maps, 2u);
}

// With the nearest corners the energy is within its bounds, and a circumference 47 times too large.
TEST(MapCampaign, Circumferences) {
    Tally tally;
    Random random(85);
    run(marked(random), false, tally);
    EXPECT_EQ(tally.maps + tally.refused, 1u);
}

// With the nearest corners the energy is 0.76 times that of the foliation, and each circumference within its bounds.
TEST(MapCampaign, Energies) {
    Tally tally;
    Random random(1728);
    run(genus_three_pants(random), false, tally);
    EXPECT_EQ(tally.maps + tally.refused, 1u);
}

} // namespace test_map_campaign
