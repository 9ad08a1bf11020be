// Restriction: collapsing the edge from i to j means that the image of j in the
// tree goes to the image of i.
//
//     .. i ------ j ..          .. i=j ..         F(j, x) = d(i, x) for all
//                                                 neighbours x of j
//
// The way is the path from j to i in the tree, in legal Whitehead moves from
// branch point to branch point (whitehead.hpp), with all that has to move along
// (cluster_move.cpp).
// Once F_ij = 0, the collapse leaves the boundary of the cluster as it is.
#include "restriction.hpp"

namespace hmf {

bool RestrictionScratch::allocate(Memory& from) {
    memory = &from;
    return room_for(32);
}

bool RestrictionScratch::room_for(uint32_t degree) {
    if (degree <= side.size()) return true;
    return star.allocate(*memory, 2 * degree) && side.allocate(*memory, 2 * degree);
}

namespace {

// Number of sides of v, 0 if there is no memory for them.
uint32_t read_sides(const Mesh& mesh, uint32_t v, RestrictionScratch& scratch) {
    const uint32_t first = mesh.out[v];
    uint32_t degree = 0, h = first;
    do {
        ++degree;
        h = mesh.rotate_ccw(h);
    } while (h != first);
    if (!scratch.room_for(degree)) return 0;
    for (uint32_t t = 0; t < degree; ++t, h = mesh.rotate_ccw(h)) scratch.side[t] = {h, edge_of(mesh.next[h])};
    return degree;
}

// One move of the origin of g (with what it pushes) towards the target of g,
// up to the next branch point, neighbour, or the target.
void move_along(Foliation& f, uint32_t g, RestrictionScratch& scratch) {
    const uint32_t degree = read_sides(f.mesh, f.mesh.origin[g], scratch);
    if (degree == 0) {
        f.out_of_memory = true;
        return;
    }
    Star& star = scratch.star;
    const Rings::Side* side = scratch.side.data();
    star.budget = NONE;
    read_star(f, side, degree, nullptr, star);
    for (uint32_t t = 0; t < degree; ++t)
        if (side[t].half_edge == g) star.best = star.group[t];
    plan_move(f, side, star); // all is known: no limit to the search, no edge from a vertex to itself
    if (!f.out_of_memory) apply_move(f, side, star, room_for_move(f, side, star));
}

} // namespace

void move_to_end(Foliation& f, uint32_t h, RestrictionScratch& scratch) {
    // Each move lands on a branch point, on a neighbour, or arrives.
    while (f.at(h) > 0 && !f.out_of_memory) move_along(f, h, scratch);
}

void collapse_foliation(Foliation& f, const Collapse& c, RestrictionScratch& scratch) {
    move_to_end(f, twin(c.h), scratch);
    collapse(f.mesh, c.h);
}

} // namespace hmf
