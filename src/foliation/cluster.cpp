// Clusters of zero edges: search, index, and the count of all singularities
// ([W] 3.2, Eq. 1 and 3; see foliation.hpp for the form used here).
#include "foliation.hpp"

namespace hmf {

Cluster explore_cluster(Foliation& f, uint32_t vertex, uint32_t without, uint32_t blocked, uint32_t target,
                        uint32_t closed_limit, uint32_t budget) {
    const Mesh& mesh = f.mesh;
    Cluster result;
    f.members.clear();
    if (!f.members.push(vertex)) {
        f.out_of_memory = true;
        return result;
    }
    const uint32_t mark = ++f.epoch;
    f.stamp[vertex] = mark;
    // Zero edges are met from both ends, zero triangles from three sides.
    uint64_t zero_half_edges = 0, zero_sides = 0;
    for (size_t at = 0; at < f.members.size(); ++at) {
        const uint32_t v = f.members[at];
        if (v == target) result.reached = true;
        result.marked += mesh.is_marked(v);
        const uint32_t first = mesh.out[v];
        uint32_t h = first;
        do {
            const uint32_t ahead = mesh.rotate_ccw(h);
            const uint32_t w = mesh.target(h);
            if (f.at(h) == 0 && edge_of(h) != without && w != blocked) {
                ++zero_half_edges;
                if (mesh.target(ahead) != blocked && f.at(mesh.next[h]) == 0 && edge_of(mesh.next[h]) != without
                    && edge_of(ahead) != without)
                    ++zero_sides;
                if (f.stamp[w] != mark) {
                    f.stamp[w] = mark;
                    if (!f.members.push(w)) {
                        f.out_of_memory = true;
                        return result;
                    }
                }
            } else if (f.at(h) != 0 && f.at(ahead) != 0 && f.corner2(h) == 0) {
                if (++result.closed_corners == closed_limit) return result;
            }
            h = ahead;
        } while (h != first);
        if (budget && f.members.size() > budget) return result;
    }
    result.euler = static_cast<int64_t>(f.members.size()) - static_cast<int64_t>(zero_half_edges / 2)
                 + static_cast<int64_t>(zero_sides / 3);
    result.complete = true;
    return result;
}

namespace {

// A vertex without zero edges and with two closed corners.
bool is_plain_and_regular(const Foliation& f, uint32_t v) {
    const uint32_t first = f.mesh.out[v];
    uint32_t closed = 0, h = first;
    do {
        const uint32_t across = f.mesh.next[h], last = f.mesh.next[across];
        if (f.at(h) == 0) return false;
        closed += f.at(h) + f.at(last) == f.at(across);
        h = twin(last);
    } while (h != first);
    return closed == 2 && !f.mesh.is_marked(v);
}

} // namespace

SingularityCount count_singularities(Foliation& f, int32_t* vertex_index, uint32_t* vertex_cluster,
                                     uint32_t* cluster_size, int32_t* face_index) {
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
        if (face_index) face_index[mesh.face[h]] = tripod ? -1 : 0;
    }
    // Clusters are found from their lowest vertex; stamps of this call stay.
    const uint32_t before = f.epoch;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        if (f.stamp[v] > before) {
            if (vertex_index) vertex_index[v] = 0;
            if (cluster_size) cluster_size[v] = 0;
            continue;
        }
        // Nearly all vertices are regular and have no zero edge.
        if (is_plain_and_regular(f, v)) {
            if (vertex_index) vertex_index[v] = 0;
            if (cluster_size) cluster_size[v] = 1;
            if (vertex_cluster) vertex_cluster[v] = v;
            continue;
        }
        const Cluster cluster = explore_cluster(f, v, NONE, NONE, NONE, 0, 0);
        if (f.out_of_memory) return count;
        const int64_t index = cluster.index();
        count.index_sum += index;
        if (index > 0) count.poles += static_cast<uint64_t>(index);
        if (index < 0) count.zeros += static_cast<uint64_t>(-index);
        if (vertex_index) vertex_index[v] = static_cast<int32_t>(index);
        if (cluster_size) cluster_size[v] = static_cast<uint32_t>(f.members.size());
        if (vertex_cluster)
            for (uint32_t u : f.members) vertex_cluster[u] = v;
    }
    return count;
}

} // namespace hmf
