// hmf.h: interpolate, energy, residuals, singularities.
#include "../hierarchy/caller_numbers.hpp"
#include "../leaves/double_reflection.hpp"
#include "../extreme/fraction.hpp"
#include "foliation_object.hpp"
#include "result.hpp"
#include "singularity_list.hpp"

using namespace hmf;

static const hmf_hierarchy* hierarchy_of(const hmf_foliation* foliation) {
    return foliation ? foliation->hierarchy : nullptr;
}

extern "C" {

hmf_status hmf_interpolate(const hmf_foliation* foliation, size_t level, const hmf_control* control,
                           hmf_foliation** out, hmf_error* error) {
    Entry entry(hierarchy_of(foliation), control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy_of(foliation), out) || check_foliation(foliation, call)
        || check_level(*foliation->hierarchy, level, call))
        return call.status();
    State state;
    if (load_values(*foliation, level, state, call)) return call.status();
    if (!state.go_to(level, call)) return call.stopped();
    Symmetrized made;
    const bool moved = level != foliation->level;
    if (moved && make_symmetric(*state.hierarchy, level, state.foliation, call, made)) return call.status();
    FoliationData data;
    data.unit = foliation->unit;
    return make_foliation(state, data, call, out) ? call.status() : entry.end();
}

hmf_status hmf_energy(const hmf_foliation* foliation, const hmf_control* control, double* out, hmf_error* error) {
    Entry entry(hierarchy_of(foliation), control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy_of(foliation), static_cast<const void*>(out))) return call.status();
    State state;
    double unit = 1;
    if (load_solved(*foliation, state, unit, call)) return call.status();
    const double* weight = foliation->hierarchy->levels[foliation->level].weight;
    *out = energy(state.foliation, weight, call.parallel) * unit * unit * foliation->hierarchy->share();
    return entry.end();
}

hmf_status hmf_residuals(const hmf_foliation* foliation, const hmf_control* control, hmf_residual_set** out,
                         hmf_error* error) {
    Entry entry(hierarchy_of(foliation), control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy_of(foliation), out) || check_foliation(foliation, call)) return call.status();
    const hmf_hierarchy& h = *foliation->hierarchy;
    const Level& level = h.levels[foliation->level];
    const uint32_t n = h.shown_vertices(foliation->level);
    State state;
    Rings rings;
    Star star;
    Array<double> residual;
    double unit = 1;
    if (load_solved(*foliation, state, unit, call)) return call.status();
    if (!rings.build(state.foliation.mesh, level.weight, call.memory, call.parallel)
        || !star.allocate(call.memory, rings.max_degree) || !residual.allocate(call.memory, level.mesh.vertex_count))
        return call.out_of_memory();
    ResidualResult unused;
    if (!foliation->fraction) residuals(state.foliation, rings, level.weight, star, residual.data(), call);
    else if (const hmf_status status = residuals_with_fractions(
                 state.foliation, rings, level.weight, foliation->fraction, star, residual.data(), call, unused))
        return status;
    if (call.cancelled()) return call.was_cancelled();
    hmf_residual_set result{sizeof(hmf_residual_set), 0, n, nullptr};
    ResultBlock block;
    block.room(result, result.values, n);
    hmf_residual_set* const made = block.make(result, h, call);
    if (!made) return call.status();
    for (uint32_t v = 0; v < n; ++v) fill(made->values)[v] = residual[foliation->level == 0 ? h.vertex_internal[v] : v];
    *out = made;
    return entry.end();
}

hmf_status hmf_singularities(const hmf_foliation* foliation, const hmf_control* control, hmf_singularity_set** out,
                             hmf_error* error) {
    Entry entry(hierarchy_of(foliation), control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy_of(foliation), out)) return call.status();
    State state;
    if (load_values(*foliation, foliation->level, state, call)) return call.status();
    if (!call.tick(0.3)) return call.was_cancelled();
    return list_singularities(state, call, out) ? call.status() : entry.end();
}

} // extern "C"
