// Clusters of zero edges: search, index, and the count of all singularities
// ([W] 3.2, Eq. 1 and 3; see foliation.hpp for the form used here).
#include "foliation.hpp"

namespace hmf {

Done Foliation::allocate_scratch(uint32_t vertex_count, Memory& memory) {
    epoch = 0;
    members.start(memory);
    pushed.start(memory);
    queue.start(memory);
    if (!stamps_.allocate_filled(memory, vertex_count, 0) || !members.reserve(vertex_count)
        || !pushed.reserve(vertex_count))
        return false;
    stamp = stamps_.data();
    return true;
}

Done Foliation::share(const Foliation& whole, const uint32_t* blocks, Memory& memory) {
    mesh = whole.mesh;
    value = whole.value;
    stamp = whole.stamp;
    inside = blocks;
    members.start(memory);
    pushed.start(memory);
    return members.reserve(MOST_INSIDE) && pushed.reserve(MOST_INSIDE);
}

Cluster explore_cluster(Foliation& f, uint32_t vertex, const ClusterSearch& search) {
    const Mesh& mesh = f.mesh;
    const uint32_t without = search.removed_edge, blocked = search.removed_vertex;
    Cluster result;
    f.members.clear();
    if (!f.may_look(vertex, 0)) return result;
    f.members.add(vertex);
    const uint32_t mark = ++f.epoch;
    f.stamp[vertex] = mark;
    // Zero edges are met from both ends, zero triangles from three sides.
    uint64_t zero_half_edges = 0, zero_sides = 0;
    struct Counter {
        uint64_t &total, steps = 0;
        ~Counter() { total += steps; }
    } counter{f.walked};
    for (size_t at = 0; at < f.members.size(); ++at) {
        const uint32_t v = f.members[at];
        if (v == search.target) result.reached = true;
        result.marked += mesh.is_marked(v);
        for (const uint32_t h : mesh.around(v)) {
            ++counter.steps;
            const uint32_t ahead = mesh.rotate_ccw(h);
            const uint32_t w = mesh.target(h);
            if (f.at(h) == 0 && edge_of(h) != without && w != blocked) {
                ++zero_half_edges;
                if (mesh.target(ahead) != blocked && f.at(mesh.next[h]) == 0 && edge_of(mesh.next[h]) != without
                    && edge_of(ahead) != without)
                    ++zero_sides;
                if (f.stamp[w] != mark) {
                    if (!f.may_look(w, f.members.size())) return result;
                    f.stamp[w] = mark;
                    f.members.add(w);
                }
            } else if (f.at(h) != 0 && f.at(ahead) != 0 && f.corner2(h) == 0) {
                if (++result.closed_corners == search.corner_limit) return result;
            }
        }
        if (search.budget && f.members.size() > search.budget) return result;
    }
    result.euler = static_cast<int64_t>(f.members.size()) - static_cast<int64_t>(zero_half_edges / 2)
                 + static_cast<int64_t>(zero_sides / 3);
    result.complete = true;
    return result;
}

namespace {

// A vertex without zero edges and with two closed corners.
bool is_plain_and_regular(const Foliation& f, uint32_t v) {
    uint32_t closed = 0;
    for (const uint32_t h : f.mesh.around(v)) {
        const uint32_t across = f.mesh.next[h], last = f.mesh.next[across];
        if (f.at(h) == 0) return false;
        closed += f.at(h) + f.at(last) == f.at(across);
    }
    return closed == 2 && !f.mesh.is_marked(v);
}

// Each face is visited from the lowest of its three half-edges.
SingularityCount count_tripods(const Foliation& f, int32_t* face_index, size_t begin, size_t end) {
    const Mesh& mesh = f.mesh;
    SingularityCount count;
    for (uint32_t h = static_cast<uint32_t>(begin); h < end; ++h) {
        const uint32_t n = mesh.next[h], p = mesh.next[n];
        if (h > n || h > p) continue;
        const int64_t a = f.corner2(h), b = f.corner2(n), c = f.corner2(p);
        if (a < 0 || b < 0 || c < 0 || ((a | b | c) & 1) || f.at(h) < 0 || f.at(n) < 0 || f.at(p) < 0)
            ++count.broken_triangles;
        const bool tripod = a > 0 && b > 0 && c > 0;
        count.zeros += tripod;
        count.index_sum -= tripod;
        if (face_index) face_index[mesh.face[h]] = tripod ? -1 : 0;
    }
    return count;
}

// What the maps say of the regular vertices of a block; the others are listed at
// `other`.  Returns how many.
uint32_t pass_over_regular(const Foliation& f, const SingularityMaps& maps, size_t begin, size_t end, uint32_t* other) {
    uint32_t count = 0;
    for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) {
        if (!is_plain_and_regular(f, v)) {
            other[count++] = v;
            continue;
        }
        if (maps.vertex_index) maps.vertex_index[v] = 0;
        if (maps.cluster_size) maps.cluster_size[v] = 1;
        if (maps.vertex_cluster) maps.vertex_cluster[v] = v;
    }
    return count;
}

} // namespace

SingularityCount count_singularities(Foliation& f, const SingularityMaps& maps, Call* call) {
    const Mesh& mesh = f.mesh;
    const Parallel alone;
    const Parallel& parallel = call ? call->parallel : alone;
    SingularityCount count =
        parallel.sum_blocks<SingularityCount>(size_t{2} * mesh.edge_count, [&](size_t begin, size_t end) {
            return count_tripods(f, maps.face_index, begin, end);
        });
    if (call && !call->tick(0, true)) return count;
    const size_t n = mesh.vertex_count, size = Parallel::pass_block(n);
    uint32_t* const other = f.pushed.data(); // not in use now, and as long as there are vertices
    uint32_t others[Parallel::MOST_PARTS];
    parallel.for_blocks(n, size, [&](size_t begin, size_t end) {
        others[begin / size] = pass_over_regular(f, maps, begin, end, other + begin);
    });
    // Clusters are found from their lowest vertex; stamps of this call stay.
    const uint32_t before = f.epoch;
    for (size_t k = 0; k * size < n; ++k) {
        if (call && !call->tick(0, true)) return count;
        for (uint32_t i = 0; i < others[k]; ++i) { // NOLINT(clang-analyzer-core*): each block set its number
            const uint32_t v = other[k * size + i];
            if (f.stamp[v] > before) {
                if (maps.vertex_index) maps.vertex_index[v] = 0;
                if (maps.cluster_size) maps.cluster_size[v] = 0;
                continue;
            }
            const Cluster cluster = explore_cluster(f, v);
            const int64_t index = cluster.index();
            count.index_sum += index;
            if (index > 0) count.poles += static_cast<uint64_t>(index);
            if (index < 0) count.zeros += static_cast<uint64_t>(-index);
            if (maps.vertex_index) maps.vertex_index[v] = static_cast<int32_t>(index);
            if (maps.cluster_size) maps.cluster_size[v] = static_cast<uint32_t>(f.members.size());
            if (maps.vertex_cluster)
                for (uint32_t u : f.members) maps.vertex_cluster[u] = v;
        }
    }
    return count;
}

} // namespace hmf
