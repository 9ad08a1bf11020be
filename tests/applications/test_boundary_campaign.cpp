// Random holes cut into surfaces, real ones if a folder is given, each with 1 to 50
// holes: solved with the loops of the library, then quads and parameterized.
//
//     HMF_HOLES               number of cases, default 6, a sample (3 under sanitizers); ./test.sh campaign runs 500
//     HMF_HOLES_SEED          of the first case, default 0; case k cuts mesh k of the sorted list
//     HMF_HOLES_MAX_VERTICES  larger meshes are left out, default 2000; 300 000 in the campaign
//     HMF_MESHES, HMF_SURFACES   folders of OBJ meshes; surfaces from formulas without one
//
// A line is printed for each case that is not perfect, and a table at the end.
#include "support/boundary.hpp"
#include "support/read_obj.hpp"
#include "support/sample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace test_boundary_campaign {

using namespace test;

namespace {

uint64_t number(const char* name, uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

std::vector<std::string> real_meshes() {
    std::vector<std::string> paths;
    const uint64_t most = number("HMF_HOLES_MAX_VERTICES", 2000);
    for (const char* name : {"HMF_MESHES", "HMF_SURFACES"}) {
        std::error_code failure;
        if (const char* folder = std::getenv(name))
            for (const auto& entry : std::filesystem::directory_iterator(folder, failure))
                if (entry.path().extension() == ".obj" && count_obj_vertices(entry.path().string()) <= most)
                    paths.push_back(entry.path().string());
    }
    std::sort(paths.begin(), paths.end());
    return paths;
}

TriMesh from_formula(uint64_t k) {
    switch (k % 3) {
    case 0: return pretzel(2, 2);
    case 1: return torus(48, 24, 3, 1, {true, 1, 0.3, k + 1});
    default: return torus_with_finger(24, 16, 12, 6);
    }
}

struct Tally {
    size_t cases = 0, unlucky = 0, converged = 0, proven = 0, holes = 0, most_holes = 0, triangles = 0;
    size_t quads = 0, quads_refused = 0, inverted_quads = 0, with_inverted = 0, maps = 0, flipped = 0;
    double worst = 0;
};

// Holes may meet or leave a disk: then fewer.
bool cut_holes(const TriMesh& whole, uint64_t k, TriMesh& mesh) {
    for (uint64_t tries = 0; tries < 8; ++tries) {
        mesh = with_holes(whole, std::max(size_t{1 + k * 7 % 50} >> tries, size_t{1}), 1 + k % 3, 8 * k + tries);
        hmf_hierarchy* h = nullptr;
        const hmf_status status =
            hmf_hierarchy_create(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                 mesh.triangle_count(), nullptr, nullptr, &h, nullptr);
        if (h) mesh.genus = hmf_hierarchy_describe(h)->genus;
        hmf_hierarchy_destroy(h);
        if (status == HMF_OK) return true;
    }
    return false;
}

void check_quads(const TriMesh& mesh, const Solution& s, bool merge, Tally& tally) {
    // Relaxed or not, their boundary lies on that of the surface.
    Owned<hmf_quad_mesh> quads;
    for (const uint64_t relax : {0, 40}) {
        hmf_quad_mesh* raw = nullptr;
        hmf_error error{};
        const hmf_quad_options options = quad_options(2000, merge, relax);
        const hmf_status status = hmf_quads(s.foliation.get(), &options, nullptr, &raw, &error);
        quads.reset(raw);
        if (status == HMF_ERROR_QUADS || status == HMF_ERROR_UNSUPPORTED) {
            ++tally.quads_refused;
            std::printf("%s\n", error.message);
            return;
        }
        ASSERT_EQ(status, HMF_OK) << error.message;
        expect_quads_conform(mesh, *quads, int64_t(mesh.genus));
    }
    ++tally.quads;
    tally.inverted_quads += quads->inverted_count;
    tally.with_inverted += quads->inverted_count > 0;
    if (quads->inverted_count > 0)
        std::printf("%zu of %zu quads are inverted\n", size_t(quads->inverted_count), size_t(quads->quad_count));
}

void check_map(const Solution& s, Tally& tally) {
    const auto uv = make<hmf_parameterization>([&](hmf_parameterization** out, hmf_error* error) {
        return hmf_parameterize(s.foliation.get(), nullptr, nullptr, out, error);
    });
    ASSERT_TRUE(uv);
    ++tally.maps;
    tally.flipped += uv->flipped_count;
    for (uint64_t i = 0; i < 6 * uv->triangle_count; ++i) ASSERT_TRUE(std::isfinite(uv->corner_uv[i]));
    EXPECT_NEAR(uv->area / s.report.energy, 1, 0.1);
}

void run_case(const TriMesh& mesh, uint64_t k, Tally& tally) {
    const int64_t boundaries = boundary_count(mesh);
    tally.holes += size_t(boundaries);
    tally.most_holes = std::max(tally.most_holes, size_t(boundaries));
    tally.triangles += mesh.triangle_count();
    const Hierarchy hierarchy(mesh);
    ASSERT_TRUE(hierarchy);
    const auto set = loops_of(hierarchy, k % 2 ? HMF_LOOPS_PANTS : HMF_LOOPS_CUT);
    ASSERT_TRUE(set);
    const Solution s = solve(hierarchy, *set);
    ASSERT_TRUE(s.foliation) << s.error.message;
    tally.converged += s.status == HMF_OK;
    tally.proven += s.report.class_state == HMF_CLASS_PROVEN;
    tally.worst = std::max(tally.worst, s.report.residual_max);
    EXPECT_EQ(s.report.class_state, HMF_CLASS_PROVEN);
    expect_result(hierarchy, s, boundaries);
    check_quads(mesh, s, k % 4 > 1, tally);
    check_map(s, tally);
}

} // namespace

TEST(BoundaryCampaign, HolesInSurfaces) {
    const std::vector<std::string> paths = real_meshes();
    const uint64_t cases = number("HMF_HOLES", sample(6, 2)), seed = number("HMF_HOLES_SEED", 0);
    Tally tally;
    for (uint64_t k = seed; k < seed + cases; ++k) {
        const std::string path = paths.empty() ? "formula" : paths[k % paths.size()];
        SCOPED_TRACE(testing::Message() << path << " case " << k);
        TriMesh whole = paths.empty() ? from_formula(k) : TriMesh(), mesh;
        if (!paths.empty()) ASSERT_TRUE(read_obj(path, whole));
        ++tally.cases;
        if (!cut_holes(whole, k, mesh)) { // no surface in one piece before, or a sphere
            ++tally.unlucky;
            continue;
        }
        std::printf("case %zu: %s, %zu triangles, %zu holes\n", size_t(k), path.c_str(), mesh.triangle_count(),
                    size_t(boundary_count(mesh)));
        std::fflush(stdout);
        run_case(mesh, k, tally);
    }
    std::printf("%zu cases, %zu left out (pieces, spheres): %zu converged, %zu proven, worst residual %.1e\n"
                "%zu holes, at most %zu; %zu triangles; quads %zu, refused %zu, with inverted ones %zu (%zu quads);\n"
                "maps %zu, flipped triangles %zu\n",
                tally.cases, tally.unlucky, tally.converged, tally.proven, tally.worst, tally.holes, tally.most_holes,
                tally.triangles, tally.quads, tally.quads_refused, tally.with_inverted, tally.inverted_quads,
                tally.maps, tally.flipped);
    EXPECT_EQ(tally.converged, tally.cases - tally.unlucky);
    EXPECT_GE(2 * tally.converged, tally.cases);
}

} // namespace test_boundary_campaign
