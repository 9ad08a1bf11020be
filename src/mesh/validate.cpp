// Input validation in linear time, without hashing: sides are sorted by their
// lower vertex (counting sort), and matched inside each bucket with one mark
// per vertex.
//
//     bucket of u:   (u,v) (u,w) (v,u) (u,x) ...      two of each, in opposite
//                      ^-----------^                  directions: an edge
//
// The order of the checks is that of the interface, from local to global, so
// that the first message is the one that helps.
#include "validate.hpp"

namespace hmf {

namespace {

constexpr size_t TICK = 1u << 16;

bool finite(double x) { return x - x == 0; }

// Squared area (times 4) against the longest side: a needle of 0.001 degrees
// has 1e-10, the rounding of collinear corners stays below the bound.
bool has_area(const double* a, const double* b, const double* c) {
    double u[3], v[3], w[3], largest = 0;
    for (int n = 0; n < 3; ++n) {
        u[n] = b[n] - a[n];
        v[n] = c[n] - a[n];
        w[n] = c[n] - b[n];
        const double sides[3] = {u[n], v[n], w[n]};
        for (const double d : sides) {
            const double size = d < 0 ? -d : d;
            if (size > largest) largest = size;
        }
    }
    if (!(largest > 0) || !finite(largest)) return false;
    for (int n = 0; n < 3; ++n) { // no overflow for extreme units
        u[n] /= largest;
        v[n] /= largest;
    }
    const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    return x * x + y * y + z * z > 4e-30;
}

hmf_status check_corners(const double* positions, size_t vertex_count, size_t stride, const uint32_t* corners,
                         size_t triangle_count, Call& call) {
    for (size_t v = 0; v < vertex_count; ++v) {
        const double* x = position_at(positions, stride, v);
        for (int c = 0; c < 3; ++c)
            if (!finite(x[c]))
                return call.fail(HMF_ERROR_MESH_NOT_FINITE, HMF_ELEMENT_VERTEX, v,
                                 "Coordinate %d of vertex %llu is infinite or not a number. Repair or remove the vertex.", c,
                                 static_cast<unsigned long long>(v));
    }
    for (size_t t = 0; t < triangle_count; ++t) {
        if (t % TICK == 0 && !call.tick(0.04 * static_cast<double>(t) / static_cast<double>(triangle_count))) return HMF_CANCELLED;
        const uint32_t* corner = corners + 3 * t;
        const unsigned long long number = t;
        for (int s = 0; s < 3; ++s)
            if (corner[s] >= vertex_count)
                return call.fail(HMF_ERROR_MESH_INDEX, HMF_ELEMENT_TRIANGLE, t,
                                 "Triangle %llu names vertex %u, but there are %llu vertices. Indices start at 0.", number,
                                 corner[s], static_cast<unsigned long long>(vertex_count));
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
            return call.fail(HMF_ERROR_MESH_REPEATED_VERTEX, HMF_ELEMENT_TRIANGLE, t,
                             "Triangle %llu (%u, %u, %u) names a vertex twice. Remove it, or collapse the edge.", number, corner[0],
                             corner[1], corner[2]);
        if (!has_area(position_at(positions, stride, corner[0]), position_at(positions, stride, corner[1]),
                      position_at(positions, stride, corner[2])))
            return call.fail(HMF_ERROR_MESH_DEGENERATE, HMF_ELEMENT_TRIANGLE, t,
                             "Triangle %llu (%u, %u, %u) has no area. Move a corner, collapse its shortest edge, or flip its longest.",
                             number, corner[0], corner[1], corner[2]);
    }
    return HMF_OK;
}

uint32_t end_of(const uint32_t* corners, uint32_t side) { return corners[side % 3 == 2 ? side - 2 : side + 1]; }

hmf_status match_sides(size_t vertex_count, const uint32_t* corners, uint32_t side_count, Array<uint32_t>& opposite, Call& call) {
    Array<uint32_t> begin, sorted, last_low, first_side;
    if (!begin.allocate_filled(call.memory, vertex_count + 1, 0) || !sorted.allocate(call.memory, side_count)
        || !last_low.allocate_filled(call.memory, vertex_count, NONE) || !first_side.allocate(call.memory, vertex_count))
        return call.out_of_memory();
    for (uint32_t side = 0; side < side_count; ++side) {
        const uint32_t a = corners[side], b = end_of(corners, side);
        ++begin[a < b ? a : b];
    }
    if (!call.tick(0.04)) return HMF_CANCELLED;
    uint32_t total = 0;
    for (size_t v = 0; v <= vertex_count; ++v) {
        total += begin[v];
        begin[v] = total;
    }
    for (uint32_t side = side_count; side-- > 0;) { // backwards: buckets come out ascending
        const uint32_t a = corners[side], b = end_of(corners, side);
        sorted[--begin[a < b ? a : b]] = side;
    }
    for (uint32_t low = 0; low < vertex_count; ++low) {
        if (low % TICK == 0 && !call.tick(0.05 + 0.03 * low / static_cast<double>(vertex_count))) return HMF_CANCELLED;
        for (uint32_t n = begin[low]; n < begin[low + 1]; ++n) {
            const uint32_t side = sorted[n], a = corners[side], b = end_of(corners, side), high = a < b ? b : a;
            opposite[side] = NONE;
            if (last_low[high] != low) {
                last_low[high] = low;
                first_side[high] = side;
                continue;
            }
            const uint32_t first = first_side[high];
            if (opposite[first] != NONE)
                return call.fail(HMF_ERROR_MESH_NON_MANIFOLD_EDGE, HMF_ELEMENT_TRIANGLE, side / 3,
                                 "Triangle %u is the third one at the edge between the vertices %u and %u. Remove one of them, or "
                                 "duplicate the vertices to separate the sheets.", side / 3, a, b);
            opposite[first] = side;
            opposite[side] = first;
        }
        for (uint32_t n = begin[low]; n < begin[low + 1]; ++n) {
            const uint32_t side = sorted[n], a = corners[side], b = end_of(corners, side);
            if (opposite[side] == NONE)
                return call.fail(HMF_ERROR_MESH_BOUNDARY, HMF_ELEMENT_TRIANGLE, side / 3,
                                 "Triangle %u has no neighbour at the edge between the vertices %u and %u. The mesh must be closed: fill "
                                 "the hole, or join duplicate vertices.", side / 3, a, b);
            if (corners[opposite[side]] == a)
                return call.fail(HMF_ERROR_MESH_ORIENTATION, HMF_ELEMENT_TRIANGLE, side / 3,
                                 "The triangles %u and %u both run from vertex %u to vertex %u. Reverse one of them; if that is not "
                                 "possible, the surface is not orientable.", side / 3, opposite[side] / 3, a, b);
        }
    }
    return HMF_OK;
}

uint32_t side_before(uint32_t side) { return side % 3 == 0 ? side + 2 : side - 1; }

hmf_status check_fans(size_t vertex_count, const uint32_t* corners, uint32_t side_count, const Array<uint32_t>& opposite, Call& call) {
    Array<uint32_t> degree, any;
    if (!degree.allocate_filled(call.memory, vertex_count, 0) || !any.allocate(call.memory, vertex_count)) return call.out_of_memory();
    for (uint32_t side = 0; side < side_count; ++side) {
        ++degree[corners[side]];
        any[corners[side]] = side;
    }
    for (uint32_t v = 0; v < vertex_count; ++v) {
        if (v % TICK == 0 && !call.tick(0.08 + 0.03 * v / static_cast<double>(vertex_count))) return HMF_CANCELLED;
        if (degree[v] == 0)
            return call.fail(HMF_ERROR_MESH_UNUSED_VERTEX, HMF_ELEMENT_VERTEX, v,
                             "Vertex %u belongs to no triangle. Remove it and renumber the others.", v);
        uint32_t steps = 0, side = any[v];
        do {
            side = opposite[side_before(side)];
            ++steps;
        } while (side != any[v]);
        if (steps != degree[v])
            return call.fail(HMF_ERROR_MESH_NON_MANIFOLD_VERTEX, HMF_ELEMENT_VERTEX, v,
                             "The triangles at vertex %u form several fans. Duplicate the vertex, one for each fan.", v);
    }
    return HMF_OK;
}

} // namespace

hmf_status validate_arguments(const double* positions, size_t vertex_count, size_t position_stride,
                              const uint32_t* triangles, size_t triangle_count, Call& call) {
    if (!positions) return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "positions is NULL. Give three coordinates per vertex.");
    if (!triangles) return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "triangles is NULL. Give three vertex indices per triangle.");
    if (position_stride != 0 && (position_stride < 24 || position_stride % 8 != 0))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, position_stride,
                         "position_stride is %llu. Give 0, or a multiple of 8 that is at least 24.",
                         static_cast<unsigned long long>(position_stride));
    constexpr size_t limit = 0x80000000u / 3;
    if (vertex_count == 0 || triangle_count == 0)
        return call.fail(HMF_ERROR_MESH_COUNTS, HMF_ELEMENT_NONE, 0, "The mesh has no %s. Check the counts.",
                         vertex_count == 0 ? "vertices" : "triangles");
    if (vertex_count > limit || triangle_count > limit)
        return call.fail(HMF_ERROR_MESH_COUNTS, HMF_ELEMENT_NONE, 0, "The mesh has more than 2^31 / 3 %s. Simplify or divide it.",
                         vertex_count > limit ? "vertices" : "triangles");
    return HMF_OK;
}

hmf_status validate(const double* positions, size_t vertex_count, size_t position_stride, const uint32_t* triangles,
                    size_t triangle_count, uint32_t* triangle_vertices, uint32_t* triangle_edges, Sides& sides, Call& call) {
    std::memcpy(triangle_vertices, triangles, 3 * triangle_count * sizeof(uint32_t));
    const uint32_t side_count = static_cast<uint32_t>(3 * triangle_count);
    if (!sides.opposite.allocate(call.memory, side_count)) return call.out_of_memory();
    hmf_status status = check_corners(positions, vertex_count, position_stride, triangle_vertices, triangle_count, call);
    if (!status) status = match_sides(vertex_count, triangle_vertices, side_count, sides.opposite, call);
    if (!status) status = check_fans(vertex_count, triangle_vertices, side_count, sides.opposite, call);
    if (status) return status;
    for (uint32_t side = 0; side < side_count; ++side) {
        const uint32_t other = sides.opposite[side];
        triangle_edges[side] = other < side ? triangle_edges[other] : sides.edge_count++;
    }
    return HMF_OK;
}

} // namespace hmf
