#include "write_results.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>

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
        const bool triangles = loops.element_kind == HMF_LOOP_TRIANGLES;
        const int arc = loops.arcs ? loops.arcs[c] : 0;
        if (arc > 1 && triangles) std::fprintf(output.file(), "\nat%d%d:", (arc >> 1 & 3) - 1, (arc >> 3 & 3) - 1);
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

void write_png(const std::string& path, const Image& image) {
    const std::string bytes = png_of(image);
    Output output(path);
    std::fwrite(bytes.data(), 1, bytes.size(), output.file());
    output.close();
}

void write_textured_obj(const std::string& path, const Foliation& foliation, const double* uv, double period) {
    const std::string material = with_extension(path, ".mtl"), texture = with_extension(path, ".png");
    Image tile;
    tile.width = tile.height = 256;
    for (unsigned y = 0; y < tile.height; ++y)
        for (unsigned x = 0; x < tile.width; ++x) {
            // Squares with thin lines; even in both directions, as the transitions ask.
            const bool dark = (x < 64 || x >= 192) != (y < 64 || y >= 192);
            const bool line = x % 64 == 0 || y % 64 == 0 || x % 64 == 63 || y % 64 == 63;
            for (const unsigned c :
                 dark ? std::array<unsigned, 3>{190, 40, 48} : std::array<unsigned, 3>{246, 243, 236})
                tile.rgb.push_back(static_cast<uint8_t>(line ? c * 3 / 4 : c));
        }
    write_png(texture, tile);
    {
        Output output(material);
        std::fprintf(output.file(), "newmtl checkerboard\nKd 1 1 1\nmap_Kd %s\n",
                     std::filesystem::path(texture).filename().string().c_str());
        output.close();
    }
    Output output(path);
    std::FILE* file = output.file();
    std::fprintf(file, "# vt = (u, v) / %.17g\nmtllib %s\n", period,
                 std::filesystem::path(material).filename().string().c_str());
    for (size_t v = 0; v < foliation.positions.size() / 3; ++v)
        std::fprintf(file, "v %.9g %.9g %.9g\n", foliation.positions[3 * v], foliation.positions[3 * v + 1],
                     foliation.positions[3 * v + 2]);
    // One vt for all corners of a vertex with the same (u, v): a list per vertex.
    constexpr uint32_t none = 0xffffffffu;
    std::vector<uint32_t> head(foliation.positions.size() / 3, none), next, corner_of,
        number(foliation.triangles.size());
    for (size_t k = 0; k < foliation.triangles.size(); ++k) {
        uint32_t& first = head[foliation.triangles[k]];
        uint32_t at = first;
        while (at != none && (uv[2 * corner_of[at]] != uv[2 * k] || uv[2 * corner_of[at] + 1] != uv[2 * k + 1]))
            at = next[at];
        if (at == none) {
            at = static_cast<uint32_t>(corner_of.size());
            corner_of.push_back(static_cast<uint32_t>(k));
            next.push_back(first);
            first = at;
            std::fprintf(file, "vt %.9g %.9g\n", uv[2 * k] / period, uv[2 * k + 1] / period);
        }
        number[k] = at + 1;
    }
    std::fprintf(file, "usemtl checkerboard\n");
    for (size_t t = 0; t < foliation.triangle_count(); ++t) {
        std::fputc('f', file);
        for (size_t k = 3 * t; k < 3 * t + 3; ++k) std::fprintf(file, " %u/%u", foliation.triangles[k] + 1, number[k]);
        std::fputc('\n', file);
    }
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
