// Input validation in linear time, without hashing.
#include "validate.hpp"

#include "../base/disjoint_sets.hpp"
#include "../base/prefetch.hpp"

#include <algorithm>

namespace hmf {

namespace {

// The lowest of some numbers, NONE of none.
struct Least {
    uint32_t number = NONE;
    void operator+=(const Least& other) { number = std::min(number, other.number); }
};

// Squared area (times 4) against the longest side: a needle of 0.001 degrees
// has 1e-10, the rounding of collinear corners stays below the bound.
bool has_area(const double* a, const double* b, const double* c) {
    double u[3], v[3];
    for (int n = 0; n < 3; ++n) {
        u[n] = b[n] - a[n];
        v[n] = c[n] - a[n];
    }
    const auto square_of_cross = [&] {
        const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
        return x * x + y * y + z * z;
    };
    // Almost all triangles pass this, which implies what is below: the square of
    // the longest side is at most twice the sum.
    const double sum = u[0] * u[0] + u[1] * u[1] + u[2] * u[2] + v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (sum > 1e-100 && square_of_cross() > 1e-28 * sum * sum) return true;
    double largest = 0;
    for (int n = 0; n < 3; ++n) {
        const double sides[3] = {u[n], v[n], c[n] - b[n]};
        for (const double side : sides) {
            const double size = side < 0 ? -side : side;
            largest = std::max(largest, size);
        }
    }
    if (!(largest > 0)) return false;
    if (largest < 1e-60) { // no underflow in small details
        for (int n = 0; n < 3; ++n) {
            u[n] /= largest;
            v[n] /= largest;
        }
        largest = 1;
    }
    const double square = largest * largest;
    return square_of_cross() > 4e-30 * square * square;
}

} // namespace

hmf_status validate_arguments(const double* positions, size_t vertex_count, size_t position_stride,
                              const uint32_t* triangles, size_t triangle_count, Call& call) {
    if (!positions)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0, "positions is NULL. Give three coordinates per vertex.");
    if (!triangles)
        return call.fail(HMF_ERROR_NULL, HMF_ELEMENT_NONE, 0,
                         "triangles is NULL. Give three vertex indices per triangle.");
    if (position_stride != 0 && (position_stride < 24 || position_stride % 8 != 0))
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, position_stride,
                         "position_stride is %llu. Give 0, or a multiple of 8 that is at least 24.",
                         static_cast<unsigned long long>(position_stride));
    constexpr size_t limit = 0x80000000u / 3;
    if (vertex_count == 0 || triangle_count == 0)
        return call.fail(HMF_ERROR_MESH_COUNTS, HMF_ELEMENT_NONE, 0, "The mesh has no %s. Check the counts.",
                         vertex_count == 0 ? "vertices" : "triangles");
    if (vertex_count > limit || triangle_count > limit)
        return call.fail(HMF_ERROR_MESH_COUNTS, HMF_ELEMENT_NONE, 0,
                         "The mesh has more than 2^31 / 3 %s. Simplify or divide it.",
                         vertex_count > limit ? "vertices" : "triangles");
    if (position_stride > PTRDIFF_MAX / vertex_count)
        return call.fail(HMF_ERROR_OPTIONS, HMF_ELEMENT_OPTION, position_stride,
                         "position_stride is %llu: so many bytes from vertex to vertex do not fit into memory.",
                         static_cast<unsigned long long>(position_stride));
    return HMF_OK;
}

hmf_status check_areas(const OrderedTriangles& ordered, const double* position, const CallerMesh& caller, Call& call) {
    const uint32_t* const words = ordered.words.data();
    if (!call.tick(0.04)) return HMF_CANCELLED;
    // The first triangle without area, by the caller's numbers.
    const Least flat = call.parallel.sum_blocks<Least>(ordered.words.size() / 4, [&](size_t begin, size_t end) {
        Least least;
        for (size_t face = begin; face < end; ++face) {
            const uint32_t* v = &words[4 * face];
            if (!has_area(position + size_t{3} * v[0], position + size_t{3} * v[1], position + size_t{3} * v[2]))
                least += {v[3]};
        }
        return least;
    });
    if (flat.number == NONE) return HMF_OK;
    const uint32_t* corner = caller.triangles + size_t{3} * flat.number;
    return call.fail(HMF_ERROR_MESH_DEGENERATE, HMF_ELEMENT_TRIANGLE, flat.number,
                     "Triangle %u (%u, %u, %u) has no area. Move a corner, collapse its shortest edge, or set "
                     "mollify in the build options.",
                     flat.number, corner[0], corner[1], corner[2]);
}

hmf_status check_connection(const Mesh& mesh, const Array<uint32_t>& degree, const CallerMesh& caller, uint32_t* part,
                            uint32_t part_count, Call& call) {
    const auto callers_vertex = [&](uint32_t internal) {
        uint32_t v = 0;
        while (caller.vertex_internal[v] != internal) ++v;
        return caller.mirror.front(v);
    };
    // A single fan returns to its start after all triangles, and not earlier. Triangles are counted, so that the walk
    // around the next vertex does not depend on the end of this one.
    const auto is_one_fan = [&](uint32_t v) {
        uint32_t h = mesh.out[v], returns = 0;
        for (uint32_t steps = 0; steps < degree[v]; ++steps) {
            h = mesh.rotate_cw(h);
            returns += h == mesh.out[v];
        }
        return (returns == 1) & (h == mesh.out[v]);
    };
    if (!call.tick(0.11)) return HMF_CANCELLED;
    struct Bad {
        Least unused, fans;
        void operator+=(const Bad& other) {
            unused += other.unused;
            fans += other.fans;
        }
    };
    const Bad bad = call.parallel.sum_blocks<Bad>(mesh.vertex_count, [&](size_t begin, size_t end) {
        Bad here;
        for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v)
            if (degree[v] == 0) here.unused += {v};
            else if (!is_one_fan(v)) here.fans += {v};
        return here;
    });
    if (bad.unused.number != NONE) {
        const uint32_t number = callers_vertex(bad.unused.number);
        return call.fail(HMF_ERROR_MESH_UNUSED_VERTEX, HMF_ELEMENT_VERTEX, number,
                         "Vertex %u belongs to no triangle. Remove it and renumber the others.", number);
    }
    if (bad.fans.number != NONE) {
        const uint32_t number = callers_vertex(bad.fans.number);
        return call.fail(HMF_ERROR_MESH_NON_MANIFOLD_VERTEX, HMF_ELEMENT_VERTEX, number,
                         "The triangles at vertex %u form several fans. Duplicate the vertex, one for each fan.",
                         number);
    }
    if (part_count == 1) return HMF_OK;
    const auto part_of = [&](uint32_t triangle) {
        return find_root(part, caller.vertex_internal[caller.triangles[size_t{3} * triangle]]);
    };
    uint32_t lost = 0;
    while (part_of(lost) == part_of(0)) ++lost;
    return call.fail(HMF_ERROR_MESH_COMPONENTS, HMF_ELEMENT_TRIANGLE, lost,
                     "Triangle %u is not connected to triangle 0. Build each component of hmf_components on its own.",
                     lost);
}

// A side is the first one of its edge if its triangle comes before the one on
// the other side.  So the sides are marked in the order of this mesh, counted and
// numbered in that of the caller.
hmf_status number_edges(const OrderedTriangles& ordered, const Mesh& mesh, uint32_t* triangle_edges,
                        uint32_t* edge_internal, uint32_t* scratch, Call& call) {
    uint32_t* const number = scratch;
    const auto mark = [&](size_t begin, size_t end) {
        constexpr size_t ahead = 16; // the caller's order may have nothing to do with this one
        for (size_t face = begin; face < end; ++face) {
            const uint32_t* const here = &ordered.words[4 * face];
            if (end - face > ahead) prefetch(&triangle_edges[size_t{3} * here[4 * ahead + 3]]);
            for (size_t s = 0; s < 3; ++s) {
                const bool first = here[3] < ordered.number(mesh.face[twin(here[s])]);
                triangle_edges[size_t{3} * here[3] + s] = (here[s] & ~1u) + first;
            }
        }
    };
    if (!call.pass(mesh.face_count, 0.14, mark)) return HMF_CANCELLED;
    uint32_t count = 0;
    for (size_t side = 0; side < size_t{3} * mesh.face_count; ++side) {
        if (side % 65536 == 0 && !call.tick(0.15)) return HMF_CANCELLED;
        if ((triangle_edges[side] & 1) == 0) continue;
        const uint32_t edge = edge_of(triangle_edges[side]);
        edge_internal[count] = edge;
        number[edge] = count++;
    }
    const auto translate = [&](size_t begin, size_t end) {
        for (size_t side = 3 * begin; side < 3 * end; ++side)
            triangle_edges[side] = number[edge_of(triangle_edges[side])];
    };
    return call.pass(mesh.face_count, 0.16, translate) ? HMF_OK : HMF_CANCELLED;
}

} // namespace hmf
