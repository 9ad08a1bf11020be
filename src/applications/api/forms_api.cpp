// applications.h: harmonic forms.
#include "../../../include/hmf/applications.h"

#include "../../core/api/result.hpp"
#include "../forms/harmonic_forms.hpp"

using namespace hmf;

namespace {

// Of the input triangulation, for each edge of the caller in the direction of hmf_level.
Done directed_edges(const hmf_hierarchy& h, size_t level, Array<uint32_t>& half_edge, Call& call) {
    if (!half_edge.allocate(call.memory, h.shown_edges(level))) return false;
    if (level > 0) {
        for (uint32_t e = 0; e < half_edge.size(); ++e) half_edge[e] = 2 * e;
        return true;
    }
    for (size_t side = size_t{3} * h.surface_triangles; side-- > 0;) { // the first triangle decides the direction
        const uint32_t from = h.vertex_internal[h.triangle_vertices[side]], e = h.triangle_edges[side],
                       inside = h.edge_internal[e];
        half_edge[e] = 2 * inside + (h.input.origin[size_t{2} * inside] != from);
    }
    return call.tick(0.02);
}

} // namespace

extern "C" hmf_status hmf_harmonic_forms(const hmf_hierarchy* hierarchy, size_t level, const hmf_control* control,
                                         hmf_form_set** out, hmf_error* error) {
    Entry entry(hierarchy, control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy, out) || check_level(*hierarchy, level, call)) return call.status();
    const hmf_hierarchy& h = *hierarchy;
    if (h.is_double())
        return call.fail(
            HMF_ERROR_MESH_BOUNDARY, HMF_ELEMENT_NONE, 0,
            "The surface has a boundary. Harmonic forms are computed on closed surfaces; close the holes.");
    Array<uint32_t> half_edge;
    if (!directed_edges(h, level, half_edge, call)) return call.stopped();
    const size_t g = h.genus, n = 2 * g;
    hmf_form_set set{};
    set.struct_size = sizeof set;
    set.level = level;
    set.genus = g;
    set.form_count = n;
    set.edge_count = half_edge.size();
    ResultBlock block;
    block.room(set, set.values, n * half_edge.size());
    block.room(set, set.intersections, n * n);
    block.room(set, set.inner_products, n * n);
    block.room(set, set.conjugation, n * n);
    block.room(set, set.period_real, g * g);
    block.room(set, set.period_imaginary, g * g);
    hmf_form_set* const made = block.make(set, h, call);
    if (!made) return call.status();
    HarmonicForms forms{fill(made->values),      fill(made->intersections), fill(made->inner_products),
                        fill(made->conjugation), fill(made->period_real),   fill(made->period_imaginary)};
    if (harmonic_forms(h, level, half_edge, forms, call)) {
        free_block(made);
        return call.status();
    }
    made->residual = forms.residual;
    made->conjugation_error = forms.conjugation_error;
    *out = made;
    return entry.end();
}
