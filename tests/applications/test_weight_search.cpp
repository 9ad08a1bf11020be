// Loops without a weight in the even design of a surface with boundary: kept where quads need them.
#include "src/applications/design/weight_search.hpp"
#include "src/core/hierarchy/hierarchy.hpp"
#include "src/core/curves/double_loops.hpp"
#include "src/applications/loops/surface_loops.hpp"
#include "support/boundary.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <vector>

namespace test_weight_search {

using namespace hmf;
using test::TriMesh;

namespace {

// A strip with holes, such as two near each end:
//
//     +------------------- ... -------------------+
//     |   o    o                         o    o   |
//     +------------------- ... -------------------+
TriMesh strip(size_t length, const std::vector<double>& holes) {
    const TriMesh whole = test::rectangle(length, 8, static_cast<double>(length), 8, 0.1, 7);
    TriMesh mesh;
    std::map<uint32_t, uint32_t> number;
    for (size_t t = 0; t < whole.triangle_count(); ++t) {
        double middle[2] = {0, 0};
        for (size_t c = 0; c < 3; ++c)
            for (size_t k = 0; k < 2; ++k) middle[k] += whole.positions[3 * whole.triangles[3 * t + c] + k] / 3;
        bool in_hole = false;
        for (const double x : holes) in_hole = in_hole || std::hypot(middle[0] - x, middle[1] - 4) < 1.3;
        if (in_hole) continue;
        for (size_t c = 0; c < 3; ++c) {
            const uint32_t v = whole.triangles[3 * t + c];
            const auto [place, is_new] = number.try_emplace(v, static_cast<uint32_t>(number.size()));
            if (is_new)
                for (size_t k = 0; k < 3; ++k) mesh.positions.push_back(whole.positions[3 * v + k]);
            mesh.triangles.push_back(place->second);
        }
    }
    return mesh;
}

// The weights after keep_all_if_bare where only loops that lie before x = 20 have one.
std::vector<double> kept(const TriMesh& mesh) {
    hmf_hierarchy h(nullptr, nullptr, nullptr, 0);
    hmf_error error{};
    Call call(h.memory, &error, nullptr, nullptr);
    BuildOptions options;
    options.coarsest = 250;
    EXPECT_EQ(build_hierarchy(h, mesh.positions.data(), mesh.vertex_count(), 0, mesh.triangles.data(),
                              mesh.triangle_count(), options, call),
              HMF_OK);
    FoundLoops found;
    WeightedLoops doubled;
    EXPECT_EQ(surface_loops(h, HMF_LOOPS_PANTS, call, found), HMF_OK);
    EXPECT_EQ(double_loops(h, found.set(), found.is_round.data(), call, doubled), HMF_OK);
    EXPECT_EQ(check_loops(h.input, doubled.loops, call, nullptr), HMF_OK);
    Array<double> weights;
    EXPECT_TRUE(weights.allocate_filled(h.memory, found.count(), 1.0));
    size_t with = 0;
    for (size_t c = 0; c < found.count(); ++c) {
        for (uint64_t i = found.offsets[c]; i < found.offsets[c + 1]; ++i)
            if (mesh.positions[3 * mesh.triangles[3 * found.triangles[i]]] > 20) weights[c] = 0;
        with += weights[c] > 0;
    }
    EXPECT_GT(with, 0u);
    EXPECT_LT(with, found.count());
    WeightSearch search(h, call);
    double unevenness = 0;
    EXPECT_EQ(search.start(), HMF_OK);
    bool bare = true;
    EXPECT_EQ(search.keep_all_if_bare(doubled, weights, unevenness, bare), HMF_OK);
    EXPECT_FALSE(bare);
    return {weights.begin(), weights.end()};
}

auto even_design_of(const TriMesh& mesh, int32_t no_poles) {
    hmf_design_options options{};
    options.struct_size = sizeof options;
    options.no_poles = no_poles;
    return test::make<hmf_design>([&](hmf_design** out, hmf_error* error) {
        return hmf_even_design(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                               &options, nullptr, out, error);
    });
}

} // namespace

// A disk of five arms, 4 wide and 30 long, on a comb 4 wide: four marked corners leave most arms without leaves.
TEST(WeightSearch, ArmsOfADisk) {
    const auto cell = [](int x, int y) { return y < 4 || x % 8 < 4; };
    TriMesh mesh;
    std::map<std::pair<int, int>, uint32_t> vertex;
    const auto at = [&](int x, int y) {
        const auto [found, is_new] = vertex.emplace(std::make_pair(x, y), static_cast<uint32_t>(vertex.size()));
        if (is_new) mesh.positions.insert(mesh.positions.end(), {double(x), double(y), 0});
        return found->second;
    };
    for (int x = 0; x < 36; ++x)
        for (int y = 0; y < 34; ++y)
            if (cell(x, y)) {
                const uint32_t p = at(x, y), q = at(x + 1, y), r = at(x + 1, y + 1), s = at(x, y + 1);
                mesh.triangles.insert(mesh.triangles.end(), {p, q, r, p, r, s});
            }
    const auto plain = even_design_of(mesh, 1), design = even_design_of(mesh, 0);
    ASSERT_TRUE(plain && design);
    EXPECT_EQ(plain->marked_count, 4u);
    EXPECT_LT(design->unevenness, 0.5 * plain->unevenness);
    std::set<int> arms;
    for (uint64_t k = 0; k < design->marked_count; ++k)
        if (mesh.positions[3 * design->marked_vertices[k] + 1] > 24)
            arms.insert(static_cast<int>(mesh.positions[3 * design->marked_vertices[k]]) / 8);
    EXPECT_GE(arms.size(), 4u);
    EXPECT_NEAR(design->unevenness_before, plain->unevenness_before, 1e-9 * plain->unevenness_before);
}

// A tube of radius 1 that is closed by half a sphere at its upper end; its lower end is cut off at this slope.
TriMesh thimble(size_t around, size_t rings, double slope) {
    TriMesh mesh;
    const double height = 4, turn = 6.283185307179586 / static_cast<double>(around);
    const size_t cap = around / 4;
    for (size_t i = 0; i < rings + cap; ++i)
        for (size_t j = 0; j < around; ++j) {
            const double angle = turn * (static_cast<double>(j) + 0.5 * static_cast<double>(i % 2));
            const double up = i < rings ? static_cast<double>(i) / static_cast<double>(rings) : 1;
            const double over =
                i < rings ? 0 : 1.5707963267948966 * static_cast<double>(i - rings) / static_cast<double>(cap);
            const double r = std::cos(over), low = slope * std::cos(angle);
            mesh.positions.insert(mesh.positions.end(), {r * std::cos(angle), r * std::sin(angle),
                                                         low + (height - low) * up + std::sin(over)});
        }
    const uint32_t top = static_cast<uint32_t>(mesh.vertex_count());
    mesh.positions.insert(mesh.positions.end(), {0, 0, height + 1});
    for (size_t i = 0; i < rings + cap; ++i)
        for (size_t j = 0; j < around; ++j) {
            const uint32_t a = static_cast<uint32_t>(i * around + j),
                           b = static_cast<uint32_t>(i * around + (j + 1) % around);
            if (i + 1 == rings + cap) {
                mesh.triangles.insert(mesh.triangles.end(), {a, b, top});
                continue;
            }
            const uint32_t c = a + static_cast<uint32_t>(around), d = b + static_cast<uint32_t>(around);
            if (i % 2 == 0) mesh.triangles.insert(mesh.triangles.end(), {a, b, c, b, d, c});
            else mesh.triangles.insert(mesh.triangles.end(), {a, b, d, a, d, c});
        }
    return mesh;
}

// A thimble is a disk, and a limb: with two poles at its closed end leaves go around it.  The lowest point of its
// boundary counts as a tip, too: at a slope of 1.5 the pair there leaves a part without leaves, and is left out.
TEST(WeightSearch, Thimble) {
    for (const double slope : {1.2, 1.5, 10.0}) {
        const TriMesh mesh = thimble(32, 24, slope);
        const auto plain = even_design_of(mesh, 1), design = even_design_of(mesh, 0);
        ASSERT_TRUE(plain && design) << slope;
        EXPECT_EQ(plain->marked_count, 4u) << slope;
        EXPECT_LT(design->unevenness, 0.55 * plain->unevenness) << slope;
        size_t above = 0;
        for (uint64_t k = 0; k < design->marked_count; ++k)
            above += mesh.positions[3 * design->marked_vertices[k] + 2] > 4.5;
        EXPECT_EQ(above, slope > 2 ? 4u : 2u) << slope;
        EXPECT_EQ(design->marked_count - above, slope == 1.5 ? 0u : 2u) << slope;
    }
}

// The ends of a strip beyond its holes are limbs: with poles there the scale is more even, unless they are not wanted.
TEST(WeightSearch, LimbsWithBoundary) {
    const TriMesh mesh = strip(80, {36, 44});
    double unevenness[2];
    for (const int32_t no_poles : {0, 1}) {
        const auto design = even_design_of(mesh, no_poles);
        ASSERT_TRUE(design);
        unevenness[no_poles] = design->unevenness;
        EXPECT_EQ(design->marked_count > 0, no_poles == 0);
        for (uint64_t k = 0; k < design->marked_count; ++k) {
            const double x = mesh.positions[3 * design->marked_vertices[k]];
            EXPECT_TRUE(x < 8 || x > 72) << x;
        }
    }
    EXPECT_LT(unevenness[0], 0.9 * unevenness[1]);
}

// Leaves fade along the strip as exp(-pi x / 8): on a short one they reach the other end, where 1e-6 is left of
// them, a hundred times what a solve resolves; on a long one no double does.
TEST(WeightSearch, LoopsAreKeptWhereQuadsNeedThem) {
    for (const double w : kept(strip(240, {5, 13, 227, 235}))) EXPECT_EQ(w, 1);
    double least = 1;
    for (const double w : kept(strip(48, {5, 13, 35, 43}))) least = std::min(least, w);
    EXPECT_EQ(least, 0);
}

} // namespace test_weight_search
