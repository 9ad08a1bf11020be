#include "cylinder_leaves.hpp"

#include <algorithm>

namespace hmf {

namespace {
constexpr uint32_t CYLINDERS_STRIDE = 65536; // elements between two reports
} // namespace

Crossing leaf_at(const Foliation& f, const Cylinders& cylinders, uint32_t cylinder, int64_t height) {
    const Cylinder& c = cylinders.list[cylinder];
    const PathPiece* const pieces = cylinders.pieces.data();
    // The last piece that begins below.
    const PathPiece& p = std::upper_bound(pieces + c.path_begin + 1, pieces + c.path_end, height,
                                          [](int64_t at, const PathPiece& beyond) { return at < beyond.height; })[-1];
    return reversed(f, {p.half_edge, p.from + (height - p.height)});
}

hmf_status locate(Foliation& f, Cylinders& cylinders, const Crossing& c, uint32_t& cylinder, int64_t& height,
                  Call& call) {
    const Crossing back = reversed(f, c);
    LeafMark found;
    int64_t distance = 0;
    // On a boundary leaf the search begins at the leaf itself.
    if (cylinders.walk_across(f, back.half_edge, back.at - 1, nullptr, found, distance, call)) return call.status();
    --distance;
    if (found.forward && distance == 0
        && cylinders.walk_across(f, back.half_edge, back.at, nullptr, found, distance, call))
        return call.status();
    cylinder = cylinders.of_boundary[found.boundary];
    height = cylinders.list[cylinder].lower == found.boundary ? distance + 1
                                                              : 2 * cylinders.list[cylinder].height - distance - 1;
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

Done CylinderParts::find(const Foliation& f, const Cylinders& cylinders, Call& call) {
    cylinders_ = &cylinders;
    const CriticalGraph& graph = cylinders.graph;
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
        of_vertex_[v] = cylinders.of_boundary[first.boundary];
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
        if (!closed_leaf(f, leaf_at(f, cylinders, c, cylinders.list[c].height | 1), cylinders.graph.crossing_limit(),
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
    CylinderParts parts;
    if (!parts.find(f, cylinders, call)) return call.stopped();
    for (size_t c = 0; c < cylinders.list.size(); ++c) area[c] = 0;
    for (uint32_t e = 0; e < f.mesh.edge_count; ++e) {
        if (e % CYLINDERS_STRIDE == 0 && !call.tick(0)) return call.was_cancelled();
        const double pull = weight[e] * static_cast<double>(f.value[e]);
        parts.visit(
            f, e, [&](uint32_t c, int64_t from, int64_t to) { area[c] += pull * static_cast<double>(to - from) / 2; });
    }
    return HMF_OK;
}

} // namespace hmf
