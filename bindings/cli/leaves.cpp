#include "leaves.hpp"

#include <algorithm>
#include <cstdio>

#include "failure.hpp"
#include "output.hpp"

namespace cli {

namespace {

struct Lines {
    std::vector<hmf_line> lines;
    std::vector<uint64_t> offsets;
    std::vector<double> points;
};

Lines trace(const hmf_hierarchy* hierarchy, const Foliation& foliation, const hmf_trace_options& options,
            const std::string& mesh_name) {
    Lines l;
    size_t line_count = 0, point_count = 0;
    hmf_error error{};
    // First the counts, then the lines.
    for (int round = 0; round < 2; ++round) {
        const hmf_status status = hmf_trace(
            hierarchy, 0, foliation.values.data(), foliation.values.size(), &options, round ? l.lines.data() : nullptr,
            l.lines.size(), round ? l.offsets.data() : nullptr, l.offsets.size(), round ? l.points.data() : nullptr,
            nullptr, l.points.size() / 3, &line_count, &point_count, &error);
        if (status != HMF_OK) fail_with(status, error, mesh_name);
        l.lines.resize(line_count);
        l.offsets.resize(line_count + 1);
        l.points.resize(3 * point_count);
    }
    return l;
}

void print(std::FILE* file, const Lines& l, const char* cylinder_group, uint64_t& before) {
    for (size_t p = 0; p < l.points.size(); p += 3)
        std::fprintf(file, "v %.9g %.9g %.9g\n", l.points[p], l.points[p + 1], l.points[p + 2]);
    for (size_t k = 0; k < l.lines.size(); ++k) {
        const hmf_line& line = l.lines[k];
        const bool critical = line.kind == HMF_LINE_CRITICAL;
        if (k == 0 || critical != (l.lines[k - 1].kind == HMF_LINE_CRITICAL)
            || (!critical && line.cylinder != l.lines[k - 1].cylinder)) {
            if (critical) std::fprintf(file, "g critical\n");
            else std::fprintf(file, "g %s_%u\n", cylinder_group, line.cylinder);
        }
        if (l.offsets[k + 1] - l.offsets[k] < 2) continue;
        std::fputc('l', file);
        for (uint64_t p = l.offsets[k]; p < l.offsets[k + 1]; ++p)
            std::fprintf(file, " %llu", static_cast<unsigned long long>(before + p + 1));
        if (line.closed) std::fprintf(file, " %llu", static_cast<unsigned long long>(before + l.offsets[k] + 1));
        std::fputc('\n', file);
    }
    before += l.points.size() / 3;
}

} // namespace

size_t write_leaves(const std::string& path, const hmf_hierarchy* hierarchy, const Foliation& foliation, double spacing,
                    bool conjugate, const std::string& mesh_name) {
    hmf_trace_options options;
    hmf_trace_options_init(&options);
    options.critical = 1;
    options.spacing =
        spacing > 0 ? spacing : 0.1 * *std::min_element(foliation.loop_weights.begin(), foliation.loop_weights.end());
    const Lines leaves = trace(hierarchy, foliation, options, mesh_name);
    Lines across;
    if (conjugate) {
        options.critical = 0;
        options.leaves = HMF_LEAVES_CONJUGATE;
        across = trace(hierarchy, foliation, options, mesh_name);
    }
    Output output(path);
    uint64_t before = 0;
    print(output.file(), leaves, "cylinder", before);
    print(output.file(), across, "across", before);
    output.close();
    return leaves.lines.size() + across.lines.size();
}

std::vector<hmf_cylinder> find_cylinders(const hmf_hierarchy* hierarchy, const Foliation& foliation,
                                         const hmf_loop_set& loops, const std::string& mesh_name) {
    std::vector<hmf_cylinder> list(loops.count);
    size_t count = 0, triangles = 0;
    hmf_error error{};
    const hmf_status status =
        hmf_cylinders(hierarchy, 0, foliation.values.data(), foliation.values.size(), &loops, list.data(), list.size(),
                      nullptr, 0, nullptr, 0, &count, &triangles, &error);
    if (status != HMF_OK) fail_with(status, error, mesh_name);
    return list;
}

size_t write_quads(const std::string& path, const hmf_hierarchy* hierarchy, const Foliation& foliation, double size,
                   const std::string& mesh_name) {
    hmf_quad_options options;
    hmf_quad_options_init(&options);
    options.edge_length = size;
    std::vector<double> positions;
    std::vector<uint32_t> quads;
    size_t vertex_count = 0, quad_count = 0;
    hmf_error error{};
    for (int round = 0; round < 2; ++round) {
        const hmf_status status =
            hmf_quads(hierarchy, 0, foliation.values.data(), foliation.values.size(), &options,
                      round ? positions.data() : nullptr, positions.size() / 3, round ? quads.data() : nullptr,
                      quads.size() / 4, &vertex_count, &quad_count, &error);
        if (status != HMF_OK) fail_with(status, error, mesh_name);
        positions.resize(3 * vertex_count);
        quads.resize(4 * quad_count);
    }
    Output output(path);
    for (size_t v = 0; v < vertex_count; ++v)
        std::fprintf(output.file(), "v %.9g %.9g %.9g\n", positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
    for (size_t q = 0; q < quad_count; ++q)
        std::fprintf(output.file(), "f %u %u %u %u\n", quads[4 * q] + 1, quads[4 * q + 1] + 1, quads[4 * q + 2] + 1,
                     quads[4 * q + 3] + 1);
    output.close();
    return quad_count;
}

} // namespace cli
