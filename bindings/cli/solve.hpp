// hmf solve: its options and its outputs.
#pragma once

#include <hmf/applications.h>

#include <string>
#include <vector>

#include "failure.hpp"
#include "options.hpp"
#include "prepare_mesh.hpp"

namespace cli {

constexpr int32_t LOOPS_EVEN = -1; // beside HMF_LOOPS_*

struct SolveRequest {
    std::string mesh;
    std::string loops = "cut";   // cut, handle, tunnel, pants, even, or a file
    std::string through;         // picked points of loops instead; empty: none
    std::vector<double> weights; // of the loops; empty: all 1
    std::string marks = "auto";  // auto, none, or a file
    std::string start;           // values to start from instead of loops; empty: none
    int32_t method = HMF_METHOD_DEFAULT;
    int32_t collapse = HMF_COLLAPSE_MIDPOINT;
    MeshRequest prepare; // the mesh, before all else
    double ratio = 0.5, mollify = 0, tolerance = 0, time_limit = 0;
    uint64_t coarsest = 0;
    uint64_t refine = 0;  // the mesh, to so many triangles
    uint64_t threads = 0; // 0: one for each processor
    // Outputs; empty: not wanted.
    std::vector<std::string> values;
    std::string report, history, image, leaves, quads, obj, textured, atlas, save_loops, save_mesh, save_marks;
    double spacing = 0, size = 0;  // of leaves, of quads
    uint64_t count = 0, relax = 0; // of quads: how many instead of their size; steps of relaxation
    bool merges = false;           // quads: short critical leaves
    bool no_poles = false;         // no marks of the library
    bool conjugate = false;        // leaves across as well
    int32_t pattern = 0;           // of the picture: a Pattern
    std::string camera = "auto", image_size = "1400x1050";
    double period = 0; // of stripes and squares; 0: chosen
    bool legend = false;
    bool conformality = false; // in the report

    // How an error names a loop of the caller: a line of the file, or its number.
    std::string name_of_loop(size_t line) const;
};

Options solve_options(SolveRequest& request);
Options quads_options(SolveRequest& request);
// Of both.
Option loops_option(SolveRequest& request);
Option through_option(SolveRequest& request);
Option weights_option(SolveRequest& request);
Option marks_option(SolveRequest& request);
Option mollify_option(SolveRequest& request);
Option threads_option(SolveRequest& request);
Option camera_option(SolveRequest& request);
Option image_size_option(SolveRequest& request);
Option legend_option(SolveRequest& request);

// What a run has to say; all outputs are written.
struct Outcome {
    ExitStatus exit_status = EXIT_SOLVED;
    std::string summary;             // one line, and one of the vertices that were marked
    bool uses_stdout = false;        // for an output
    std::vector<std::string> notes;  // a sentence each: components without a result
    std::vector<std::string> errors; // a sentence each: the limit that ended it, outputs that could not be made
};

// Throws Failure where there is no result.
Outcome solve(const std::vector<std::string>& words);
Outcome quads(const std::vector<std::string>& words);

// hmf_version as text.
std::string version_text();

} // namespace cli
