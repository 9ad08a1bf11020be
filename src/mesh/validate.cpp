// Input validation in linear time, without hashing.  The sides of the triangles
// go to the bucket of their lower vertex, and are matched there with one mark
// per vertex:
//
//     bucket of u:   (u,v) (u,w) (v,u) (u,x) ...      two of each, in opposite
//                      ^-----------^                  directions: an edge
//
// Triangles come in the order of their lowest vertex, which has two of the three
// sides in its bucket; the third one waits for the bucket of its own lower
// vertex, which comes later.  So one pass sees each bucket when it is complete,
// and all that it touches is near in memory.
#include "validate.hpp"

#include "../base/disjoint_sets.hpp"
#include "../base/prefetch.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr size_t TICK = 1u << 16;

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

// A side is a place in OrderedTriangles::words: 4 * face + corner.
uint32_t side_after(uint32_t side) { return side % 4 == 2 ? side - 2 : side + 1; }

struct FaceSide {
    uint32_t high; // its higher vertex
    uint32_t place;
};

// Sides with the same lower vertex and the same key belong together.  In a double
// the two vertices are not enough: they may have one edge in front and one behind.
struct PlainKeys {
    static constexpr uint32_t per_vertex = 1;
    uint32_t operator()(FaceSide side) const { return side.high; }
};
struct DoubleKeys {
    static constexpr uint32_t per_vertex = 2;
    const OrderedTriangles& ordered;
    const CallerMesh& caller;
    uint32_t vertex_count;
    uint32_t operator()(FaceSide side) const {
        const uint32_t triangle = ordered.number(side.place / 4), m = caller.mirror.triangle_count;
        if (triangle < m) return side.high;
        const uint32_t front = 3 * (triangle - m) + (2 - side.place % 4); // the side that it is the image of
        return caller.boundary_side[front] ? side.high : side.high + vertex_count;
    }
};

struct Mark {
    uint32_t low;   // the bucket that the vertex was seen in
    uint32_t place; // the side seen there; NONE: it has found its other side
};

// The sides of triangles that wait for the bucket of their lower vertex, one
// list for each vertex.  They lie in arrays of the mesh that are filled later.
struct Waiting {
    uint32_t *first, *high, *next; // per vertex: a place; per face: the higher vertex, a place; NONE ends the list
};

// Sides that belong together.
struct Pairs {
    static constexpr uint32_t ROOM = 512;
    uint32_t side[ROOM][2], count = 0;

    // Numbers the edges from edge_count; words of the sides become half-edges.
    void make_edges(uint32_t* words, const Mesh& mesh, uint32_t& edge_count) {
        uint32_t h = 2 * edge_count;
        for (uint32_t n = 0; n < count; ++n)
            for (const uint32_t place : side[n]) {
                mesh.origin[h] = words[place];
                words[place] = h++;
            }
        edge_count += count;
        count = 0;
    }
};

// Messages about one triangle or bucket.
class Report {
public:
    Report(const OrderedTriangles& ordered, const CallerMesh& caller, Call& call) :
        ordered_(ordered), caller_(caller), call_(call) {}

    // The third triangle at the edge, by the caller's numbers.
    hmf_status third(const FaceSide* bucket, uint32_t size, uint32_t high) const {
        const FaceSide* lowest[3] = {nullptr, nullptr, nullptr};
        for (uint32_t n = 0; n < size; ++n) {
            if (bucket[n].high != high) continue;
            const FaceSide* here = &bucket[n];
            for (const FaceSide*& place : lowest)
                if (here && (!place || number(here->place) < number(place->place))) {
                    const FaceSide* moved = place;
                    place = here;
                    here = moved;
                }
        }
        assert(lowest[2]); // the caller has counted three
        return call_.fail(
            HMF_ERROR_MESH_NON_MANIFOLD_EDGE, HMF_ELEMENT_TRIANGLE, number(lowest[2]->place),
            "Triangle %u is the third one at the edge between the vertices %u and %u. Remove one of them, or "
            "duplicate the vertices to separate the sheets.",
            number(lowest[2]->place), from(lowest[2]->place), to(lowest[2]->place));
    }
    hmf_status flat(uint32_t triangle) const {
        const uint32_t* corner = caller_.triangles + size_t{3} * triangle;
        return call_.fail(HMF_ERROR_MESH_DEGENERATE, HMF_ELEMENT_TRIANGLE, triangle,
                          "Triangle %u (%u, %u, %u) has no area. Move a corner, collapse its shortest edge, or set "
                          "mollify in the build options.",
                          triangle, corner[0], corner[1], corner[2]);
    }
    hmf_status turned(uint32_t a, uint32_t b) const {
        return call_.fail(
            HMF_ERROR_MESH_ORIENTATION, HMF_ELEMENT_TRIANGLE, number(a),
            "The triangles %u and %u both run from vertex %u to vertex %u. Reverse one of them; if that is not "
            "possible, the surface is not orientable.",
            number(a), number(b), from(a), to(a));
    }

private:
    uint32_t number(uint32_t side) const { return ordered_.number(side / 4); }
    uint32_t from(uint32_t side) const { return caller_.triangles[size_t{3} * number(side) + side % 4]; }
    uint32_t to(uint32_t side) const { return caller_.triangles[size_t{3} * number(side) + side_after(side) % 4]; }

    const OrderedTriangles& ordered_;
    const CallerMesh& caller_;
    Call& call_;
};

template <class Keys>
hmf_status link(OrderedTriangles& ordered, const Keys& keys, const Report& report, Mesh& mesh, uint32_t largest,
                uint32_t* part, Array<uint32_t>& boundary, Call& call);

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
    return HMF_OK;
}

hmf_status link_triangles(OrderedTriangles& ordered, const double* position, const CallerMesh& caller, Mesh& mesh,
                          Array<uint32_t>& degree, uint32_t* part, Array<uint32_t>& boundary, Call& call) {
    uint32_t* const words = ordered.words.data();
    const uint32_t vertex_count = mesh.vertex_count, places = static_cast<uint32_t>(ordered.words.size());
    const Report report(ordered, caller, call);
    if (!call.tick(0.04)) return HMF_CANCELLED;
    // The first triangle without area, by the caller's numbers.
    const Least flat =
        call.parallel.sum_blocks<Least>(caller.flat_allowed ? 0 : places / 4, [&](size_t begin, size_t end) {
            Least least;
            for (size_t face = begin; face < end; ++face) {
                const uint32_t* v = &words[4 * face];
                if (!has_area(position + size_t{3} * v[0], position + size_t{3} * v[1], position + size_t{3} * v[2]))
                    least += {v[3]};
            }
            return least;
        });
    if (flat.number != NONE) return report.flat(flat.number);
    for (uint32_t place = 0; place < places; place += 4) {
        if (place % TICK == 0 && !call.tick(0.04 + 0.02 * place / places)) return HMF_CANCELLED;
        for (uint32_t s = 0; s < 3; ++s) ++degree[words[place + s]];
    }
    uint32_t largest = 0;
    for (const uint32_t d : degree) largest = std::max(largest, d);
    boundary.start(call.memory);
    if (caller.mirror.triangle_count == 0)
        return link(ordered, PlainKeys{}, report, mesh, largest, part, boundary, call);
    return link(ordered, DoubleKeys{ordered, caller, vertex_count}, report, mesh, largest, part, boundary, call);
}

namespace {

// The words of a triangle are its half-edges now.
Done make_faces(const uint32_t* words, uint32_t places, Mesh& mesh, Call& call) {
    const auto join = [&](size_t begin, size_t end) {
        for (size_t face = begin; face < end; ++face) {
            const uint32_t* h = &words[4 * face];
            for (int s = 0; s < 3; ++s) {
                mesh.next[h[s]] = h[s == 2 ? 0 : s + 1];
                mesh.face[h[s]] = static_cast<uint32_t>(face);
            }
        }
    };
    if (!call.pass(places / 4, 0.1, join)) return false;
    for (uint32_t place = 0; place < places; place += 4) // in order: the last triangle of a vertex counts
        for (uint32_t s = 0; s < 3; ++s) mesh.out[mesh.origin[words[place + s]]] = words[place + s];
    return true;
}

// Matches the sides and makes the half-edges.  largest: degree.
template <class Keys>
hmf_status link(OrderedTriangles& ordered, const Keys& keys, const Report& report, Mesh& mesh, uint32_t largest,
                uint32_t* part, Array<uint32_t>& boundary, Call& call) {
    uint32_t* const words = ordered.words.data();
    const uint32_t vertex_count = mesh.vertex_count, places = static_cast<uint32_t>(ordered.words.size());
    Array<Mark> marks;
    Array<FaceSide> bucket;
    if (!marks.allocate_filled(call.memory, size_t{Keys::per_vertex} * vertex_count, Mark{NONE, NONE})
        || !bucket.allocate(call.memory, size_t{2} * largest))
        return call.out_of_memory();
    const Waiting waiting = {mesh.out, mesh.next, mesh.face};
    for (uint32_t v = 0; v < vertex_count; ++v) waiting.first[v] = NONE;
    Pairs pairs;
    uint32_t edges = 0, place = 0;
    for (uint32_t low = 0; low < vertex_count; ++low) {
        if (low % TICK == 0 && !call.tick(0.06 + 0.03 * low / vertex_count)) return HMF_CANCELLED;
        uint32_t size = 0;
        for (; place < places; place += 4) {
            const uint32_t a = words[place], b = words[place + 1], c = words[place + 2];
            if ((a != low) & (b != low) & (c != low)) break;
            const uint32_t s = (b == low) + 2 * (c == low); // the corner that is lowest
            const uint32_t next = side_after(place + s), last = side_after(next), v = words[next], w = words[last];
            bucket[size] = {v, place + s};
            bucket[size + 1] = {w, last};
            size += 2;
            const uint32_t lower = std::min(w, v);
            waiting.high[place / 4] = std::max(v, w);
            waiting.next[place / 4] = waiting.first[lower];
            waiting.first[lower] = next;
        }
        for (uint32_t third = waiting.first[low]; third != NONE; third = waiting.next[third / 4])
            bucket[size++] = {waiting.high[third / 4], third};
        // Branch-free: whether a side finds another one is mispredicted half the time.
        // What is written for those that do not is overwritten.
        uint32_t matched = 0, turned[2] = {NONE, NONE};
        for (uint32_t n = 0; n < size; ++n) {
            const FaceSide side = bucket[n];
            Mark& mark = marks[keys(side)];
            const bool second = mark.low == low;
            const uint32_t first = second ? mark.place : side.place;
            if (first == NONE) return report.third(bucket.data(), size, side.high);
            mark = {low, second ? NONE : side.place};
            if (second & (words[first] == words[side.place])) {
                turned[0] = first;
                turned[1] = side.place;
            }
            pairs.side[pairs.count][0] = first;
            pairs.side[pairs.count][1] = side.place;
            pairs.count += second;
            matched += 2 * second;
            if (pairs.count == Pairs::ROOM) pairs.make_edges(words, mesh, edges);
        }
        for (uint32_t n = 0; n < size && matched < size; ++n) { // sides with one triangle
            const uint32_t side = bucket[n].place;
            if (marks[keys(bucket[n])].place == side && !boundary.push(3 * ordered.number(side / 4) + side % 4))
                return call.out_of_memory();
        }
        if (turned[0] != NONE) return report.turned(turned[0], turned[1]);
    }
    if (!boundary.empty()) return HMF_OK;
    pairs.make_edges(words, mesh, edges);
    // A mark still tells a lower neighbour: trees that cover almost everything.
    for (uint32_t v = 0; v < vertex_count; ++v) part[v] = marks[v].low == NONE ? v : part[marks[v].low];
    return make_faces(words, places, mesh, call) ? HMF_OK : HMF_CANCELLED;
}

} // namespace

hmf_status check_connection(const Mesh& mesh, const Array<uint32_t>& degree, const CallerMesh& caller, uint32_t* part,
                            Call& call) {
    const auto callers_vertex = [&](uint32_t internal) {
        uint32_t v = 0;
        while (caller.vertex_internal[v] != internal) ++v;
        return caller.mirror.front(v);
    };
    uint32_t parts = 0;
    for (uint32_t v = 0; v < mesh.vertex_count; ++v) {
        parts += part[v] == v;
        if (degree[v] > 0) continue;
        const uint32_t number = callers_vertex(v);
        return call.fail(HMF_ERROR_MESH_UNUSED_VERTEX, HMF_ELEMENT_VERTEX, number,
                         "Vertex %u belongs to no triangle. Remove it and renumber the others.", number);
    }
    // One fan comes back after all triangles, and not before.  Counted, so that
    // the walk round the next vertex need not wait for the end of this one.
    const auto is_one_fan = [&](uint32_t v) {
        uint32_t h = mesh.out[v], returns = 0;
        for (uint32_t steps = 0; steps < degree[v]; ++steps) {
            h = mesh.rotate_cw(h);
            returns += h == mesh.out[v];
        }
        return (returns == 1) & (h == mesh.out[v]);
    };
    if (!call.tick(0.11)) return HMF_CANCELLED;
    const Least bad = call.parallel.sum_blocks<Least>(mesh.vertex_count, [&](size_t begin, size_t end) {
        Least least;
        for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v)
            if (!is_one_fan(v)) least += {v};
        return least;
    });
    if (bad.number != NONE) {
        const uint32_t number = callers_vertex(bad.number);
        return call.fail(HMF_ERROR_MESH_NON_MANIFOLD_VERTEX, HMF_ELEMENT_VERTEX, number,
                         "The triangles at vertex %u form several fans. Duplicate the vertex, one for each fan.",
                         number);
    }
    for (uint32_t e = 0; e < mesh.edge_count && parts > 1; ++e) {
        if (e % TICK == 0 && !call.tick(0.13 + 0.01 * e / mesh.edge_count)) return HMF_CANCELLED;
        const uint32_t i = mesh.origin[2 * e], j = mesh.origin[2 * e + 1];
        if (part[i] != part[j]) parts -= unite(part, i, j);
    }
    if (parts == 1) return HMF_OK;
    const auto part_of = [&](uint32_t triangle) {
        return find_root(part, caller.vertex_internal[caller.triangles[size_t{3} * triangle]]);
    };
    uint32_t lost = 0;
    while (part_of(lost) == part_of(0)) ++lost;
    return call.fail(HMF_ERROR_MESH_COMPONENTS, HMF_ELEMENT_TRIANGLE, lost,
                     "Triangle %u is not connected to triangle 0. Build each component of hmf_components on its own.",
                     lost);
}

hmf_status number_edges(const OrderedTriangles& ordered, const Mesh& mesh, uint32_t* triangle_edges,
                        uint32_t* edge_internal, uint32_t* scratch, Call& call) {
    uint32_t* const number = scratch;
    for (uint32_t e = 0; e < mesh.edge_count; ++e) number[e] = NONE;
    // Memory is read in the order of the caller, which may have nothing to do
    // with this one: ask for it some triangles ahead, and never guess.
    constexpr uint32_t ahead = 16;
    const auto half_edges = [&](uint32_t t) { return &ordered.words[size_t{4} * triangle_edges[size_t{3} * t]]; };
    uint32_t count = 0, latest = 0;
    for (uint32_t t = 0; t < mesh.face_count; ++t) {
        if (t % TICK == 0 && !call.tick(0.14 + 0.03 * t / mesh.face_count)) return HMF_CANCELLED;
        if (mesh.face_count - t > 2 * ahead) prefetch(half_edges(t + 2 * ahead));
        if (mesh.face_count - t > ahead) {
            const uint32_t* soon = half_edges(t + ahead);
            for (size_t s = 0; s < 3; ++s) prefetch(&number[edge_of(soon[s])]);
        }
        const uint32_t* here = half_edges(t);
        for (size_t s = 0; s < 3; ++s) {
            const uint32_t e = edge_of(here[s]), known = number[e], first = known == NONE;
            // The last edge that was new is written again until the next one comes.
            const uint32_t n = first ? count : known;
            number[e] = n;
            triangle_edges[size_t{3} * t + s] = n;
            count += first;
            latest = first ? e : latest;
            edge_internal[count - 1] = latest;
        }
    }
    return HMF_OK;
}

} // namespace hmf
