#include "map_judge.hpp"

#include <algorithm>
#include <cmath>

namespace test {

namespace {

// Of the nearest multiple.
double off_multiple(double x, double of) { return std::fabs(x - of * std::floor(x / of + 0.5)); }

// |du| of each edge.  Both of its sides are where its transition says, to the last bits of the largest coordinate.
std::string read_edges(const LevelMesh& mesh, const hmf_parameterization& map, std::vector<double>& du) {
    std::vector<size_t> first(mesh.edge_count, SIZE_MAX);
    du.assign(mesh.edge_count, 0);
    const auto after = [](size_t c) { return c - c % 3 + (c + 1) % 3; };
    double largest = 0;
    for (size_t i = 0; i < 6 * mesh.triangle_count; ++i) largest = std::max(largest, std::fabs(map.corner_uv[i]));
    const double rounding = std::ldexp(largest, -50);
    for (size_t c = 0; c < 3 * mesh.triangle_count; ++c) {
        const size_t e = mesh.triangle_edges[c];
        const double length = std::fabs(map.corner_uv[2 * c] - map.corner_uv[2 * after(c)]);
        if (first[e] == SIZE_MAX) {
            first[e] = c;
            du[e] = length;
            continue;
        }
        const double* const g = map.transition + 3 * e;
        const size_t ends[2][2] = {{first[e], after(c)}, {after(first[e]), c}};
        for (const auto& end : ends)
            for (size_t x = 0; x < 2; ++x)
                if (std::fabs(g[0] * map.corner_uv[2 * end[0] + x] + g[1 + x] - map.corner_uv[2 * end[1] + x])
                    > rounding)
                    return "transition of edge " + std::to_string(e);
        if (std::fabs(length - du[e]) > rounding) return "|du| of edge " + std::to_string(e);
    }
    return "";
}

} // namespace

MapJudgment judge_map(const LevelMesh& mesh, const Foliation& foliation, const Loops& loops,
                      const hmf_parameterization& map) {
    MapJudgment judged;
    std::vector<double> du;
    const std::vector<double> values = values_of(foliation);
    const double step = std::min(1.0, std::ldexp(hmf_foliation_unit(foliation.get()), 52));
    judged.defect = read_edges(mesh, map, du);
    for (size_t t = 0; t < mesh.triangle_count; ++t) {
        const double* const p = map.corner_uv + 6 * t;
        const double twice = (p[2] - p[0]) * (p[5] - p[1]) - (p[4] - p[0]) * (p[3] - p[1]);
        judged.area += 0.5 * twice;
        judged.absolute_area += 0.5 * std::fabs(twice);
    }
    for (size_t v = 0; v < mesh.vertex_count; ++v) {
        judged.turns += 2 - map.cone[v];
        judged.odd += map.cone[v] % 2 != 0;
    }
    const auto is_odd = [&](size_t c) { return map.cone[mesh.triangle_vertices[c]] % 2 != 0; };
    size_t start = 0;
    while (start < 3 * mesh.triangle_count && !is_odd(start)) ++start;
    const double height = start < 3 * mesh.triangle_count ? map.corner_uv[2 * start] : 0;
    for (size_t c = 0; c < 3 * mesh.triangle_count; ++c)
        if (is_odd(c))
            judged.off_lattice = std::max(judged.off_lattice, off_multiple(map.corner_uv[2 * c] - height, step));
    for (size_t e = 0; e < mesh.edge_count; ++e) {
        const double* const g = map.transition + 3 * e;
        if (start < 3 * mesh.triangle_count || g[0] > 0)
            judged.off_lattice = std::max(judged.off_lattice, off_multiple(g[1] - (1 - g[0]) * height, step));
    }
    for (size_t c = 0; c < loops.count(); ++c) {
        double by_map = 0, by_values = 0;
        for (const uint32_t e : crossed_edges(mesh, loops, c)) {
            by_map += du[e];
            by_values += values[e];
        }
        judged.least_share = std::min(judged.least_share, by_map / by_values);
        judged.largest_share = std::max(judged.largest_share, by_map / by_values);
    }
    return judged;
}

} // namespace test
