// Whitehead moves of a vertex v that has edges to itself.  Such an edge, which
// bounds no disk, stands for a deck transformation g; its value is the distance
// of phi(v) and g phi(v).  Its two half-edges are the directions to g phi(v) and
// to the inverse of g, each in a sector of its own or both in one.  If v moves
// by mu into direction S, so does g v into g S:
//
//     both half-edges in S     -2 mu      the images approach each other
//     one of them                 0
//     none                     +2 mu
//
// so that every half-edge counts for itself, as those to other vertices do.
//
// A value of 0 means that g fixes phi(v).  Then the edge stays 0 if g fixes S,
// and gets 2 mu otherwise.  The triangle beside the edge decides:
//
//          w          the half-edges of v at the two sides of the triangle
//        /   \        are g-images of each other: if both are in S, g fixes S;
//       v--0--v       if one is, it does not.
//
// Where both triangles have other zero edges or no side in S, nothing is known
// for sure, and the vertex waits.  A move with zero edges is tried: what it
// leaves behind may not be a pole.
#include "whitehead.hpp"

namespace hmf {

namespace {

// Side of star that follows or precedes side t.
uint32_t after(uint32_t t, uint32_t degree) { return t + 1 < degree ? t + 1 : 0; }
uint32_t before(uint32_t t, uint32_t degree) { return t > 0 ? t - 1 : degree - 1; }

uint32_t find_side(const Rings::Side* side, uint32_t degree, uint32_t half_edge) {
    uint32_t t = 0;
    while (t < degree && side[t].half_edge != half_edge) ++t;
    return t;
}

enum class Zero : uint8_t { stays, opens, unknown };

// What happens to a zero edge whose half-edges are the sides t and u.
Zero zero_edge(const Star& star, uint32_t t, uint32_t u) {
    const uint32_t d = star.degree;
    const uint32_t pair[2][2] = {{before(t, d), after(u, d)}, {after(t, d), before(u, d)}};
    bool known = true;
    for (const auto& two : pair) {
        const bool first = star.group[two[0]] == star.best, second = star.group[two[1]] == star.best;
        if (first && second) return Zero::stays;
        if (first || second) return Zero::opens;
        known = known && star.F[two[0]] != 0 && star.F[two[1]] != 0;
    }
    return known ? Zero::opens : Zero::unknown;
}

bool is_broken(const Foliation& f, uint32_t h) {
    return f.corner2(h) < 0 || f.corner2(f.mesh.next[h]) < 0 || f.corner2(f.mesh.prev(h)) < 0;
}

} // namespace

bool move_with_self_edges(Foliation& f, const Rings::Side* side, const double* weight, const Star& star, bool& lands, double& energy_change) {
    const Mesh& mesh = f.mesh;
    const uint32_t degree = star.degree, v = mesh.origin[side[0].half_edge];
    const auto sign = [&](uint32_t t) { return star.group[t] == star.best ? -1 : 1; };
    // Change of the value of a side for mu = 1; of an edge to itself both half-edges.
    const auto rate = [&](uint32_t t) {
        if (mesh.target(side[t].half_edge) != v) return sign(t);
        const uint32_t u = find_side(side, degree, twin(side[t].half_edge));
        if (star.F[t] == 0 && zero_edge(star, t, u) == Zero::stays) return 0;
        return sign(t) + sign(u);
    };
    double curvature = 0;
    int64_t limit = INT64_MAX;
    for (uint32_t t = 0; t < degree; ++t) {
        const uint32_t h = side[t].half_edge;
        const bool self = mesh.target(h) == v;
        if (self && star.F[t] == 0 && zero_edge(star, t, find_side(side, degree, twin(h))) == Zero::unknown) return false;
        const int r = rate(t);
        if (!self || !(h & 1)) curvature += weight[edge_of(h)] * r * r;
        if (star.group[t] != star.best || star.F[t] == 0) continue;
        const int64_t room = r < -1 ? star.F[t] / 2 : star.F[t];
        if (room < limit) limit = room;
        const uint32_t u = after(t, degree);
        if (star.F[u] != 0 && star.group[u] == star.best && star.corner2[t] > 0 && star.corner2[t] / 2 < limit) limit = star.corner2[t] / 2;
    }
    const double excess = 2 * star.best_pull - star.pull;
    if (!(curvature > 0) || excess < curvature || limit < 1) return false; // less than a unit
    const double best = excess / curvature;
    lands = best >= static_cast<double>(limit);
    const int64_t mu = lands ? limit : static_cast<int64_t>(best);
    for (uint32_t t = 0; t < degree; ++t) f.value[edge_of(side[t].half_edge)] = star.F[t] + rate(t) * mu;
    bool sound = true;
    for (uint32_t t = 0; t < degree && sound && star.has_zero; ++t) {
        const uint32_t h = side[t].half_edge;
        sound = !is_broken(f, h);
        if (!sound || star.F[t] != 0 || f.at(h) == 0) continue;
        const Cluster part = explore_cluster(f, mesh.target(h), NONE, NONE, NONE, 2, star.budget);
        sound = (part.complete || part.closed_corners >= 2) && !part.is_pole();
    }
    if (sound && star.has_zero) {
        const Cluster own = explore_cluster(f, v, NONE, NONE, NONE, 2, star.budget);
        sound = (own.complete || own.closed_corners >= 2) && !own.is_pole();
    }
    if (!sound) {
        for (uint32_t t = 0; t < degree; ++t) f.value[edge_of(side[t].half_edge)] = star.F[t];
        return false;
    }
    const double step = static_cast<double>(mu);
    energy_change += step * (step * curvature - 2 * excess);
    return true;
}

} // namespace hmf
