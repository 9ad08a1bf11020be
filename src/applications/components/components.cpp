#include "components.hpp"

#include "../../core/base/disjoint_sets.hpp"
#include "../../core/mesh/mesh.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr size_t TICK = 1u << 16;

// Triangles and their sides, as 3 * triangle + side.
struct ComponentCorners {
    const uint32_t* vertex;
    size_t count;
    uint32_t from(size_t side) const { return vertex[side]; }
    uint32_t to(size_t side) const { return vertex[side % 3 == 2 ? side - 2 : side + 1]; }
    uint32_t low(size_t side) const { return std::min(from(side), to(side)); }
    uint32_t high(size_t side) const { return std::max(from(side), to(side)); }
};

hmf_status join_corners(const ComponentCorners& corners, size_t vertex_count, Call& call, uint32_t* part) {
    for (uint32_t v = 0; v < vertex_count; ++v) part[v] = v;
    for (size_t c = 0; c < corners.count; c += 3) {
        if (c % (3 * TICK) == 0 && !call.tick(0.1 * static_cast<double>(c) / static_cast<double>(corners.count)))
            return call.was_cancelled();
        for (size_t s = 0; s < 3; ++s)
            if (corners.vertex[c + s] >= vertex_count)
                return call.fail(HMF_ERROR_MESH_INDEX, HMF_ELEMENT_TRIANGLE, c / 3,
                                 "Triangle %llu names vertex %u, but there are %llu vertices. Indices start at 0.",
                                 static_cast<unsigned long long>(c / 3), corners.vertex[c + s],
                                 static_cast<unsigned long long>(vertex_count));
        unite(part, corners.vertex[c], corners.vertex[c + 1]);
        unite(part, corners.vertex[c], corners.vertex[c + 2]);
    }
    return HMF_OK;
}

// is_first: of each side, whether its edge appears there first. Sides are visited by their lower vertex, each list in
// order.
hmf_status find_first_sides(const ComponentCorners& corners, size_t vertex_count, Call& call,
                            Array<uint8_t>& is_first) {
    Array<uint32_t> end, bucket, seen; // seen: the lower vertex that a higher one was met with last
    if (!is_first.allocate_filled(call.memory, corners.count, uint8_t{0})
        || !end.allocate_filled(call.memory, vertex_count + 1, 0u) || !bucket.allocate(call.memory, corners.count)
        || !seen.allocate_filled(call.memory, vertex_count, NONE))
        return call.out_of_memory();
    for (size_t side = 0; side < corners.count; ++side) ++end[corners.low(side) + 1];
    for (size_t v = 0; v < vertex_count; ++v) end[v + 1] += end[v];
    if (!call.tick(0.12)) return call.was_cancelled();
    for (size_t side = 0; side < corners.count; ++side) bucket[end[corners.low(side)]++] = static_cast<uint32_t>(side);
    for (size_t place = 0; place < corners.count; ++place) {
        if (place % TICK == 0 && !call.tick(0.14)) return call.was_cancelled();
        const uint32_t side = bucket[place], low = corners.low(side);
        uint32_t& met = seen[corners.high(side)];
        is_first[side] = met != low;
        met = low;
    }
    return HMF_OK;
}

// The parts of one kind of elements.  number: of each element in its component.
Done divide(const Array<uint32_t>& component, Array<hmf_component>& list, uint64_t hmf_component::*first,
            uint64_t hmf_component::*count, Call& call, Array<uint32_t>& whole, Array<uint32_t>& number) {
    uint64_t used = 0;
    if (!number.allocate(call.memory, component.size())) return false;
    for (size_t i = 0; i < component.size(); ++i)
        number[i] = component[i] == NONE ? NONE : static_cast<uint32_t>((list[component[i]].*count)++);
    for (hmf_component& c : list) {
        c.*first = used;
        used += c.*count;
    }
    if (!whole.allocate(call.memory, static_cast<size_t>(used))) return false;
    for (size_t i = 0; i < component.size(); ++i)
        if (component[i] != NONE) whole[list[component[i]].*first + number[i]] = static_cast<uint32_t>(i);
    return call.tick(0.15);
}

} // namespace

hmf_status find_components(const uint32_t* triangles, size_t triangle_count, size_t vertex_count, Call& call,
                           Components& out) {
    const ComponentCorners corners = {triangles, 3 * triangle_count};
    Array<uint32_t> part, edge_component, edge_number;
    Array<uint8_t> is_first;
    if (!part.allocate(call.memory, vertex_count)
        || !out.vertex_component.allocate_filled(call.memory, vertex_count, NONE)
        || !out.triangle_component.allocate(call.memory, triangle_count))
        return call.out_of_memory();
    if (join_corners(corners, vertex_count, call, part.data())) return call.status();
    out.list.start(call.memory);
    for (size_t t = 0; t < triangle_count; ++t) {
        uint32_t& component = out.vertex_component[find_root(part.data(), triangles[3 * t])]; // of the root first
        if (component == NONE) {
            component = static_cast<uint32_t>(out.list.size());
            if (!out.list.push(hmf_component{})) return call.out_of_memory();
        }
        out.triangle_component[t] = component;
    }
    for (size_t c = 0; c < corners.count; ++c) out.vertex_component[triangles[c]] = out.triangle_component[c / 3];
    part.release();
    if (find_first_sides(corners, vertex_count, call, is_first)) return call.status();
    edge_component.start(call.memory);
    for (size_t side = 0; side < corners.count; ++side)
        if (is_first[side] && !edge_component.push(out.triangle_component[side / 3])) return call.out_of_memory();
    if (!divide(out.vertex_component, out.list, &hmf_component::first_vertex, &hmf_component::vertex_count, call,
                out.vertices, out.vertex_number)
        || !divide(edge_component, out.list, &hmf_component::first_edge, &hmf_component::edge_count, call, out.edges,
                   edge_number)
        || !divide(out.triangle_component, out.list, &hmf_component::first_triangle, &hmf_component::triangle_count,
                   call, out.triangles, out.triangle_number))
        return call.stopped();
    return HMF_OK;
}

} // namespace hmf
