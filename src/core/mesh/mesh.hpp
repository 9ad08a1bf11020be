// Edge-index mesh: edges are the main element.  Edge e has the two half-edges
// 2e and 2e+1; twin(h) = h ^ 1.  A half-edge knows where it starts, what
// follows it in its triangle, and its triangle:
//
//              k
//             / ^           left triangle of h = (h, next h, next next h)
//  next      /   \          origin(h) = i,  origin(twin h) = j
//  next h   v     \ next h
//          i --h--> j
//
// Nothing here assumes that two vertices share at most one edge, or that the
// ends of an edge differ: intrinsic triangulations need both.
#pragma once

#include <cstdint>

#include "../base/memory.hpp"
#include "../base/prefetch.hpp"

namespace hmf {

constexpr uint32_t NONE = 0xffffffffu;

inline uint32_t twin(uint32_t h) { return h ^ 1u; }
inline uint32_t edge_of(uint32_t h) { return h >> 1; }

// The half-edges that start at one vertex, once round:
//
//     for (const uint32_t h : mesh.around(v)) ...
//
// The connectivity must not change meanwhile.
template <bool clockwise>
class OneRing {
public:
    OneRing(const uint32_t* next, uint32_t first) : next_(next), first_(first) {}
    struct End {};
    class Iterator {
    public:
        Iterator(const uint32_t* next, uint32_t first) : next_(next), first_(first), h_(first) {}
        uint32_t operator*() const { return h_; }
        Iterator& operator++() {
            h_ = clockwise ? next_[twin(h_)] : twin(next_[next_[h_]]);
            moved_ = true;
            return *this;
        }
        bool operator!=(End) const { return h_ != first_ || !moved_; }

    private:
        const uint32_t* next_;
        uint32_t first_, h_;
        bool moved_ = false;
    };
    Iterator begin() const { return {next_, first_}; }
    End end() const { return {}; }

private:
    const uint32_t* next_;
    uint32_t first_;
};

// Arrays of a mesh, owned elsewhere.
struct Mesh {
    uint32_t vertex_count = 0, edge_count = 0, face_count = 0;
    uint32_t* origin = nullptr; // 2 * edge_count
    uint32_t* next = nullptr;   // 2 * edge_count
    uint32_t* face = nullptr;   // 2 * edge_count
    uint32_t* out = nullptr;    // vertex_count: any half-edge that starts at the vertex
    uint32_t marked_count = 0;  // vertices 0 .. marked_count - 1 are marked (foliation.hpp)

    int64_t euler() const { return int64_t{vertex_count} - edge_count + face_count; }
    bool is_marked(uint32_t v) const { return v < marked_count; }

    uint32_t prev(uint32_t h) const { return next[next[h]]; }
    // The half-edges a, b, c become the sides of a face, in this order.
    void set_triangle(uint32_t a, uint32_t b, uint32_t c, uint32_t f) {
        next[a] = b;
        next[b] = c;
        next[c] = a;
        face[a] = face[b] = face[c] = f;
    }
    uint32_t target(uint32_t h) const { return origin[twin(h)]; }
    // The next half-edge out of origin(h), counter-clockwise and clockwise.
    uint32_t rotate_ccw(uint32_t h) const { return twin(prev(h)); }
    uint32_t rotate_cw(uint32_t h) const { return next[twin(h)]; }
    // All of them, counter-clockwise from out[v], from h, and clockwise from h.
    OneRing<false> around(uint32_t v) const { return {next, out[v]}; }
    OneRing<false> around_from(uint32_t h) const { return {next, h}; }
    OneRing<true> clockwise_from(uint32_t h) const { return {next, h}; }
    uint32_t degree(uint32_t v) const {
        uint32_t count = 0;
        for (const uint32_t h : around(v)) count += h != NONE;
        return count;
    }
};

// What a collapse removed and where to put it back (collapse.cpp).
// All members are half-edges, but vertex (j) and the two faces.
struct Collapse {
    uint32_t h;                             // i -> j, removed with its edge
    uint32_t jk;                            // next h, removed with its edge
    uint32_t lj;                            // previous of twin h, removed with its edge
    uint32_t ki;                            // stays, takes the place of k -> j
    uint32_t il;                            // stays, takes the place of j -> l
    uint32_t vertex, face_left, face_right; // removed
};

// Link condition: the ends of h have no other edge between them, and exactly the
// two opposite vertices are common neighbors, through single edges.  marks:
// vertex_count zeros, left as found.
bool can_collapse(const Mesh& mesh, uint32_t h, uint8_t* marks);

//          k                     k
//        / | \                   |
//       i--h->j     ->     .. -- i -- ..
//        \ | /                   |
//          l                     l
//
// Merges j into i, removes three edges and two triangles.
Collapse collapse(Mesh& mesh, uint32_t h);

// Exact reversal of the last collapse: restores the connectivity. Works also on a copy that never held the removed
// elements. Does not change the counts.
void split(Mesh& mesh, const Collapse& c);

// Prefetches the data of a split that comes soon, if log[i] is reversed at present, down to `begin`.
HMF_INLINE void prefetch_split(const Mesh& mesh, const Collapse* log, size_t i, size_t begin) {
    constexpr size_t ahead = 8;
    if (i < begin + ahead) return;
    const Collapse& soon = log[i - ahead];
    const uint32_t sides[] = {soon.ki, soon.il, soon.h, soon.jk, soon.lj};
    for (const uint32_t h : sides) {
        prefetch(&mesh.next[h]);
        prefetch(&mesh.origin[h]);
        prefetch(&mesh.face[h]);
    }
    prefetch(&mesh.out[soon.vertex]);
}

//          k                     k
//        /   \                 / ^ \     .
//       i--h->j      ->       i  h  j      h turns counter-clockwise
//        \   /                 \ | /
//          l                     l
//
// Rotates half-edge 2e from i -> j to l -> k.  unflip is its exact reversal.
void flip(Mesh& mesh, uint32_t edge);
void unflip(Mesh& mesh, uint32_t edge);
// The same if only mesh.next is needed.
void unflip_sides(uint32_t* next, uint32_t edge);

} // namespace hmf
