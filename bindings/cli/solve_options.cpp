// The table of the options of hmf solve.  A new one is a row here, a field of SolveRequest, and its use.
#include "solve.hpp"

#include "render.hpp"

namespace cli {

Option loops_option(SolveRequest& r) {
    return Option{"--loops", &r.loops, "cut|handle|tunnel|pants|even|FILE",
                  "cut: short loops, one per handle, that cut the surface into one planar piece; on genus 0 loops\n"
                  "around pairs of marked vertices; handle, tunnel: the same, bounding inside or outside the solid;\n"
                  "pants: 3 genus - 3 + marked vertices loops that cut the surface into pairs of pants;\n"
                  "even: loops, weights and marked vertices with a nearly constant scale; or FILE: one loop per\n"
                  "line, vertex indices from 0 (closed edge path), t: and triangle indices, or\n"
                  "a: and the vertices of an arc from boundary to boundary"}
        .reads("");
}

Option through_option(SolveRequest& r) {
    return Option{"--through", &r.through, "\"POINTS\"",
                  "instead of --loops: a loop of shortest edge paths through at least three points, in order, on all\n"
                  "sides of what it goes around; points are vertex indices from 0 or positions X,Y,Z, at most a\n"
                  "tenth of its size away, separated by blanks; \";\" begins another loop"}
        .without("--loops --start");
}

Option weights_option(SolveRequest& r) {
    return Option{"--weights", &r.weights, "W,W,...",
                  "one weight per loop; otherwise those of the FILE of --loops or of even, otherwise 1"}
        .in("(0, inf)");
}

Option marks_option(SolveRequest& r) {
    return Option{"--marks", &r.marks, "auto|none|FILE",
                  "vertices that may be poles, at least four on genus 0; auto: suggested on genus 0, otherwise none;\n"
                  "or FILE: vertex indices from 0"}
        .reads("");
}

Option threads_option(SolveRequest& r) {
    return Option{"--threads", &r.threads, "N", "threads; 0: one per processor; results do not depend on the number"}
        .in("[0, 256]");
}

Option camera_option(SolveRequest& r) {
    return Option{"--camera", &r.camera, "VIEW",
                  "view of the picture: auto (shows as many zeros and loops as possible), front, back, left, right,\n"
                  "top, bottom, corner, a direction X,Y,Z, or a direction and up vector X,Y,Z,UX,UY,UZ"}
        .requires_one_of("--image");
}

Option image_size_option(SolveRequest& r) {
    return Option{"--image-size", &r.image_size, "WxH", "size of the picture in pixels"}.requires_one_of("--image");
}

Option legend_option(SolveRequest& r) {
    return Option{"--legend", &r.legend, "", "explain the colors in the picture"}.requires_one_of("--image");
}

Option mollify_option(SolveRequest& r) {
    return Option{"--mollify", &r.mollify, "X",
                  "accept triangles of zero area by adding a length to all edges, so that each triangle inequality\n"
                  "holds with a margin of X mean edge lengths; 1e-5 is a good value; 0: off"}
        .in("[0, 0.1]");
}

Options solve_options(SolveRequest& r) {
    Options options = {
        Option{"MESH", &r.mesh, "", MESH_FILES}.reads(""),
    };
    for (const Option& o : mesh_options(r.prepare)) options.push_back(o);
    const Options others = {
        loops_option(r),
        through_option(r),
        weights_option(r),
        marks_option(r),
        Option{"--start", &r.start, "FILE.csv|FILE.npy",
               "start from a file of --values instead of loops, and keep its class"}
            .reads(".csv .npy")
            .without("--loops --save-loops"),
        Option{"--method",
               Choice{&r.method,
                      {{"newton", HMF_METHOD_NEWTON},
                       {"whitehead", HMF_METHOD_WHITEHEAD},
                       {"single-level", HMF_METHOD_SINGLE_LEVEL},
                       {"paper", HMF_METHOD_PAPER}}},
               "newton|whitehead|single-level|paper",
               "solver; newton by default; the others are the published methods, for comparison"},
        Option{"--collapse",
               Choice{&r.collapse,
                      {{"midpoint", HMF_COLLAPSE_MIDPOINT},
                       {"endpoint", HMF_COLLAPSE_ENDPOINT},
                       {"qslim", HMF_COLLAPSE_QSLIM}}},
               "midpoint|endpoint|qslim", "edge collapse of the hierarchy"},
        Option{"--ratio", &r.ratio, "X", "number of edges of a level / of the next finer level"}.in("[0.05, 0.95]"),
        Option{"--coarsest", &r.coarsest, "N",
               "vertices of the coarsest level, at least 40 genus + 10 marked; 0: a sixteenth of all, at most 1000"}
            .in("[0, inf)"),
        mollify_option(r),
        Option{"--tolerance", &r.tolerance, "X",
               "largest residual, by default 1e-8; methods other than newton then stop by the energy"}
            .in("(0, 1)"),
        Option{"--time-limit", &r.time_limit, "X", "in seconds; 0: none"}.in("[0, inf)"),
        threads_option(r),
        Option{"--values", &r.values, "FILE",
               "one value per edge: .csv (vertex,vertex,value) or .npy; - is CSV; may be given once for each"}
            .writes(".csv .npy"),
        Option{"--report", &r.report, "FILE.json", "numbers of the run"}.writes(".json"),
        Option{"--conformality", &r.conformality, "", "add the dilatation of the parameterization to the report"}
            .requires_one_of("--report"),
        Option{"--history", &r.history, "FILE.csv", "write energy and residual over time"}.writes(".csv"),
        Option{"--save-loops", &r.save_loops, "FILE", "the loops on this mesh, as --loops reads them"}.writes(""),
        Option{"--save-mesh", &r.save_mesh, "FILE.obj",
               "the mesh that was solved, after repairs; loops, values and all other outputs refer to it"}
            .writes(".obj"),
        Option{"--save-marks", &r.save_marks, "FILE", "the marked vertices, as --marks reads them"}.writes(""),
        Option{"--image", &r.image, "FILE.png",
               "picture: zeros blue, with their order; marked vertices violet, poles yellow, loops green"}
            .writes(".png"),
        Option{"--pattern",
               Choice{&r.pattern,
                      {{"stripes", static_cast<int32_t>(Pattern::stripes)},
                       {"checkerboard", static_cast<int32_t>(Pattern::checkerboard)},
                       {"quads", static_cast<int32_t>(Pattern::quads)},
                       {"dilatation", static_cast<int32_t>(Pattern::dilatation)},
                       {"scale", static_cast<int32_t>(Pattern::scale)}}},
               "stripes|checkerboard|quads|dilatation|scale",
               "pattern of the picture: stripes along the leaves, squares of (u, v), the grid of --quads, the\n"
               "dilatation of (u, v), or the scale: white mean, red narrow stripes, blue wide stripes"}
            .requires_one_of("--image"),
        camera_option(r),
        image_size_option(r),
        Option{"--period", &r.period, "X",
               "width of stripes and squares, in the unit of the weights; each cylinder gets a whole number"}
            .in("(0, inf)")
            .requires_one_of("--image --obj --textured"),
        legend_option(r),
        Option{"--obj", &r.obj, "FILE.obj",
               "mesh with (u, v) per corner as texture coordinates;\n"
               "FILE.mtl and FILE.png (a checkerboard) are written beside it"}
            .writes(".obj", ".mtl .png"),
        Option{"--textured", &r.textured, "FILE",
               "the same in one file: .glb with its texture, or .ply with s, t per vertex, doubled at seams"}
            .writes(".glb .ply"),
        Option{"--atlas", &r.atlas, "FILE",
               "charts without overlap in the unit square, as texture coordinates of an .obj or .glb;\n"
               "uses even loops unless --loops or --start is given"}
            .writes(".obj .glb", ".mtl .png"),
        Option{"--leaves", &r.leaves, "FILE.obj", "leaves as polylines: level sets and the leaves between zeros"}
            .writes(".obj"),
        Option{"--spacing", &r.spacing, "X",
               "distance of level sets, in the unit of the weights; by default a tenth of the least weight"}
            .in("(0, inf)")
            .requires_one_of("--leaves"),
        Option{"--conjugate", &r.conjugate, "", "add the conjugate leaves, where v is constant"}.requires_one_of(
            "--leaves"),
        Option{"--quads", &r.quads, "FILE.obj", "quad mesh along the leaves, irregular only at the zeros"}.writes(
            ".obj"),
        Option{"--size", &r.size, "X", "target edge length of the quads; by default half as many quads as triangles"}
            .in("(0, inf)")
            .requires_one_of("--quads --pattern"),
    };
    options.insert(options.end(), others.begin(), others.end());
    return options;
}

} // namespace cli
