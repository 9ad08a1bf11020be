// Restriction: collapsing the edge from i to j means that the image of j in the
// tree goes to the image of i.
//
//     .. i ------ j ..          .. i=j ..         F(j, x) = d(i, x) for all
//                                                 neighbors x of j
//
// The way is the path from j to i in the tree, in legal Whitehead moves from
// branch point to branch point (whitehead.hpp), with all that has to move along
// (cluster_move.cpp).
// Once F_ij = 0, the collapse leaves the boundary of the cluster as it is.
#include "restriction.hpp"

namespace hmf {

Done RestrictionScratch::allocate(Memory& from) {
    memory = &from;
    return room_for(32);
}

Done RestrictionScratch::room_for(uint32_t degree) {
    if (degree <= side.size()) return true;
    return star.allocate(*memory, 2 * degree) && side.allocate(*memory, 2 * degree);
}

namespace {

// The sides of v into scratch.side.
Done read_sides(const Mesh& mesh, uint32_t v, RestrictionScratch& scratch, uint32_t& degree) {
    degree = mesh.degree(v);
    if (!scratch.room_for(degree)) return false;
    uint32_t t = 0;
    for (const uint32_t h : mesh.around(v)) scratch.side[t++] = {h, edge_of(mesh.next[h])};
    return true;
}

// One move of the origin of g, with the parts that it pushes, towards the target of g: up to the next branch point,
// neighbor, or the target.
Done move_along(Foliation& f, uint32_t g, RestrictionScratch& scratch) {
    uint32_t degree = 0;
    if (!read_sides(f.mesh, f.mesh.origin[g], scratch, degree)) return false;
    Star& star = scratch.star;
    const Rings::Side* side = scratch.side.data();
    star.budget = NONE;
    read_star(f, side, degree, nullptr, star);
    for (uint32_t t = 0; t < degree; ++t)
        if (side[t].half_edge == g) star.best = star.group[t];
    plan_move(f, side, star); // all is known: no limit to the search, no edge from a vertex to itself
    apply_move(f, side, star, room_for_move(f, side, star));
    return true;
}

} // namespace

Done move_to_end(Foliation& f, uint32_t h, RestrictionScratch& scratch) {
    // Each move ends at a branch point, at a neighbor, or at the target.
    while (f.at(h) > 0)
        if (!move_along(f, h, scratch)) return false;
    return true;
}

Done collapse_foliation(Foliation& f, const Collapse& c, RestrictionScratch& scratch) {
    if (!move_to_end(f, twin(c.h), scratch)) return false;
    collapse(f.mesh, c.h);
    return true;
}

} // namespace hmf
