#include "write_results.hpp"

#include <png.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "failure.hpp"
#include "output.hpp"

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

void write_report(const std::string& path, const Summary& summary) {
    const hmf_report& r = summary.report;
    nlohmann::ordered_json levels = nlohmann::ordered_json::array();
    for (const hmf_level_report& level : summary.levels)
        levels.push_back({{"vertices", level.vertices},
                          {"edges", level.edges},
                          {"nld", level.nld},
                          {"iterations", level.iterations},
                          {"linear_solves", level.linear_solves},
                          {"optimize_seconds", level.optimize_seconds},
                          {"interpolate_seconds", level.interpolate_seconds}});
    nlohmann::ordered_json report = {{"mesh",
                                      {{"vertices", summary.vertices},
                                       {"edges", summary.edges},
                                       {"triangles", summary.triangles},
                                       {"genus", summary.genus},
                                       {"marked", summary.marked}}},
                                     {"method", summary.method},
                                     {"levels", levels},
                                     {"loops", summary.loops},
                                     {"build_seconds", summary.build_seconds},
                                     {"loops_seconds", summary.loops_seconds},
                                     {"solve_seconds", r.solve_seconds},
                                     {"total_seconds", summary.total_seconds},
                                     {"energy", r.energy},
                                     {"residual_max", r.residual_max},
                                     {"residual_mean", r.residual_mean},
                                     {"poles", r.poles},
                                     {"zeros", r.zeros},
                                     {"index_sum", r.index_sum},
                                     {"bad_flips", r.bad_flips},
                                     {"bad_flips_left", r.bad_flips_left},
                                     {"converged", r.converged != 0},
                                     {"peak_memory_bytes", summary.peak_memory_bytes}};
    if (summary.parameterized) {
        const hmf_parameterization& p = summary.parameterization;
        report["dilatation_mean"] = p.dilatation_mean;
        report["dilatation_median"] = p.dilatation_median;
        // Not finite where more than a hundredth of the area is degenerate.
        report["dilatation_p99"] =
            std::isfinite(p.dilatation_p99) ? nlohmann::ordered_json(p.dilatation_p99) : nlohmann::ordered_json();
        report["flipped_triangles"] = p.flipped_triangles;
        report["degenerate_triangles"] = p.degenerate_triangles;
        report["seam_edges"] = p.seam_edge_count;
        report["seam_length"] = p.seam_length;
        report["parameterize_seconds"] = p.seconds;
    }
    if (summary.leaves > 0) {
        report["leaves"] = summary.leaves;
        report["cylinders"] = nlohmann::ordered_json::array();
        for (const hmf_cylinder& c : summary.cylinders)
            report["cylinders"].push_back({{"loop", c.loop},
                                           {"height", c.height},
                                           {"circumference", c.circumference},
                                           {"modulus", c.modulus},
                                           {"area", c.area}});
    }
    if (summary.quads > 0) report["quads"] = summary.quads;
    const std::string text = report.dump(2) + "\n";
    Output output(path);
    std::fwrite(text.data(), 1, text.size(), output.file());
    output.close();
}

void write_history(const std::string& path, const std::vector<hmf_history_entry>& history) {
    static const char* const kinds[] = {"interpolation", "sweep", "linear_solve"};
    Output output(path);
    std::fprintf(output.file(), "seconds,energy,residual_max,level,kind\n");
    for (const hmf_history_entry& entry : history) {
        std::fprintf(output.file(), "%.9g,%.17g,", entry.seconds, entry.energy);
        // An empty field where it was not evaluated.
        if (entry.residual_max >= 0) std::fprintf(output.file(), "%.9g", entry.residual_max);
        std::fprintf(output.file(), ",%u,%s\n", entry.level, entry.kind < 3 ? kinds[entry.kind] : "other");
    }
    output.close();
}

void write_png(const std::string& path, const Image& image) {
    png_image png;
    std::memset(&png, 0, sizeof png);
    png.version = PNG_IMAGE_VERSION;
    png.width = image.width;
    png.height = image.height;
    png.format = PNG_FORMAT_RGB;
    Output output(path);
    if (!png_image_write_to_stdio(&png, output.file(), 0, image.rgb.data(), 0, nullptr))
        throw Failure(EXIT_RESOURCES, path + ": " + png.message);
    output.close();
}

std::string with_extension(const std::string& path, const char* extension) {
    return std::filesystem::path(path).replace_extension(extension).string();
}

void write_textured_obj(const std::string& path, const Foliation& foliation, const Parameterization& parameterization,
                        double period) {
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
    const std::vector<double>& uv = parameterization.corner_uv;
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

void write_mesh_obj(const std::string& path, const TriangleMesh& mesh) {
    Output output(path);
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        std::fprintf(output.file(), "v %.9g %.9g %.9g\n", mesh.positions[3 * v], mesh.positions[3 * v + 1],
                     mesh.positions[3 * v + 2]);
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        std::fprintf(output.file(), "f %u %u %u\n", mesh.triangles[3 * t] + 1, mesh.triangles[3 * t + 1] + 1,
                     mesh.triangles[3 * t + 2] + 1);
    output.close();
}

} // namespace cli
