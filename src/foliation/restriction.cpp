// Restriction: collapsing the edge from i to j means that the image of j in the
// tree goes to the image of i.
//
//     .. i ------ j ..          .. i=j ..         F(j, x) = d(i, x) for all
//                                                 neighbours x of j
//
// The way is the path from j to i in the tree, in legal Whitehead moves from
// branch point to branch point (whitehead.hpp).  What a move would leave
// behind as an extremum (a neighbour or a piece of the cluster of j that has
// nothing ahead but the direction of the move) is taken along: pushed.  A push
// is a move of a connected set that sits at one point of the tree, into a
// direction that is one for all of it, so it keeps the class like any other.
// Once F_ij = 0, the collapse leaves the boundary of the cluster as it is.
#include "restriction.hpp"

namespace hmf {

bool RestrictionScratch::allocate(Memory& from, uint32_t vertex_count) {
    memory = &from;
    movers.start(from);
    return room_for(32) && movers.reserve(vertex_count) && mover_of.allocate_filled(from, vertex_count, 0);
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

// Adds the parts of the cluster of v that would be left as extrema if v moved
// into direction S alone.
void add_pushed_parts(Foliation& f, uint32_t v, uint32_t degree, uint32_t S, RestrictionScratch& scratch) {
    const Star& star = scratch.star;
    for (uint32_t t = 0; t < degree; ++t) {
        const uint32_t first_zero = t + 1 < degree ? t + 1 : 0;
        if (star.F[t] == 0 || star.F[first_zero] != 0 || star.group[t] != S) continue;
        uint32_t u = first_zero;
        while (star.F[u] == 0) u = u + 1 < degree ? u + 1 : 0;
        if (star.group[u] != S) continue;
        const uint32_t neighbour = f.mesh.target(scratch.side[first_zero].half_edge);
        if (scratch.mover_of[neighbour] == scratch.round) continue;
        const Cluster part = explore_cluster(f, neighbour, NONE, v, NONE, 1, 0);
        if (f.out_of_memory) return;
        if (!part.complete || part.euler != 1) continue;
        uint32_t behind = 0; // sides that fall behind v close a corner of the part
        for (uint32_t s = 0; s < degree; ++s) {
            if (star.F[s] == 0 || star.group[s] == S) continue;
            const uint32_t next = s + 1 < degree ? s + 1 : 0, before = s > 0 ? s - 1 : degree - 1;
            behind += star.F[next] == 0 && f.stamp[f.mesh.target(scratch.side[next].half_edge)] == f.epoch;
            behind += star.F[before] == 0 && f.stamp[f.mesh.target(scratch.side[before].half_edge)] == f.epoch;
        }
        if (behind > 0) continue;
        for (uint32_t w : f.members) {
            scratch.mover_of[w] = scratch.round;
            scratch.movers.push(w);
        }
    }
}

// One move of the origin of g (with what it pushes) towards the target of g,
// up to the next branch point, neighbour, or the target.
void move_along(Foliation& f, uint32_t g, RestrictionScratch& scratch) {
    const Mesh& mesh = f.mesh;
    const uint32_t v = mesh.origin[g];
    const uint32_t degree = read_sides(mesh, v, scratch);
    if (degree == 0) { f.out_of_memory = true; return; }
    Star& star = scratch.star;
    star.budget = NONE;
    read_star(f, scratch.side.data(), degree, nullptr, star);
    uint32_t S = NONE;
    for (uint32_t t = 0; t < degree; ++t)
        if (scratch.side[t].half_edge == g) S = star.group[t];
    ++scratch.round;
    scratch.movers.clear();
    scratch.movers.push(v);
    scratch.mover_of[v] = scratch.round;
    if (star.has_zero) add_pushed_parts(f, v, degree, S, scratch);

    int64_t mu = f.at(g);
    for (uint32_t t = 0; t < degree; ++t) {
        if (star.F[t] == 0 || star.group[t] != S) continue;
        // An edge between two movers, round a handle, gets shorter from both ends.
        const bool both = scratch.mover_of[mesh.target(scratch.side[t].half_edge)] == scratch.round;
        if (star.F[t] / (both ? 2 : 1) < mu) mu = star.F[t] / (both ? 2 : 1);
        const uint32_t u = t + 1 < degree ? t + 1 : 0;
        if (star.F[u] != 0 && star.group[u] == S && star.corner2[t] > 0 && star.corner2[t] / 2 < mu) mu = star.corner2[t] / 2;
    }
    for (size_t i = 1; i < scratch.movers.size(); ++i) {
        const uint32_t first = mesh.out[scratch.movers[i]];
        uint32_t h = first;
        do {
            const uint32_t ahead = mesh.rotate_ccw(h);
            if (f.at(h) > 0) {
                const bool both = scratch.mover_of[mesh.target(h)] == scratch.round;
                if (f.at(h) / (both ? 2 : 1) < mu) mu = f.at(h) / (both ? 2 : 1);
                if (f.at(ahead) > 0 && f.corner2(h) / 2 < mu) mu = f.corner2(h) / 2;
            }
            h = ahead;
        } while (h != first);
    }
    // All non-zero sides of the pushed vertices lie in S; v goes by its star.
    for (size_t i = 1; i < scratch.movers.size(); ++i) {
        const uint32_t first = mesh.out[scratch.movers[i]];
        uint32_t h = first;
        do {
            if (f.at(h) > 0) f.value[edge_of(h)] -= mu;
            h = mesh.rotate_ccw(h);
        } while (h != first);
    }
    for (uint32_t t = 0; t < degree; ++t) {
        const uint32_t h = scratch.side[t].half_edge;
        if (star.F[t] == 0 && scratch.mover_of[mesh.target(h)] == scratch.round) continue; // moves along
        f.value[edge_of(h)] += star.group[t] == S ? -mu : mu;
    }
}

} // namespace

void collapse_foliation(Foliation& f, const Collapse& c, RestrictionScratch& scratch) {
    // Each move lands on a branch point, on a neighbour, or arrives.
    while (f.at(c.h) > 0 && !f.out_of_memory) move_along(f, twin(c.h), scratch);
    collapse(f.mesh, c.h);
}

} // namespace hmf
