#include "leaves.hpp"

#include <cstdio>

#include "output.hpp"

namespace cli {

namespace {

void print(std::FILE* file, const hmf_lines& l, const char* cylinder_group, uint64_t& before) {
    for (uint64_t p = 0; p < 3 * l.point_count; p += 3)
        std::fprintf(file, "v %.9g %.9g %.9g\n", l.points[p], l.points[p + 1], l.points[p + 2]);
    for (uint64_t k = 0; k < l.line_count; ++k) {
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
    before += l.point_count;
}

} // namespace

size_t write_leaves(const std::string& path, const hmf_foliation* foliation, double spacing, bool conjugate,
                    const hmf_control* control, const std::string& mesh_name) {
    hmf_trace_options options = {};
    options.struct_size = sizeof options;
    options.critical = 1;
    options.spacing = spacing;
    const auto trace = [&] {
        return make<hmf_lines>(mesh_name, [&](hmf_lines** out, hmf_error* error) {
            return hmf_trace(foliation, &options, control, out, error);
        });
    };
    const Owned<hmf_lines> leaves = trace();
    Owned<hmf_lines> across;
    if (conjugate) {
        options.critical = 0;
        options.leaves = HMF_LEAVES_CONJUGATE;
        across = trace();
    }
    Output output(path);
    uint64_t before = 0;
    print(output.file(), *leaves, "cylinder", before);
    if (across) print(output.file(), *across, "across", before);
    output.close();
    return leaves->line_count + (across ? across->line_count : 0);
}

size_t write_quads(const std::string& path, const hmf_foliation* foliation, double size, const hmf_control* control,
                   const std::string& mesh_name) {
    hmf_quad_options options = {};
    options.struct_size = sizeof options;
    options.edge_length = size;
    const auto mesh = make<hmf_quad_mesh>(mesh_name, [&](hmf_quad_mesh** out, hmf_error* error) {
        return hmf_quads(foliation, &options, control, out, error);
    });
    Output output(path);
    for (uint64_t v = 0; v < 3 * mesh->vertex_count; v += 3)
        std::fprintf(output.file(), "v %.9g %.9g %.9g\n", mesh->positions[v], mesh->positions[v + 1],
                     mesh->positions[v + 2]);
    for (uint64_t q = 0; q < 4 * mesh->quad_count; q += 4)
        std::fprintf(output.file(), "f %u %u %u %u\n", mesh->quads[q] + 1, mesh->quads[q + 1] + 1,
                     mesh->quads[q + 2] + 1, mesh->quads[q + 3] + 1);
    output.close();
    return mesh->quad_count;
}

} // namespace cli
