#include "write_results.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>

#include "failure.hpp"
#include "options.hpp"
#include "output.hpp"
#include "png.hpp"

namespace cli {

void write_values_csv(const std::string& path, const Foliation& foliation) {
    Output output(path);
    for (size_t e = 0; e < foliation.values.size(); ++e)
        std::fprintf(output.file(), "%u,%u,%.17g\n", foliation.edge_vertices[2 * e], foliation.edge_vertices[2 * e + 1],
                     foliation.values[e]);
    output.close();
}

void write_values_npy(const std::string& path, const std::vector<double>& values) {
    // Magic, version 1.0, length of the header, header padded to a multiple of 64.
    std::string header =
        "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(values.size()) + ",), }";
    header.append(63 - (10 + header.size()) % 64, ' ');
    header += '\n';
    std::string bytes("\x93NUMPY\x01\x00", 8);
    bytes += static_cast<char>(header.size() & 0xffu);
    bytes += static_cast<char>(header.size() >> 8);
    bytes += header;
    for (double value : values) {
        uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        for (int shift = 0; shift < 64; shift += 8) bytes += static_cast<char>((bits >> shift) & 0xffu);
    }
    Output output(path);
    std::fwrite(bytes.data(), 1, bytes.size(), output.file());
    output.close();
}

void write_report(const std::string& path, const readers::Json& report) {
    const std::string text = report.dump(2) + "\n";
    Output output(path);
    std::fwrite(text.data(), 1, text.size(), output.file());
    output.close();
}

void write_loops(const std::string& path, const hmf_loop_set& loops, const std::vector<double>& weights) {
    Output output(path);
    std::fprintf(output.file(), "# --weights ");
    for (size_t c = 0; c < weights.size(); ++c) std::fprintf(output.file(), c ? ",%.17g" : "%.17g", weights[c]);
    for (uint64_t c = 0; c < loops.count; ++c) {
        const bool triangles = loops.element_kind == HMF_PATH_TRIANGLES;
        const bool arc = loops.arcs && loops.arcs[c];
        const uint32_t* const sides = arc && triangles && loops.arc_sides ? loops.arc_sides + 2 * c : nullptr;
        if (sides && sides[0] != HMF_NONE && sides[1] != HMF_NONE)
            std::fprintf(output.file(), "\nat%u%u:", sides[0], sides[1]);
        else std::fprintf(output.file(), arc ? triangles ? "\nat:" : "\na:" : triangles ? "\nt:" : "\nv:");
        for (uint64_t i = loops.offsets[c]; i < loops.offsets[c + 1]; ++i)
            std::fprintf(output.file(), " %u", loops.elements[i]);
    }
    std::fputc('\n', output.file());
    output.close();
}

void write_history(const std::string& path, const std::vector<const hmf_report*>& reports) {
    static const char* const kinds[] = {"interpolation", "sweep", "linear_solve"};
    const bool several = reports.size() > 1;
    Output output(path);
    std::fprintf(output.file(), "seconds,energy,residual_max,level,kind%s\n", several ? ",component" : "");
    for (size_t c = 0; c < reports.size(); ++c)
        for (uint64_t k = 0; reports[c] && k < reports[c]->history_count; ++k) {
            const hmf_history_entry& entry = reports[c]->history[k];
            std::fprintf(output.file(), "%.9g,%.17g,", entry.seconds, entry.energy);
            // An empty field where it was not evaluated.
            if (entry.residual_max >= 0) std::fprintf(output.file(), "%.9g", entry.residual_max);
            std::fprintf(output.file(), ",%u,%s", entry.level, entry.kind < 3 ? kinds[entry.kind] : "other");
            if (several) std::fprintf(output.file(), ",%zu", c);
            std::fputc('\n', output.file());
        }
    output.close();
}

void write_png(const std::string& path, const Image& image, const hmf_control* control) {
    const std::string bytes = png_of(image, Workers(control));
    Output output(path);
    std::fwrite(bytes.data(), 1, bytes.size(), output.file());
    output.close();
}

void write_mesh_obj(const std::string& path, const TriangleMesh& mesh, int digits) {
    Output output(path);
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        std::fprintf(output.file(), "v %.*g %.*g %.*g\n", digits, mesh.positions[3 * v], digits,
                     mesh.positions[3 * v + 1], digits, mesh.positions[3 * v + 2]);
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        std::fprintf(output.file(), "f %u %u %u\n", mesh.triangles[3 * t] + 1, mesh.triangles[3 * t + 1] + 1,
                     mesh.triangles[3 * t + 2] + 1);
    output.close();
}

} // namespace cli
