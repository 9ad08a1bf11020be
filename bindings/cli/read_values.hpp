// Values of a foliation from a file that --values has written.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cli {

// NPY, or one line per edge, "vertex,vertex,value", in the order of edge_vertices (2
// per edge).  Throws Failure with the line where the file differs.
std::vector<double> read_values(const std::string& path, const std::vector<uint32_t>& edge_vertices);

} // namespace cli
