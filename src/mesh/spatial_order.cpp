// Spatial order of the input: vertices along a Z-shaped curve through a grid of
// 1024^3 cells [Morton 1966], triangles by their lowest vertex.
//
//     +--+--+--+--+
//     | 0  1| 4  5|      interleaved bits of the coordinates of a cell;
//     +     +     +      cells of the same block of 2^k cells follow
//     | 2  3| 6  7|      each other
//     +--+--+--+--+
//
// Files of meshes often have no order at all, and then each step on the surface
// is a cache miss.  This order needs no connectivity, so that validation is
// local already.  It only decides numbers: an outlier that puts all other
// vertices into one cell costs time and nothing else.
#include "spatial_order.hpp"

#include "../base/prefetch.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr size_t TICK = 1u << 16;
constexpr uint32_t AXIS_BITS = 10, DIGITS = 3, DIGIT_SIZE = 1u << AXIS_BITS; // as many digits as axes

struct Bounds {
    double low[3], high[3];
};

bool finite(double x) { return x - x == 0; }

hmf_status find_bounds(const double* positions, size_t vertex_count, size_t stride, Bounds& bounds, Call& call) {
    for (int c = 0; c < 3; ++c) bounds.low[c] = bounds.high[c] = positions[c];
    for (size_t v = 0; v < vertex_count; ++v) {
        const double* x = position_at(positions, stride, v);
        for (int c = 0; c < 3; ++c) {
            if (!finite(x[c]))
                return call.fail(
                    HMF_ERROR_MESH_NOT_FINITE, HMF_ELEMENT_VERTEX, v,
                    "Coordinate %d of vertex %llu is infinite or not a number. Repair or remove the vertex.", c,
                    static_cast<unsigned long long>(v));
            bounds.low[c] = std::min(bounds.low[c], x[c]);
            bounds.high[c] = std::max(bounds.high[c], x[c]);
        }
    }
    return HMF_OK;
}

double working_scale(const Bounds& bounds) {
    double largest = 0, scale = 1;
    for (int c = 0; c < 3; ++c) {
        if (-bounds.low[c] > largest) largest = -bounds.low[c];
        largest = std::max(largest, bounds.high[c]);
    }
    if (largest > 1e-30 && largest < 1e30) return 1;
    for (int n = 0; n < 1000 && largest * scale > 1; ++n) scale *= 0.5;
    for (int n = 0; n < 1000 && largest * scale < 0.5; ++n) scale *= 2;
    return scale;
}

// Puts two zeros between the ten lowest bits.
uint32_t spread(uint32_t x) {
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

} // namespace

hmf_status order_vertices(const double* positions, size_t vertex_count, size_t stride, uint32_t* vertex_internal,
                          double* position, double& scale, Call& call) {
    Bounds bounds;
    if (find_bounds(positions, vertex_count, stride, bounds, call)) return call.status();
    if (!call.tick(0.01)) return HMF_CANCELLED;
    scale = working_scale(bounds);
    double extent = 0;
    for (int c = 0; c < 3; ++c) {
        const double size = scale * bounds.high[c] - scale * bounds.low[c];
        extent = std::max(extent, size);
    }
    const double cells = extent > 1e-200 ? (DIGIT_SIZE - 1) / extent : 0;

    // Cell and vertex in one word; a stable sort by the digits of the cell.
    Array<uint64_t> list, other;
    Array<uint32_t> begin;
    if (!list.allocate(call.memory, vertex_count) || !other.allocate(call.memory, vertex_count)
        || !begin.allocate_filled(call.memory, size_t{DIGITS} * DIGIT_SIZE, 0))
        return call.out_of_memory();
    for (size_t v = 0; v < vertex_count; ++v) {
        const double* x = position_at(positions, stride, v);
        uint32_t cell = 0;
        for (int c = 0; c < 3; ++c)
            cell |= spread(static_cast<uint32_t>((scale * x[c] - scale * bounds.low[c]) * cells)) << c;
        list[v] = uint64_t{cell} << 32 | v;
        for (uint32_t d = 0; d < DIGITS; ++d) ++begin[d * DIGIT_SIZE + (cell >> (d * AXIS_BITS)) % DIGIT_SIZE];
    }
    for (uint32_t d = 0; d < DIGITS; ++d) {
        if (!call.tick(0.012 + 0.002 * d)) return HMF_CANCELLED;
        uint32_t total = 0;
        for (uint32_t n = d * DIGIT_SIZE; n < (d + 1) * DIGIT_SIZE; ++n) {
            const uint32_t size = begin[n];
            begin[n] = total;
            total += size;
        }
        for (const uint64_t entry : list)
            other[begin[d * DIGIT_SIZE + (entry >> (32 + d * AXIS_BITS)) % DIGIT_SIZE]++] = entry;
        list.swap(other);
    }
    for (size_t n = 0; n < vertex_count; ++n) {
        if (n % TICK == 0 && !call.tick(0.02)) return HMF_CANCELLED;
        const uint32_t v = static_cast<uint32_t>(list[n]);
        vertex_internal[v] = static_cast<uint32_t>(n);
        const double* x = position_at(positions, stride, v);
        for (size_t c = 0; c < 3; ++c) position[3 * n + c] = scale * x[c];
    }
    return HMF_OK;
}

hmf_status order_triangles(const uint32_t* triangles, size_t triangle_count, const uint32_t* vertex_internal,
                           size_t vertex_count, uint32_t* sides, OrderedTriangles& out, Call& call) {
    Array<uint32_t> begin;
    if (!begin.allocate_filled(call.memory, vertex_count, 0) || !out.words.allocate(call.memory, 4 * triangle_count))
        return call.out_of_memory();
    constexpr size_t ahead = 16;
    const auto lowest = [](const uint32_t* v) {
        const uint32_t low = std::min(v[1], v[0]);
        return std::min(v[2], low);
    };
    for (size_t t = 0; t < triangle_count; ++t) {
        if (t % TICK == 0 && !call.tick(0.02 + 0.01 * static_cast<double>(t) / static_cast<double>(triangle_count)))
            return HMF_CANCELLED;
        const uint32_t* corner = triangles + 3 * t;
        const unsigned long long number = t;
        for (int s = 0; s < 3; ++s)
            if (corner[s] >= vertex_count)
                return call.fail(HMF_ERROR_MESH_INDEX, HMF_ELEMENT_TRIANGLE, t,
                                 "Triangle %llu names vertex %u, but there are %llu vertices. Indices start at 0.",
                                 number, corner[s], static_cast<unsigned long long>(vertex_count));
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
            return call.fail(HMF_ERROR_MESH_REPEATED_VERTEX, HMF_ELEMENT_TRIANGLE, t,
                             "Triangle %llu (%u, %u, %u) names a vertex twice. Remove it, or collapse the edge.",
                             number, corner[0], corner[1], corner[2]);
        uint32_t* internal = sides + 3 * t;
        for (int s = 0; s < 3; ++s) internal[s] = vertex_internal[corner[s]];
        ++begin[lowest(internal)];
    }
    uint32_t total = 0;
    for (uint32_t& entry : begin) {
        const uint32_t size = entry;
        entry = total;
        total += size;
    }
    for (size_t t = 0; t < triangle_count; ++t) {
        if (t % TICK == 0 && !call.tick(0.03 + 0.01 * static_cast<double>(t) / static_cast<double>(triangle_count)))
            return HMF_CANCELLED;
        if (triangle_count - t > 2 * ahead) prefetch(&begin[lowest(sides + 3 * (t + 2 * ahead))]);
        if (triangle_count - t > ahead) prefetch(&out.words[size_t{4} * begin[lowest(sides + 3 * (t + ahead))]]);
        uint32_t* internal = sides + 3 * t;
        const uint32_t face = begin[lowest(internal)]++;
        uint32_t* words = &out.words[size_t{4} * face];
        for (int s = 0; s < 3; ++s) words[s] = internal[s];
        words[3] = static_cast<uint32_t>(t);
        internal[0] = face;
    }
    return HMF_OK;
}

} // namespace hmf
