// What one does with a foliation, with options made of bytes.
#pragma once

#include "loops.hpp"
#include "results.hpp"

namespace fuzz {

// Leaves through points, of both kinds.
inline void leaves_through_points(Bytes& bytes, const hmf_hierarchy* h, const hmf_foliation* f, bool memory_is_short) {
    const hmf_level_info& info = hmf_hierarchy_describe(h)->levels[hmf_foliation_level(f)];
    std::vector<uint32_t> triangles;
    std::vector<double> barycentrics;
    for (uint32_t i = 1 + bytes.below(4); i > 0; --i) {
        const uint32_t a = bytes.byte(), b = bytes.byte(), all = 256;
        triangles.push_back((bytes.byte() * 7u + bytes.byte()) % static_cast<uint32_t>(info.triangle_count));
        for (const uint32_t x : {a % 128, b % 128, all - a % 128 - b % 128}) barycentrics.push_back(x / 256.0);
    }
    if (bytes.rarely()) triangles[0] += static_cast<uint32_t>(info.triangle_count);
    if (bytes.rarely()) barycentrics[0] = coordinate(bytes);
    hmf_trace_options options = sized<hmf_trace_options>();
    options.point_count = triangles.size();
    options.point_triangles = triangles.data();
    options.point_barycentrics = barycentrics.data();
    options.leaves = static_cast<int32_t>(bytes.below(3));
    if (bytes.rarely()) options.length_limit = std::abs(coordinate(bytes));
    const auto lines =
        result_of<hmf_lines>({HMF_ERROR_OPTIONS, HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ERROR_UNSUPPORTED}, memory_is_short,
                             [&](auto out) { return hmf_trace(f, &options, nullptr, out, nullptr); });
    if (!lines) return;
    const bool cut = hmf_hierarchy_describe(h)->boundary_count > 0; // a leaf can give several lines
    FUZZ_ASSERT(cut || lines->line_count == triangles.size());
    for (size_t i = 0; i < lines->line_count; ++i) {
        const hmf_line& line = lines->lines[i];
        FUZZ_ASSERT(line.kind == HMF_LINE_POINT && (cut ? line.source < triangles.size() : line.source == i));
        FUZZ_ASSERT((line.closed == 1) == (line.begin == HMF_END_CLOSED) && line.length >= 0);
        FUZZ_ASSERT(line.begin != HMF_END_NOWHERE || lines->offsets[i] == lines->offsets[i + 1]);
    }
    for (size_t i = 0; i < 3 * lines->point_count; ++i) FUZZ_ASSERT(std::isfinite(lines->points[i]));
}

// Each loop has one cylinder, as high as its weight.
inline void cylinders_of_loops(const hmf_foliation* f, const LoopArrays& loops, bool memory_is_short) {
    hmf_error error{};
    hmf_cylinder_set* made = nullptr;
    meter_now->begin_call();
    const hmf_status status = hmf_cylinders(f, &loops.set, nullptr, &made, &error);
    const Owned<hmf_cylinder_set> set(made);
    expect_status(status, error, {1, 4, 5, memory_is_short ? 2 : 1});
    FUZZ_ASSERT((made != nullptr) == (status == HMF_OK));
    std::vector<uint8_t> taken(static_cast<size_t>(loops.set.count), 0);
    for (size_t i = 0; made && i < made->count; ++i) {
        const hmf_cylinder& c = made->list[i];
        FUZZ_ASSERT(c.loop < taken.size() && !taken[c.loop]++ && c.circumference > 0);
        const double weight = loops.set.weights ? loops.set.weights[c.loop] : 1;
        FUZZ_ASSERT(std::abs(c.height - weight) <= 1e-12 * weight);
    }
}

inline void quads_to_order(Bytes& bytes, const hmf_foliation* f, bool memory_is_short) {
    hmf_quad_options options = sized<hmf_quad_options>();
    options.edge_length = 0.3 + bytes.below(16) / 8.0;
    result_of<hmf_quad_mesh>({HMF_ERROR_QUADS, HMF_ERROR_UNSUPPORTED, HMF_ERROR_OPTIONS, HMF_ERROR_VALUE_NOT_HARMONIC},
                             memory_is_short, [&](auto out) { return hmf_quads(f, &options, nullptr, out, nullptr); });
}

inline void seams_to_order(Bytes& bytes, const hmf_foliation* f, bool memory_is_short) {
    hmf_parameterize_options options = sized<hmf_parameterize_options>();
    std::vector<uint32_t> edges;
    for (uint32_t i = bytes.below(16); i > 0; --i) edges.push_back(bytes.byte());
    options.seam_edges = edges.data();
    options.seam_edge_count = edges.size();
    if (bytes.rarely()) options.tolerance = coordinate(bytes);
    result_of<hmf_parameterization>(
        {HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ERROR_UNSUPPORTED, HMF_ERROR_OPTIONS, HMF_ERROR_NULL}, memory_is_short,
        [&](auto out) { return hmf_parameterize(f, &options, nullptr, out, nullptr); });
}

inline void any_use(Bytes& bytes, const hmf_hierarchy* h, const hmf_foliation* f, const LoopArrays& loops,
                    bool memory_is_short) {
    switch (bytes.below(4)) {
    case 0: return leaves_through_points(bytes, h, f, memory_is_short);
    case 1: return cylinders_of_loops(f, loops, memory_is_short);
    case 2: return quads_to_order(bytes, f, memory_is_short);
    default: return seams_to_order(bytes, f, memory_is_short);
    }
}

} // namespace fuzz
