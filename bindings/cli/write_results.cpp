#include "write_results.hpp"

#include <png.h>

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
        std::fprintf(output.file(), "%u,%u,%.17g\n", foliation.edge_vertices[2 * e], foliation.edge_vertices[2 * e + 1], foliation.values[e]);
    output.close();
}

void write_values_npy(const std::string& path, const std::vector<double>& values) {
    // Magic, version 1.0, length of the header, header padded to a multiple of 64.
    std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(values.size()) + ",), }";
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
    const nlohmann::ordered_json report = {
        {"mesh", {{"vertices", summary.vertices}, {"edges", summary.edges}, {"triangles", summary.triangles}, {"genus", summary.genus}}},
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
        {"peak_memory_bytes", summary.peak_memory_bytes},
        {"leaves", summary.leaves}};
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

void write_mesh_obj(const std::string& path, const TriangleMesh& mesh) {
    Output output(path);
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        std::fprintf(output.file(), "v %.9g %.9g %.9g\n", mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]);
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        std::fprintf(output.file(), "f %u %u %u\n", mesh.triangles[3 * t] + 1, mesh.triangles[3 * t + 1] + 1, mesh.triangles[3 * t + 2] + 1);
    output.close();
}

} // namespace cli
