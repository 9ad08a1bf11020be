// hmf.h: interpolate, energy, residuals, singularities.
#include "../foliation/whitehead.hpp"
#include "values.hpp"

using namespace hmf;

namespace {

// Loads the caller's values on a level, validated; poles are allowed where
// they are the question.
hmf_status load_values(const hmf_hierarchy* h, size_t level, const double* values, size_t count, size_t finest,
                       State& state, double& unit, Call& call, bool poles_allowed = false) {
    if (check_level(h, level, call) || check_level(h, finest, call)) return call.status();
    if (!state.allocate(*h, finest, call.memory)) return call.out_of_memory();
    state.load(level, Side::input);
    return import_values(state, values, count, unit, poles_allowed, call);
}

hmf_status to_intrinsic(State& state, Call& call) {
    if (state.level == 0 && !state.to_intrinsic(call)) return call.out_of_memory();
    return HMF_OK;
}

} // namespace

extern "C" {

hmf_status hmf_interpolate(const hmf_hierarchy* hierarchy, size_t from_level, const double* values, size_t count,
                           size_t to_level, double* out_values, size_t out_capacity, hmf_error* error) {
    Query query(hierarchy, error);
    Call& call = query.call;
    if (query.check(hierarchy, from_level, out_values) || check_level(hierarchy, to_level, call)) return call.status();
    if (check_capacity(out_capacity, hierarchy->levels[to_level].mesh.edge_count, "out_values", call))
        return call.status();
    State state;
    double unit = 1;
    if (load_values(hierarchy, from_level, values, count, from_level < to_level ? from_level : to_level, state, unit,
                    call))
        return call.status();
    if (!state.go_to(to_level, call)) return call.out_of_memory();
    return export_values(state, unit, out_values, call);
}

hmf_status hmf_energy(const hmf_hierarchy* hierarchy, size_t level, const double* values, size_t count, double* out,
                      hmf_error* error) {
    Query query(hierarchy, error);
    Call& call = query.call;
    if (query.check(hierarchy, level, out)) return call.status();
    State state;
    double unit = 1;
    if (load_values(hierarchy, level, values, count, level, state, unit, call) || to_intrinsic(state, call))
        return call.status();
    *out = energy(state.foliation, hierarchy->levels[level].weight) * unit * unit;
    return HMF_OK;
}

hmf_status hmf_residuals(const hmf_hierarchy* hierarchy, size_t level, const double* values, size_t count, double* out,
                         size_t capacity, hmf_error* error) {
    Query query(hierarchy, error);
    Call& call = query.call;
    if (query.check(hierarchy, level, out)) return call.status();
    const uint32_t n = hierarchy->levels[level].mesh.vertex_count;
    if (check_capacity(capacity, n, "residuals", call)) return call.status();
    State state;
    double unit = 1;
    if (load_values(hierarchy, level, values, count, level, state, unit, call) || to_intrinsic(state, call))
        return call.status();
    Rings rings;
    Star star;
    Array<double> residual;
    const double* weight = hierarchy->levels[level].weight;
    if (!rings.build(state.foliation.mesh, weight, call.memory) || !star.allocate(call.memory, rings.max_degree)
        || !residual.allocate(call.memory, n))
        return call.out_of_memory();
    residuals(state.foliation, rings, weight, star, residual.data(), call);
    if (state.foliation.out_of_memory) return call.out_of_memory();
    for (uint32_t v = 0; v < n; ++v) out[v] = residual[level == 0 ? hierarchy->vertex_internal[v] : v];
    return HMF_OK;
}

hmf_status hmf_singularities(const hmf_hierarchy* hierarchy, size_t level, const double* values, size_t count,
                             int32_t* vertex_index, size_t vertex_capacity, int32_t* triangle_index,
                             size_t triangle_capacity, uint32_t* vertex_cluster, size_t cluster_capacity,
                             hmf_singularity* list, size_t list_capacity, size_t* list_count, hmf_error* error) {
    Query query(hierarchy, error);
    Call& call = query.call;
    if (query.check(hierarchy, level, list_count)) return call.status();
    const Mesh& mesh = level == 0 ? hierarchy->input : hierarchy->levels[level].mesh;
    const uint32_t n = mesh.vertex_count, m = mesh.face_count;
    if ((vertex_index && check_capacity(vertex_capacity, n, "vertex_index", call))
        || (triangle_index && check_capacity(triangle_capacity, m, "triangle_index", call))
        || (vertex_cluster && check_capacity(cluster_capacity, n, "vertex_cluster", call)))
        return call.status();
    State state;
    double unit = 1;
    if (load_values(hierarchy, level, values, count, level, state, unit, call, true)) return call.status();
    Array<int32_t> at_vertex, at_face;
    Array<uint32_t> cluster, size, lowest;
    if (!at_vertex.allocate(call.memory, n) || !at_face.allocate(call.memory, m) || !cluster.allocate(call.memory, n)
        || !size.allocate(call.memory, n) || !lowest.allocate_filled(call.memory, n, NONE))
        return call.out_of_memory();
    count_singularities(state.foliation, at_vertex.data(), cluster.data(), size.data(), at_face.data());
    if (state.foliation.out_of_memory) return call.out_of_memory();
    // From internal numbers to the caller's: the lowest vertex of a cluster may be another one.
    const auto internal = [&](uint32_t v) { return level == 0 ? hierarchy->vertex_internal[v] : v; };
    for (uint32_t v = n; v-- > 0;) lowest[cluster[internal(v)]] = v;
    const auto face_of = [&](uint32_t t) { return level == 0 ? internal_face(*hierarchy, t) : t; };
    size_t found = 0;
    for (uint32_t v = 0; v < n; ++v) found += lowest[cluster[internal(v)]] == v && at_vertex[cluster[internal(v)]] != 0;
    for (uint32_t t = 0; t < m; ++t) found += at_face[t] != 0;
    const auto is_single_mark = [&](uint32_t v) { // in no zero
        return mesh.is_marked(internal(v)) && at_vertex[cluster[internal(v)]] == 0;
    };
    for (uint32_t v = 0; v < n && mesh.marked_count > 0; ++v) found += is_single_mark(v);
    if (list && check_capacity(list_capacity, found, "list", call)) return call.status();
    size_t at = 0;
    for (uint32_t v = 0; v < n; ++v) {
        const uint32_t c = cluster[internal(v)];
        const bool first = lowest[c] == v;
        if (vertex_index) vertex_index[v] = first ? at_vertex[c] : 0;
        if (vertex_cluster) vertex_cluster[v] = lowest[c];
        if (list && first && at_vertex[c] != 0)
            list[at++] = {size[c] > 1 ? HMF_SINGULAR_CLUSTER : HMF_SINGULAR_VERTEX, at_vertex[c], v, size[c]};
    }
    for (uint32_t t = 0; t < m; ++t) {
        const int32_t index = at_face[face_of(t)];
        if (triangle_index) triangle_index[t] = index;
        if (list && index != 0) list[at++] = {HMF_SINGULAR_TRIANGLE, index, t, 1};
    }
    for (uint32_t v = 0; v < n && list && mesh.marked_count > 0; ++v)
        if (is_single_mark(v)) list[at++] = {HMF_SINGULAR_VERTEX, 0, v, 1};
    *list_count = found;
    return HMF_OK;
}

} // extern "C"
