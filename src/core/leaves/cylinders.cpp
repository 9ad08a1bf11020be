// Cylinders from boundary leaves: from each one a path goes straight across the
// leaves until it meets another, which bounds the same cylinder.  Along an edge
// the height above the boundary grows by exactly what one walks, at a vertex the
// path goes on into the direction ahead; so the height of the whole cylinder is
// a sum of integers, and it is the weight of the loop.
#include "cylinders.hpp"

#include "../base/heap_sort.hpp"

namespace hmf {

namespace {
constexpr uint32_t CYLINDERS_STRIDE = 65536; // elements between two reports
} // namespace

hmf_status Cylinders::build(Foliation& f, const uint32_t* vertex_order, const uint32_t* face_order, Call& call) {
    if (graph.build(f, vertex_order, face_order, call)) return call.status();
    return find_cylinders(f, call);
}

hmf_status Cylinders::build(Foliation& f, const ZeroList& known, Call& call) {
    if (graph.build(f, known, call)) return call.status();
    return find_cylinders(f, call);
}

hmf_status Cylinders::find_cylinders(Foliation& f, Call& call) {
    list.start(call.memory);
    pieces.start(call.memory);
    circle_.start(call.memory);
    const uint32_t n = static_cast<uint32_t>(graph.boundaries.size());
    if (!of_boundary.allocate_filled(call.memory, n, NONE)) return call.out_of_memory();
    for (uint32_t b = 0; b < n; ++b) {
        if (of_boundary[b] != NONE) continue;
        if (!call.tick(0)) return call.was_cancelled();
        const Crossing back = reversed(f, graph.crossings[graph.boundaries[b].begin]);
        Cylinder c{b, NONE, 0, pieces.size(), 0};
        LeafMark found;
        int64_t distance = 0;
        if (walk_across(f, back.half_edge, back.at, &pieces, found, distance, call)) return call.status();
        c.upper = found.boundary;
        // Both boundary leaves are half a unit inside.
        c.height = (distance + 2) / 2;
        c.path_end = pieces.size();
        if (found.forward || c.upper == b || of_boundary[c.upper] != NONE)
            return call.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0,
                             "The leaves do not form one cylinder for each loop. Pass values as the library returned "
                             "them for loops.");
        of_boundary[b] = of_boundary[c.upper] = static_cast<uint32_t>(list.size());
        if (!list.push(c)) return call.out_of_memory();
    }
    return HMF_OK;
}

// Where a path goes on that comes to a vertex along the twin of `back`: the
// longest half-edge on the other side of its leaf, NONE if there is none.
Done Cylinders::half_edge_ahead(Foliation& f, uint32_t back, uint32_t& best) {
    const Mesh& mesh = f.mesh;
    uint32_t closed_corners = 0;
    best = NONE;
    circle_.clear();
    uint32_t g = back;
    do {
        if (!circle_.push(g)) return false;
        if (closed_corners == 1 && (best == NONE || f.at(g) > f.at(best))) best = g;
        const uint32_t ahead = mesh.rotate_ccw(g);
        if (f.at(ahead) > 0) {
            closed_corners += f.corner2(g) == 0;
            g = ahead;
        } else g = twin(mesh.next[g]);
    } while (g != back && closed_corners < 2);
    if (best != NONE) return true;
    // A closed leaf along zero edges: its other side is another circle.
    const auto ascending = [](uint32_t a, uint32_t b) { return a < b; };
    heap_sort(circle_.data(), circle_.size(), ascending);
    explore_cluster(f, mesh.origin[back]);
    for (const uint32_t v : f.members)
        for (const uint32_t h : mesh.around(v)) {
            if (f.at(h) > 0 && (best == NONE || f.at(h) > f.at(best))) {
                size_t low = 0, high = circle_.size();
                while (low < high) {
                    const size_t middle = low + (high - low) / 2;
                    if (circle_[middle] < h) low = middle + 1;
                    else high = middle;
                }
                if (low == circle_.size() || circle_[low] != h) best = h;
            }
        }
    return true;
}

hmf_status Cylinders::walk_across(Foliation& f, uint32_t h, int64_t at, Array<PathPiece>* path, LeafMark& found,
                                  int64_t& distance, Call& call) {
    distance = 0;
    // Each step climbs, and a cylinder has no vertex twice.
    for (uint32_t step = 0; step <= f.mesh.vertex_count; ++step) {
        const bool arrived = graph.mark_ahead(f, h, at, found);
        const int64_t to = arrived ? found.at : width(f, h);
        // Values that have left their class may be further across than integers are.
        if (to - at >= INT64_MAX - distance) break;
        // The first height is that of a boundary leaf.
        if (path && !path->push({h, at, to, distance + 1})) return call.out_of_memory();
        distance += to - at;
        if (arrived) return HMF_OK;
        if (!half_edge_ahead(f, twin(h), h)) return call.out_of_memory();
        at = 0;
        if (h == NONE) break;
    }
    return call.fail(
        HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0,
        "The leaves do not form one cylinder for each loop. Pass values as the library returned them for loops.");
}

Crossing Cylinders::leaf_at(const Foliation& f, uint32_t cylinder, int64_t height, uint64_t* piece) const {
    const Cylinder& c = list[cylinder];
    uint64_t low = c.path_begin, high = c.path_end; // the last piece that begins below
    while (high - low > 1) {
        const uint64_t middle = low + (high - low) / 2;
        if (pieces[middle].height <= height) low = middle;
        else high = middle;
    }
    if (piece) *piece = low;
    const PathPiece& p = pieces[low];
    return reversed(f, {p.half_edge, p.from + (height - p.height)});
}

hmf_status Cylinders::locate(Foliation& f, const Crossing& c, uint32_t& cylinder, int64_t& height, Call& call) {
    const Crossing back = reversed(f, c);
    LeafMark found;
    int64_t distance = 0;
    // On a boundary leaf the search begins at the leaf itself.
    if (walk_across(f, back.half_edge, back.at - 1, nullptr, found, distance, call)) return call.status();
    --distance;
    if (found.forward && distance == 0 && walk_across(f, back.half_edge, back.at, nullptr, found, distance, call))
        return call.status();
    cylinder = of_boundary[found.boundary];
    height = list[cylinder].lower == found.boundary ? distance + 1 : 2 * list[cylinder].height - distance - 1;
    return HMF_OK;
}

bool closed_leaf(const Foliation& f, const Crossing& start, uint64_t limit, Array<Crossing>& found) {
    found.clear();
    Crossing c = start;
    do {
        if (found.size() == limit) {
            found.clear();
            return false;
        }
        if (!found.push(c)) return false;
        c = follow(f, c);
    } while (!(c == start));
    return true;
}

Done Cylinders::find_vertices(const Foliation& f, Call& call) {
    Memory& memory = call.memory;
    const Mesh& mesh = f.mesh;
    // A vertex within a cylinder gets it from an edge with a mark, or from a neighbor.
    Array<uint32_t> queue;
    queue.start(memory);
    if (!of_vertex_.allocate_filled(memory, mesh.vertex_count, NONE) || !queue.reserve(mesh.vertex_count)) return false;
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        if (h % CYLINDERS_STRIDE == 0 && !call.tick(0)) return false;
        LeafMark first;
        const uint32_t v = mesh.origin[h];
        if (of_vertex_[v] != NONE || f.at(h) == 0 || !graph.mark_ahead(f, h, 0, first) || first.forward) continue;
        of_vertex_[v] = of_boundary[first.boundary];
        queue.add(v);
    }
    for (size_t at = 0; at < queue.size(); ++at) {
        if (at % CYLINDERS_STRIDE == 0 && !call.tick(0)) return false;
        const uint32_t v = queue[at];
        for (const uint32_t h : mesh.around(v)) {
            const uint32_t w = mesh.target(h);
            LeafMark first;
            if (of_vertex_[w] == NONE && !graph.mark_ahead(f, h, 0, first)) {
                of_vertex_[w] = of_vertex_[v];
                queue.add(w);
            }
        }
    }
    return true;
}

hmf_status middle_leaves(const Foliation& f, const Cylinders& cylinders, const Array<uint32_t>* found, Curves& out,
                         Call& call) {
    Array<Crossing> leaf;
    leaf.start(call.memory);
    out.offsets.start(call.memory);
    out.crossings.start(call.memory);
    if (!out.offsets.push(0)) return call.out_of_memory();
    for (uint32_t i = 0; i < cylinders.list.size(); ++i) {
        const uint32_t c = found ? (*found)[i] : i;
        if (!call.tick(0)) return call.was_cancelled();
        if (!closed_leaf(f, cylinders.leaf_at(f, c, cylinders.list[c].height | 1), cylinders.graph.crossing_limit(),
                         leaf))
            return call.memory.failure()
                     ? call.out_of_memory()
                     : call.fail(HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0,
                                 "A leaf crosses too many edges. Pass values as the library returned them for loops.");
        for (const Crossing& crossing : leaf)
            if (!out.crossings.push(crossing)) return call.out_of_memory();
        if (!out.offsets.push(out.crossings.size())) return call.out_of_memory();
    }
    return HMF_OK;
}

hmf_status cylinder_areas(const Foliation& f, const Cylinders& cylinders, const double* weight, double* area,
                          Call& call) {
    for (size_t c = 0; c < cylinders.list.size(); ++c) area[c] = 0;
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) {
        if (e % CYLINDERS_STRIDE == 0 && !call.tick(0)) return call.was_cancelled();
        const double pull = weight[e] * static_cast<double>(f.value[e]);
        cylinders.visit_parts(f.mesh, f.value, e, [&](uint32_t c, int64_t from, int64_t to) {
            area[c] += pull * static_cast<double>(to - from) / 2;
        });
    }
    return HMF_OK;
}

} // namespace hmf
