// Files with results.  All throw Failure(EXIT_RESOURCES) when the disk refuses.
#pragma once

#include <string>
#include <vector>

#include "../readers/json.hpp"
#include "library.hpp"
#include "potential.hpp"
#include "read_mesh.hpp"
#include "render.hpp"

namespace cli {

void write_values_csv(const std::string& path, const Foliation& foliation);
void write_values_npy(const std::string& path, const std::vector<double>& values);
void write_report(const std::string& path, const readers::Json& report);
// One loop a line, as --loops reads them.
void write_loops(const std::string& path, const hmf_loop_set& loops, const std::vector<double>& weights);
// One report for each component; NULL: it has none.  Of several components each line says which.
void write_history(const std::string& path, const std::vector<const hmf_report*>& reports);
void write_png(const std::string& path, const Image& image, const hmf_control* control);
// digits: of a coordinate; 17 give the same bits again.
void write_mesh_obj(const std::string& path, const TriangleMesh& mesh, int digits = 9);

} // namespace cli
