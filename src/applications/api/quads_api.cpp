// applications.h: quads.
#include "../cylinders/to_minimum.hpp"
#include "../quads/fit_quads.hpp"
#include "../quads/quad_mesh.hpp"
#include "../quads/sized_quads.hpp"
#include "../../core/api/result.hpp"
#include "application_entry.hpp"

#include <cmath>

using namespace hmf;

namespace {

hmf_status read_quad_options(const hmf_quad_options* options, const hmf_foliation& foliation, hmf_quad_options& all,
                             Call& call) {
    if (read_options(options, all, "hmf_quad_options", call)) return call.status();
    if (!(all.edge_length >= 0) || !std::isfinite(all.edge_length))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0,
                         "edge_length must be finite and not negative; 0 means the default.");
    if (all.edge_length > 0 && all.count > 0)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "edge_length and count are both given. Choose one.");
    if (all.count > MOST_QUADS || all.relax > MOST_RELAX_STEPS)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, 0, "count must be at most %llu, relax at most %llu.",
                         static_cast<unsigned long long>(MOST_QUADS),
                         static_cast<unsigned long long>(MOST_RELAX_STEPS));
    return refuse_level_of_double(foliation, call);
}

} // namespace

extern "C" void hmf_quad_options_init(hmf_quad_options* options, uint32_t struct_size) {
    init_options(options, struct_size, {});
}

extern "C" hmf_status hmf_quads(const hmf_foliation* foliation, const hmf_quad_options* options,
                                const hmf_control* control, hmf_quad_mesh** out, hmf_error* error) {
    ApplicationEntry entry(foliation, control, error);
    Call& call = entry.call;
    hmf_quad_options all;
    if (entry.check(out) || read_quad_options(options, *foliation, all, call)) return call.status();
    const hmf_hierarchy& h = *foliation->hierarchy;
    Leaves leaves;
    Reflection reflection;
    FrontParts front;
    if (leaves.load(*foliation, call, &reflection) || refuse_wide_zeros(leaves.cylinders.graph, call))
        return call.status();
    FlatOf flat;
    const auto improve = [&](State& solved, double& unit) { return to_minimum(solved, unit, call); };
    if (const hmf_status status = flat.find(*foliation, entry, HARMONIC_TOLERANCE, improve)) return status;
    Foliation& f = leaves.state.foliation;
    if (h.is_double() && front.build(f, reflection, leaves.cylinders, call)) return call.status();
    SizedQuads wish;
    wish.edge_length = all.edge_length > 0 ? length_inside(h, all.edge_length) : 0;
    wish.count = all.count;
    wish.relax = static_cast<int>(all.relax);
    wish.merge = all.merge != 0;
    wish.keep_poles = all.keep_poles != 0;
    wish.share = h.share();
    wish.front = h.is_double() ? &front : nullptr;
    wish.reflection = &reflection;
    const Conjugate conjugate(f, *flat.flat, flat.unit / foliation->unit);
    wish.conjugate = &conjugate;
    QuadMesh made;
    QuadFigures figures;
    double area = 0;
    if (make_sized_quads(f, h.levels[foliation->level].position, leaves.cylinders, wish, made, area, figures, call))
        return call.status();
    for (double& x : made.positions) x /= h.scale;
    hmf_quad_mesh mesh{sizeof(hmf_quad_mesh),
                       0,
                       made.vertex_count(),
                       made.quad_count(),
                       nullptr,
                       nullptr,
                       figures.irregular,
                       figures.inverted,
                       std::sqrt(area / static_cast<double>(made.quad_count())) / h.scale,
                       figures.area / area,
                       figures.distance / h.scale};
    ResultBlock block;
    block.array(mesh, mesh.positions, made.positions.size(), made.positions.data());
    block.array(mesh, mesh.quads, made.quads.size(), made.quads.data());
    *out = block.make(mesh, h, call);
    return entry.end();
}
