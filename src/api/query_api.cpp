// hmf.h: interpolate, energy, residuals, singularities.
#include "../design/conformal_scale.hpp"
#include "../hierarchy/caller_numbers.hpp"
#include "../solve/double_reflection.hpp"
#include "../solve/fraction.hpp"
#include "foliation_object.hpp"

#include <cmath>

using namespace hmf;

namespace {

const hmf_hierarchy* hierarchy_of(const hmf_foliation* foliation) { return foliation ? foliation->hierarchy : nullptr; }

// Indices by internal numbers, and the caller's numbers for them.
struct Indices {
    Array<int32_t> at_vertex, at_face;
    Array<uint32_t> cluster, size, lowest, face;

    hmf_status count(State& state, Call& call) {
        Foliation& f = state.foliation;
        const hmf_hierarchy& h = *state.hierarchy;
        const uint32_t n = f.mesh.vertex_count, m = f.mesh.face_count;
        if (!at_vertex.allocate(call.memory, n) || !at_face.allocate(call.memory, m)
            || !cluster.allocate(call.memory, n) || !size.allocate(call.memory, n)
            || !lowest.allocate_filled(call.memory, n, NONE) || !face.allocate(call.memory, m))
            return call.out_of_memory();
        if (!call.tick(0.3)) return call.was_cancelled();
        count_singularities(f, {at_vertex.data(), cluster.data(), size.data(), at_face.data()}, &call);
        if (!call.tick(0.5)) return call.was_cancelled();
        internal_vertex = state.level == 0 ? h.vertex_internal : nullptr;
        // From internal numbers to the caller's: the lowest vertex of a cluster may be another one.
        for (uint32_t v = n; v-- > 0;) lowest[cluster[internal(v)]] = v;
        for (uint32_t t = 0; t < m; ++t) face[t] = state.level == 0 ? internal_face(h, t) : t;
        return HMF_OK;
    }

    uint32_t internal(uint32_t v) const { return internal_vertex ? internal_vertex[v] : v; }
    // Index of the cluster whose lowest vertex is v, else 0.
    int32_t index_at(uint32_t v) const {
        const uint32_t c = cluster[internal(v)];
        return lowest[c] == v ? at_vertex[c] : 0;
    }

private:
    const uint32_t* internal_vertex = nullptr;
};

// Where singularities lie in space; a cluster at the mean of its vertices, or at the vertex nearest to that where there
// is a boundary, which it may go along.
class Places {
public:
    Places(const State& state, const Indices& indices) :
        mesh_(state.foliation.mesh), position_(state.hierarchy->levels[state.level].position), indices_(indices) {}

    void of_vertex(uint32_t internal, double* at) const {
        std::memcpy(at, position_ + 3 * size_t{internal}, 3 * sizeof(double));
    }

    void of_face(uint32_t side, double* at) const {
        const uint32_t corner[3] = {mesh_.origin[side], mesh_.target(side), mesh_.origin[mesh_.prev(side)]};
        for (size_t a = 0; a < 3; ++a)
            at[a] = (position_[3 * size_t{corner[0]} + a] + position_[3 * size_t{corner[1]} + a]
                     + position_[3 * size_t{corner[2]} + a])
                  / 3;
    }

    // Of all clusters with a place in the list: one pass.
    void of_clusters(const Array<uint32_t>& place, hmf_singularity* list) const {
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
            const uint32_t c = indices_.cluster[v];
            if (place[c] == NONE || indices_.size[c] < 2) continue;
            hmf_singularity& s = list[place[c]];
            for (size_t a = 0; a < 3; ++a) s.position[a] += position_[3 * size_t{v} + a] / s.size;
        }
    }

    // From the mean to a vertex of the cluster; count: entries of the list.
    Done to_vertices(const Array<uint32_t>& place, hmf_singularity* list, size_t count, Memory& memory) const {
        struct Nearest {
            double square;
            uint32_t vertex;
        };
        Array<Nearest> nearest;
        if (!nearest.allocate_filled(memory, count, Nearest{HUGE_VAL, NONE})) return false;
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
            const uint32_t c = indices_.cluster[v];
            if (place[c] == NONE || indices_.size[c] < 2) continue;
            double square = 0;
            for (size_t a = 0; a < 3; ++a) {
                const double x = position_[3 * size_t{v} + a] - list[place[c]].position[a];
                square += x * x;
            }
            if (square < nearest[place[c]].square) nearest[place[c]] = {square, v};
        }
        for (size_t k = 0; k < count; ++k)
            if (nearest[k].vertex != NONE) of_vertex(nearest[k].vertex, list[k].position);
        return true;
    }

private:
    const Mesh& mesh_;
    const double* position_;
    const Indices& indices_;
};

} // namespace

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
    if (level != foliation->level && make_symmetric(state, call)) return call.status();
    Making making;
    making.unit = foliation->unit;
    return make_foliation(state, making, call, out) ? call.status() : entry.end();
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

hmf_status hmf_residuals(const hmf_foliation* foliation, const hmf_control* control, double* out, size_t capacity,
                         hmf_error* error) {
    Entry entry(hierarchy_of(foliation), control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy_of(foliation), static_cast<const void*>(out)) || check_foliation(foliation, call))
        return call.status();
    const hmf_hierarchy& h = *foliation->hierarchy;
    const Level& level = h.levels[foliation->level];
    const uint32_t n = h.shown_vertices(foliation->level);
    if (check_capacity(capacity, n, "residuals", call)) return call.status();
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
    for (uint32_t v = 0; v < n; ++v) out[v] = residual[foliation->level == 0 ? h.vertex_internal[v] : v];
    return entry.end();
}

hmf_status hmf_conformal_scale(const hmf_foliation* foliation, const hmf_control* control, double* log_scale,
                               size_t capacity, double* unevenness, hmf_error* error) {
    Entry entry(hierarchy_of(foliation), control, error);
    Call& call = entry.call;
    const void* const output = log_scale ? log_scale : unevenness;
    if (entry.check(hierarchy_of(foliation), output)) return call.status();
    State state;
    ConformalScale scale;
    Array<uint32_t> side;
    if (load_values(*foliation, foliation->level, state, call)) return call.status();
    const Mesh& mesh = state.foliation.mesh;
    const size_t shown = foliation->hierarchy->shown_triangles(foliation->level);
    if (log_scale && check_capacity(capacity, shown, "log_scale", call)) return call.status();
    if (!call.tick(0.3)) return call.was_cancelled();
    if (!scale.measure(mesh, foliation->hierarchy->levels[foliation->level].position, state.foliation.value,
                       foliation->unit, call.memory, &call)
        || (log_scale && !side_of_triangles(*foliation->hierarchy, foliation->level, side, call)))
        return call.stopped();
    if (!call.tick(0.8)) return call.was_cancelled();
    for (size_t t = 0; log_scale && t < shown; ++t) log_scale[t] = scale.log_scale[mesh.face[side[t]]] + scale.offset;
    if (unevenness) *unevenness = scale.unevenness();
    return entry.end();
}

hmf_status hmf_singularities(const hmf_foliation* foliation, const hmf_control* control, hmf_singularity_set** out,
                             hmf_error* error) {
    Entry entry(hierarchy_of(foliation), control, error);
    Call& call = entry.call;
    if (entry.check(hierarchy_of(foliation), out)) return call.status();
    State state;
    Indices indices;
    Array<uint32_t> place, side; // of a cluster in the list; half-edge of each triangle
    if (load_values(*foliation, foliation->level, state, call)) return call.status();
    if (!call.tick(0.3)) return call.was_cancelled();
    if (indices.count(state, call)) return call.status();
    if (!call.tick(0.6)) return call.was_cancelled();
    // Of a double only what touches its front.
    const hmf_hierarchy& h = *foliation->hierarchy;
    const uint32_t n = h.shown_vertices(foliation->level), m = h.shown_triangles(foliation->level);
    if (!place.allocate_filled(call.memory, state.foliation.mesh.vertex_count, NONE)
        || !side_of_triangles(*foliation->hierarchy, foliation->level, side, call))
        return call.stopped();
    if (!call.tick(0.7)) return call.was_cancelled();
    uint64_t found = 0;
    for (uint32_t v = 0; v < n; ++v) found += indices.index_at(v) != 0;
    for (uint32_t t = 0; t < m; ++t) found += indices.at_face[indices.face[t]] != 0;
    const Mesh& mesh = state.foliation.mesh;
    const auto is_single_mark = [&](uint32_t v) { // in no zero
        return mesh.is_marked(indices.internal(v)) && indices.at_vertex[indices.cluster[indices.internal(v)]] == 0;
    };
    for (uint32_t v = 0; v < n && mesh.marked_count > 0; ++v) found += is_single_mark(v);

    hmf_singularity_set counts{sizeof(hmf_singularity_set), 0, n, m, found, nullptr, nullptr, nullptr, nullptr};
    ResultBlock block;
    block.room(counts, counts.list, static_cast<size_t>(found));
    block.room(counts, counts.vertex_index, n);
    block.room(counts, counts.vertex_cluster, n);
    block.room(counts, counts.triangle_index, m);
    hmf_singularity_set* made = block.make(counts, *foliation->hierarchy, call);
    if (!made) return call.status();
    if (!call.tick(0.8)) {
        free_block(made);
        return call.was_cancelled();
    }
    hmf_singularity* const list = fill(made->list);
    const Places places(state, indices);
    uint32_t at = 0;
    for (uint32_t v = 0; v < n; ++v) {
        const uint32_t internal = indices.internal(v), c = indices.cluster[internal];
        const int32_t index = fill(made->vertex_index)[v] = indices.index_at(v);
        fill(made->vertex_cluster)[v] = indices.lowest[c];
        if (index == 0) continue;
        const bool single = indices.size[c] < 2;
        list[at] = {single ? HMF_SINGULAR_VERTEX : HMF_SINGULAR_CLUSTER, index, v, indices.size[c], {0, 0, 0}};
        if (single) places.of_vertex(internal, list[at].position);
        place[c] = at++;
    }
    places.of_clusters(place, list);
    if (h.is_double() && !places.to_vertices(place, list, at, call.memory)) {
        free_block(made);
        return call.out_of_memory();
    }
    for (uint32_t t = 0; t < m; ++t) {
        const int32_t index = fill(made->triangle_index)[t] = indices.at_face[indices.face[t]];
        if (index == 0) continue;
        list[at] = {HMF_SINGULAR_TRIANGLE, index, t, 1, {0, 0, 0}};
        places.of_face(side[t], list[at++].position);
    }
    for (uint32_t v = 0; v < n && mesh.marked_count > 0; ++v) {
        if (!is_single_mark(v)) continue;
        list[at] = {HMF_SINGULAR_VERTEX, 0, v, 1, {0, 0, 0}};
        places.of_vertex(indices.internal(v), list[at++].position);
    }
    *out = made;
    return entry.end();
}

} // extern "C"
