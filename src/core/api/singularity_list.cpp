#include "singularity_list.hpp"

#include "../hierarchy/caller_numbers.hpp"

#include <cmath>

namespace hmf {

namespace {

// Lists them in the order of hmf_singularity_set.
class Lister {
public:
    Lister(State& state, Call& call) :
        f_(state.foliation), mesh_(f_.mesh), h_(*state.hierarchy), level_(state.level),
        position_(h_.levels[level_].position), call_(call) {}

    hmf_status run(hmf_singularity_set** out) {
        if (count_indices()) return call_.status();
        // Of a double only what touches its front.
        if (!call_.tick(0.6) || !place_.allocate_filled(call_.memory, mesh_.vertex_count, NONE)
            || !side_of_triangles(h_, level_, side_, call_) || !call_.tick(0.7))
            return call_.stopped();
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
    hmf_status count_indices() {
        const uint32_t n = mesh_.vertex_count, m = mesh_.face_count;
        if (!at_vertex_.allocate(call_.memory, n) || !at_face_.allocate(call_.memory, m)
            || !cluster_.allocate(call_.memory, n) || !size_.allocate(call_.memory, n)
            || !lowest_.allocate_filled(call_.memory, n, NONE) || !face_.allocate(call_.memory, m))
            return call_.out_of_memory();
        if (!call_.tick(0.3)) return call_.was_cancelled();
        count_singularities(f_, {at_vertex_.data(), cluster_.data(), size_.data(), at_face_.data()}, &call_);
        if (!call_.tick(0.5)) return call_.was_cancelled();
        // From internal numbers to the caller's: the lowest vertex of a cluster may be another one.
        for (uint32_t v = n; v-- > 0;) lowest_[cluster_[internal(v)]] = v;
        for (uint32_t t = 0; t < m; ++t) face_[t] = level_ == 0 ? internal_face(h_, t) : t;
        return HMF_OK;
    }

    uint32_t vertices() const { return h_.shown_vertices(level_); }
    uint32_t triangles() const { return h_.shown_triangles(level_); }
    uint32_t internal(uint32_t v) const { return level_ == 0 ? h_.vertex_internal[v] : v; }
    const double* at(uint32_t internal) const { return position_ + size_t{3} * internal; }
    // Index of the cluster whose lowest vertex is v, else 0.
    int32_t index_at(uint32_t v) const {
        const uint32_t c = cluster_[internal(v)];
        return lowest_[c] == v ? at_vertex_[c] : 0;
    }
    int32_t index_of_triangle(uint32_t t) const { return at_face_[face_[t]]; }
    // A marked vertex that is in no zero.
    bool is_single_mark(uint32_t v) const {
        return mesh_.is_marked(internal(v)) && at_vertex_[cluster_[internal(v)]] == 0;
    }

    uint64_t count() const {
        uint64_t found = 0;
        for (uint32_t v = 0; v < vertices(); ++v) found += index_at(v) != 0;
        for (uint32_t t = 0; t < triangles(); ++t) found += index_of_triangle(t) != 0;
        for (uint32_t v = 0; v < vertices() && mesh_.marked_count > 0; ++v) found += is_single_mark(v);
        return found;
    }

    Done fill_in(hmf_singularity_set& made) {
        hmf_singularity* const list = fill(made.list);
        uint32_t end = 0;
        for (uint32_t v = 0; v < vertices(); ++v) {
            const uint32_t c = cluster_[internal(v)];
            const int32_t index = fill(made.vertex_index)[v] = index_at(v);
            fill(made.vertex_cluster)[v] = lowest_[c];
            if (index == 0) continue;
            const bool single = size_[c] < 2;
            list[end] = {single ? HMF_SINGULAR_VERTEX : HMF_SINGULAR_CLUSTER, index, v, size_[c], {0, 0, 0}};
            if (single) std::memcpy(list[end].position, at(internal(v)), 3 * sizeof(double));
            place_[c] = end++;
        }
        find_means(list);
        if (h_.is_double() && !move_to_vertices(list, end)) return false;
        for (uint32_t t = 0; t < triangles(); ++t) {
            const int32_t index = fill(made.triangle_index)[t] = index_of_triangle(t);
            if (index == 0) continue;
            const uint32_t h = side_[t];
            const double *const a = at(mesh_.origin[h]), *const b = at(mesh_.target(h)),
                                *const c = at(mesh_.origin[mesh_.prev(h)]);
            hmf_singularity& s = list[end++] = {HMF_SINGULAR_TRIANGLE, index, t, 1, {0, 0, 0}};
            for (size_t axis = 0; axis < 3; ++axis) s.position[axis] = (a[axis] + b[axis] + c[axis]) / 3;
        }
        for (uint32_t v = 0; v < vertices() && mesh_.marked_count > 0; ++v) {
            if (!is_single_mark(v)) continue;
            list[end] = {HMF_SINGULAR_VERTEX, 0, v, 1, {0, 0, 0}};
            std::memcpy(list[end++].position, at(internal(v)), 3 * sizeof(double));
        }
        for (uint32_t k = 0; k < end; ++k)
            for (double& x : list[k].position) x /= h_.scale;
        return true;
    }

    // A cluster lies at the mean of its vertices, all in one pass.
    void find_means(hmf_singularity* list) const {
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
            const uint32_t c = cluster_[v];
            if (place_[c] == NONE || size_[c] < 2) continue;
            hmf_singularity& s = list[place_[c]];
            for (size_t axis = 0; axis < 3; ++axis) s.position[axis] += at(v)[axis] / s.size;
        }
    }
    // Or, where there is a boundary, which it may go along, at the vertex nearest to that.  count: entries of the list.
    Done move_to_vertices(hmf_singularity* list, size_t count) const {
        struct Nearest {
            double square;
            uint32_t vertex;
        };
        Array<Nearest> nearest;
        if (!nearest.allocate_filled(call_.memory, count, Nearest{HUGE_VAL, NONE})) return false;
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
            const uint32_t c = cluster_[v];
            if (place_[c] == NONE || size_[c] < 2) continue;
            double square = 0;
            for (size_t axis = 0; axis < 3; ++axis) {
                const double x = at(v)[axis] - list[place_[c]].position[axis];
                square += x * x;
            }
            if (square < nearest[place_[c]].square) nearest[place_[c]] = {square, v};
        }
        for (size_t k = 0; k < count; ++k)
            if (nearest[k].vertex != NONE) std::memcpy(list[k].position, at(nearest[k].vertex), 3 * sizeof(double));
        return true;
    }

    Foliation& f_;
    const Mesh& mesh_;
    const hmf_hierarchy& h_;
    const size_t level_;
    const double* const position_;
    Call& call_;
    Array<int32_t> at_vertex_, at_face_;             // indices by internal numbers
    Array<uint32_t> cluster_, size_, lowest_, face_; // lowest_: of each cluster by the caller's numbers
    Array<uint32_t> place_;                          // per cluster: in the list
    Array<uint32_t> side_;                           // a half-edge of each triangle
};

} // namespace

hmf_status list_singularities(State& state, Call& call, hmf_singularity_set** out) {
    return Lister(state, call).run(out);
}

} // namespace hmf
