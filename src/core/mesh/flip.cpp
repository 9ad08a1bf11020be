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

} // namespace

void flip(Mesh& mesh, uint32_t edge) {
    const uint32_t h = 2 * edge, jk = mesh.next[h], ki = mesh.next[jk];
    const uint32_t t = twin(h), il = mesh.next[t], lj = mesh.next[il];
    const uint32_t left = mesh.face[h], right = mesh.face[t];
    assert(left != right);
    mesh.out[mesh.origin[h]] = il;
    mesh.out[mesh.origin[t]] = jk;
    mesh.origin[h] = mesh.origin[lj];
    mesh.origin[t] = mesh.origin[ki];
    mesh.set_triangle(h, ki, il, left);
    mesh.set_triangle(t, lj, jk, right);
}

void unflip(Mesh& mesh, uint32_t edge) {
    const uint32_t h = 2 * edge, ki = mesh.next[h], il = mesh.next[ki];
    const uint32_t t = twin(h), lj = mesh.next[t], jk = mesh.next[lj];
    const uint32_t left = mesh.face[h], right = mesh.face[t];
    assert(left != right);
    mesh.out[mesh.origin[h]] = lj;
    mesh.out[mesh.origin[t]] = ki;
    mesh.origin[h] = mesh.origin[il];
    mesh.origin[t] = mesh.origin[jk];
    mesh.set_triangle(h, jk, ki, left);
    mesh.set_triangle(t, il, lj, right);
}

void unflip_sides(uint32_t* next, uint32_t edge) {
    const uint32_t h = 2 * edge, ki = next[h], il = next[ki];
    const uint32_t t = twin(h), lj = next[t], jk = next[lj];
    set_sides(next, h, jk, ki);
    set_sides(next, t, il, lj);
}

} // namespace hmf
