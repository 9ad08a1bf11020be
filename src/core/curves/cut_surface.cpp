// Regions, segments and points of a surface cut along a normal multicurve.
#include "cut_surface.hpp"

namespace hmf {

constexpr uint32_t CUT_STRIDE = 1u << 16; // edges and faces between two reports

Done CutSurface::build(const Mesh& mesh, const Multicurve& curves, bool with_links, Call& call) {
    Memory& memory = call.memory;
    segment_count = mesh.edge_count + static_cast<uint32_t>(curves.total);
    point_count = mesh.vertex_count + 2 * static_cast<uint32_t>(curves.components.count());
    Array<uint32_t> side; // first half-edge of each face
    if (!side.allocate_filled(memory, mesh.face_count, NONE) || !segment_first.allocate(memory, mesh.edge_count)
        || !segment_edge.allocate(memory, segment_count) || !region_first.allocate(memory, mesh.face_count)
        || !region.allocate(memory, 2 * size_t{segment_count}) || !point.allocate(memory, 2 * size_t{segment_count})
        || !cut_edges(mesh, curves, call))
        return false;
    for (uint32_t h = 2 * mesh.edge_count; h-- > 0;) side[mesh.face[h]] = h;
    if (!call.tick(0, true)) return false;
    count_regions(mesh, curves, side);
    link.release();
    if (with_links && !link.allocate_filled(memory, 3 * size_t{region_count}, NONE)) return false;
    for (uint32_t f = 0; f < mesh.face_count; ++f) {
        if (f % CUT_STRIDE == 0 && !call.tick(0, true)) return false;
        cut_face(mesh, curves, f, side[f]);
    }
    return true;
}

// The segments of each edge, with their ends.
Done CutSurface::cut_edges(const Mesh& mesh, const Multicurve& curves, Call& call) {
    uint32_t s = 0;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        if (e % CUT_STRIDE == 0 && !call.tick(0, true)) return false;
        segment_first[e] = s;
        const uint32_t n = curves.count[e];
        for (uint32_t q = 0; q <= n; ++q, ++s) {
            segment_edge[s] = e;
            // The end of half-edge 2e lies on the left of a curve that leaves through it.
            point[2 * size_t{s}] =
                q == 0 ? mesh.origin[2 * e] : mesh.vertex_count + curves.strand[curves.first[e] + q - 1];
            point[2 * size_t{s} + 1] =
                q == n ? mesh.origin[2 * e + 1] : mesh.vertex_count + (curves.strand[curves.first[e] + q] ^ 1u);
        }
    }
    return true;
}

// One more than a face has arcs.
void CutSurface::count_regions(const Mesh& mesh, const Multicurve& curves, const Array<uint32_t>& side) {
    region_count = 0;
    for (uint32_t f = 0; f < mesh.face_count; ++f) {
        region_first[f] = region_count;
        const uint32_t h = side[f], k = mesh.next[h], l = mesh.next[k];
        const uint64_t crossings =
            uint64_t{curves.count[edge_of(h)]} + curves.count[edge_of(k)] + curves.count[edge_of(l)];
        region_count += 1 + static_cast<uint32_t>(crossings / 2);
    }
}

// The region on the inner side of each segment of face f, which begins with half-edge `side`.
void CutSurface::cut_face(const Mesh& mesh, const Multicurve& curves, uint32_t f, uint32_t side) {
    uint32_t h[3], n[3], corner[4]; // first region at each corner
    h[0] = side;
    h[1] = mesh.next[h[0]];
    h[2] = mesh.next[h[1]];
    for (int i = 0; i < 3; ++i) n[i] = curves.count[edge_of(h[i])];
    if ((n[0] | n[1] | n[2]) == 0) { // most faces
        for (size_t i = 0; i < 3; ++i) {
            const uint32_t half_segment = 2 * segment_first[edge_of(h[i])] + (h[i] & 1u);
            region[half_segment] = region_first[f];
            if (!link.empty()) link[3 * size_t{region_first[f]} + i] = half_segment;
        }
        return;
    }
    corner[0] = region_first[f] + 1;
    for (int i = 0; i < 3; ++i)
        corner[i + 1] = corner[i] + static_cast<uint32_t>((uint64_t{n[i]} + n[(i + 2) % 3] - n[(i + 1) % 3]) / 2);
    for (int i = 0; i < 3; ++i) {
        const uint32_t round_origin = corner[i + 1] - corner[i], target = corner[(i + 1) % 3];
        for (uint32_t q = 0; q <= n[i]; ++q) {
            const uint32_t segment = segment_first[edge_of(h[i])] + (h[i] & 1u ? n[i] - q : q);
            const uint32_t half_segment = 2 * segment + (h[i] & 1u);
            const bool at_origin = q < round_origin, at_middle = q == round_origin;
            const uint32_t into = at_origin ? corner[i] + q : at_middle ? region_first[f] : target + n[i] - q;
            region[half_segment] = into;
            if (!link.empty())
                link[3 * size_t{into} + static_cast<size_t>(at_middle ? i : at_origin ? 0 : 1)] = half_segment;
        }
    }
}

} // namespace hmf
