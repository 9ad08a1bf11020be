// Elementary moves of pants decompositions, and the components that they are made in.
#include "support/watched_host.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "src/core/base/disjoint_sets.hpp"
#include "src/applications/loops/class_lengths.hpp"
#include "src/applications/loops/dual_length.hpp"
#include "src/applications/loops/elementary_moves.hpp"
#include "src/applications/loops/hole_joins.hpp"
#include "src/applications/loops/loop_search.hpp"
#include "src/applications/loops/pants_component.hpp"

namespace test_elementary_moves {

using namespace test;

namespace {

class Surface {
public:
    explicit Surface(const TriMesh& mesh) :
        hierarchy_(mesh), memory(nullptr, nullptr, nullptr, 0), call(memory, &error, nullptr, nullptr) {}
    const hmf::Mesh& mesh() const { return hierarchy_.get()->input; }
    const double* position() const { return hierarchy_.get()->levels[0].position; }
    // With one coordinate longer.
    std::vector<double> stretched(size_t axis, double factor) const {
        std::vector<double> p(position(), position() + 3 * size_t{mesh().vertex_count});
        for (size_t v = 0; v < mesh().vertex_count; ++v) p[3 * v + axis] *= factor;
        return p;
    }
    // The pants of the library where vertices are there.
    void find(const double* at, hmf::Loops& pants) {
        hmf::ClassLengths lengths(mesh(), at, call);
        ASSERT_EQ(hmf::pants_decomposition(mesh(), at, lengths, call, pants), HMF_OK) << error.message;
    }
    // Of the closed geodesics.
    double total_length(const hmf::Loops& loops) {
        hmf::ClassLengths lengths(mesh(), position(), call);
        double sum = 0;
        for (size_t c = 0; c < loops.count(); ++c) {
            uint32_t id = 0;
            EXPECT_TRUE(lengths.add(loops.loop(c), loops.length(c), id));
            sum += lengths.length(id);
        }
        return sum;
    }

private:
    Hierarchy hierarchy_;

public:
    hmf::Memory memory;
    hmf_error error{};
    hmf::Call call;
};

long euler(const hmf::CutSurface& surface) {
    return static_cast<long>(surface.point_count) + surface.region_count - static_cast<long>(surface.segment_count);
}
// Whether all regions hang together across segments.
bool is_connected(const hmf::CutSurface& surface) {
    std::vector<uint32_t> parent(surface.region_count);
    for (uint32_t r = 0; r < surface.region_count; ++r) parent[r] = r;
    size_t pieces = surface.region_count;
    for (size_t s = 0; s < surface.segment_count; ++s)
        pieces -= hmf::unite(parent.data(), surface.region[2 * s], surface.region[2 * s + 1]);
    return pieces == 1;
}
size_t holes(const hmf::Component& component) {
    return static_cast<size_t>(std::count(component.is_hole.begin(), component.is_hole.end(), uint8_t{1}));
}

} // namespace

// Pants of the stretched surface become those of the surface itself, as short as if they had been searched there.
TEST(ElementaryMoves, FromOtherPantsToTheShortest) {
    double worst = 1;
    for (const size_t handles : {2, 3, 4}) {
        Surface surface(uneven(pretzel(handles, 2)));
        hmf::Loops own;
        surface.find(surface.position(), own);
        const double shortest = surface.total_length(own);
        for (size_t axis = 0; axis < 2; ++axis) // thicker, all the curves lie flat, and no two of them get shorter
            for (const double factor : {0.2, 5.0}) {
                hmf::Loops pants;
                surface.find(surface.stretched(axis, factor).data(), pants);
                ASSERT_EQ(pants.count(), 3 * handles - 3);
                worst = std::max(worst, surface.total_length(pants) / shortest);
                hmf::ClassLengths lengths(surface.mesh(), surface.position(), surface.call);
                ASSERT_EQ(hmf::shorten_by_moves(surface.mesh(), surface.position(), lengths, surface.call, pants),
                          HMF_OK)
                    << surface.error.message;
                ASSERT_EQ(hmf::shorten_loops(surface.mesh(), surface.position(), surface.call, pants), HMF_OK);
                EXPECT_EQ(hmf::check_loops(surface.mesh(), pants, surface.call), HMF_OK) << surface.error.message;
                EXPECT_LT(surface.total_length(pants), 1.01 * shortest) << handles << " " << axis << " " << factor;
            }
    }
    EXPECT_GT(worst, 1.2); // else it would be easy
}

// One curve taken out leaves a sphere with four holes or a torus with one; two that bound pants together a sphere with
// five or a torus with two.  Cut along a cycle that does not separate, a torus is a sphere with two holes more.
TEST(PantsComponents, HaveTheirHolesAndHandles) {
    Surface surface(uneven(pretzel(3, 1)));
    hmf::Loops pants;
    surface.find(surface.position(), pants);
    hmf::PantsComponents components(surface.mesh());
    ASSERT_EQ(components.start(pants, surface.call), HMF_OK);
    EXPECT_EQ(components.pants_count(), 4u);
    const hmf::DualLength dual(surface.mesh(), surface.position());
    hmf::Array<double> length;
    ASSERT_TRUE(length.allocate(surface.memory, surface.mesh().edge_count));
    for (uint32_t e = 0; e < surface.mesh().edge_count; ++e) length[e] = dual(e);
    size_t tori = 0, apart = 0;
    for (uint32_t k = 0; k < pants.count(); ++k)
        for (uint32_t l = k; l < pants.count(); ++l) {
            const uint32_t both[2] = {k, l};
            const size_t taken = k == l ? 1 : 2;
            hmf::Component whole, half;
            ASSERT_TRUE(components.build(both, taken, whole, surface.memory));
            ASSERT_EQ(components.touch(k, l), is_connected(whole.surface)) << k << " " << l;
            if (!components.touch(k, l)) {
                ++apart;
                continue;
            }
            const long chi = euler(whole.surface);
            ASSERT_TRUE(chi == 2 || chi == 0);
            EXPECT_EQ(holes(whole), chi == 2 ? 3 + taken : taken);
            for (uint32_t s = 0; s < whole.surface.segment_count; ++s) // its regions have it as well
                for (uint32_t b = 0; b < 2; ++b) {
                    const uint32_t* const links = &whole.surface.link[3 * size_t{whole.surface.region[2 * s + b]}];
                    EXPECT_TRUE(links[0] == 2 * s + b || links[1] == 2 * s + b || links[2] == 2 * s + b);
                }
            if (chi == 2) continue;
            ++tori;
            hmf::Signatures signatures;
            hmf::LoopSearch search(whole.surface, length, nullptr, surface.call);
            ASSERT_TRUE(signatures.build_punctured(whole.surface, whole.is_hole, surface.call));
            ASSERT_TRUE(search.prepare(signatures, 1));
            uint32_t root = 0;
            while (!signatures.of[root]) ++root;
            ASSERT_TRUE(search.search(whole.surface.region[2 * root], HUGE_VAL));
            ASSERT_GT(search.count(), 0u);
            hmf::Array<uint32_t> cycle;
            cycle.start(surface.memory);
            ASSERT_TRUE(search.strip(0, cycle));
            ASSERT_TRUE(whole.cut_along(surface.mesh(), cycle, half, surface.memory));
            EXPECT_EQ(euler(half.surface), 2);
            EXPECT_EQ(holes(half), taken + 2);
            hmf::HoleJoins joins(surface.mesh(), length);
            hmf::Array<hmf::HoleJoins::Join> found;
            ASSERT_TRUE(joins.find(half.surface, half.is_hole, found, surface.call));
            EXPECT_EQ(found.empty(), taken == 1); // three holes are a pair of pants
            for (const hmf::HoleJoins::Join& join : found) EXPECT_NE(join.hole[0], join.hole[1]);
        }
    EXPECT_GT(tori, 0u);
    EXPECT_GT(apart, 0u);
}

// A failed allocation anywhere in the moves is a failure, and nothing is kept.
TEST(ElementaryMoves, AllocationsMayFail) {
    Surface surface(uneven(pretzel(2, 1)));
    hmf::Loops pants;
    surface.find(surface.stretched(0, 5).data(), pants);
    uint64_t all = 0, tried = 0;
    for (uint64_t fail = 0; fail == 0 || fail <= all; fail += fail < 40 ? 1 : 1 + all / 150) {
        WatchedHost watched;
        {
            hmf::Memory memory(WatchedHost::take, WatchedHost::give, &watched, 0);
            hmf_error error{};
            hmf::Call call(memory, &error, nullptr, nullptr);
            hmf::Loops loops;
            ASSERT_TRUE(loops.copy_from(pants, memory));
            hmf::ClassLengths lengths(surface.mesh(), surface.position(), call);
            watched.fail = fail ? watched.calls + fail : 0;
            const uint64_t before = watched.calls;
            const hmf_status status = hmf::shorten_by_moves(surface.mesh(), surface.position(), lengths, call, loops);
            EXPECT_EQ(status, fail ? HMF_ERROR_MEMORY : HMF_OK) << fail;
            if (!fail) all = watched.calls - before;
            tried += fail > 0;
        }
        EXPECT_EQ(watched.used, 0u) << fail;
    }
    EXPECT_GT(tried, 100u);
}

} // namespace test_elementary_moves
