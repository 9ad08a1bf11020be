// Edge flip and its exact reversal ([W] 4.1 and 4.2.2), without copies of the
// edge: the number of an edge is kept, so values can stay in their place.
//
//          k                     k
//        / A \                 / ^ \                                        .
//       i--h->j      ->       i A|B j       A = face(h), B = face(twin h)
//        \ B /                 \ h /
//          l                     l
//
// Four flips turn an edge once; flip and unflip differ in the sense only.
#include "mesh.hpp"

namespace hmf {

namespace {

void set_sides(uint32_t* next, uint32_t a, uint32_t b, uint32_t c) {
    next[a] = b;
    next[b] = c;
    next[c] = a;
}

// counter_clockwise: flip, which takes the sides in the order h, jk, ki, il, lj; unflip takes h, ki, il, lj, jk.
template <bool counter_clockwise>
void turn(Mesh& mesh, uint32_t edge) {
    const uint32_t h = 2 * edge, a = mesh.next[h], b = mesh.next[a];
    const uint32_t t = twin(h), c = mesh.next[t], d = mesh.next[c];
    const uint32_t left = mesh.face[h], right = mesh.face[t];
    assert(left != right);
    mesh.out[mesh.origin[h]] = c;
    mesh.out[mesh.origin[t]] = a;
    mesh.origin[h] = mesh.origin[counter_clockwise ? d : b];
    mesh.origin[t] = mesh.origin[counter_clockwise ? b : d];
    mesh.set_triangle(h, counter_clockwise ? b : d, counter_clockwise ? c : a, left);
    mesh.set_triangle(t, counter_clockwise ? d : b, counter_clockwise ? a : c, right);
}

} // namespace

void flip(Mesh& mesh, uint32_t edge) { turn<true>(mesh, edge); }

void unflip(Mesh& mesh, uint32_t edge) { turn<false>(mesh, edge); }

void unflip_sides(uint32_t* next, uint32_t edge) {
    const uint32_t h = 2 * edge, ki = next[h], il = next[ki];
    const uint32_t t = twin(h), lj = next[t], jk = next[lj];
    set_sides(next, h, jk, ki);
    set_sides(next, t, il, lj);
}

} // namespace hmf
