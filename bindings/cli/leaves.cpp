#include "leaves.hpp"

#include <algorithm>
#include <cstdio>

#include "output.hpp"

namespace cli {

namespace {

void print(std::FILE* file, const hmf_lines& l, const char* cylinder_group, uint32_t first_cylinder, uint64_t& before) {
    for (uint64_t p = 0; p < 3 * l.point_count; p += 3)
        std::fprintf(file, "v %.17g %.17g %.17g\n", l.points[p], l.points[p + 1], l.points[p + 2]);
    for (uint64_t k = 0; k < l.line_count; ++k) {
        const hmf_line& line = l.lines[k];
        const bool critical = line.kind == HMF_LINE_CRITICAL;
        if (k == 0 || critical != (l.lines[k - 1].kind == HMF_LINE_CRITICAL)
            || (!critical && line.cylinder != l.lines[k - 1].cylinder)) {
            if (critical) std::fprintf(file, "g critical\n");
            else if (line.cylinder == HMF_NONE) std::fprintf(file, "g %s\n", cylinder_group); // with boundary
            else std::fprintf(file, "g %s_%u\n", cylinder_group, first_cylinder + line.cylinder);
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

Leaves trace_leaves(const hmf_foliation* foliation, double spacing, bool conjugate, const hmf_control* control,
                    const std::string& subject) {
    hmf_trace_options options;
    hmf_trace_options_init(&options, sizeof options);
    options.critical = 1;
    options.spacing = spacing;
    const auto trace = [&] {
        return make<hmf_lines>(subject, [&](hmf_lines** out, hmf_error* error) {
            return hmf_trace(foliation, &options, control, out, error);
        });
    };
    Leaves leaves;
    leaves.along = trace();
    if (conjugate) {
        options.critical = 0;
        options.leaves = HMF_LEAVES_CONJUGATE;
        leaves.across = trace();
    }
    return leaves;
}

size_t write_leaves(const std::string& path, const std::vector<Leaves>& components) {
    Output output(path);
    uint64_t before = 0;
    size_t count = 0;
    uint32_t cylinders = 0;
    for (const Leaves& leaves : components) {
        uint32_t own = 0;
        print(output.file(), *leaves.along, "cylinder", cylinders, before);
        if (leaves.across) print(output.file(), *leaves.across, "across", cylinders, before);
        for (uint64_t k = 0; k < leaves.along->line_count; ++k)
            if (const uint32_t cylinder = leaves.along->lines[k].cylinder; cylinder != HMF_NONE)
                own = std::max(own, cylinder + 1);
        cylinders += own;
        count += leaves.along->line_count + (leaves.across ? leaves.across->line_count : 0);
    }
    output.close();
    return count;
}

Owned<hmf_quad_mesh> make_quads(const hmf_foliation* foliation, const hmf_quad_options& options,
                                const hmf_control* control, const std::string& subject) {
    return make<hmf_quad_mesh>(subject, [&](hmf_quad_mesh** out, hmf_error* error) {
        return hmf_quads(foliation, &options, control, out, error);
    });
}

} // namespace cli
