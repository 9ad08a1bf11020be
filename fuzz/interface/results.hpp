// What holds for each result, whatever it was made from.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "host.hpp"

namespace fuzz {

// Refused with a reason, or cone angles that add up.
inline void expect_parameterization(const hmf_hierarchy* h, const hmf_foliation* f, bool memory_is_short) {
    const auto map =
        result_of<hmf_parameterization>({HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ERROR_UNSUPPORTED}, memory_is_short,
                                        [&](auto out) { return hmf_parameterize(f, nullptr, nullptr, out, nullptr); });
    if (!map) return;
    for (size_t i = 0; i < 6 * map->triangle_count; ++i) FUZZ_ASSERT(std::isfinite(map->corner_uv[i]));
    int64_t sum = 0;
    for (size_t v = 0; v < map->vertex_count; ++v) sum += 2 - map->cone[v];
    // A marked pole has an angle of pi.  With boundary half of the double is counted.
    FUZZ_ASSERT(hmf_hierarchy_describe(h)->boundary_count > 0
                || sum == 4 - 4 * static_cast<int64_t>(hmf_hierarchy_describe(h)->genus));
}

inline void expect_charts(const hmf_foliation* f, bool memory_is_short) {
    const auto atlas = result_of<hmf_chart_set>({HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ERROR_UNSUPPORTED}, memory_is_short,
                                                [&](auto out) { return hmf_atlas(f, nullptr, nullptr, out, nullptr); });
    for (size_t t = 0; atlas && t < atlas->triangle_count; ++t) {
        FUZZ_ASSERT(atlas->triangle_chart[t] < atlas->chart_count);
        for (size_t i = 6 * t; i < 6 * t + 6; ++i) FUZZ_ASSERT(atlas->corner_uv[i] >= 0 && atlas->corner_uv[i] <= 1);
    }
}

// Leaves close or join zeros, a quad mesh is closed and has the right genus.
inline void expect_leaves(const hmf_hierarchy* h, const hmf_foliation* f, double largest, bool memory_is_short) {
    hmf_trace_options options = sized<hmf_trace_options>();
    options.critical = 1;
    options.spacing = largest;
    const auto traced = [&](auto out) { return hmf_trace(f, &options, nullptr, out, nullptr); };
    if (const auto leaves = result_of<hmf_lines>({}, memory_is_short, traced))
        for (size_t i = 0; i < leaves->line_count; ++i) {
            const hmf_line& line = leaves->lines[i];
            if (hmf_hierarchy_describe(h)->boundary_count > 0) continue; // leaves end there
            FUZZ_ASSERT(line.kind == HMF_LINE_CRITICAL ? line.begin == HMF_END_ZERO && line.end == HMF_END_ZERO
                                                       : line.closed == 1);
        }
    options.leaves = HMF_LEAVES_CONJUGATE;
    result_of<hmf_lines>({HMF_ERROR_VALUE_NOT_HARMONIC, HMF_ERROR_UNSUPPORTED, HMF_ERROR_OPTIONS}, memory_is_short,
                         traced);
    // With boundary cylinders are told apart by their loops, which are not given here.
    result_of<hmf_cylinder_set>(
        {HMF_ERROR_VALUE_NOT_HARMONIC,
         hmf_hierarchy_describe(h)->boundary_count > 0 ? HMF_ERROR_UNSUPPORTED : HMF_ERROR_VALUE_NOT_HARMONIC},
        memory_is_short, [&](auto out) { return hmf_cylinders(f, nullptr, nullptr, out, nullptr); });

    if (charts_now) expect_charts(f, memory_is_short);
    const auto mesh = result_of<hmf_quad_mesh>(
        {HMF_ERROR_QUADS, HMF_ERROR_UNSUPPORTED, HMF_ERROR_OPTIONS, HMF_ERROR_VALUE_NOT_HARMONIC}, memory_is_short,
        [&](auto out) { return hmf_quads(f, nullptr, nullptr, out, nullptr); });
    if (!mesh) return;
    for (size_t i = 0; i < 3 * mesh->vertex_count; ++i) FUZZ_ASSERT(std::isfinite(mesh->positions[i]));
    std::vector<std::pair<uint32_t, uint32_t>> sides;
    for (size_t q = 0; q < mesh->quad_count; ++q)
        for (size_t s = 0; s < 4; ++s) sides.push_back({mesh->quads[4 * q + s], mesh->quads[4 * q + (s + 1) % 4]});
    std::sort(sides.begin(), sides.end());
    int64_t outer = 0; // sides on the boundary
    for (size_t i = 0; i < sides.size(); ++i) {
        FUZZ_ASSERT(sides[i].first < mesh->vertex_count && (i == 0 || sides[i] != sides[i - 1]));
        outer += !std::binary_search(sides.begin(), sides.end(), std::make_pair(sides[i].second, sides[i].first));
    }
    FUZZ_ASSERT(outer == 0 || hmf_hierarchy_describe(h)->boundary_count > 0);
    const int64_t edges = (static_cast<int64_t>(sides.size()) + outer) / 2;
    FUZZ_ASSERT(static_cast<int64_t>(mesh->vertex_count) - edges + static_cast<int64_t>(mesh->quad_count)
                == 2 - 2 * static_cast<int64_t>(hmf_hierarchy_describe(h)->genus)
                       - static_cast<int64_t>(hmf_hierarchy_describe(h)->boundary_count));
}

inline void expect_closed(const hmf_hierarchy* h, const hmf_foliation* f, bool memory_is_short) {
    const auto mesh = level_of(h, hmf_foliation_level(f), memory_is_short);
    if (!mesh) return;
    size_t count = 0;
    const double* const values = hmf_foliation_values(f, &count);
    FUZZ_ASSERT(count == mesh->edge_count);
    const uint32_t* const side = mesh->triangle_edges;
    for (size_t t = 0; t < mesh->triangle_count; ++t)
        for (size_t s = 0; s < 3; ++s)
            FUZZ_ASSERT(values[side[3 * t + s]] >= 0
                        && values[side[3 * t + s]]
                               <= values[side[3 * t + (s + 1) % 3]] + values[side[3 * t + (s + 2) % 3]]);
}

// No pole but at marked vertices.
inline void expect_singularities(const hmf_hierarchy* h, const hmf_foliation* f, bool memory_is_short) {
    const auto set = result_of<hmf_singularity_set>(
        {}, memory_is_short, [&](auto out) { return hmf_singularities(f, nullptr, out, nullptr); });
    if (!set) return;
    int64_t sum = 0;
    for (size_t i = 0; i < set->count; ++i) {
        FUZZ_ASSERT(set->list[i].index < 0 || (set->list[i].index == 0 && marks_now > 0));
        for (const double x : set->list[i].position) FUZZ_ASSERT(std::isfinite(x));
        sum += set->list[i].index;
    }
    FUZZ_ASSERT(has_index_sum(h, sum));
}

// Exact triangle inequalities, no pole, 4 - 4 g; the values, read again, are
// the same foliation.
inline void expect_foliation(const hmf_hierarchy* h, const hmf_foliation* f, bool memory_is_short) {
    expect_closed(h, f, memory_is_short);
    expect_singularities(h, f, memory_is_short);
    const size_t level = hmf_foliation_level(f);
    size_t count = 0;
    const double* const values = hmf_foliation_values(f, &count);
    if (const auto read = result_of<hmf_foliation>({}, memory_is_short, [&](auto out) {
            return hmf_foliation_from_values(h, level, values, count, nullptr, out, nullptr);
        }))
        FUZZ_ASSERT(std::equal(values, values + count, hmf_foliation_values(read.get(), nullptr)));
    expect_parameterization(h, f, memory_is_short);
    expect_leaves(h, f, *std::max_element(values, values + count), memory_is_short);
}

// Everything that a level tells; corners and edges fit together.
inline void expect_level(const hmf_hierarchy* h, size_t level, bool memory_is_short) {
    hmf_level_mesh* made = nullptr;
    meter_now->begin_call();
    const hmf_status status = hmf_level(h, level, nullptr, &made, nullptr);
    const Owned<hmf_level_mesh> mesh(made);
    FUZZ_ASSERT((status == HMF_ERROR_LEVEL) == (level >= hmf_hierarchy_describe(h)->level_count));
    FUZZ_ASSERT((made != nullptr) == (status == HMF_OK));
    FUZZ_ASSERT(status == HMF_OK || status == HMF_ERROR_LEVEL || (memory_is_short && status / 100 == 2));
    if (!made) return;
    const hmf_level_info& info = hmf_hierarchy_describe(h)->levels[level];
    FUZZ_ASSERT(made->vertex_count == info.vertex_count && made->edge_count == info.edge_count
                && made->triangle_count == info.triangle_count);
    const uint32_t *const ends = made->edge_vertices, *const edges = made->triangle_edges;
    const uint32_t* const corners = made->triangle_vertices;
    for (size_t c = 0; c < 3 * info.triangle_count; ++c) {
        const uint32_t a = corners[c], b = corners[c - c % 3 + (c + 1) % 3], e = edges[c];
        FUZZ_ASSERT(a < info.vertex_count && e < info.edge_count);
        FUZZ_ASSERT((ends[2 * e] == a && ends[2 * e + 1] == b) || (ends[2 * e] == b && ends[2 * e + 1] == a));
    }
    for (size_t e = 0; e < info.edge_count; ++e)
        FUZZ_ASSERT(std::isfinite(made->weights[e]) && (level == 0 || made->weights[e] > 0));
    for (size_t i = 0; i < 3 * info.vertex_count; ++i) FUZZ_ASSERT(std::isfinite(made->positions[i]));
}

// On a coarse level the energy is the sum of weight * value^2; residuals are shares.
inline void expect_measures(const hmf_hierarchy* h, const hmf_foliation* f, bool memory_is_short) {
    double energy = -1;
    meter_now->begin_call();
    if (hmf_energy(f, nullptr, &energy, nullptr) != HMF_OK) {
        FUZZ_ASSERT(memory_is_short && energy == -1);
        return;
    }
    const size_t level = hmf_foliation_level(f);
    const auto mesh = level_of(h, level, memory_is_short);
    if (mesh && level > 0) {
        const double* const values = hmf_foliation_values(f, nullptr);
        const double share = hmf_hierarchy_describe(h)->boundary_count > 0 ? 0.5 : 1; // of the double
        double sum = 0;
        for (size_t e = 0; e < mesh->edge_count; ++e) sum += share * mesh->weights[e] * values[e] * values[e];
        FUZZ_ASSERT(std::abs(sum - energy) <= 1e-9 * sum);
    }
    const auto residuals = result_of<hmf_residual_set>(
        {}, memory_is_short, [&](auto out) { return hmf_residuals(f, nullptr, out, nullptr); });
    for (size_t v = 0; residuals && v < residuals->vertex_count; ++v)
        FUZZ_ASSERT(residuals->values[v] >= 0 && residuals->values[v] <= 1 + 1e-9);
}

// A call that gives a foliation even where it stops early.
template <class Call>
inline Owned<hmf_foliation> foliation_of(const hmf_hierarchy* h, const Stop& stop, bool memory_is_short, Call&& call) {
    hmf_foliation* made = nullptr;
    hmf_error error{};
    meter_now->begin_call();
    const hmf_status status = call(&made, &error);
    Owned<hmf_foliation> f(made);
    expect_status(status, error, {0, 1, memory_is_short ? 2 : 1});
    FUZZ_ASSERT(status != HMF_CANCELLED || stop.at > 0);
    FUZZ_ASSERT(status == HMF_CANCELLED || (made != nullptr) == (status < HMF_CANCELLED || status == HMF_LIMIT_CLASS));
    if (!f) return f;
    const hmf_report* report = hmf_foliation_report(made);
    FUZZ_ASSERT(report && report->poles == 0 && report->bad_flips_left == 0);
    // Sweeps may end by the energy; a stopped call may have arrived all the same.
    const bool has_arrived = status == HMF_OK && report->method == HMF_METHOD_NEWTON;
    FUZZ_ASSERT(report->converged ? report->residual_max >= 0 : !has_arrived);
    FUZZ_ASSERT(report->class_state != HMF_CLASS_LOST);
    expect_closed(h, made, memory_is_short);
    expect_singularities(h, made, memory_is_short);
    return f;
}

} // namespace fuzz
