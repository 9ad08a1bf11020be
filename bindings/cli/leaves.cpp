#include "leaves.hpp"

#include <algorithm>
#include <cstdio>

#include "failure.hpp"
#include "output.hpp"

namespace cli {

size_t write_leaves(const std::string& path, const hmf_hierarchy* hierarchy, const Foliation& foliation, double spacing, const std::string& mesh_name) {
    hmf_trace_options options;
    hmf_trace_options_init(&options);
    options.critical = 1;
    options.spacing = spacing > 0 ? spacing : 0.1 * *std::min_element(foliation.loop_weights.begin(), foliation.loop_weights.end());
    std::vector<hmf_line> lines;
    std::vector<uint64_t> offsets(1);
    std::vector<double> points;
    size_t line_count = 0, point_count = 0;
    hmf_error error{};
    // First the counts, then the lines.
    for (int round = 0; round < 2; ++round) {
        const hmf_status status = hmf_trace(hierarchy, 0, foliation.values.data(), foliation.values.size(), &options, round ? lines.data() : nullptr, lines.size(),
                                            round ? offsets.data() : nullptr, offsets.size(), round ? points.data() : nullptr, nullptr, points.size() / 3,
                                            &line_count, &point_count, &error);
        if (status != HMF_OK) fail_with(status, error, mesh_name);
        lines.resize(line_count);
        offsets.resize(line_count + 1);
        points.resize(3 * point_count);
    }
    Output output(path);
    for (size_t p = 0; p < point_count; ++p)
        std::fprintf(output.file(), "v %.9g %.9g %.9g\n", points[3 * p], points[3 * p + 1], points[3 * p + 2]);
    for (size_t k = 0; k < line_count; ++k) {
        const bool critical = lines[k].kind == HMF_LINE_CRITICAL;
        if (k == 0 || critical != (lines[k - 1].kind == HMF_LINE_CRITICAL) || (!critical && lines[k].cylinder != lines[k - 1].cylinder)) {
            if (critical) std::fprintf(output.file(), "g critical\n");
            else std::fprintf(output.file(), "g cylinder_%u\n", lines[k].cylinder);
        }
        if (offsets[k + 1] - offsets[k] < 2) continue;
        std::fputc('l', output.file());
        for (uint64_t p = offsets[k]; p < offsets[k + 1]; ++p) std::fprintf(output.file(), " %llu", static_cast<unsigned long long>(p + 1));
        if (lines[k].closed) std::fprintf(output.file(), " %llu", static_cast<unsigned long long>(offsets[k] + 1));
        std::fputc('\n', output.file());
    }
    output.close();
    return line_count;
}

std::vector<hmf_cylinder> find_cylinders(const hmf_hierarchy* hierarchy, const Foliation& foliation, const hmf_loop_set& loops, const std::string& mesh_name) {
    std::vector<hmf_cylinder> list(loops.count);
    size_t count = 0, triangles = 0;
    hmf_error error{};
    const hmf_status status = hmf_cylinders(hierarchy, 0, foliation.values.data(), foliation.values.size(), &loops, list.data(), list.size(), nullptr, 0, nullptr, 0,
                                            &count, &triangles, &error);
    if (status != HMF_OK) fail_with(status, error, mesh_name);
    return list;
}

size_t write_quads(const std::string& path, const hmf_hierarchy* hierarchy, const Foliation& foliation, double size, const std::string& mesh_name) {
    hmf_quad_options options;
    hmf_quad_options_init(&options);
    options.edge_length = size;
    std::vector<double> positions;
    std::vector<uint32_t> quads;
    size_t vertex_count = 0, quad_count = 0;
    hmf_error error{};
    for (int round = 0; round < 2; ++round) {
        const hmf_status status = hmf_quads(hierarchy, 0, foliation.values.data(), foliation.values.size(), &options, round ? positions.data() : nullptr,
                                            positions.size() / 3, round ? quads.data() : nullptr, quads.size() / 4, &vertex_count, &quad_count, &error);
        if (status != HMF_OK) fail_with(status, error, mesh_name);
        positions.resize(3 * vertex_count);
        quads.resize(4 * quad_count);
    }
    Output output(path);
    for (size_t v = 0; v < vertex_count; ++v)
        std::fprintf(output.file(), "v %.9g %.9g %.9g\n", positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
    for (size_t q = 0; q < quad_count; ++q)
        std::fprintf(output.file(), "f %u %u %u %u\n", quads[4 * q] + 1, quads[4 * q + 1] + 1, quads[4 * q + 2] + 1, quads[4 * q + 3] + 1);
    output.close();
    return quad_count;
}

} // namespace cli
