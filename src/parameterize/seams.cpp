// The cut graph by tree and cotree, and the layout along the cotree.
//
// 1. A forest of shortest paths from the cones to all vertices.
// 2. A spanning tree of the faces that crosses no edge of the forest and
//    prefers edges that are far from the cones.
// 3. 2 * genus + cones - 1 edges are in neither.  Each of them, with its two
//    paths back to the cones, is a seam.  The rest of the forest heals again:
//    at its vertices the forms are closed, so both sides agree.
#include "seams.hpp"

#include "../base/disjoint_sets.hpp"
#include "../base/nearest_first.hpp"
#include "../base/sort_keys.hpp"

#include <cmath>

namespace hmf {

namespace {

constexpr uint32_t STRIDE = 16384; // steps between two calls of the progress function

// Dijkstra from all cones at once; parent[v]: half-edge out of v to its parent.
class Forest {
public:
    Array<double> distance;
    Array<uint32_t> parent;

    Done build(const Mesh& mesh, const double* length, const uint8_t* is_cone, Call& call) {
        Memory& memory = call.memory;
        heap_.start(memory);
        const uint32_t n = mesh.vertex_count;
        if (!distance.allocate_filled(memory, n, HUGE_VAL) || !parent.allocate_filled(memory, n, NONE)
            || !heap_.reserve(n))
            return false;
        bool any = false;
        for (uint32_t v = 0; v < n; ++v)
            if (is_cone[v]) {
                any = true;
                distance[v] = 0;
                if (!heap_.push({0, v})) return false;
            }
        if (!any) {
            distance[0] = 0;
            if (!heap_.push({0, 0})) return false;
        }
        uint32_t steps = 0;
        while (!heap_.empty()) {
            if (++steps % STRIDE == 0 && !call.tick(0)) return false;
            const NearestFirst::Entry entry = heap_.pop();
            if (entry.distance > distance[entry.item]) continue;
            for (const uint32_t h : mesh.around(entry.item)) {
                const uint32_t w = mesh.target(h);
                const double d = entry.distance + length[edge_of(h)];
                if (d < distance[w]) {
                    distance[w] = d;
                    parent[w] = twin(h);
                    if (!heap_.push({d, w})) return false;
                }
            }
        }
        return true;
    }

private:
    NearestFirst heap_;
};

} // namespace

Done cut_through_cones(const Mesh& mesh, const double* length, const uint8_t* is_cone, Seams& seams, Call& call) {
    Memory& memory = call.memory;
    const uint32_t n = mesh.vertex_count, m = mesh.edge_count;
    if (!seams.on.allocate_filled(memory, m, 1) || !seams.tree.allocate_filled(memory, m, 0)) return false;
    KeyedItems edges;
    Array<uint32_t> component;
    {
        Forest forest;
        if (!forest.build(mesh, length, is_cone, call) || !call.tick(0)) return false;
        for (uint32_t v = 0; v < n; ++v)
            if (forest.parent[v] != NONE) seams.tree[edge_of(forest.parent[v])] = 2; // not to be crossed
        uint32_t free_edges = 0;
        for (const uint8_t t : seams.tree) free_edges += t == 0;
        if (!edges.allocate(memory, free_edges)) return false;
        uint32_t at = 0;
        for (uint32_t e = 0; e < m; ++e) {
            if (seams.tree[e] == 2) continue;
            edges.item[at] = e;
            edges.key[at++] =
                key_of(forest.distance[mesh.origin[2 * e]] + forest.distance[mesh.origin[2 * e + 1]] + length[e]);
        }
    }
    if (!call.tick(0)) return false;
    edges.sort_falling();
    if (!call.tick(0)) return false;
    if (!component.allocate(memory, mesh.face_count)) return false;
    for (uint32_t f = 0; f < mesh.face_count; ++f) component[f] = f;
    uint32_t steps = 0;
    for (const uint32_t e : edges.item) {
        if (++steps % STRIDE == 0 && !call.tick(0)) return false;
        if (unite(component.data(), mesh.face[2 * e], mesh.face[2 * e + 1])) seams.tree[e] = 1;
    }
    for (uint32_t e = 0; e < m; ++e) {
        seams.on[e] = seams.tree[e] != 1;
        seams.tree[e] = seams.tree[e] == 1;
    }
    // Ends that are no cones heal.
    Array<uint32_t> degree, queue;
    if (!call.tick(0)) return false;
    if (!degree.allocate_filled(memory, n, 0) || !queue.allocate(memory, n)) return false;
    for (uint32_t h = 0; h < 2 * m; ++h) degree[mesh.origin[h]] += seams.on[edge_of(h)];
    if (!call.tick(0)) return false;
    uint32_t size = 0;
    for (uint32_t v = 0; v < n; ++v)
        if (degree[v] == 1 && !is_cone[v]) queue[size++] = v;
    for (uint32_t i = 0; i < size; ++i) {
        if (i % STRIDE == 0 && !call.tick(0)) return false;
        uint32_t h = NONE;
        for (const uint32_t g : mesh.around(queue[i]))
            if (h == NONE && seams.on[edge_of(g)]) h = g;
        if (h == NONE) continue; // the other end of its last edge was first
        seams.on[edge_of(h)] = 0;
        const uint32_t w = mesh.target(h);
        if (--degree[w] == 1 && !is_cone[w]) queue[size++] = w;
    }
    if (!call.tick(0)) return false;
    seams.edge_count = 0;
    seams.length = 0;
    for (uint32_t e = 0; e < m; ++e)
        if (seams.on[e]) {
            ++seams.edge_count;
            seams.length += length[e];
        }
    return true;
}

Done Layout::build(const Mesh& mesh, const SignBundle& bundle, const TwistedForm& du, const TwistedForm& dv,
                   uint32_t first_half_edge, const Seams& seams, Call& call) {
    Memory& memory = call.memory;
    const size_t sides = size_t{2} * mesh.edge_count;
    Array<uint32_t> queue; // of half-edges; their faces are laid out
    if (!u.allocate(memory, sides) || !v.allocate(memory, sides) || !chart.allocate_filled(memory, mesh.face_count, 0)
        || !queue.allocate(memory, mesh.face_count) || !call.tick(0))
        return false;
    // From the value at h round its face.
    const auto lay = [&](uint32_t h) {
        const int8_t s = chart[mesh.face[h]];
        const uint32_t n = mesh.next[h], p = mesh.next[n];
        u[n] = u[h] + s * du.at(bundle, h);
        v[n] = v[h] + s * dv.at(bundle, h);
        u[p] = u[n] + s * du.at(bundle, n);
        v[p] = v[n] + s * dv.at(bundle, n);
    };
    constexpr int64_t limit = int64_t{1} << 52;
    chart[mesh.face[first_half_edge]] = 1;
    u[first_half_edge] = v[first_half_edge] = 0;
    lay(first_half_edge);
    uint32_t size = 0;
    queue[size++] = first_half_edge;
    for (uint32_t i = 0; i < size; ++i) {
        if (i % STRIDE == 0 && !call.tick(0)) return false;
        uint32_t h = queue[i];
        for (uint32_t turn = 0; turn < 3; ++turn, h = mesh.next[h]) {
            const uint32_t t = twin(h), e = edge_of(h), face = mesh.face[t];
            if (!seams.tree[e] || chart[face] != 0) continue;
            chart[face] = static_cast<int8_t>(chart[mesh.face[h]] * bundle.turn[e]);
            u[t] = u[mesh.next[h]];
            v[t] = v[mesh.next[h]];
            // Too far from 0 for an exact double: a seam with a translation more.
            u[t] += u[t] > limit ? -limit : u[t] < -limit ? limit : 0;
            v[t] += v[t] > limit ? -limit : v[t] < -limit ? limit : 0;
            lay(t);
            queue[size++] = t;
        }
    }
    return true;
}

} // namespace hmf
