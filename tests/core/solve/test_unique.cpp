// Uniqueness of the minimum on meshes of genus 2 to 10: the strongest check of
// restriction, interpolation and class, for each of them may change neither
// the class nor the minimum.  The same on real meshes: test_corpus.cpp.
#include "support/unique.hpp"

#include <gtest/gtest.h>

namespace test_unique {

using namespace test;

namespace {

// A plate of a x b holes, pulled out of symmetry so that no minimum is degenerate.
TriMesh holes(size_t a, size_t b, size_t refinements, size_t smoothings) {
    const auto cuts = [](size_t n) {
        std::vector<double> x(2 * n + 2);
        for (size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i) + 0.03 * static_cast<double>(i * i % 7);
        return x;
    };
    TriMesh mesh =
        voxel_surface(cuts(a), cuts(b), {0, 0.8}, [](size_t i, size_t j, size_t) { return i % 2 == 0 || j % 2 == 0; });
    mesh.genus = a * b;
    for (size_t i = 0; i < refinements; ++i) mesh = subdivide(mesh);
    return smooth(mesh, smoothings);
}

} // namespace

// Quick ones, for every build.
TEST(Unique, Genus4) { expect_unique(holes(2, 2, 2, 2)); }
TEST(Unique, Genus6Flipped) { expect_unique(with_random_flips(holes(3, 2, 2, 4), 20000, 0.8, 17)); }
TEST(Unique, Genus9) { expect_unique(holes(3, 3, 2, 3)); }
TEST(Unique, Genus10) { expect_unique(holes(5, 2, 2, 4)); }
TEST(Unique, Genus2Flipped) {
    for (const uint64_t seed : {1, 2, 3}) {
        SCOPED_TRACE(seed);
        expect_unique(with_random_flips(holes(2, 1, 2, 4), 5000, 0.7, seed));
    }
}

// Stretched across its holes a pretzel has long limbs that no loop goes around.
// The values there decay below the error of a linear solve.
TEST(Unique, DeadLimbs) {
    UniqueOptions options;
    options.ratios = {0.5, 0.3, 0.7};
    options.coarsest = {300};
    options.paper = false; // creeps on such triangles
    for (const double stretch : {501.187, 1000.0}) {
        SCOPED_TRACE(stretch);
        expect_unique(transformed(pretzel(4, 2), {1, 0, 0, 0, stretch, 0, 0, 0, 1}), options);
    }
}

// Finer ones: test.sh leaves UniqueLong to the release build.
TEST(UniqueLong, Genus2) { expect_unique(holes(2, 1, 3, 4)); }
TEST(UniqueLong, Genus2Sharp) { expect_unique(holes(2, 1, 3, 0)); }
TEST(UniqueLong, Genus3) { expect_unique(holes(3, 1, 3, 4)); }
TEST(UniqueLong, Genus5BadTriangles) { expect_unique(with_bad_triangles(holes(5, 1, 2, 4), 60, 0.05, 9)); }
TEST(UniqueLong, Genus2Fine) {
    UniqueOptions options;
    options.ratios = {0.3, 0.6};
    options.coarsest = {500};
    options.paper = false;
    expect_unique(holes(2, 1, 4, 4), options);
}

} // namespace test_unique
