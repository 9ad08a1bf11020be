// applications.h: atlas.
#include "../atlas/atlas.hpp"
#include "../atlas/atlas_measures.hpp"
#include "../atlas/check_atlas.hpp"
#include "../parameterize/parameterization.hpp"
#include "../../core/api/result.hpp"
#include "application_entry.hpp"

using namespace hmf;

namespace {

constexpr double DEFAULT_MARGIN = 1.0 / 512, MOST_MARGIN = 1.0 / 16;

hmf_status check_overlaps(const Atlas& made, const Mesh& mesh, const Array<uint32_t>& side, AtlasCheck& found,
                          Call& call) {
    if (check_atlas(made, mesh, side, found, call)) return call.status();
    if (found.turned == 0 && found.crossings == 0) return HMF_OK;
    return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                     "%llu triangles of the atlas are turned over, and %llu edges of charts overlap others. Please "
                     "report it.",
                     static_cast<unsigned long long>(found.turned), static_cast<unsigned long long>(found.crossings));
}

// Corners and charts, triangle by triangle.  side: of each triangle of the caller.
hmf_status write_charts(const Atlas& made, const Mesh& mesh, const Array<uint32_t>& side, hmf_chart_set& to,
                        Call& call) {
    for (size_t t = 0; t < to.triangle_count; ++t) {
        if (t % 65536 == 0 && !call.tick(0.99)) return call.was_cancelled();
        fill(to.triangle_chart)[t] = made.chart[mesh.face[side[t]]];
        uint32_t h = side[t];
        for (size_t s = 0; s < 3; ++s, h = mesh.next[h])
            for (size_t a = 0; a < 2; ++a) fill(to.corner_uv)[6 * t + 2 * s + a] = made.uv[2 * size_t{h} + a];
    }
    return HMF_OK;
}

} // namespace

extern "C" void hmf_atlas_options_init(hmf_atlas_options* options, uint32_t struct_size) {
    hmf_atlas_options defaults{};
    defaults.margin = DEFAULT_MARGIN;
    init_options(options, struct_size, defaults);
}

extern "C" hmf_status hmf_atlas(const hmf_foliation* foliation, const hmf_atlas_options* options,
                                const hmf_control* control, hmf_chart_set** out, hmf_error* error) {
    ApplicationEntry entry(foliation, control, error);
    Call& call = entry.call;
    hmf_atlas_options all;
    if (entry.check(out) || read_options(options, all, "hmf_atlas_options", call)) return call.status();
    if (!(all.margin >= 0 && all.margin <= MOST_MARGIN))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "margin must lie in [0, 1/16]; 0 means 1/512.");
    const hmf_hierarchy& h = *foliation->hierarchy;
    const size_t level = foliation->level;
    if (refuse_level_of_double(*foliation, call)) return call.status();
    const double* position = h.levels[level].position;
    FlatOf flat;
    const auto improve = [&](State& state, double&) { return check_harmonic(state, HARMONIC_TOLERANCE, call); };
    if (const hmf_status status = flat.find(*foliation, entry, HARMONIC_TOLERANCE, improve)) return status;
    Leaves leaves;
    Reflection reflection;
    Strips strips;
    Atlas made;
    Array<uint32_t> side;
    if (leaves.load(*foliation, call, &reflection)) return call.status();
    const Foliation& f = leaves.state.foliation;
    if (strips.build(f, leaves.cylinders, *flat.flat, h.is_double() ? &reflection : nullptr,
                     foliation->unit / flat.unit, call)
        || made.build(f.mesh, position, flat.flat->bundle, strips, all.margin > 0 ? all.margin : DEFAULT_MARGIN, call))
        return call.status();
    AtlasMeasures measures;
    AtlasCheck found;
    if (!side_of_triangles(h, level, side, call)) return call.stopped();
    if (check_overlaps(made, f.mesh, side, found, call) || measure_atlas(made, f.mesh, position, side, measures, call))
        return call.status();
    hmf_chart_set counts{};
    counts.struct_size = sizeof counts;
    counts.triangle_count = h.shown_triangles(level);
    counts.chart_count = made.chart_count;
    counts.used_area = made.used_area;
    counts.collapsed_count = made.collapsed;
    counts.unevenness = measures.unevenness;
    counts.seam_edge_count = measures.seam_edges;
    counts.seam_length = measures.seam_length / h.scale;
    counts.speck_count = found.specks;
    counts.compared_count = found.edges;
    ResultBlock block;
    block.room(counts, counts.corner_uv, 6 * counts.triangle_count);
    block.room(counts, counts.triangle_chart, counts.triangle_count);
    hmf_chart_set* result = block.make(counts, h, call);
    if (!result) return call.status();
    if (write_charts(made, f.mesh, side, *result, call)) {
        free_block(result);
        return call.status();
    }
    *out = result;
    return entry.end();
}
