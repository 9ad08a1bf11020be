// Files with results.  All throw Failure(EXIT_RESOURCES) when the disk refuses.
#pragma once

#include <string>
#include <vector>

#include "../../include/hmf/hmf.h"
#include "parameterize.hpp"
#include "potential.hpp"
#include "read_mesh.hpp"
#include "render.hpp"

namespace cli {

// What --report holds.
struct Summary {
    size_t vertices = 0, edges = 0, triangles = 0, genus = 0, marked = 0, loops = 0;
    std::string method;
    double build_seconds = 0, loops_seconds = 0, total_seconds = 0;
    uint64_t peak_memory_bytes = 0;
    size_t leaves = 0, quads = 0;        // lines and quads written, 0 where not wanted
    std::vector<hmf_cylinder> cylinders; // with the leaves
    hmf_report report{};
    std::vector<hmf_level_report> levels;
    bool parameterized = false;
    hmf_parameterization parameterization{};
};

void write_values_csv(const std::string& path, const Foliation& foliation);
void write_values_npy(const std::string& path, const std::vector<double>& values);
void write_report(const std::string& path, const Summary& summary);
void write_history(const std::string& path, const std::vector<hmf_history_entry>& history);
void write_png(const std::string& path, const Image& image);
// The mesh with texture coordinates (u, v) / period, FILE.mtl and FILE.png (one
// tile of a checkerboard) beside it.
void write_textured_obj(const std::string& path, const Foliation& foliation, const Parameterization& parameterization,
                        double period);
// The names that write_textured_obj uses.
std::string with_extension(const std::string& path, const char* extension);
void write_mesh_obj(const std::string& path, const TriangleMesh& mesh);

} // namespace cli
