// The commands that call the library.
#pragma once

#include <string>
#include <vector>

#include "../../include/hmf/hmf.h"
#include "read_mesh.hpp"

namespace cli {

struct SolveRequest {
    std::string mesh_name;            // for messages
    std::string loops = "cut";        // cut, handle, tunnel, pants, or a file
    std::vector<double> loop_weights; // empty: all 1
    int32_t method = HMF_METHOD_DEFAULT;
    int32_t collapse = HMF_COLLAPSE_DEFAULT;
    std::string marks = "auto"; // auto, none, or a file
    std::string start;          // values to start from instead of loops; empty: none
    double ratio = 0, mollify = 0, tolerance = 0, time_limit = 0;
    uint64_t coarsest = 0;
    // Outputs; empty: not wanted.
    std::vector<std::string> values;
    std::string report, history, image, leaves, quads, obj;
    double leaf_spacing = 0, quad_size = 0;
    bool conjugate = false;    // leaves across as well
    bool checkerboard = false; // in the picture, instead of stripes
};

// Both print to standard output, and return an exit status or throw Failure.
int solve(const TriangleMesh& mesh, double read_seconds, const SolveRequest& request);
int info(const TriangleMesh& mesh, const std::string& mesh_name, bool json);

} // namespace cli
