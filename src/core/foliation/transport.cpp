// Transport of a foliation across a flip and a split, exact and without poles
// ([W] 4.2.2 and 4.2.3).
//
//          k                     k
//        / | \                 / ^ \                                        .
//       i--h->j      ->       i  h  j
//        \ | /                 \ | /
//          l                     l
//
// The new value is the distance of k and l in the tree.  By the four-point
// condition of trees it is
//
//     F_kl = max(F_ik + F_jl, F_il + F_jk) - F_ij
//
// unless k and l branch off the path from i to j at the same point x.  If x is
// inside the path, k and l leave it on opposite sides of the edge, so these
// are different directions and the formula holds.  If x is i (both corners at
// i closed: "case 4" of the paper) they are different directions exactly if
// the boundary of the cluster of i has another closed corner, or the cluster
// has topology or a marked vertex.  Otherwise j alone lies on one side of the cluster and all
// else in one direction R.  Then the cluster is first moved into R up to the
// next branch point of the tree, a Whitehead move of the whole cluster.  There
// it has a further direction, and the formula holds.  The neighbors that it
// meets on the way join the cluster, and the search goes on around them.
// HMF_METHOD_PAPER uses the formula anyway, as [W] does: i becomes a pole,
// and triangle ikl of the new ones a zero.
//
// Hence: no cluster of positive index before, none after.
#include "foliation.hpp"

#include <algorithm>

namespace hmf {

namespace {

// Moves the cluster in f.members, which has one direction R apart from the
// half-edge `behind`, into R up to the first closed corner or the
// first neighbor.
void advance_cluster(Foliation& f, uint32_t behind) {
    const Mesh& mesh = f.mesh;
    int64_t limit = INT64_MAX;
    for (const uint32_t v : f.members)
        for (const uint32_t h : mesh.around(v)) {
            // The end of `behind` may be a copy of the cluster: it follows, and what is between them does not change.
            if (f.at(h) <= 0 || h == behind || twin(h) == behind) continue;
            // An edge with both ends in the cluster gets shorter from both.
            const bool both = f.stamp[mesh.target(h)] == f.epoch;
            limit = std::min(limit, both ? f.at(h) / 2 : f.at(h));
            const uint32_t ahead = mesh.rotate_ccw(h);
            if (f.at(ahead) > 0 && ahead != behind && twin(ahead) != behind) limit = std::min(limit, f.corner2(h) / 2);
        }
    if (limit == INT64_MAX) return;
    for (const uint32_t v : f.members)
        for (const uint32_t h : mesh.around(v)) {
            int64_t& value = f.value[edge_of(h)];
            if (h == behind) value += limit;
            else if (value > 0) value -= limit;
        }
}

} // namespace

void flip_foliation(Foliation& f, uint32_t edge, bool reverse, TransportStatistics& statistics, BadFlip bad_flip) {
    Mesh& mesh = f.mesh;
    const uint32_t ij = 2 * edge, jk = mesh.next[ij], ki = mesh.next[jk];
    const uint32_t ji = twin(ij), il = mesh.next[ji], lj = mesh.next[il];
    int64_t result = 0;
    bool bad = false;
    // Each round but the last enlarges a cluster or gives it a direction.
    for (uint32_t round = 0; round <= mesh.vertex_count; ++round) {
        const int64_t F_ij = f.at(ij), F_jk = f.at(jk), F_ik = f.at(ki), F_il = f.at(il), F_jl = f.at(lj);
        if (F_ij == 0) {
            result = F_ik + F_il;
            if (F_ik == 0 || F_il == 0) break;
            // Without the edge, does an end keep more than one direction?
            bool advanced = false;
            for (uint32_t end = 0; end < 2 && !advanced; ++end) {
                const uint32_t v = mesh.origin[ij ^ end], other = mesh.origin[ij ^ end ^ 1];
                const Cluster cluster =
                    explore_cluster(f, v, ClusterSearch().without_edge(edge).looking_for(other).up_to_corners(1));
                if (!cluster.complete || cluster.reached || !cluster.is_disk()) continue;
                // The edge stays behind: it grows from zero.
                f.value[edge] = 0;
                advance_cluster(f, ij ^ end);
                advanced = true;
            }
            if (!advanced) break;
        } else {
            const int64_t through_ik = F_ik + F_jl, through_il = F_il + F_jk;
            result = std::max(through_ik, through_il) - F_ij;
            uint32_t closed_end = NONE;
            if (F_ik > 0 && F_il > 0 && F_jk == F_ij + F_ik && F_jl == F_ij + F_il) closed_end = ij;
            if (F_jk > 0 && F_jl > 0 && F_ik == F_ij + F_jk && F_il == F_ij + F_jl) closed_end = ji;
            if (closed_end == NONE) break;
            const Cluster cluster = explore_cluster(f, mesh.origin[closed_end], ClusterSearch().up_to_corners(3));
            if (!cluster.complete || !cluster.is_disk()) break;
            if (bad_flip == BadFlip::as_printed) { // the formula is F_ik + F_il now
                bad = true;
                break;
            }
            advance_cluster(f, closed_end);
        }
        bad = true;
    }
    if (bad) ++statistics.bad_flips;
    if (reverse) unflip(mesh, edge);
    else flip(mesh, edge);
    f.value[edge] = result;
    assert(f.corner2(2 * edge) >= 0 && f.corner2(mesh.next[2 * edge]) >= 0 && f.corner2(mesh.prev(2 * edge)) >= 0);
    assert(f.corner2(2 * edge + 1) >= 0 && f.corner2(mesh.next[2 * edge + 1]) >= 0
           && f.corner2(mesh.prev(2 * edge + 1)) >= 0);
    if (bad) {
        const uint32_t quad[4] = {ki, il, lj, jk}; // they start at k, i, l and j
        for (uint32_t h : quad)
            if (explore_cluster(f, mesh.origin[h], ClusterSearch().up_to_corners(2)).is_pole()) {
                ++statistics.bad_flips_left;
                break;
            }
    }
}

//          k                      k
//          |                    / | \                                       .
//     .. --i-- ..     ->   .. -i--h--j- ..      F_ij = 0, F_jk = F_ik, F_jl = F_il
//          |                    \ | /
//          l                      l
//
// The cluster of i and j has the boundary that i had: same directions, same
// index.  Nothing has to be opened.
void split_values(int64_t* value, const Collapse& c) {
    value[edge_of(c.h)] = 0;
    value[edge_of(c.jk)] = value[edge_of(c.ki)];
    value[edge_of(c.lj)] = value[edge_of(c.il)];
}

} // namespace hmf
