// Whitehead moves: exact coordinate descent of the Dirichlet energy.
#pragma once

#include "../base/prefetch.hpp"
#include "../mesh/monogon.hpp"
#include "foliation.hpp"

#include <algorithm>

namespace hmf {

// One-rings of a mesh as flat arrays, for sweeps: side t of vertex v has the
// half-edge to neighbor t and the edge between neighbors t and t+1,
// counter-clockwise.  What lies in a monogon at v is left out, as if its
// boundary were contracted: all values there are 0 and stay so.
struct Rings {
    struct Side {
        uint32_t half_edge, opposite;
    };
    Array<uint32_t> offset;   // vertex_count + 1
    Array<Side> side;         // 2 * edge_count
    Array<uint32_t> neighbor; // 2 * edge_count: target of each side
    Array<double> weight_sum; // vertex_count, over the sides
    Monogons monogons;
    uint32_t max_degree = 0;
    Done build(const Mesh& mesh, const double* weight, Memory& memory, const Parallel& parallel = Parallel());
    // Prefetches the data that a walk around v will read. A pass over the vertices does so for a vertex that is
    // `ahead`.
    static constexpr uint32_t AHEAD = 8;
    HMF_INLINE void prefetch_star(const int64_t* value, const double* weight, uint32_t v) const {
        for (uint32_t t = offset[v]; t < offset[v + 1]; ++t) {
            prefetch(value + side[t].opposite);
            prefetch(weight + edge_of(side[t].half_edge));
        }
    }
    bool is(uint32_t v, uint8_t kind) const { return !monogons.vertex.empty() && (monogons.vertex[v] & kind); }
};

// The next side of a vertex, counter-clockwise and clockwise.
inline uint32_t side_after(uint32_t t, uint32_t degree) { return t + 1 < degree ? t + 1 : 0; }
inline uint32_t side_before(uint32_t t, uint32_t degree) { return t > 0 ? t - 1 : degree - 1; }

// Walks once around a vertex.  Counts its closed corners; NONE if an edge is
// zero.  visit(t, direction, here, ahead, opposite) sees side t, the values of
// sides t and t+1 and of the edge between their ends; direction changes
// between 0 and 1 at each closed corner.
template <class Visit>
inline uint32_t walk_plain_star(const int64_t* value, const Rings::Side* side, uint32_t degree, Visit visit) {
    const int64_t first = value[edge_of(side[0].half_edge)];
    int64_t here = first;
    uint32_t closed = 0;
    for (uint32_t t = 0; t < degree; ++t) {
        if (here == 0) return NONE;
        const int64_t ahead = t + 1 < degree ? value[edge_of(side[t + 1].half_edge)] : first;
        const int64_t opposite = value[side[t].opposite];
        visit(t, closed & 1, here, ahead, opposite);
        closed += here + ahead == opposite;
        here = ahead;
    }
    return closed;
}

// The directions of the tree at one vertex and their pulls.
struct Star {
    uint32_t degree = 0;
    uint32_t group_count = 0;
    uint32_t best = 0;              // group of the largest pull
    double best_pull = 0, pull = 0; // of that group; of all
    bool has_zero = false, decided = true;
    uint32_t budget = 512; // vertices or steps that one move may examine
    // The budget of all moves together until it is filled again. It keeps a sweep linear if large clusters move as a
    // whole repeatedly. Moves beyond the budget are left to a later sweep.
    uint64_t credit = UINT64_MAX;
    uint32_t allowance() const {
        constexpr uint64_t always = 64;
        return budget == NONE ? NONE : static_cast<uint32_t>(std::min<uint64_t>(budget, std::max(credit, always)));
    }
    void spend(size_t vertices) {
        if (budget != NONE) credit -= std::min<uint64_t>(credit, vertices);
    }
    Array<int64_t> F;       // per side
    Array<int64_t> corner2; // twice the coordinate of the corner between sides t and t+1
    Array<uint32_t> group;  // per side: direction, NONE for zero edges
    Array<double> group_pull;
    // Of the move into group `best` that plan_move has found.
    Array<int8_t> step;  // per side: sign of its share of the change of its edge, 0 if it has none
    Array<uint32_t> end; // per side, of an edge of value 0 from the vertex to itself: where it comes back
    uint32_t moving = 0; // stamp of what moves: the vertex itself and Foliation::pushed, whose values all shrink
    Done allocate(Memory& memory, uint32_t max_degree);
};

// Fills star for the vertex with these sides.  weight NULL: all 1.  Groups that are one direction around a cluster
// are merged; a search of more than star.budget steps gives star.decided = false.
void read_star(Foliation& f, const Rings::Side* side, uint32_t degree, const double* weight, Star& star);

struct SweepResult {
    double energy_change = 0; // in squared units, <= 0
    uint64_t moves = 0;
    uint64_t blocked = 0; // vertices whose move is postponed
    double largest = 0;   // excess by pull of a vertex that moved: its residual before

    void add_move(double excess, double pull) {
        ++moves;
        if (excess > largest * pull) largest = excess / pull;
    }
    void operator+=(const SweepResult& part) {
        energy_change += part.energy_change;
        moves += part.moves;
        blocked += part.blocked;
        largest = std::max(largest, part.largest);
    }
};

// A move of the vertex of a star into star.best, with what has to go along
// (cluster_move.cpp).  plan_move fills star.step and f.pushed; false: what
// would be left behind or go along is not known, the vertex has to wait.
bool plan_move(Foliation& f, const Rings::Side* side, Star& star);
// The planned move ends at the first neighbor or branch point.
int64_t room_for_move(const Foliation& f, const Rings::Side* side, const Star& star);
void apply_move(Foliation& f, const Rings::Side* side, const Star& star, int64_t mu);
// As far as is best and there is room; false: not by a unit.  lands: as far as there is room.
bool move_together(Foliation& f, const Rings::Side* side, const double* weight, const Star& star, bool& lands,
                   double& energy_change);
// Fills star.step for edges of value 0 from the vertex to itself: 1 if they
// open, else 0 (self_edges.cpp).  false: the cluster is too large to decide all of them.
bool open_zero_self_edges(Foliation& f, const Rings::Side* side, Star& star);

// One vertex, repeatedly, as in a sweep; true if it moved.
bool relax_vertex(Foliation& f, const Rings& rings, const double* weight, uint32_t v, Star& star, SweepResult& result);

// Relative coclosedness residual of each vertex ([W] Eq. 4); residual may be
// NULL.  Stops early, with what it has, if the call is cancelled.
struct ResidualResult {
    double max = 0, mean = 0;
    uint32_t worst = NONE;
};
ResidualResult residuals(Foliation& f, const Rings& rings, const double* weight, Star& star, double* residual,
                         Call& call);

// The residual of one vertex; floor: the least pull that it is measured
// against, from the sum of weight * F over all edges.
double pull_floor(double total, uint32_t vertex_count);
double residual_at(Foliation& f, const Rings& rings, const double* weight, uint32_t v, double floor, Star& star);

// Dirichlet energy in squared units ([W] Eq. 5).
double energy(const Foliation& f, const double* weight, const Parallel& parallel = Parallel());

} // namespace hmf
