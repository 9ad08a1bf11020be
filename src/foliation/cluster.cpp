// Clusters of zero edges: search, index, and the count of all singularities
// ([W] 3.2, Eq. 1 and 3; see foliation.hpp for the form used here).
#include "foliation.hpp"

namespace hmf {

Done Foliation::allocate_scratch(uint32_t vertex_count, Memory& memory) {
    epoch = 0;
    members.start(memory);
    pushed.start(memory);
    return stamp.allocate_filled(memory, vertex_count, 0) && members.reserve(vertex_count)
        && pushed.reserve(vertex_count);
}

Cluster explore_cluster(Foliation& f, uint32_t vertex, const ClusterSearch& search) {
    const Mesh& mesh = f.mesh;
    const uint32_t without = search.removed_edge, blocked = search.removed_vertex;
    Cluster result;
    f.members.clear();
    f.members.add(vertex);
    const uint32_t mark = ++f.epoch;
    f.stamp[vertex] = mark;
    // Zero edges are met from both ends, zero triangles from three sides.
    uint64_t zero_half_edges = 0, zero_sides = 0;
    for (size_t at = 0; at < f.members.size(); ++at) {
        const uint32_t v = f.members[at];
        if (v == search.target) result.reached = true;
        result.marked += mesh.is_marked(v);
        for (const uint32_t h : mesh.around(v)) {
            const uint32_t ahead = mesh.rotate_ccw(h);
            const uint32_t w = mesh.target(h);
            if (f.at(h) == 0 && edge_of(h) != without && w != blocked) {
                ++zero_half_edges;
                if (mesh.target(ahead) != blocked && f.at(mesh.next[h]) == 0 && edge_of(mesh.next[h]) != without
                    && edge_of(ahead) != without)
                    ++zero_sides;
                if (f.stamp[w] != mark) {
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

} // namespace

SingularityCount count_singularities(Foliation& f, const SingularityMaps& maps) {
    const Mesh& mesh = f.mesh;
    SingularityCount count;
    // A face is visited from the lowest of its three half-edges.
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        const uint32_t n = mesh.next[h], p = mesh.next[n];
        if (h > n || h > p) continue;
        const int64_t a = f.corner2(h), b = f.corner2(n), c = f.corner2(p);
        if (a < 0 || b < 0 || c < 0 || ((a | b | c) & 1) || f.at(h) < 0 || f.at(n) < 0 || f.at(p) < 0)
            ++count.broken_triangles;
        const bool tripod = a > 0 && b > 0 && c > 0;
        if (tripod) {
            ++count.zeros;
            --count.index_sum;
        }
        if (maps.face_index) maps.face_index[mesh.face[h]] = tripod ? -1 : 0;
    }
    // Clusters are found from their lowest vertex; stamps of this call stay.
    const uint32_t before = f.epoch;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        if (f.stamp[v] > before) {
            if (maps.vertex_index) maps.vertex_index[v] = 0;
            if (maps.cluster_size) maps.cluster_size[v] = 0;
            continue;
        }
        // Nearly all vertices are regular and have no zero edge.
        if (is_plain_and_regular(f, v)) {
            if (maps.vertex_index) maps.vertex_index[v] = 0;
            if (maps.cluster_size) maps.cluster_size[v] = 1;
            if (maps.vertex_cluster) maps.vertex_cluster[v] = v;
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
    return count;
}

} // namespace hmf
