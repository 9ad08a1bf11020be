// applications.h: parameterize.
#include "../loops/library_loops.hpp"
#include "../parameterize/parameterization.hpp"
#include "../../core/api/result.hpp"
#include "application_entry.hpp"
#include "write_parameterization.hpp"

using namespace hmf;

namespace {

// The seam edges of the caller by internal numbers.
hmf_status read_seam_edges(const hmf_foliation& foliation, const hmf_parameterize_options& all,
                           Array<uint32_t>& internal, Call& call) {
    if (!internal.allocate(call.memory, static_cast<size_t>(all.seam_edge_count))) return call.out_of_memory();
    for (size_t i = 0; i < internal.size(); ++i) {
        assert(all.seam_edges); // there is a count only with an array
        const uint32_t e = all.seam_edges[i];
        const uint32_t edges = foliation.hierarchy->shown_edges(foliation.level);
        if (e >= edges)
            return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_EDGE, e,
                             "seam_edges names edge %u; the level has %u edges.", static_cast<unsigned>(e),
                             static_cast<unsigned>(edges));
        internal[i] = internal_edge(*foliation.hierarchy, foliation.level, e);
    }
    return HMF_OK;
}

// What flipped triangles cover counts twice.  An atlas can do with more of them: it gives them other shapes.
hmf_status refuse_folds(double covered, Call& call) {
    constexpr double most = 1.5; // as of the energy of du
    if (covered < most) return HMF_OK;
    return call.fail(
        HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_NONE, 0,
        "The mesh is too coarse: (u, v) is folded. Its area, that of flipped triangles counted as positive, "
        "is %.3g times the energy of the foliation. Subdivide it.",
        covered);
}

} // namespace

extern "C" void hmf_parameterize_options_init(hmf_parameterize_options* options, uint32_t struct_size) {
    hmf_parameterize_options defaults{};
    defaults.tolerance = HARMONIC_TOLERANCE;
    init_options(options, struct_size, defaults);
}

extern "C" hmf_status hmf_parameterize(const hmf_foliation* foliation, const hmf_parameterize_options* options,
                                       const hmf_control* control, hmf_parameterization** out, hmf_error* error) {
    ApplicationEntry entry(foliation, control, error);
    Call& call = entry.call;
    hmf_parameterize_options all;
    if (entry.check(out) || read_options(options, all, "hmf_parameterize_options", call)) return call.status();
    if (!(all.tolerance >= 0) || (all.seam_edge_count && !all.seam_edges))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "tolerance must not be negative, and seam_edges not NULL where there are some.");
    const hmf_hierarchy& h = *foliation->hierarchy;
    const size_t level = foliation->level;
    const Mesh& mesh = loop_mesh(h, level);
    Array<uint32_t> seam_edges;
    CallerTriangles triangles;
    FlatOf flat;
    Parameterization made;
    if (read_seam_edges(*foliation, all, seam_edges, call)) return call.status();
    const double tolerance = all.tolerance > 0 ? all.tolerance : HARMONIC_TOLERANCE;
    const auto improve = [&](State& state, double&) { return check_harmonic(state, tolerance, call); };
    if (const hmf_status status = flat.find(*foliation, entry, tolerance, improve)) return status;
    if (refuse_folds(flat.flat->figures.covered, call)) return call.status();
    if (!triangles.build(h, level, call)) return call.stopped();
    const uint32_t start = level == 0 ? internal_side(h, 0) : triangles.of_face[0].side;
    if (made.build(mesh, h.levels[level].position, *flat.flat, start, seam_edges, call)) return call.status();

    hmf_parameterization counts{};
    counts.struct_size = sizeof counts;
    counts.linear_iterations = flat.flat->iterations;
    counts.energy_ratio = flat.flat->figures.energy_ratio;
    counts.area_error = flat.flat->figures.area_error;
    counts.circumference_least = flat.flat->figures.circumference_least;
    counts.circumference_most = flat.flat->figures.circumference_most;
    counts.vertex_count = h.shown_vertices(level);
    counts.edge_count = h.shown_edges(level);
    counts.triangle_count = h.shown_triangles(level);
    ResultBlock block;
    block.room(counts, counts.corner_uv, 6 * counts.triangle_count);
    block.room(counts, counts.transition, 3 * counts.edge_count);
    block.room(counts, counts.seam, counts.edge_count);
    block.room(counts, counts.cone, counts.vertex_count);
    block.room(counts, counts.dilatation, counts.triangle_count);
    block.room(counts, counts.differential, 2 * counts.triangle_count);
    hmf_parameterization* result = block.make(counts, h, call);
    if (!result) return call.status();
    if (write_parameterization(made, *foliation, mesh, *flat.flat, flat.unit, triangles, *result, call)) {
        free_block(result);
        return call.status();
    }
    result->seconds = call.seconds();
    *out = result;
    return entry.end();
}
