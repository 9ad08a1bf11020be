// Cylinders from boundary leaves: from each one a path goes straight across the
// leaves until it meets another, which bounds the same cylinder.  Along an edge
// the height above the boundary grows by exactly what one walks, at a vertex the
// path goes on into the direction ahead; so the height of the whole cylinder is
// a sum of integers, and it is the weight of the loop.
#include "cylinders.hpp"

#include <algorithm>

namespace hmf {

static hmf_status no_cylinders(Call& call) {
    return call.fail(
        HMF_ERROR_VALUE_CLASS, HMF_ELEMENT_NONE, 0,
        "The leaves do not form one cylinder for each loop. Pass values as the library returned them for loops.");
}

hmf_status Cylinders::build(Foliation& f, const uint32_t* vertex_order, const uint32_t* face_order, Call& call) {
    return graph.build(f, vertex_order, face_order, call) ? call.status() : find_cylinders(f, call);
}

hmf_status Cylinders::build(Foliation& f, const ZeroList& known, Call& call) {
    return graph.build(f, known, call) ? call.status() : find_cylinders(f, call);
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
        if (found.forward || c.upper == b || of_boundary[c.upper] != NONE) return no_cylinders(call);
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
        bool closed = false;
        g = next_round(f, g, closed);
        closed_corners += closed;
    } while (g != back && closed_corners < 2);
    if (best != NONE) return true;
    // A closed leaf along zero edges: its other side is another circle.
    std::sort(circle_.begin(), circle_.end());
    explore_cluster(f, mesh.origin[back]);
    for (const uint32_t v : f.members)
        for (const uint32_t h : mesh.around(v)) {
            if (f.at(h) > 0 && (best == NONE || f.at(h) > f.at(best))
                && !std::binary_search(circle_.begin(), circle_.end(), h))
                best = h;
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
    return no_cylinders(call);
}

} // namespace hmf
