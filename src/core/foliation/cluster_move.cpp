// Moves a vertex of a cluster, together with the parts of the cluster that would otherwise become extrema.
//
//      S S S           v moves by mu into direction S.  The cluster without v
//      |/ \|           falls into parts.  A part that is a disk and has nothing
//      P   |           but S around it would be left as a pole (v ahead of it is
//      |0  |           in S, too): it is pushed, it moves along by the same mu.
//      v --+           Any other part stays where it is, and so does every part
//                      with a marked vertex.
//
// Both kinds of move are one: a set of vertices at one point of the tree moves
// into one direction S.  Each half-edge of the set adds -mu to its edge if it
// leaves in S, and mu otherwise; zero edges within the set stay zero.  An edge
// between two vertices of the set (around a handle) changes by both half-edges.
#include "whitehead.hpp"

#include <algorithm>

namespace hmf {

namespace {

// Counts the closed corners that the part of the cluster in f.stamp would have
// without v, up to those where two of its own values meet.
uint32_t corners_towards(const Foliation& f, const Rings::Side* side, const Star& star, uint32_t v) {
    uint32_t corners = 0;
    for (uint32_t t = 0; t < star.degree; ++t) {
        const uint32_t w = f.mesh.target(side[t].half_edge);
        if (star.F[t] != 0 || w == v || f.stamp[w] != f.epoch) continue;
        const uint32_t ends[2] = {side_before(t, star.degree), side_after(t, star.degree)};
        for (uint32_t k = 0; k < 2; ++k) {
            if (star.F[ends[k]] != 0) corners += star.group[ends[k]] != star.best;
            // An edge from v to itself that opens: v goes two ways; seen from one of them.
            else if (k == 1 && f.mesh.target(side[ends[k]].half_edge) == v) corners += star.step[ends[k]] != 0;
        }
    }
    return corners;
}

// Sign of half-edge h in the move, 0 if its origin does not move.
int sign_in_move(const Foliation& f, const Rings::Side* side, const Star& star, uint32_t h) {
    const uint32_t u = f.mesh.origin[h];
    if (f.stamp[u] != star.moving) return 0;
    if (u != f.mesh.origin[side[0].half_edge]) return f.at(h) != 0 ? -1 : 0;
    uint32_t t = 0;
    while (t < star.degree && side[t].half_edge != h) ++t;
    return t < star.degree ? star.step[t] : 0;
}

// Calls visit(half-edge, its sign, the sign of its twin) for each half-edge of
// the set that changes.
template <class Visit>
void for_half_edges(const Foliation& f, const Rings::Side* side, const Star& star, Visit visit) {
    for (uint32_t t = 0; t < star.degree; ++t)
        if (star.step[t] != 0)
            visit(side[t].half_edge, star.step[t], sign_in_move(f, side, star, twin(side[t].half_edge)));
    for (const uint32_t u : f.pushed)
        for (const uint32_t h : f.mesh.around(u))
            if (f.at(h) != 0) visit(h, -1, sign_in_move(f, side, star, twin(h)));
}

} // namespace

bool plan_move(Foliation& f, const Rings::Side* side, Star& star) {
    const Mesh& mesh = f.mesh;
    const uint32_t v = mesh.origin[side[0].half_edge], degree = star.degree;
    f.pushed.clear();
    uint32_t rows = 0, closed = 0;
    bool to_itself = false;
    for (uint32_t t = 0; t < degree; ++t) {
        const uint32_t u = side_after(t, degree);
        star.step[t] = star.F[t] != 0 && star.group[t] == star.best ? -1 : 1;
        rows += star.F[t] != 0 && star.F[u] == 0;
        closed += star.F[t] != 0 && star.F[u] != 0 && star.corner2[t] == 0;
        to_itself |= star.F[t] == 0 && mesh.target(side[t].half_edge) == v;
    }
    // A boundary vertex with one row of zero edges and one direction: the
    // cluster without it has the same shape and the same closed corners.
    bool known = true;
    if (star.has_zero && !(rows == 1 && closed == 0 && !to_itself)) {
        if (to_itself) known = open_zero_self_edges(f, side, star);
        for (uint32_t t = 0; t < degree; ++t) {
            // A row of zero edges to one part, with S or an edge to itself at both ends.
            const uint32_t first = side_after(t, degree), neighbor = mesh.target(side[first].half_edge);
            const auto passes = [&](uint32_t s) {
                return star.F[s] != 0 ? star.group[s] == star.best : mesh.target(side[s].half_edge) == v;
            };
            if (star.F[first] != 0 || neighbor == v || star.step[first] == 0 || !passes(t)) continue;
            uint32_t end = first;
            while (star.F[end] == 0 && mesh.target(side[end].half_edge) != v) end = side_after(end, degree);
            if (!passes(end)) continue;
            const Cluster part = explore_cluster(
                f, neighbor, ClusterSearch().without_vertex(v).up_to_corners(2).up_to_vertices(star.allowance()));
            star.spend(f.members.size());
            if (part.closed_corners >= 2 || part.marked > 0) continue;
            if (!part.complete) {
                known = false;
                continue;
            }
            if (part.euler != 1) continue;
            const uint32_t corners = part.closed_corners + corners_towards(f, side, star, v);
            if (corners >= 2) continue;
            if (corners == 1) {
                known = false;
                continue;
            } // no distances in a tree
            for (uint32_t s = 0; s < degree; ++s) {
                const uint32_t w = mesh.target(side[s].half_edge);
                if (star.F[s] == 0 && w != v && f.stamp[w] == f.epoch) star.step[s] = 0;
            }
            for (const uint32_t w : f.members) { // parts are disjoint
                if (!f.may_look(w, f.pushed.size())) return false;
                f.pushed.add(w);
            }
        }
    }
    star.moving = ++f.epoch;
    f.stamp[v] = star.moving;
    for (const uint32_t w : f.pushed) f.stamp[w] = star.moving;
    return known;
}

int64_t room_for_move(const Foliation& f, const Rings::Side* side, const Star& star) {
    int64_t room = INT64_MAX;
    const auto at_most = [&](int64_t x) { room = std::min(room, x); };
    for_half_edges(f, side, star, [&](uint32_t h, int own, int other) {
        if (own + other < 0) at_most(f.at(h) / -(own + other));
    });
    // Corners inside S. A closed one occurs only around a pole that a flip of HMF_METHOD_PAPER has made.
    for (uint32_t t = 0; t < star.degree; ++t) {
        const uint32_t u = side_after(t, star.degree);
        const bool inside =
            star.F[t] != 0 && star.F[u] != 0 && star.group[t] == star.best && star.group[u] == star.best;
        if (inside) at_most(star.corner2[t] / 2);
    }
    for (const uint32_t u : f.pushed)
        for (const uint32_t h : f.mesh.around(u))
            if (f.at(h) != 0 && f.at(f.mesh.rotate_ccw(h)) != 0) at_most(f.corner2(h) / 2);
    return room;
}

void apply_move(Foliation& f, const Rings::Side* side, const Star& star, int64_t mu) {
    for_half_edges(f, side, star, [&](uint32_t h, int own, int) { f.value[edge_of(h)] += own * mu; });
}

bool move_together(Foliation& f, const Rings::Side* side, const double* weight, const Star& star, bool& lands,
                   double& energy_change) {
    double excess = 0, curvature = 0;
    for_half_edges(f, side, star, [&](uint32_t h, int own, int other) {
        const double w = weight[edge_of(h)], rate = own + other;
        excess -= own * w * static_cast<double>(f.at(h));
        curvature += other != 0 ? 0.5 * w * rate * rate : w; // if both ends move, the edge comes twice
    });
    const int64_t room = room_for_move(f, side, star);
    if (!(curvature > 0) || excess < curvature || room < 1) return false; // less than a unit
    const double best = excess / curvature;
    lands = best >= static_cast<double>(room);
    const int64_t mu = lands ? room : static_cast<int64_t>(best);
    apply_move(f, side, star, mu);
    const double step = static_cast<double>(mu);
    energy_change += step * (step * curvature - 2 * excess);
    return true;
}

} // namespace hmf
