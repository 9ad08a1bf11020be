// Matching of sides in linear time.  The sides of the triangles go to the bucket
// of their lower vertex, and are matched there:
//
//     bucket of u:   (u,v) (u,w) (v,u) (u,x) ...      two of each, in opposite
//                      ^-----------^                  directions: an edge
//
// Sides are sorted into blocks of vertices first, then by vertex in each block. The two half-edges of an edge get
// consecutive numbers in the range of their bucket, so blocks are independent, and their order does not matter.
#include "match_sides.hpp"

#include "../base/disjoint_sets.hpp"
#include "../base/heap_sort.hpp"
#include "../base/sort_few.hpp"

#include <algorithm>

namespace hmf {

namespace {

// A side is a place in OrderedTriangles::words: 4 * face + corner.
uint32_t side_after_in_face(uint32_t side) { return side % 4 == 2 ? side - 2 : side + 1; }

// What is wrong in a block of vertices.
struct Defects {
    uint32_t third = NONE;    // a side of an edge that has two already
    uint32_t turned[2] = {0}; // two sides with the same direction, if they differ
    bool open = false;        // a side is alone

    bool found() const { return third != NONE || turned[0] != turned[1]; }
};

class Matcher {
public:
    Matcher(OrderedTriangles& ordered, const CallerMesh& caller, Mesh& mesh, Array<uint32_t>& degree, uint32_t* part,
            Call& call) :
        words_(ordered.words.data()),
        ordered_(ordered), caller_(caller), mesh_(mesh), degree_(degree), part_(part), call_(call), listed_(mesh.next),
        sorted_(mesh.face), side_count_(3 * mesh.face_count) {
        while ((mesh.vertex_count - 1) >> shift_ >= MOST_BLOCKS) ++shift_;
        block_count_ = ((mesh.vertex_count - 1) >> shift_) + 1;
    }

    hmf_status run(Array<uint32_t>& boundary, uint32_t& part_count) {
        if (!sort_by_block()) return call_.stopped();
        call_.parallel.for_each(block_count_, [&](uint32_t k, uint32_t) {
            sort_by_vertex(k);
            match_block(k);
        });
        if (call_.cancelled()) return HMF_CANCELLED;
        bool open = false;
        for (uint32_t k = 0; k < block_count_; ++k) {
            const Defects& here = defects_[k];
            if (here.found()) return here.third != NONE ? third(here.third) : turned(here.turned[0], here.turned[1]);
            open |= here.open;
        }
        if (open) return take_boundary(boundary) ? HMF_OK : call_.out_of_memory();
        if (!call_.tick(0.08)) return HMF_CANCELLED;
        part_count = connect();
        return make_faces() ? HMF_OK : HMF_CANCELLED;
    }

private:
    static constexpr uint32_t MOST_BLOCKS = 256;
    static constexpr uint32_t FEW = 32; // sides that are compared with each other, without sorting

    uint32_t lower_end(uint32_t side) const { return std::min(words_[side], words_[side_after_in_face(side)]); }
    uint32_t higher_end(uint32_t side) const { return std::max(words_[side], words_[side_after_in_face(side)]); }
    uint32_t lowest_corner(uint32_t side) const {
        const uint32_t* v = words_ + (side & ~3u);
        const uint32_t low = std::min(v[0], v[1]);
        return std::min(low, v[2]);
    }

    Done sort_by_block() {
        const auto side = [](size_t i) { return static_cast<uint32_t>(i / 3 * 4 + i % 3); };
        const auto block = [&](size_t i) { return lower_end(side(i)) >> shift_; };
        const auto put = [&](size_t i, uint32_t at) { listed_[at] = side(i); };
        return call_.tick(0.05)
            && place_by_few(side_count_, MOST_BLOCKS, block, put, block_begin_, call_.parallel, call_.memory)
            && call_.tick(0.06);
    }

    // Sides with the same lower vertex and the same key belong together.  In a double
    // the two vertices are not enough: they may have one edge in front and one behind.
    uint32_t key_of_side(uint32_t side) const {
        const uint32_t high = higher_end(side), m = caller_.mirror.triangle_count;
        if (m == 0 || number(side) < m) return high;
        const uint32_t front = 3 * (number(side) - m) + (2 - side % 4); // the side that it is the image of
        return caller_.boundary_side[front] ? high : high + mesh_.vertex_count;
    }

    // out and degree: the end of the bucket of each vertex in sorted_, and its size.
    void sort_by_vertex(uint32_t k) {
        const uint32_t v_begin = k << shift_, v_end = std::min(v_begin + (1u << shift_), mesh_.vertex_count);
        for (uint32_t v = v_begin; v < v_end; ++v) degree_[v] = 0;
        for (uint32_t n = block_begin_[k]; n < block_begin_[k + 1]; ++n) ++degree_[lower_end(listed_[n])];
        uint32_t begin = block_begin_[k];
        for (uint32_t v = v_begin; v < v_end; ++v) {
            mesh_.out[v] = begin;
            begin += degree_[v];
        }
        for (uint32_t n = block_begin_[k]; n < block_begin_[k + 1]; ++n)
            sorted_[mesh_.out[lower_end(listed_[n])]++] = listed_[n];
    }

    void match_block(uint32_t k) {
        const uint32_t v_begin = k << shift_, v_end = std::min(v_begin + (1u << shift_), mesh_.vertex_count);
        for (uint32_t v = v_begin; v < v_end && !defects_[k].found(); ++v) {
            const uint32_t size = degree_[v], begin = mesh_.out[v] - size;
            if (!work(16 + 16 * uint64_t{size})) return;
            order_bucket(v, begin, size);
            if (size > FEW) match_many(begin, size, defects_[k]);
            else match_few(begin, size, defects_[k]);
        }
    }
    // Progress can be reported where one thread does all.
    bool work(uint64_t steps) { return call_.parallel.slots() > 1 || call_.work(steps, 0.06, false); }

    // From sorted_ to listed_: triangles that have v as their lowest vertex, the side that begins there first, then
    // the third sides of others, from the last triangle to the first.
    void order_bucket(uint32_t v, uint32_t begin, uint32_t size) {
        const uint32_t* const from = sorted_ + begin;
        uint32_t* const to = listed_ + begin;
        uint32_t thirds = 0;
        while (thirds < size && lowest_corner(from[thirds]) != v) ++thirds;
        for (uint32_t n = thirds; n + 1 < size; n += 2) {
            const bool in_order = words_[from[n]] == v;
            to[n - thirds] = from[in_order ? n : n + 1];
            to[n - thirds + 1] = from[in_order ? n + 1 : n];
        }
        for (uint32_t n = 0; n < thirds; ++n) to[size - 1 - n] = from[n];
    }

    // Edges in the order of their second sides.
    void match_few(uint32_t begin, uint32_t size, Defects& defects) {
        const uint32_t* const side = listed_ + begin;
        // Which sides are second ones cannot be predicted, so no branch depends on it: what is written for
        // the others is overwritten.
        uint32_t key[FEW], first[FEW + 1], second[FEW + 1], edges = 0;
        uint8_t is_second[FEW + 1]; // and a place for a side that is alone so far
        is_second[FEW] = 0;
        for (uint32_t n = 0; n < size; ++n) {
            key[n] = key_of_side(side[n]);
            uint32_t same = FEW;
            for (uint32_t m = 0; m < n; ++m) same = key[m] == key[n] ? m : same;
            if (is_second[same]) defects.third = std::min(defects.third, side[n]);
            is_second[n] = same != FEW;
            first[edges] = same;
            second[edges] = n;
            edges += same != FEW;
        }
        if (defects.third != NONE) return;
        for (uint32_t e = 0; e < edges; ++e) make_edge(begin + 2 * e, side[first[e]], side[second[e]], defects);
        leave_open(begin + 2 * edges, begin + size, defects);
    }

    void match_many(uint32_t begin, uint32_t size, Defects& defects) {
        const uint32_t* const side = listed_ + begin;
        // Numbers in the bucket by key; for each second side the number of the first one, else NONE.
        uint32_t *const order = sorted_ + begin, *const first = mesh_.origin + begin;
        const auto key = [&](uint32_t n) { return key_of_side(side[n]); };
        const auto lower = [&](uint32_t a, uint32_t b) {
            const uint32_t at_a = key(a), at_b = key(b);
            return at_a != at_b ? at_a < at_b : a < b;
        };
        for (uint32_t n = 0; n < size; ++n) order[n] = n;
        if (!heap_sort(order, size, lower, [this] { return work(128); })) return;
        for (uint32_t n = 0; n < size; ++n) {
            const bool same = n > 0 && key(order[n]) == key(order[n - 1]);
            if (same && first[order[n - 1]] != NONE) defects.third = std::min(defects.third, side[order[n]]);
            first[order[n]] = same ? order[n - 1] : NONE;
        }
        if (defects.third != NONE) return;
        uint32_t h = begin; // half-edges are written over what has been read
        for (uint32_t n = 0; n < size; ++n) {
            if (first[n] == NONE) continue;
            make_edge(h, side[first[n]], side[n], defects);
            h += 2;
        }
        leave_open(h, begin + size, defects);
    }

    void make_edge(uint32_t h, uint32_t first, uint32_t second, Defects& defects) {
        mesh_.origin[h] = words_[first];
        mesh_.origin[h + 1] = words_[second];
        sorted_[h] = first;
        sorted_[h + 1] = second;
        if (words_[first] != words_[second]) return;
        defects.turned[0] = first;
        defects.turned[1] = second;
    }
    void leave_open(uint32_t h, uint32_t end, Defects& defects) {
        defects.open |= h < end;
        for (; h < end; ++h) mesh_.origin[h] = NONE;
    }

    // Sides that are in no edge.
    Done take_boundary(Array<uint32_t>& boundary) const {
        for (uint32_t h = 0; h < side_count_; ++h)
            if (mesh_.origin[h] != NONE) words_[sorted_[h]] = NONE;
        for (uint32_t face = 0; face < mesh_.face_count; ++face)
            for (uint32_t s = 0; s < 3; ++s)
                if (words_[4 * face + s] != NONE && !boundary.push(3 * ordered_.number(face) + s)) return false;
        return true;
    }

    // The parts of the mesh; their number.
    uint32_t connect() {
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) part_[v] = v;
        // A lower neighbor, if there is one: trees that cover almost everything.
        for (uint32_t h = 0; h < side_count_; h += 2) {
            const uint32_t v = mesh_.origin[h], w = mesh_.origin[h + 1];
            part_[std::max(v, w)] = std::min(v, w);
        }
        uint32_t parts = 0;
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) parts += part_[v] == v;
        for (uint32_t h = 0; h < side_count_ && parts > 1; h += 2)
            parts -= unite(part_, mesh_.origin[h], mesh_.origin[h + 1]);
        return parts;
    }

    // The words become half-edges.
    Done make_faces() {
        const auto number_sides = [&](size_t begin, size_t end) {
            for (size_t h = begin; h < end; ++h) words_[sorted_[h]] = static_cast<uint32_t>(h);
        };
        const auto link = [&](size_t begin, size_t end) {
            for (size_t face = begin; face < end; ++face) {
                const uint32_t* const h = words_ + 4 * face;
                for (uint32_t s = 0; s < 3; ++s) {
                    mesh_.next[h[s]] = h[s == 2 ? 0 : s + 1];
                    mesh_.face[h[s]] = static_cast<uint32_t>(face);
                }
            }
        };
        if (!call_.pass(side_count_, 0.09, number_sides) || !call_.pass(mesh_.face_count, 0.1, link)) return false;
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) degree_[v] = 0;
        for (uint32_t face = 0; face < mesh_.face_count; ++face)
            for (uint32_t s = 0; s < 3; ++s) {
                const uint32_t h = words_[size_t{4} * face + s], v = mesh_.origin[h];
                ++degree_[v];
                mesh_.out[v] = h; // that of its last triangle
            }
        return true;
    }

    // --- Messages ---

    uint32_t number(uint32_t side) const { return ordered_.number(side / 4); }
    uint32_t corner(uint32_t triangle, uint32_t s) const { return caller_.triangles[size_t{3} * triangle + s % 3]; }

    // The third triangle at the edge of this side, by the caller's numbers.
    hmf_status third(uint32_t side) const {
        const uint32_t a = corner(number(side), side % 4), b = corner(number(side), side % 4 + 1);
        uint32_t seen = 0;
        for (uint32_t t = 0;; ++t)
            for (uint32_t s = 0; s < 3; ++s) {
                const uint32_t from = corner(t, s), to = corner(t, s + 1);
                const bool is_there = (from == a && to == b) || (from == b && to == a);
                if (!is_there || ++seen < 3) continue;
                return call_.fail(HMF_ERROR_MESH_NON_MANIFOLD_EDGE, HMF_ELEMENT_TRIANGLE, t,
                                  "Triangle %u is the third one at the edge between the vertices %u and %u. Remove one "
                                  "of them, or duplicate the vertices to separate the sheets.",
                                  t, from, to);
            }
    }
    hmf_status turned(uint32_t side_a, uint32_t side_b) const {
        const uint32_t a = number(side_a), b = number(side_b), s = side_a % 4;
        return call_.fail(
            HMF_ERROR_MESH_ORIENTATION, HMF_ELEMENT_TRIANGLE, a,
            "The triangles %u and %u both run from vertex %u to vertex %u. Reverse one of them; if that is not "
            "possible, the surface is not orientable.",
            a, b, corner(a, s), corner(a, s + 1));
    }

    uint32_t* const words_;
    const OrderedTriangles& ordered_;
    const CallerMesh& caller_;
    Mesh& mesh_;
    Array<uint32_t>& degree_;
    uint32_t* const part_;
    Call& call_;
    // Lists of sides in arrays that are filled later: by block and by bucket; by vertex and by half-edge.
    uint32_t *const listed_, *const sorted_;
    const uint32_t side_count_;
    uint32_t shift_ = 12, block_count_ = 0, block_begin_[MOST_BLOCKS + 1];
    Defects defects_[MOST_BLOCKS];
};

} // namespace

hmf_status match_sides(OrderedTriangles& ordered, const CallerMesh& caller, Mesh& mesh, Array<uint32_t>& degree,
                       uint32_t* part, uint32_t& part_count, Array<uint32_t>& boundary, Call& call) {
    boundary.start(call.memory);
    return Matcher(ordered, caller, mesh, degree, part, call).run(boundary, part_count);
}

} // namespace hmf
