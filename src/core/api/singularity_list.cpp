#include "singularity_list.hpp"

#include "../hierarchy/caller_numbers.hpp"

#include <cmath>

namespace hmf {

namespace {

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
        internal_vertex_ = state.level == 0 ? h.vertex_internal : nullptr;
        // From internal numbers to the caller's: the lowest vertex of a cluster may be another one.
        for (uint32_t v = n; v-- > 0;) lowest[cluster[internal(v)]] = v;
        for (uint32_t t = 0; t < m; ++t) face[t] = state.level == 0 ? internal_face(h, t) : t;
        return HMF_OK;
    }

    uint32_t internal(uint32_t v) const { return internal_vertex_ ? internal_vertex_[v] : v; }
    // Index of the cluster whose lowest vertex is v, else 0.
    int32_t index_at(uint32_t v) const {
        const uint32_t c = cluster[internal(v)];
        return lowest[c] == v ? at_vertex[c] : 0;
    }

private:
    const uint32_t* internal_vertex_ = nullptr;
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

// Fills the list, which is already allocated, in the order of hmf_singularity_set.
class Lister {
public:
    Lister(const State& state, const Indices& indices, Call& call) :
        mesh_(state.foliation.mesh), h_(*state.hierarchy), level_(state.level), indices_(indices),
        places_(state, indices), call_(call) {}

    hmf_status run(hmf_singularity_set** out) {
        // Of a double only what touches its front.
        if (!place_.allocate_filled(call_.memory, mesh_.vertex_count, NONE)
            || !side_of_triangles(h_, level_, side_, call_))
            return call_.stopped();
        if (!call_.tick(0.7)) return call_.was_cancelled();
        hmf_singularity_set counts{
            sizeof(hmf_singularity_set), 0, vertices(), triangles(), count(), nullptr, nullptr, nullptr, nullptr};
        ResultBlock block;
        block.room(counts, counts.list, static_cast<size_t>(counts.count));
        block.room(counts, counts.vertex_index, vertices());
        block.room(counts, counts.vertex_cluster, vertices());
        block.room(counts, counts.triangle_index, triangles());
        hmf_singularity_set* const made = block.make(counts, h_, call_);
        if (!made) return call_.status();
        if (!call_.tick(0.8) || !fill_in(*made)) {
            free_block(made);
            return call_.stopped();
        }
        *out = made;
        return HMF_OK;
    }

private:
    uint32_t vertices() const { return h_.shown_vertices(level_); }
    uint32_t triangles() const { return h_.shown_triangles(level_); }
    int32_t index_of_triangle(uint32_t t) const { return indices_.at_face[indices_.face[t]]; }
    // A marked vertex that is in no zero.
    bool is_single_mark(uint32_t v) const {
        return mesh_.is_marked(indices_.internal(v)) && indices_.at_vertex[indices_.cluster[indices_.internal(v)]] == 0;
    }

    uint64_t count() const {
        uint64_t found = 0;
        for (uint32_t v = 0; v < vertices(); ++v) found += indices_.index_at(v) != 0;
        for (uint32_t t = 0; t < triangles(); ++t) found += index_of_triangle(t) != 0;
        for (uint32_t v = 0; v < vertices() && mesh_.marked_count > 0; ++v) found += is_single_mark(v);
        return found;
    }

    Done fill_in(hmf_singularity_set& made) {
        hmf_singularity* const list = fill(made.list);
        uint32_t at = 0;
        for (uint32_t v = 0; v < vertices(); ++v) {
            const uint32_t internal = indices_.internal(v), c = indices_.cluster[internal];
            const int32_t index = fill(made.vertex_index)[v] = indices_.index_at(v);
            fill(made.vertex_cluster)[v] = indices_.lowest[c];
            if (index == 0) continue;
            const bool single = indices_.size[c] < 2;
            list[at] = {single ? HMF_SINGULAR_VERTEX : HMF_SINGULAR_CLUSTER, index, v, indices_.size[c], {0, 0, 0}};
            if (single) places_.of_vertex(internal, list[at].position);
            place_[c] = at++;
        }
        places_.of_clusters(place_, list);
        if (h_.is_double() && !places_.to_vertices(place_, list, at, call_.memory)) return false;
        for (uint32_t t = 0; t < triangles(); ++t) {
            const int32_t index = fill(made.triangle_index)[t] = index_of_triangle(t);
            if (index == 0) continue;
            list[at] = {HMF_SINGULAR_TRIANGLE, index, t, 1, {0, 0, 0}};
            places_.of_face(side_[t], list[at++].position);
        }
        for (uint32_t v = 0; v < vertices() && mesh_.marked_count > 0; ++v) {
            if (!is_single_mark(v)) continue;
            list[at] = {HMF_SINGULAR_VERTEX, 0, v, 1, {0, 0, 0}};
            places_.of_vertex(indices_.internal(v), list[at++].position);
        }
        for (uint32_t k = 0; k < at; ++k)
            for (double& x : list[k].position) x /= h_.scale;
        return true;
    }

    const Mesh& mesh_;
    const hmf_hierarchy& h_;
    size_t level_;
    const Indices& indices_;
    Places places_;
    Call& call_;
    Array<uint32_t> place_; // per cluster: in the list
    Array<uint32_t> side_;  // a half-edge of each triangle
};

} // namespace

hmf_status list_singularities(State& state, Call& call, hmf_singularity_set** out) {
    Indices indices;
    if (indices.count(state, call)) return call.status();
    if (!call.tick(0.6)) return call.was_cancelled();
    return Lister(state, indices, call).run(out);
}

} // namespace hmf
