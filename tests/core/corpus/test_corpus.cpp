// Real meshes: every one that is small enough.  The folder is in HMF_MESHES;
// HMF_CORPUS_MAX_VERTICES (default 60000) bounds the size.  Whitehead moves
// with three ratios on meshes below 20000 vertices, else with 0.5 only unless
// HMF_CORPUS_ALL_RATIOS is set; Newton's method with its defaults.
#include "support/read_obj.hpp"
#include "support/surface.hpp"
#include "support/unique.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace test_corpus {

using namespace test;

namespace {

std::string folder() {
    const char* name = std::getenv("HMF_MESHES");
    return name ? name : "";
}

size_t max_vertices() {
    const char* text = std::getenv("HMF_CORPUS_MAX_VERTICES");
    return text ? static_cast<size_t>(std::strtoull(text, nullptr, 10)) : 60000;
}

bool all_ratios() { return std::getenv("HMF_CORPUS_ALL_RATIOS") != nullptr; }

// Sorted names; one name that does not exist if there is no folder.
std::vector<std::string> mesh_names() {
    std::vector<std::string> names;
    std::error_code failure;
    if (!folder().empty())
        for (const auto& entry : std::filesystem::directory_iterator(folder(), failure))
            if (entry.path().extension() == ".obj") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    if (names.empty()) names.push_back("missing");
    return names;
}

class Corpus : public testing::TestWithParam<std::string> {};

} // namespace

TEST_P(Corpus, IsSolved) {
    const std::string path = folder() + "/" + GetParam() + ".obj";
    const size_t vertices = count_obj_vertices(path);
    if (GetParam() == "missing") GTEST_SKIP() << "skipped: set HMF_MESHES to a folder of OBJ meshes";
    ASSERT_GT(vertices, 0u) << "cannot read " << path;
    if (vertices > max_vertices())
        GTEST_SKIP() << "skipped: " << vertices << " vertices, HMF_CORPUS_MAX_VERTICES is " << max_vertices();
    TriMesh mesh;
    ASSERT_TRUE(read_obj(path, mesh));
    const bool everything = all_ratios() || vertices < 20000;
    for (const double ratio : {0.25, 0.5, 0.75}) {
        if (ratio != 0.5 && !everything) continue;
        SCOPED_TRACE(testing::Message() << GetParam() << " ratio " << ratio);
        const Hierarchy hierarchy(mesh, ratio);
        ASSERT_TRUE(hierarchy);
        const LevelMesh level = read_level(hierarchy, 0);
        EXPECT_EQ(level.raised_count, 0u);
        for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_NEWTON}) {
            if (method == HMF_METHOD_NEWTON && ratio != 0.5) continue;
            SCOPED_TRACE(testing::Message() << "method " << method);
            hmf_solve_options options = solve_options(method, 0);
            // Newton's method has to arrive; the moves are slow and may be cut short.
            if (method == HMF_METHOD_WHITEHEAD) options.time_limit = 1;
            const Solution solution = solve(hierarchy, nullptr, options);
            std::printf("%s ratio %.2f method %d status %d residual %.1e seconds %.1f\n", GetParam().c_str(), ratio,
                        method, solution.status, solution.report.residual_max, solution.report.solve_seconds);
            std::fflush(stdout);
            if (method == HMF_METHOD_NEWTON) {
                EXPECT_EQ(solution.status, HMF_OK) << solution.error.message;
                EXPECT_LE(solution.report.residual_max, 1e-8);
            } else {
                EXPECT_LT(solution.status, HMF_CANCELLED) << solution.error.message;
            }
            if (solution.status >= HMF_ERROR_NULL) continue;
            EXPECT_EQ(solution.report.poles, 0u);
            EXPECT_EQ(solution.report.index_sum, 4 - 4 * static_cast<long>(mesh.genus));
            EXPECT_EQ(solution.report.bad_flips_left, 0u);
            expect_foliation(level, solution.foliation);
            // Large zero clusters (dead limbs) may cut off the rest of the regular vertices.
            const std::string defect = class_defect(level, solution.values, 1);
            EXPECT_TRUE(defect.empty() || defect.compare(0, 5, "only ") == 0) << defect;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Meshes, Corpus, testing::ValuesIn(mesh_names()),
                         [](const testing::TestParamInfo<std::string>& info) {
                             std::string name = info.param;
                             std::replace_if(
                                 name.begin(), name.end(),
                                 [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
                             return name;
                         });

// The strongest check, on some meshes that are small and rich.
class CorpusUnique : public testing::TestWithParam<const char*> {};

TEST_P(CorpusUnique, AcrossHierarchies) {
    TriMesh mesh;
    const std::string path = folder() + "/" + GetParam() + ".obj";
    if (folder().empty() || count_obj_vertices(path) == 0) GTEST_SKIP() << "skipped: no " << path;
    ASSERT_TRUE(read_obj(path, mesh));
    UniqueOptions options;
    if (!all_ratios()) {
        options.ratios = {0.3, 0.7};
        // To 1e-10 the moves take minutes on larger meshes.
        options.paper = mesh.vertex_count() < 6000;
        options.coarsest = {500, 2000};
    }
    expect_unique(mesh, options);
}

INSTANTIATE_TEST_SUITE_P(Meshes, CorpusUnique,
                         testing::Values("fertility_9.0k", "five-torus_6.4k", "eight_11k", "sf129110_10k",
                                         "heptoroid_36k"),
                         [](const testing::TestParamInfo<const char*>& info) {
                             std::string name = info.param;
                             std::replace_if(
                                 name.begin(), name.end(),
                                 [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
                             return name;
                         });

} // namespace test_corpus
