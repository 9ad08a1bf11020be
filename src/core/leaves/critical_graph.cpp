// Sectors, boundary leaves and saddle connections; see critical_graph.hpp.
#include "critical_graph.hpp"

#include "../base/heap_sort.hpp"

#include <algorithm>

namespace hmf {

namespace {

// In place of an index: the cluster is on the list.
constexpr int32_t LISTED = INT32_MIN;

} // namespace

Done CriticalGraph::start(const Foliation& f, Memory& memory) {
    memory_ = &memory;
    zeros.start(memory);
    sectors.start(memory);
    arcs.start(memory);
    boundaries.start(memory);
    crossings.start(memory);
    circle_.start(memory);
    // A boundary leaf of a harmonic foliation crosses about as many edges as a shortest loop. Integers that belong to
    // no such class can make it longer than any memory.
    crossing_limit_ = 64 * uint64_t{f.mesh.edge_count} + (uint64_t{1} << 20);
    return at_vertex.start(memory) && at_tripod_.start(memory);
}

hmf_status CriticalGraph::build_sectors(Foliation& f, const uint32_t* vertex_order, const uint32_t* face_order,
                                        Call& call) {
    if (!start(f, call.memory)) return call.out_of_memory();
    if (!call.tick(0)) return call.was_cancelled();
    return find_zeros(f, vertex_order, face_order, call);
}

hmf_status CriticalGraph::build(Foliation& f, const uint32_t* vertex_order, const uint32_t* face_order, Call& call) {
    if (build_sectors(f, vertex_order, face_order, call)) return call.status();
    return trace(f, call);
}

hmf_status CriticalGraph::build(Foliation& f, const ZeroList& known, Call& call) {
    if (!start(f, call.memory)) return call.out_of_memory();
    crossing_limit_ = 4 * uint64_t{f.mesh.edge_count} + (uint64_t{1} << 18);
    const uint32_t before = f.epoch;
    for (const uint32_t v : known.vertices) {
        if (f.stamp[v] > before) continue; // its cluster has been looked at
        const Cluster cluster = explore_cluster(f, v);
        const int64_t index = 2 * cluster.euler - static_cast<int64_t>(cluster.closed_corners);
        if (index != 0 && !add_zero_at(f, v, static_cast<int32_t>(index), cluster.euler)) return call.out_of_memory();
    }
    for (const uint32_t h : known.tripods) {
        const uint32_t n = f.mesh.next[h], p = f.mesh.next[n];
        if (f.corner2(h) > 0 && f.corner2(n) > 0 && f.corner2(p) > 0 && !add_tripod(f, h, -1))
            return call.out_of_memory();
    }
    return trace(f, call);
}

// The cluster of the vertex is f.members.
Done CriticalGraph::add_zero_at(Foliation& f, uint32_t vertex, int32_t index, int64_t euler) {
    bool done = false;
    if (division.divide && !division.divide(division.user, *this, f, index, euler, done)) return false;
    if (done) return true;
    const uint32_t zero = static_cast<uint32_t>(zeros.size());
    if (!zeros.push({false, vertex, index, euler})) return false;
    for (const uint32_t u : f.members)
        if (!add_sectors_of_vertex(f, zero, u)) return false;
    return true;
}

Done CriticalGraph::add_tripod(const Foliation& f, uint32_t half_edge, int32_t index) {
    const uint32_t zero = static_cast<uint32_t>(zeros.size());
    return zeros.push({true, half_edge, index, 1}) && add_sectors_of_tripod(f, zero, half_edge);
}

hmf_status CriticalGraph::trace(const Foliation& f, Call& call) {
    for (uint32_t s = 0; s < sectors.size(); ++s) {
        if (sectors[s].boundary != NONE) continue;
        const uint32_t h = sectors[s].last;
        const Crossing first =
            zeros[sectors[s].zero].tripod ? Crossing{h, branch(f, h) - 1} : Crossing{twin(h), width(f, h) - 1};
        if (trace_boundary(f, first, call)) return call.status();
    }
    if (zeros.empty()) {
        uint32_t widest = closed_leaf == NONE ? 0 : closed_leaf;
        for (uint32_t e = 1; closed_leaf == NONE && e < f.mesh.edge_count; ++e)
            if (f.value[e] > f.value[widest]) widest = e;
        const int64_t middle = f.value[widest] / 2 * 2;
        if (trace_boundary(f, {2 * widest, middle - 1}, call)
            || trace_boundary(f, reversed(f, {2 * widest, middle + 1}), call))
            return call.status();
    }
    if (pair_arcs(call)) return call.status();
    if (!call.tick(0)) return call.was_cancelled();
    return sort_marks(f, call.memory) ? HMF_OK : call.out_of_memory();
}

hmf_status CriticalGraph::find_zeros(Foliation& f, const uint32_t* vertex_order, const uint32_t* face_order,
                                     Call& call) {
    const Mesh& mesh = f.mesh;
    Array<int32_t> at_vertex, at_face;
    Array<uint32_t> cluster, side_of_face;
    if (!at_vertex.allocate(call.memory, mesh.vertex_count) || !at_face.allocate(call.memory, mesh.face_count)
        || !cluster.allocate(call.memory, mesh.vertex_count) || !side_of_face.allocate(call.memory, mesh.face_count))
        return call.out_of_memory();
    count_singularities(f, {at_vertex.data(), cluster.data(), nullptr, at_face.data()}, &call);
    if (!call.tick(0)) return call.was_cancelled();
    for (uint32_t i = 0; i < mesh.vertex_count; ++i) {
        const uint32_t v = vertex_order ? vertex_order[i] : i, lowest = cluster[v];
        const int32_t index = at_vertex[lowest];
        if (index == 0 || index == LISTED) continue;
        at_vertex[lowest] = LISTED;
        const int64_t euler = explore_cluster(f, v).euler;
        if (!add_zero_at(f, v, index, euler)) return call.out_of_memory();
    }
    if (!call.tick(0)) return call.was_cancelled();
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) side_of_face[mesh.face[h]] = h;
    for (uint32_t i = 0; i < mesh.face_count; ++i) {
        const uint32_t t = face_order ? face_order[i] : i;
        if (at_face[t] == 0) continue;
        if (!add_tripod(f, side_of_face[t], at_face[t])) return call.out_of_memory();
    }
    return mesh.marked_count > 0 ? find_marked(f, vertex_order, at_vertex.data(), cluster.data(), call) : HMF_OK;
}

// Marked vertices whose cluster has index 0: one with one closed corner, or two without any.
hmf_status CriticalGraph::find_marked(Foliation& f, const uint32_t* vertex_order, const int32_t* at_vertex,
                                      const uint32_t* cluster, Call& call) {
    const size_t first = zeros.size();
    for (uint32_t i = 0; i < f.mesh.vertex_count; ++i) {
        const uint32_t v = vertex_order ? vertex_order[i] : i;
        if (f.mesh.is_marked(v) && at_vertex[cluster[v]] == 0 && !zeros.push({false, v, 0, 1}))
            return call.out_of_memory();
    }
    const size_t end = zeros.size();
    for (size_t z = first; z < end; ++z) {
        const uint32_t v = zeros[z].element;
        size_t other = first;
        while (other < end && (other == z || cluster[zeros[other].element] != cluster[v])) ++other;
        if (other < z) continue; // has been with the other one
        bool done = false;
        if (other < end && !add_sectors_of_pair(f, static_cast<uint32_t>(z), static_cast<uint32_t>(other), done))
            return call.out_of_memory();
        if (done) continue;
        explore_cluster(f, v);
        for (uint32_t u : f.members)
            if (!add_sectors_of_vertex(f, static_cast<uint32_t>(z), u)) return call.out_of_memory();
    }
    return HMF_OK;
}

// The circle around a cluster with two marked vertices: a sector at each, if both
// lie on it.  Else it is not done, and the circle is one sector without prong.
Done CriticalGraph::add_sectors_of_pair(const Foliation& f, uint32_t zero, uint32_t other_zero, bool& done) {
    const uint32_t ends[2] = {zeros[zero].element, zeros[other_zero].element};
    uint32_t from[2] = {NONE, NONE};
    for (int k = 0; k < 2; ++k)
        for (const uint32_t h : f.mesh.around(ends[k])) // the first one behind a zero edge
            if (f.at(h) > 0 && (from[k] == NONE || f.at(f.mesh.rotate_cw(h)) == 0)) from[k] = h;
    const uint32_t before = static_cast<uint32_t>(sectors.size());
    if (from[0] == NONE || from[1] == NONE) return true;
    done = true;
    const auto set_between = [&](uint32_t g, uint32_t, bool) { return at_vertex.set(g, BETWEEN); };
    if (!for_circle(f, from[0], set_between)) return false;
    for (uint32_t k = 0; k < 2; ++k) {
        const uint32_t s = before + k;
        if (!sectors.push({k == 0 ? zero : other_zero, s, s, NONE, NONE, NONE})) return false;
        uint32_t g = from[k];
        do {
            if (!at_vertex.set(g, s)) return false;
            sectors[s].last = g;
            const uint32_t ahead = f.mesh.rotate_ccw(g);
            g = f.at(ahead) > 0 ? ahead : NONE;
        } while (g != NONE && g != from[k]);
    }
    return true;
}

// The circles of the cluster's boundary on which half-edges of the vertex lie.
Done CriticalGraph::add_sectors_of_vertex(const Foliation& f, uint32_t zero, uint32_t vertex) {
    for (const uint32_t h : f.mesh.around(vertex))
        if (f.at(h) > 0 && at_vertex.find(h) == NONE && !add_sectors_of_circle(f, zero, h)) return false;
    return true;
}

// The circle that the half-edge lies on.
Done CriticalGraph::add_sectors_of_circle(const Foliation& f, uint32_t zero, uint32_t h) {
    circle_.clear();
    uint32_t count = 0;
    size_t start = 0; // behind a closed corner
    const auto add = [&](uint32_t g, uint32_t, bool closed) -> Done {
        if (!circle_.push(g)) return false;
        if (closed) {
            ++count;
            start = circle_.size();
        }
        return true;
    };
    if (!for_circle(f, h, add)) return false;
    const uint32_t before = static_cast<uint32_t>(sectors.size()), n = std::max(count, 1u);
    for (uint32_t s = 0; s < n; ++s)
        if (!sectors.push({zero, before + (s + 1) % n, before + (s + n - 1) % n, NONE, NONE, NONE})) return false;
    uint32_t s = before;
    for (size_t i = 0; i < circle_.size(); ++i) {
        const uint32_t g = circle_[(start + i) % circle_.size()];
        if (!at_vertex.set(g, s)) return false;
        sectors[s].last = g;
        bool closed = false;
        next_round(f, g, closed);
        if (closed) ++s;
    }
    return true;
}

// Seen from the middle, the sectors are the corners, counter-clockwise; the
// prong of corner i runs over the side i -> j.
Done CriticalGraph::add_sectors_of_tripod(const Foliation& f, uint32_t zero, uint32_t h) {
    const uint32_t before = static_cast<uint32_t>(sectors.size());
    for (uint32_t s = 0; s < 3; ++s, h = f.mesh.next[h]) {
        if (!at_tripod_.set(h, before + s)
            || !sectors.push({zero, before + (s + 1) % 3, before + (s + 2) % 3, h, NONE, NONE}))
            return false;
    }
    return true;
}

uint32_t CriticalGraph::sector_at(const Foliation& f, const Crossing& c) const {
    const uint32_t h = c.half_edge;
    if (c.at == branch(f, h) - 1) {
        const uint32_t s = at_tripod_.find(h);
        if (s != NONE) return s;
    }
    if (c.at == width(f, h) - 1) {
        const uint32_t s = at_vertex.find(twin(h));
        if (s < BETWEEN) return s;
    }
    return NONE;
}

// start lies at the end of a sector, or in none.
hmf_status CriticalGraph::trace_boundary(const Foliation& f, Crossing start, Call& call) {
    const uint32_t boundary = static_cast<uint32_t>(boundaries.size());
    Boundary b{crossings.size(), 0, static_cast<uint32_t>(arcs.size()), 0};
    uint32_t inside = sector_at(f, start); // sector of the crossing before
    uint32_t left = inside;                // sector passed last
    uint64_t left_at = crossings.size();
    if (inside != NONE) sectors[inside].boundary = boundary;
    if (!crossings.push(start)) return call.out_of_memory();
    for (Crossing c = follow(f, start);; c = follow(f, c)) {
        if (crossings.size() >= crossing_limit_)
            return call.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0,
                             "A leaf crosses more than %llu edges. Pass values as the library returned them for loops.",
                             static_cast<unsigned long long>(crossing_limit_));
        const uint64_t index = crossings.size();
        if (!crossings.push(c)) return call.out_of_memory();
        if (index % 65536 == 0 && !call.tick(0)) return call.was_cancelled();
        const uint32_t s = sector_at(f, c);
        if (s != NONE && s != inside) {
            if (left == NONE)
                return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                                 "A leaf of a surface without zeros passes one. Please report it.");
            sectors[left].arc = static_cast<uint32_t>(arcs.size());
            if (!arcs.push({left, s, left_at, index, NONE})) return call.out_of_memory();
            sectors[s].boundary = boundary;
        }
        if (s != NONE) {
            left = s;
            left_at = index;
        }
        inside = s;
        if (c == start) break;
    }
    b.end = crossings.size();
    b.arcs_end = static_cast<uint32_t>(arcs.size());
    return boundaries.push(b) ? HMF_OK : call.out_of_memory();
}

hmf_status CriticalGraph::pair_arcs(Call& call) {
    for (uint32_t a = 0; a < arcs.size(); ++a) {
        const uint32_t other = sectors[sectors[arcs[a].to].previous].arc;
        // Both sides of an arc join the same prongs.
        if (other == NONE || arcs[other].to != sectors[arcs[a].from].next)
            return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, a,
                             "The sides of a critical leaf do not match. Please report it.");
        arcs[a].twin = other;
    }
    return HMF_OK;
}

Done CriticalGraph::sort_marks(const Foliation& f, Memory& memory) {
    mark_offset_.start(memory);
    if (!marked_.start(memory) || !marks.allocate(memory, crossings.size() - boundaries.size())) return false;
    // How many on each edge, from the second entry on.
    if (!mark_offset_.push(0)) return false;
    for (const Boundary& b : boundaries)
        for (uint64_t i = b.begin; i + 1 < b.end; ++i) {
            const uint32_t e = edge_of(crossings[i].half_edge);
            uint32_t k = marked_.find(e);
            if (k == SparseMap::ABSENT) {
                k = static_cast<uint32_t>(mark_offset_.size() - 1);
                if (!marked_.set(e, k) || !mark_offset_.push(0)) return false;
            }
            ++mark_offset_[k + 1];
        }
    const size_t n = mark_offset_.size() - 1;
    for (size_t k = 0; k < n; ++k) mark_offset_[k + 1] += mark_offset_[k];
    Array<uint32_t> free;
    if (!free.allocate(memory, n)) return false;
    for (size_t k = 0; k < n; ++k) free[k] = mark_offset_[k];
    for (uint32_t k = 0; k < boundaries.size(); ++k)
        for (uint64_t i = boundaries[k].begin; i + 1 < boundaries[k].end; ++i) {
            const Crossing& c = crossings[i];
            const bool backwards = c.half_edge & 1u; // then the right side is ahead
            marks[free[marked_.find(edge_of(c.half_edge))]++] = {backwards ? width(f, c.half_edge) - c.at : c.at, k,
                                                                 backwards};
        }
    // In a cylinder one unit high both boundary leaves are the same: first the lower one.
    const auto before = [](const LeafMark& a, const LeafMark& b) {
        return a.at != b.at ? a.at < b.at : a.forward && !b.forward;
    };
    for (size_t k = 0; k < n; ++k)
        if (mark_offset_[k + 1] - mark_offset_[k] > 1)
            heap_sort(&marks[mark_offset_[k]], mark_offset_[k + 1] - mark_offset_[k], before);
    return true;
}

bool CriticalGraph::mark_ahead(const Foliation& f, uint32_t h, int64_t at, LeafMark& found) const {
    uint32_t begin = 0, end = 0;
    marks_on(edge_of(h), begin, end);
    const bool backwards = h & 1u;
    const int64_t place = backwards ? width(f, h) - at : at; // along 2e
    const auto is_before = [=](const LeafMark& mark) { return backwards ? mark.at < place : mark.at <= place; };
    const LeafMark *const first = marks.data() + begin, *const last = marks.data() + end;
    const LeafMark* const beyond = std::partition_point(first, last, is_before);
    if (beyond == (backwards ? first : last)) return false;
    found = backwards ? beyond[-1] : *beyond;
    if (backwards) {
        found.at = width(f, h) - found.at;
        found.forward = !found.forward;
    }
    return true;
}

} // namespace hmf
