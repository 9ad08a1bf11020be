// The table of the options of hmf solve.  A new one is a row here, a field of SolveRequest, and its use.
#include "solve.hpp"

#include "render.hpp"

namespace cli {

Option loops_option(SolveRequest& r) {
    return Option{"--loops", &r.loops, "cut|handle|tunnel|pants|even|FILE",
                  "cut: as many as the genus, together they cut the surface into one planar piece; on genus 0 round\n"
                  "pairs of marked vertices; handle, tunnel: such that bound inside, outside;\n"
                  "pants: 3 genus - 3 + marked vertices that leave pairs of pants;\n"
                  "even: loops, weights and marked vertices for which stripes and quads are as even as it gets;\n"
                  "or FILE: one loop a line, vertex indices from 0 (closed edge path), t: and triangle indices, or "
                  "a: and the vertices of an arc from boundary to boundary"}
        .reads("");
}

Option through_option(SolveRequest& r) {
    return Option{
        "--through", &r.through, "\"POINTS\"",
        "instead of --loops: loops drawn through picked points, the shortest way along edges from each to the\n"
        "next and back to the first: vertex indices from 0, or places X,Y,Z near the surface, separated by\n"
        "blanks, at least three, on all sides of what the loop goes round; \";\" begins another loop"}
        .without("--loops --start");
}

Option weights_option(SolveRequest& r) {
    return Option{"--weights", &r.weights, "W,W,...",
                  "one weight > 0 per loop, else those of the FILE of --loops or of even, else all 1"}
        .in("(0, inf)");
}

Option marks_option(SolveRequest& r) {
    return Option{
        "--marks", &r.marks, "auto|none|FILE",
        "vertices that may carry a pole, at least four on genus 0; auto: suggested ones on genus 0, else none;\n"
        "or FILE: vertex indices from 0"}
        .reads("");
}

Option threads_option(SolveRequest& r) {
    return Option{"--threads", &r.threads, "N", "0: one for each processor; 1: none is started; the same results"}.in(
        "[0, 256]");
}

Option camera_option(SolveRequest& r) {
    return Option{"--camera", &r.camera, "VIEW",
                  "picture from: auto (where most zeros and loops are seen), front, back, left, right, top,\n"
                  "bottom, corner, or a direction X,Y,Z or with what is above X,Y,Z,UX,UY,UZ"}
        .requires_one_of("--image");
}

Option image_size_option(SolveRequest& r) {
    return Option{"--image-size", &r.image_size, "WxH", "pixels of the picture"}.requires_one_of("--image");
}

Option legend_option(SolveRequest& r) {
    return Option{"--legend", &r.legend, "", "picture: what the colors mean"}.requires_one_of("--image");
}

Option mollify_option(SolveRequest& r) {
    return Option{"--mollify", &r.mollify, "X",
                  "accept triangles without area: margin of the triangle inequalities,\n"
                  "in mean edge lengths, e.g. 1e-5"}
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
               "values of --values to start from, instead of loops: the class is theirs"}
            .reads(".csv .npy")
            .without("--loops --save-loops"),
        Option{"--method",
               Choice{&r.method,
                      {{"newton", HMF_METHOD_NEWTON},
                       {"whitehead", HMF_METHOD_WHITEHEAD},
                       {"single-level", HMF_METHOD_SINGLE_LEVEL},
                       {"paper", HMF_METHOD_PAPER}}},
               "newton|whitehead|single-level|paper", "else the most exact of this version"},
        Option{"--collapse",
               Choice{&r.collapse,
                      {{"midpoint", HMF_COLLAPSE_MIDPOINT},
                       {"endpoint", HMF_COLLAPSE_ENDPOINT},
                       {"qslim", HMF_COLLAPSE_QSLIM}}},
               "midpoint|endpoint|qslim", "how the hierarchy is made"},
        Option{"--ratio", &r.ratio, "X", "edges of a level / edges of the finer one"}.in("[0.05, 0.95]"),
        Option{"--coarsest", &r.coarsest, "N",
               "vertices of the coarsest level, at least 40 genus + 10 marked; 0: a sixteenth of all, 1000 at most"}
            .in("[0, inf)"),
        mollify_option(r),
        Option{"--tolerance", &r.tolerance, "X",
               "newton: largest residual, else 1e-8; others: change of energy, else 1e-6"}
            .in("(0, 1)"),
        Option{"--time-limit", &r.time_limit, "X", "seconds"}.in("[0, inf)"),
        threads_option(r),
        Option{"--values", &r.values, "FILE",
               "F per edge: .csv (vertex,vertex,value) or .npy; - is CSV; may be given once for each"}
            .writes(".csv .npy"),
        Option{"--report", &r.report, "FILE.json", "numbers of the run"}.writes(".json"),
        Option{"--conformality", &r.conformality, "", "report: also how conformal the parameterization is"}
            .requires_one_of("--report"),
        Option{"--history", &r.history, "FILE.csv", "energy and residual over time"}.writes(".csv"),
        Option{"--save-loops", &r.save_loops, "FILE", "the loops on this mesh, as --loops reads them"}.writes(""),
        Option{"--save-mesh", &r.save_mesh, "FILE.obj",
               "the mesh as it was solved, after --repair; loops, values and all outputs refer to it"}
            .writes(".obj"),
        Option{"--save-marks", &r.save_marks, "FILE", "the marked vertices, as --marks reads them"}.writes(""),
        Option{"--image", &r.image, "FILE.png",
               "zeros blue with their order, marked vertices violet, poles yellow, loops green"}
            .writes(".png"),
        Option{"--pattern",
               Choice{&r.pattern,
                      {{"stripes", static_cast<int32_t>(Pattern::stripes)},
                       {"checkerboard", static_cast<int32_t>(Pattern::checkerboard)},
                       {"quads", static_cast<int32_t>(Pattern::quads)},
                       {"dilatation", static_cast<int32_t>(Pattern::dilatation)},
                       {"scale", static_cast<int32_t>(Pattern::scale)}}},
               "stripes|checkerboard|quads|dilatation|scale",
               "of the picture: stripes along the leaves, squares of (u, v), the grid of --quads,\n"
               "how far from conformal (u, v) is, or how wide stripes are: white average, red narrow, blue wide"}
            .requires_one_of("--image"),
        camera_option(r),
        image_size_option(r),
        Option{"--period", &r.period, "X",
               "of stripes and squares, in the unit of the weights; each cylinder gets a whole number of them"}
            .in("(0, inf)")
            .requires_one_of("--image --obj --textured"),
        legend_option(r),
        Option{"--obj", &r.obj, "FILE.obj",
               "mesh with (u, v) per corner as texture coordinates;\n"
               "FILE.mtl and FILE.png (a checkerboard) come with it"}
            .writes(".obj", ".mtl .png"),
        Option{"--textured", &r.textured, "FILE",
               "the same in one file: .glb with the texture in it, .ply with s, t of each vertex, which seams double"}
            .writes(".glb .ply"),
        Option{"--atlas", &r.atlas, "FILE",
               "charts without overlap in the unit square, as texture coordinates of an .obj or .glb, to paint or\n"
               "bake; without --loops and --start the loops are even"}
            .writes(".obj .glb", ".mtl .png"),
        Option{"--leaves", &r.leaves, "FILE.obj", "leaves as polylines: level sets and the leaves between zeros"}
            .writes(".obj"),
        Option{"--spacing", &r.spacing, "X",
               "distance of level sets, in the unit of the weights, else a tenth of the least weight"}
            .in("(0, inf)")
            .requires_one_of("--leaves"),
        Option{"--conjugate", &r.conjugate, "", "leaves: also the lines across, where v is constant"}.requires_one_of(
            "--leaves"),
        Option{"--quads", &r.quads, "FILE.obj", "quad mesh along the leaves, irregular only at the zeros"}.writes(
            ".obj"),
        Option{"--size", &r.size, "X", "wished length of an edge of a quad, else half as many quads as triangles"}
            .in("(0, inf)")
            .requires_one_of("--quads --pattern"),
    };
    options.insert(options.end(), others.begin(), others.end());
    return options;
}

} // namespace cli
