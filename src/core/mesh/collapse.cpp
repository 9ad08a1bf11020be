// Edge collapse and its exact reversal ([W] 4.1 and 4.2.3).
//
//          k                        k
//        / | \                      |
//    A  i--h->j  A'      ->      .. i ..       j's fan, from k clockwise to l,
//        \ | /                      |          is taken over by i
//          l                        l
//
// On the side of k two edges become one: ki takes the place of kj in the outer
// triangle of kj.  On the side of l, il takes the place of jl.  Which of the
// two stays is fixed, so that the reversal needs nothing but the numbers.
#include "mesh.hpp"

namespace hmf {

namespace {

// Puts half-edge `by` where `old` is in the triangle of old.
void replace(Mesh& mesh, uint32_t old, uint32_t by) {
    const uint32_t after = mesh.next[old], before = mesh.next[after];
    mesh.next[by] = after;
    mesh.next[before] = by;
    mesh.face[by] = mesh.face[old];
}

} // namespace

bool can_collapse(const Mesh& mesh, uint32_t h, uint8_t* marks) {
    const uint32_t jk = mesh.next[h], il = mesh.next[twin(h)];
    const uint32_t i = mesh.origin[h], j = mesh.origin[jk], k = mesh.target(jk), l = mesh.target(il);
    if (i == j || k == l) return false;
    uint32_t shared = 0;
    for (const uint32_t g : mesh.clockwise_from(h)) marks[mesh.target(g)] = 1;
    marks[i] = 1; // a second edge from j to i counts
    for (const uint32_t g : mesh.clockwise_from(jk)) shared += marks[mesh.target(g)];
    for (const uint32_t g : mesh.clockwise_from(h)) marks[mesh.target(g)] = 0;
    marks[i] = 0;
    return shared == 3; // k, l, and i itself
}

Collapse collapse(Mesh& mesh, uint32_t h) {
    Collapse c;
    const uint32_t t = twin(h);
    c.h = h;
    c.jk = mesh.next[h];
    c.ki = mesh.next[c.jk];
    c.il = mesh.next[t];
    c.lj = mesh.next[c.il];
    c.vertex = mesh.origin[t];
    c.face_left = mesh.face[h];
    c.face_right = mesh.face[t];
    const uint32_t i = mesh.origin[h];
    for (uint32_t g = mesh.next[twin(c.jk)]; g != twin(c.lj); g = mesh.rotate_cw(g)) mesh.origin[g] = i;
    replace(mesh, twin(c.jk), c.ki);
    replace(mesh, twin(c.lj), c.il);
    mesh.out[i] = c.il;
    mesh.out[mesh.origin[c.ki]] = c.ki;
    mesh.out[mesh.target(c.il)] = twin(c.il);
    return c;
}

void split(Mesh& mesh, const Collapse& c) {
    const uint32_t i = mesh.origin[c.il], k = mesh.origin[c.ki], l = mesh.target(c.il), j = c.vertex;
    for (uint32_t g = mesh.next[c.ki]; g != c.il; g = mesh.rotate_cw(g)) mesh.origin[g] = j;
    replace(mesh, c.il, twin(c.lj));
    replace(mesh, c.ki, twin(c.jk));
    mesh.set_triangle(c.h, c.jk, c.ki, c.face_left);
    mesh.set_triangle(twin(c.h), c.il, c.lj, c.face_right);
    mesh.origin[c.h] = i;
    mesh.origin[twin(c.h)] = mesh.origin[c.jk] = mesh.origin[twin(c.lj)] = j;
    mesh.origin[twin(c.jk)] = k;
    mesh.origin[c.lj] = l;
    mesh.out[i] = c.h;
    mesh.out[j] = c.jk;
    mesh.out[k] = c.ki;
    mesh.out[l] = c.lj;
}

} // namespace hmf
