// The table of the options of hmf quads, which runs as hmf solve does.
#include "render.hpp"
#include "solve.hpp"

namespace cli {

Options quads_options(SolveRequest& r) {
    r.loops = "even";
    r.count = 5000;
    r.relax = 40;
    r.merges = true;
    r.refine = 2000;
    r.pattern = static_cast<int32_t>(Pattern::quads);
    Options options = {
        Option{"MESH", &r.mesh, "", MESH_FILES}.reads(""),
        Option{"OUT", &r.quads, "", "quad mesh, .obj .ply .off, or .glb (two triangles for each quad)"}.writes(
            ".obj .ply .off .glb"),
        Option{"--count", &r.count, "N", "target number of quads"}.in("[1, 268435456]"),
        Option{"--relax", &r.relax, "N", "rounds that move vertices on the surface; 0: vertices stay on their leaves"}
            .in("[0, 1000]"),
        Option{"--no-poles", &r.no_poles, "", "mark no vertices: limbs that no loop goes around are lost"}.without(
            "--marks"),
        loops_option(r),
        through_option(r),
        weights_option(r),
        marks_option(r),
        mollify_option(r),
        Option{"--refine", &r.refine, "N",
               "cut a mesh of fewer triangles at its longest edges into N; the surface stays as it is; 0: do not cut;\n"
               "not with --loops FILE"}
            .in("[0, 1000000]"),
        threads_option(r),
        Option{"--image", &r.image, "FILE.png", "picture of the quads, with irregular vertices and loops"}.writes(
            ".png"),
        camera_option(r),
        image_size_option(r),
        legend_option(r),
        Option{"--report", &r.report, "FILE.json", "numbers of the run"}.writes(".json"),
        Option{"--save-loops", &r.save_loops, "FILE", "the loops on this mesh, as --loops reads them"}.writes(""),
        Option{"--save-marks", &r.save_marks, "FILE", "the marked vertices, as --marks reads them"}.writes(""),
        Option{"--save-mesh", &r.save_mesh, "FILE.obj",
               "the mesh that was solved, after repairs; loops and marks refer to it"}
            .writes(".obj"),
    };
    for (const Option& o : mesh_options(r.prepare)) options.push_back(o);
    return options;
}

} // namespace cli
