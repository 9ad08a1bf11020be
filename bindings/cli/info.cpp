#include "info.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "../readers/json.hpp"
#include "library.hpp"
#include "marks.hpp"
#include "progress.hpp"
#include "read_mesh.hpp"

namespace cli {

void info(const std::string& path, bool json) {
    const TriangleMesh mesh = read_mesh(path);
    const std::string mesh_name = shown(path);
    Progress progress;
    hmf_build_options options = {};
    options.struct_size = sizeof options;
    // Validation only: one level.
    options.coarsest = mesh.vertex_count();
    hmf_status status = HMF_OK;
    hmf_error error{};
    hmf_mark_set* raw_marks = nullptr;
    if (may_be_sphere(mesh))
        status = hmf_suggest_marks(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(),
                                   mesh.triangle_count(), &options, progress.part("check", 0, 0.5), &raw_marks, &error);
    const Owned<hmf_mark_set> set(raw_marks);
    const std::vector<uint32_t> marks(set ? set->vertices : nullptr, set ? set->vertices + set->count : nullptr);
    options.marked_vertices = marks.data();
    options.marked_count = marks.size();
    hmf_hierarchy* raw = nullptr;
    if (status == HMF_OK)
        status = hmf_build(mesh.positions.data(), mesh.vertex_count(), mesh.triangles.data(), mesh.triangle_count(),
                           &options, progress.part("check", 0.5, 1), &raw, &error);
    const Owned<hmf_hierarchy> hierarchy(raw);
    progress.clear();
    if (status != HMF_OK) {
        if (json && status >= 300 && status < 400) {
            const readers::Json refused = {{"mesh", mesh_name},        {"valid", false},
                                           {"status", status},         {"text", hmf_status_string(status)},
                                           {"message", error.message}, {"index", error.index}};
            std::printf("%s\n", refused.dump(2).c_str());
        }
        fail_with(status, error, mesh_name);
    }

    hmf_level_info counts{};
    check(hmf_level_counts(hierarchy.get(), 0, &counts, &error), error, mesh_name);
    std::vector<double> weights(counts.edge_count);
    check(hmf_level_weights(hierarchy.get(), 0, weights.data(), weights.size(), &error), error, mesh_name);
    const auto negative = std::count_if(weights.begin(), weights.end(), [](double w) { return w < 0; });
    double low[3] = {}, high[3] = {}, area = 0, least_angle = 180, largest_angle = 0, edge_sum = 0;
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        for (size_t a = 0; a < 3; ++a) {
            const double x = mesh.positions[3 * v + a];
            low[a] = v ? std::min(low[a], x) : x;
            high[a] = v ? std::max(high[a], x) : x;
        }
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        double square[3];
        for (size_t s = 0; s < 3; ++s) {
            square[s] = 0;
            for (size_t a = 0; a < 3; ++a) {
                const double d = mesh.positions[3 * size_t(mesh.triangles[3 * t + s]) + a]
                               - mesh.positions[3 * size_t(mesh.triangles[3 * t + (s + 1) % 3]) + a];
                square[s] += d * d;
            }
            edge_sum += std::sqrt(square[s]);
        }
        const double p = square[0], q = square[1], r = square[2];
        const double twice = 0.5 * std::sqrt(std::max(0.0, 4 * p * q - (p + q - r) * (p + q - r)));
        area += twice / 2;
        for (size_t s = 0; s < 3; ++s) {
            const double cosine_side = (square[s] + square[(s + 1) % 3] - square[(s + 2) % 3]) / 2;
            const double angle = std::atan2(twice, cosine_side) * 57.29577951308232;
            least_angle = std::min(least_angle, angle);
            largest_angle = std::max(largest_angle, angle);
        }
    }
    const double mean_edge = edge_sum / double(3 * mesh.triangle_count());
    const size_t genus = hmf_genus(hierarchy.get());
    const uint64_t memory = hmf_memory_estimate(mesh.vertex_count(), mesh.triangle_count(), nullptr);
    if (json) {
        const readers::Json report = {{"mesh", mesh_name},
                                      {"valid", true},
                                      {"vertices", counts.vertex_count},
                                      {"edges", counts.edge_count},
                                      {"triangles", counts.triangle_count},
                                      {"genus", genus},
                                      {"suggested_marks", marks},
                                      {"non_delaunay_edges", negative},
                                      {"min_angle", least_angle},
                                      {"max_angle", largest_angle},
                                      {"mean_edge_length", mean_edge},
                                      {"area", area},
                                      {"box_low", std::vector<double>(low, low + 3)},
                                      {"box_high", std::vector<double>(high, high + 3)},
                                      {"memory_estimate_bytes", memory}};
        std::printf("%s\n", report.dump(2).c_str());
        return;
    }
    std::printf("%s: closed oriented manifold, genus %zu\n", mesh_name.c_str(), genus);
    if (genus == 0)
        std::printf("  to mark        %zu vertices, two at each of %zu tips; hmf solve marks them unless it is told "
                    "others\n",
                    marks.size(), marks.size() / 2);
    std::printf("  vertices       %llu\n", static_cast<unsigned long long>(counts.vertex_count));
    std::printf("  edges          %llu\n", static_cast<unsigned long long>(counts.edge_count));
    std::printf("  triangles      %llu\n", static_cast<unsigned long long>(counts.triangle_count));
    std::printf("  not Delaunay   %lld edges (%.2f %%)\n", static_cast<long long>(negative),
                100.0 * double(negative) / double(counts.edge_count));
    std::printf("  angles         %.3f to %.3f degrees\n", least_angle, largest_angle);
    std::printf("  mean edge      %.6g\n", mean_edge);
    std::printf("  area           %.6g\n", area);
    std::printf("  box            %.6g %.6g %.6g  to  %.6g %.6g %.6g\n", low[0], low[1], low[2], high[0], high[1],
                high[2]);
    std::printf("  memory to build, at most %.1f MB\n", double(memory) / 1e6);
}

} // namespace cli
