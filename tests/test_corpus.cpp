// Real meshes: every one that is small enough, with three ratios.  The folder
// is in HMF_MESHES; HMF_CORPUS_MAX_VERTICES (default 60000) bounds the size.
#include "support/read_obj.hpp"
#include "support/surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

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
    if (vertices > max_vertices()) GTEST_SKIP() << "skipped: " << vertices << " vertices, HMF_CORPUS_MAX_VERTICES is " << max_vertices();
    TriMesh mesh;
    ASSERT_TRUE(read_obj(path, mesh));
    for (const double ratio : {0.25, 0.5, 0.75}) {
        SCOPED_TRACE(testing::Message() << GetParam() << " ratio " << ratio);
        const Hierarchy hierarchy(mesh, ratio);
        ASSERT_TRUE(hierarchy);
        const LevelMesh level = read_level(hierarchy, 0);
        EXPECT_EQ(level.non_delaunay_count, 0u);
        hmf_solve_options options = solve_options(HMF_METHOD_WHITEHEAD, 1e-6);
        options.time_limit = 2;
        for (const int32_t method : {HMF_METHOD_WHITEHEAD, HMF_METHOD_NEWTON}) {
            if (method == HMF_METHOD_NEWTON && ratio != 0.5) continue;
            SCOPED_TRACE(testing::Message() << "method " << method);
            options.method = method;
            options.tolerance = method == HMF_METHOD_NEWTON ? 0 : 1e-6;
            const Solution solution = solve(hierarchy, nullptr, options);
            if (solution.status == HMF_ERROR_UNSUPPORTED) continue;
            EXPECT_LT(solution.status, HMF_CANCELLED) << solution.error.message;
            if (solution.status >= HMF_ERROR_NULL) continue;
            EXPECT_EQ(solution.report.poles, 0u);
            EXPECT_EQ(solution.report.index_sum, 4 - 4 * static_cast<long>(mesh.genus));
            EXPECT_EQ(solution.report.bad_flips_left, 0u);
            expect_foliation(hierarchy, level, solution.values);
            // Large zero clusters (dead limbs) may cut off the rest of the regular vertices.
            const std::string defect = class_defect(level, solution.values, 1);
            EXPECT_TRUE(defect.empty() || defect.compare(0, 5, "only ") == 0) << defect;
            RecordProperty(("status_" + std::to_string(method) + "_" + std::to_string(static_cast<int>(100 * ratio))).c_str(), solution.status);
            std::printf("%s ratio %.2f method %d status %d residual %.1e %s\n", GetParam().c_str(), ratio, method, solution.status, solution.report.residual_max, defect.c_str());
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Meshes, Corpus, testing::ValuesIn(mesh_names()), [](const testing::TestParamInfo<std::string>& info) {
    std::string name = info.param;
    std::replace_if(name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
    return name;
});
