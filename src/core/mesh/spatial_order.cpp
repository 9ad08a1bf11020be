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
#include "../base/sort_few.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr uint32_t AXIS_BITS = 10, DIGITS = 3, DIGIT_SIZE = 1u << AXIS_BITS; // as many digits as axes

bool finite(double x) { return x - x == 0; }

struct Bounds {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    bool all_finite = true;

    void add(const double* x) {
        for (int c = 0; c < 3; ++c) {
            all_finite &= finite(x[c]);
            low[c] = std::min(low[c], x[c]);
            high[c] = std::max(high[c], x[c]);
        }
    }
    void operator+=(const Bounds& part) {
        all_finite &= part.all_finite;
        for (int c = 0; c < 3; ++c) {
            low[c] = std::min(low[c], part.low[c]);
            high[c] = std::max(high[c], part.high[c]);
        }
    }
};

hmf_status find_bounds(const double* positions, size_t vertex_count, size_t stride, Bounds& bounds, Call& call) {
    bounds = call.parallel.sum_blocks<Bounds>(vertex_count, [&](size_t begin, size_t end) {
        Bounds here;
        for (size_t v = begin; v < end; ++v) here.add(position_at(positions, stride, v));
        return here;
    });
    if (bounds.all_finite) return HMF_OK;
    size_t v = 0;
    int c = 0;
    while (finite(position_at(positions, stride, v)[c]))
        if (++c == 3) ++v, c = 0;
    return call.fail(HMF_ERROR_MESH_NOT_FINITE, HMF_ELEMENT_VERTEX, v,
                     "Coordinate %d of vertex %llu is infinite or not a number. Repair or remove the vertex.", c,
                     static_cast<unsigned long long>(v));
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

// By the upper half of the words, digit by digit.
Done sort_by_cell(Array<uint64_t>& list, Call& call) {
    Array<uint64_t> other;
    if (!other.allocate(call.memory, list.size())) return false;
    for (uint32_t d = 0; d < DIGITS; ++d) {
        if (!call.tick(0.012 + 0.002 * d)) return false;
        const uint64_t* const from = list.data();
        uint64_t* const to = other.data();
        const uint32_t shift = 32 + d * AXIS_BITS;
        const auto digit = [=](size_t i) { return static_cast<uint32_t>(from[i] >> shift) % DIGIT_SIZE; };
        const auto put = [=](size_t i, uint32_t at) { to[at] = from[i]; };
        if (!place_by_few(list.size(), DIGIT_SIZE, digit, put, nullptr, call.parallel, call.memory)) return false;
        list.swap(other);
    }
    return true;
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
    Array<uint64_t> list;
    if (!list.allocate(call.memory, vertex_count)) return call.out_of_memory();
    const auto find_cells = [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            const double* x = position_at(positions, stride, v);
            uint32_t cell = 0;
            for (int c = 0; c < 3; ++c)
                cell |= spread(static_cast<uint32_t>((scale * x[c] - scale * bounds.low[c]) * cells)) << c;
            list[v] = uint64_t{cell} << 32 | v;
        }
    };
    if (!call.pass(vertex_count, 0.01, find_cells) || !sort_by_cell(list, call)) return call.stopped();
    const auto number = [&](size_t begin, size_t end) {
        for (size_t n = begin; n < end; ++n) {
            const uint32_t v = static_cast<uint32_t>(list[n]);
            vertex_internal[v] = static_cast<uint32_t>(n);
            const double* x = position_at(positions, stride, v);
            for (size_t c = 0; c < 3; ++c) position[3 * n + c] = scale * x[c];
        }
    };
    return call.pass(vertex_count, 0.02, number) ? HMF_OK : HMF_CANCELLED;
}

// Which of the two defects it has.
static hmf_status refuse_triangle(const uint32_t* triangles, size_t t, size_t vertex_count, Call& call) {
    const uint32_t* corner = triangles + 3 * t;
    const unsigned long long number = t;
    for (int s = 0; s < 3; ++s)
        if (corner[s] >= vertex_count)
            return call.fail(HMF_ERROR_MESH_INDEX, HMF_ELEMENT_TRIANGLE, t,
                             "Triangle %llu names vertex %u, but there are %llu vertices. Indices start at 0.", number,
                             corner[s], static_cast<unsigned long long>(vertex_count));
    return call.fail(HMF_ERROR_MESH_REPEATED_VERTEX, HMF_ELEMENT_TRIANGLE, t,
                     "Triangle %llu (%u, %u, %u) names a vertex twice. Remove it, or collapse the edge.", number,
                     corner[0], corner[1], corner[2]);
}

namespace {

// A stable sort by the lowest vertex: into blocks of vertices first, then by vertex
// in each block.
class TriangleSort {
public:
    TriangleSort(const uint32_t* sides, size_t triangle_count, size_t vertex_count) :
        sides_(sides), triangles_(triangle_count), vertices_(vertex_count) {
        while ((vertex_count - 1) >> shift_ >= MOST_BLOCKS) ++shift_;
    }

    hmf_status run(Array<uint32_t>& words, Call& call) {
        uint32_t block_begin[MOST_BLOCKS + 1];
        const auto block_of = [this](size_t t) { return lowest(t) >> shift_; };
        const auto put = [this](size_t t, uint32_t at) { list_[at] = uint64_t{lowest(t)} << 32 | t; };
        if (!list_.allocate(call.memory, triangles_) || !begin_.allocate(call.memory, vertices_)
            || !place_by_few(triangles_, MOST_BLOCKS, block_of, put, block_begin, call.parallel, call.memory))
            return call.out_of_memory();
        if (!call.tick(0.035)) return HMF_CANCELLED;
        call.parallel.for_each(static_cast<uint32_t>(((vertices_ - 1) >> shift_) + 1), [&](uint32_t block, uint32_t) {
            place(block, block_begin[block], block_begin[block + 1], words.data());
        });
        return HMF_OK;
    }

private:
    static constexpr uint32_t MOST_BLOCKS = 256;

    uint32_t lowest(size_t triangle) const {
        const uint32_t* v = sides_ + 3 * triangle;
        const uint32_t low = std::min(v[1], v[0]);
        return std::min(v[2], low);
    }
    void place(uint32_t block, uint32_t first, uint32_t end, uint32_t* words) {
        constexpr uint32_t ahead = 16; // the caller's order may have nothing to do with this one
        const size_t v_begin = size_t{block} << shift_, v_end = std::min(v_begin + (size_t{1} << shift_), vertices_);
        std::memset(&begin_[v_begin], 0, (v_end - v_begin) * sizeof(uint32_t));
        for (uint32_t n = first; n < end; ++n) ++begin_[list_[n] >> 32];
        uint32_t total = first;
        for (size_t v = v_begin; v < v_end; ++v) {
            const uint32_t here = begin_[v];
            begin_[v] = total;
            total += here;
        }
        for (uint32_t n = first; n < end; ++n) {
            if (end - n > ahead) prefetch(sides_ + size_t{3} * static_cast<uint32_t>(list_[n + ahead]));
            const uint32_t t = static_cast<uint32_t>(list_[n]);
            const uint32_t place = begin_[list_[n] >> 32]++;
            uint32_t* const to = words + size_t{4} * place;
            for (size_t s = 0; s < 3; ++s) to[s] = sides_[size_t{3} * t + s];
            to[3] = t;
        }
    }

    const uint32_t* const sides_;
    const size_t triangles_, vertices_;
    uint32_t shift_ = 8;
    Array<uint64_t> list_;  // lowest vertex and triangle
    Array<uint32_t> begin_; // of each vertex
};

} // namespace

hmf_status order_triangles(const uint32_t* triangles, size_t triangle_count, const uint32_t* vertex_internal,
                           size_t vertex_count, uint32_t* sides, OrderedTriangles& out, Call& call) {
    if (!out.words.allocate(call.memory, 4 * triangle_count)) return call.out_of_memory();
    const auto is_usable = [&](const uint32_t* corner) {
        return corner[0] < vertex_count && corner[1] < vertex_count && corner[2] < vertex_count
            && corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0];
    };
    struct Least {
        size_t triangle = SIZE_MAX;
        void operator+=(const Least& other) { triangle = std::min(triangle, other.triangle); }
    };
    const Least bad = call.parallel.sum_blocks<Least>(triangle_count, [&](size_t begin, size_t end) {
        Least least;
        for (size_t t = begin; t < end; ++t) {
            const uint32_t* corner = triangles + 3 * t;
            const bool usable = is_usable(corner);
            if (!usable) least += {t};
            for (size_t s = 0; s < 3; ++s) sides[3 * t + s] = usable ? vertex_internal[corner[s]] : 0;
        }
        return least;
    });
    if (bad.triangle != SIZE_MAX) return refuse_triangle(triangles, bad.triangle, vertex_count, call);
    if (!call.tick(0.02)) return HMF_CANCELLED;
    return TriangleSort(sides, triangle_count, vertex_count).run(out.words, call);
}

} // namespace hmf
