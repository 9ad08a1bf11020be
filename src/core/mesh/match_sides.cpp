// Matching of sides in linear time.  The sides of the triangles go to the bucket
// of their lower vertex, and are matched there:
//
//     bucket of u:   (u,v) (u,w) (v,u) (u,x) ...      two of each, in opposite
//                      ^-----------^                  directions: an edge
//
// Triangles come in the order of their lowest vertex, which has two of the three
// sides in its bucket; the third one goes to the bucket of its own lower vertex, which comes later.  So one pass sees
// each bucket when it is complete,
// and all that it touches is near in memory.
//
// In blocks of vertices, each with the triangles whose lowest vertex it has.  A third side may belong to a bucket of a
// later block: such triangles are listed, and their sides are added to the lists of that block before the blocks start.
// As a bucket has
// its sides in an order that blocks do not change, neither do the edges.
#include "match_sides.hpp"

#include "../base/disjoint_sets.hpp"
#include "../base/heap_sort.hpp"

#include <algorithm>

namespace hmf {

namespace {

// A side is a place in OrderedTriangles::words: 4 * face + corner.
uint32_t side_after_in_face(uint32_t side) { return side % 4 == 2 ? side - 2 : side + 1; }

// Sides with the same lower vertex and the same key belong together.  In a double
// the two vertices are not enough: they may have one edge in front and one behind.
struct PlainKeys {
    uint32_t operator()(uint32_t high, uint32_t) const { return high; }
};
struct DoubleKeys {
    const OrderedTriangles& ordered;
    const CallerMesh& caller;
    uint32_t vertex_count;
    uint32_t operator()(uint32_t high, uint32_t place) const {
        const uint32_t triangle = ordered.number(place / 4), m = caller.mirror.triangle_count;
        if (triangle < m) return high;
        const uint32_t front = 3 * (triangle - m) + (2 - place % 4); // the side that it is the image of
        return caller.boundary_side[front] ? high : high + vertex_count;
    }
};

// Room for the largest bucket.
struct Bucket {
    static constexpr uint32_t FEW = 32; // sides that are compared with each other, without sorting
    uint32_t *key, *place;
    uint64_t* pair; // the second side of an edge, and below it the first one, by their numbers in it
    uint32_t size, pairs;
    Call* call; // for reports, where one thread does all; or NULL

    bool work(uint64_t steps) const { return !call || call->work(steps, 0.06, false); }
    void add(uint32_t side_key, uint32_t side_place) {
        key[size] = side_key;
        place[size++] = side_place;
    }
    // Pairs in the order of their second sides.  Returns the first side that is a third one, or NONE.
    uint32_t match() {
        pairs = 0;
        if (size > FEW) return match_sorted();
        // Which sides are second ones cannot be predicted, so no branch depends on it: what is written for
        // the others is overwritten.
        uint8_t is_second[FEW + 1]; // and a place for a side that is alone so far
        is_second[FEW] = 0;
        uint32_t third = NONE;
        for (uint32_t n = 0; n < size; ++n) {
            uint32_t same = FEW;
            for (uint32_t m = 0; m < n; ++m) same = key[m] == key[n] ? m : same;
            if (is_second[same]) third = std::min(third, n);
            is_second[n] = same != FEW;
            pair[pairs] = uint64_t{n} << 32 | same;
            pairs += same != FEW;
        }
        return third;
    }
    // Sides without another one, in order; the keys are gone then.
    template <class Visit>
    void for_each_alone(Visit visit) {
        if (2 * pairs == size) return;
        for (uint32_t n = 0; n < size; ++n) key[n] = 1;
        for (uint32_t k = 0; k < pairs; ++k) key[pair[k] >> 32] = key[static_cast<uint32_t>(pair[k])] = 0;
        for (uint32_t n = 0; n < size; ++n)
            if (key[n]) visit(n);
    }

private:
    uint32_t match_sorted() {
        const auto lower = [](uint64_t a, uint64_t b) { return a < b; };
        for (uint32_t n = 0; n < size; ++n) pair[n] = uint64_t{key[n]} << 32 | n;
        const auto go_on = [this] { return work(128); };
        if (!heap_sort(pair, size, lower, go_on)) return NONE;
        uint32_t third = NONE;
        bool after_second = false;
        for (uint32_t n = 1; n < size; ++n) { // pairs are written over what has been read
            const bool same = pair[n] >> 32 == pair[n - 1] >> 32;
            const uint32_t here = static_cast<uint32_t>(pair[n]);
            if (same && after_second) third = std::min(third, here);
            else if (same) pair[pairs++] = uint64_t{here} << 32 | static_cast<uint32_t>(pair[n - 1]);
            after_second = same;
        }
        (void)heap_sort(pair, pairs, lower, go_on);
        return third;
    }
};

// Vertices v with the same v >> shift, and the faces whose lowest vertex is one of them.
struct Block {
    uint32_t face = 0, face_end = 0;
    uint32_t listed = 0;      // faces with a corner outside
    uint32_t sides = 0;       // in its buckets
    uint32_t half_edge = 0;   // its first one; it has as many as sides
    uint32_t unmatched = 0;   // sides
    uint32_t crossing = 0;    // edges that leave it
    uint32_t parts = 0;       // that its vertices fall into, by edges inside
    uint32_t third = NONE;    // a side of an edge that has two already
    uint32_t turned[2] = {0}; // two sides with the same direction, if there are any
};

class Matcher {
public:
    Matcher(OrderedTriangles& ordered, const CallerMesh& caller, Mesh& mesh, Array<uint32_t>& degree, uint32_t* part,
            Call& call) :
        words_(ordered.words.data()),
        ordered_(ordered), caller_(caller), mesh_(mesh), degree_(degree), part_(part), call_(call),
        waiting_high_(mesh.next), waiting_next_(mesh.face), listed_(mesh.face + mesh.face_count),
        crossing_(mesh.next + mesh.face_count) {}

    hmf_status run(Array<uint32_t>& boundary, uint32_t& part_count) {
        cut();
        each_block([&](uint32_t k) { list_faces(k); });
        for (uint32_t k = 0; k < block_count_; ++k) put_listed(blocks_[k], k);
        uint32_t half_edge = 0;
        for (uint32_t k = 0; k < block_count_; ++k) {
            blocks_[k].half_edge = half_edge;
            half_edge += blocks_[k].sides;
        }
        if (!call_.tick(0.06)) return HMF_CANCELLED;
        const hmf_status status = caller_.mirror.triangle_count == 0
                                    ? match(PlainKeys{})
                                    : match(DoubleKeys{ordered_, caller_, mesh_.vertex_count});
        if (status) return status;
        for (uint32_t k = 0; k < block_count_; ++k)
            if (blocks_[k].third != NONE || blocks_[k].turned[0] != blocks_[k].turned[1]) return refuse(blocks_[k]);
        if (!take_boundary(boundary)) return call_.out_of_memory();
        if (!boundary.empty()) return HMF_OK;
        if (!call_.tick(0.09)) return HMF_CANCELLED;
        each_block([&](uint32_t k) { connect(k); });
        part_count = join_blocks();
        if (!call_.tick(0.1)) return HMF_CANCELLED;
        each_block([&](uint32_t k) { make_faces(k); });
        return HMF_OK;
    }

private:
    static constexpr uint32_t MOST_BLOCKS = 64, SMALLEST_SHIFT = 12;
    static constexpr uint32_t LARGEST_SHARED = 512; // degree; with larger ones buckets for each slot could be huge

    template <class F>
    void each_block(F f) {
        call_.parallel.for_each(block_count_, [&](uint32_t k, uint32_t) { f(k); });
    }
    bool is_in(uint32_t v, uint32_t k) const { return v >> shift_ == k; }
    uint32_t lowest(uint32_t face) const {
        const uint32_t* v = words_ + size_t{4} * face;
        const uint32_t low = std::min(v[0], v[1]);
        return std::min(low, v[2]);
    }
    // Of a face: its lowest vertex and the two others, the sides that begin there, the third one opposite.
    struct Corners {
        uint32_t low, v, w;
        uint32_t first, third, last; // places: low -> v -> w -> low
    };
    Corners corners(uint32_t face, uint32_t low) const {
        const uint32_t place = 4 * face, s = (words_[place + 1] == low) + 2 * (words_[place + 2] == low);
        const uint32_t first = place + s, third = side_after_in_face(first), last = side_after_in_face(third);
        return {low, words_[third], words_[last], first, third, last};
    }
    uint32_t first_vertex(uint32_t k) const { return k << shift_; }
    uint32_t vertex_end(uint32_t k) const { return k + 1 == block_count_ ? mesh_.vertex_count : first_vertex(k + 1); }

    void cut() {
        // One thread needs no blocks.
        shift_ = call_.parallel.slots() > 1 ? SMALLEST_SHIFT : 31;
        while ((mesh_.vertex_count - 1) >> shift_ >= MOST_BLOCKS) ++shift_;
        block_count_ = ((mesh_.vertex_count - 1) >> shift_) + 1;
        uint32_t face = 0;
        for (uint32_t k = 0; k < block_count_; ++k) {
            blocks_[k].face = face;
            uint32_t end = mesh_.face_count; // the first face with a lowest vertex behind the block
            while (face < end) {
                const uint32_t middle = face + (end - face) / 2;
                if (lowest(middle) >> shift_ <= k) face = middle + 1;
                else end = middle;
            }
            blocks_[k].face_end = face;
        }
    }

    // Corners inside are counted; faces with another one are listed: by the side that waits outside, else by
    // the place behind the third corner.
    void list_faces(uint32_t k) {
        Block& block = blocks_[k];
        for (uint32_t v = first_vertex(k); v < vertex_end(k); ++v) {
            degree_[v] = 0;
            mesh_.out[v] = NONE; // lists of sides for later buckets begin here
        }
        uint32_t* const list = listed_ + block.face;
        block.sides = 3 * (block.face_end - block.face);
        for (uint32_t face = block.face; face < block.face_end; ++face) {
            const Corners at = corners(face, lowest(face));
            const bool has_v = is_in(at.v, k), has_w = is_in(at.w, k);
            ++degree_[at.low];
            if (has_v && has_w) { // nearly always
                ++degree_[at.v];
                ++degree_[at.w];
                continue;
            }
            const bool waits_outside = !has_v && !has_w;
            if (has_v) ++degree_[at.v];
            if (has_w) ++degree_[at.w];
            block.sides -= waits_outside;
            list[block.listed++] = waits_outside ? at.third : 4 * face + 3;
        }
    }

    void put_listed(const Block& block, uint32_t k) {
        for (uint32_t n = 0; n < block.listed; ++n) {
            const uint32_t side = listed_[block.face + n], face = side / 4;
            for (uint32_t s = 0; s < 3; ++s) {
                const uint32_t v = words_[4 * face + s];
                if (!is_in(v, k)) ++degree_[v];
            }
            if (side % 4 == 3) continue;
            const uint32_t v = words_[side], w = words_[side_after_in_face(side)], low = std::min(v, w);
            wait(side, low, std::max(v, w));
            ++blocks_[low >> shift_].sides;
        }
    }
    void wait(uint32_t side, uint32_t low, uint32_t high) {
        waiting_high_[side / 4] = high;
        waiting_next_[side / 4] = mesh_.out[low];
        mesh_.out[low] = side;
    }

    template <class Keys>
    hmf_status match(const Keys& keys) {
        struct Largest {
            uint32_t degree = 0;
            void operator+=(const Largest& other) { degree = std::max(degree, other.degree); }
        };
        const size_t room = 2
                          * size_t{call_.parallel
                                       .sum_blocks<Largest>(mesh_.vertex_count,
                                                            [&](size_t begin, size_t end) {
                                                                Largest here;
                                                                for (size_t v = begin; v < end; ++v)
                                                                    here += {degree_[v]};
                                                                return here;
                                                            })
                                       .degree};
        const Parallel parallel = room <= 2 * LARGEST_SHARED ? call_.parallel : Parallel();
        Array<uint32_t> sides;
        Array<uint64_t> pairs;
        if (!sides.allocate(call_.memory, 2 * room * parallel.slots())
            || !pairs.allocate(call_.memory, (room + 1) * parallel.slots()))
            return call_.out_of_memory();
        parallel.for_each(block_count_, [&](uint32_t k, uint32_t slot) {
            uint32_t* const first = sides.data() + 2 * room * slot;
            Bucket bucket = {
                first, first + room, pairs.data() + (room + 1) * slot, 0, 0, parallel.slots() == 1 ? &call_ : nullptr};
            match_block(k, keys, bucket);
        });
        return call_.cancelled() ? HMF_CANCELLED : HMF_OK;
    }

    // The sides with this lower vertex.  face: the first one that has it as its lowest; moved on.
    template <class Keys>
    void gather(uint32_t k, uint32_t low, const Keys& keys, uint32_t& face, Bucket& bucket) {
        bucket.size = 0;
        for (; face < blocks_[k].face_end; ++face) {
            const uint32_t* const corner = words_ + size_t{4} * face;
            if ((corner[0] != low) & (corner[1] != low) & (corner[2] != low)) break;
            const Corners at = corners(face, low);
            bucket.add(keys(at.v, at.first), at.first);
            bucket.add(keys(at.w, at.last), at.last);
            const uint32_t lower = std::min(at.v, at.w);
            if (is_in(lower, k)) wait(at.third, lower, std::max(at.v, at.w));
        }
        for (uint32_t third = mesh_.out[low]; third != NONE; third = waiting_next_[third / 4])
            bucket.add(keys(waiting_high_[third / 4], third), third);
    }

    // Sides become half-edges, those without another one are put behind.
    template <class Keys>
    void match_block(uint32_t k, const Keys& keys, Bucket& bucket) {
        Block& block = blocks_[k];
        uint32_t face = block.face, h = block.half_edge, end = h + block.sides;
        const uint32_t first_place = 4 * block.face;
        const auto make_half_edge = [&](uint32_t place) {
            mesh_.origin[h] = words_[place];
            // The words of other blocks are read by them meanwhile.
            *(place < first_place ? waiting_high_ + place / 4 : words_ + place) = h++;
        };
        for (uint32_t low = first_vertex(k); low < vertex_end(k); ++low) {
            gather(k, low, keys, face, bucket);
            const uint32_t third = bucket.match();
            if (!bucket.work(16 + 16 * uint64_t{bucket.size})) return;
            if (third != NONE) {
                block.third = bucket.place[third];
                return;
            }
            for (uint32_t n = 0; n < bucket.pairs; ++n) {
                const uint64_t pair = bucket.pair[n];
                const uint32_t a = bucket.place[static_cast<uint32_t>(pair)], b = bucket.place[pair >> 32];
                if (words_[a] == words_[b]) {
                    block.turned[0] = a;
                    block.turned[1] = b;
                }
                make_half_edge(a);
                make_half_edge(b);
            }
            bucket.for_each_alone([&](uint32_t n) { mesh_.origin[--end] = bucket.place[n]; });
            if (block.turned[0] != block.turned[1]) return;
        }
        block.unmatched = block.half_edge + block.sides - end;
    }

    Done take_boundary(Array<uint32_t>& boundary) const {
        for (uint32_t k = 0; k < block_count_; ++k) {
            const Block& block = blocks_[k];
            for (uint32_t n = 0; n < block.unmatched; ++n) {
                const uint32_t side = mesh_.origin[block.half_edge + block.sides - 1 - n];
                if (!boundary.push(3 * ordered_.number(side / 4) + side % 4)) return false;
            }
        }
        return true;
    }

    // Half-edges of sides that waited outside, and the parts of the block.
    void connect(uint32_t k) {
        Block& block = blocks_[k];
        for (uint32_t n = 0; n < block.listed; ++n) {
            const uint32_t side = listed_[block.face + n];
            if (side % 4 != 3) words_[side] = waiting_high_[side / 4];
        }
        const uint32_t begin = first_vertex(k), end = vertex_end(k), half_edge_end = block.half_edge + block.sides;
        for (uint32_t v = begin; v < end; ++v) part_[v] = v;
        // A lower neighbor, if there is one: trees that cover almost everything.
        uint32_t* const list = crossing_ + block.half_edge / 2;
        for (uint32_t h = block.half_edge; h < half_edge_end; h += 2) {
            const uint32_t low = std::min(mesh_.origin[h], mesh_.origin[h + 1]),
                           high = std::max(mesh_.origin[h], mesh_.origin[h + 1]);
            const bool inside = is_in(high, k);
            list[block.crossing] = h;
            block.crossing += !inside;
            part_[inside ? high : low] = inside ? low : part_[low];
        }
        for (uint32_t v = begin; v < end; ++v) {
            block.parts += part_[v] == v;
            part_[v] = part_[part_[v]];
        }
        for (uint32_t h = block.half_edge; h < half_edge_end && block.parts > 1; h += 2) {
            const uint32_t v = mesh_.origin[h], w = mesh_.origin[h + 1];
            if (is_in(std::max(v, w), k) && part_[v] != part_[w]) block.parts -= unite(part_, v, w);
        }
    }

    // Number of all parts.  A corner outside of the block of its face gets a first half-edge, which
    // make_faces overwrites if there is a later one.
    uint32_t join_blocks() {
        uint32_t parts = 0;
        for (uint32_t k = 0; k < block_count_; ++k) parts += blocks_[k].parts;
        for (uint32_t k = 0; k < block_count_; ++k) {
            const Block& block = blocks_[k];
            for (uint32_t n = 0; n < block.crossing && parts > 1; ++n) {
                const uint32_t h = crossing_[block.half_edge / 2 + n];
                parts -= unite(part_, mesh_.origin[h], mesh_.origin[h + 1]);
            }
            for (uint32_t n = 0; n < block.listed; ++n) {
                const uint32_t* h = words_ + (listed_[block.face + n] & ~3u);
                for (uint32_t s = 0; s < 3; ++s)
                    if (!is_in(mesh_.origin[h[s]], k)) mesh_.out[mesh_.origin[h[s]]] = h[s];
            }
        }
        return parts;
    }

    // In order: the last triangle of a vertex counts.
    void make_faces(uint32_t k) {
        for (uint32_t face = blocks_[k].face; face < blocks_[k].face_end; ++face) {
            const uint32_t* h = words_ + size_t{4} * face;
            for (uint32_t s = 0; s < 3; ++s) {
                mesh_.next[h[s]] = h[s == 2 ? 0 : s + 1];
                mesh_.face[h[s]] = face;
                const uint32_t v = mesh_.origin[h[s]];
                if (is_in(v, k)) mesh_.out[v] = h[s];
            }
        }
    }

    // --- Messages ---

    hmf_status refuse(const Block& block) const { return block.third != NONE ? third(block.third) : turned(block); }
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
    hmf_status turned(const Block& block) const {
        const uint32_t a = number(block.turned[0]), b = number(block.turned[1]), s = block.turned[0] % 4;
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
    // Lists in arrays that are filled later: of sides that wait, by face, each with its higher vertex and the
    // next one (mesh.out has the first); of listed faces and crossing edges, by block.
    uint32_t *const waiting_high_, *const waiting_next_, *const listed_, *const crossing_;
    Block blocks_[MOST_BLOCKS];
    uint32_t shift_ = 0, block_count_ = 0;
};

} // namespace

hmf_status match_sides(OrderedTriangles& ordered, const CallerMesh& caller, Mesh& mesh, Array<uint32_t>& degree,
                       uint32_t* part, uint32_t& part_count, Array<uint32_t>& boundary, Call& call) {
    boundary.start(call.memory);
    return Matcher(ordered, caller, mesh, degree, part, call).run(boundary, part_count);
}

} // namespace hmf
