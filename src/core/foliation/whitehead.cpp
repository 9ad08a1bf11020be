// Whitehead moves ([W] 3.3, Eq. 4; Palmer 2011).  A move takes the image of
// vertex v in the tree by mu into one direction S:
//
//      \   |   /                 F -= mu on the sides in S,
//    R  \  |  /  S               F += mu on all others, zero edges included
//   -----> v ----->
//    R  /  |  \  S               best mu = (2 P_S - P) / sum of weights
//      /   |   \                 with the pulls P = sum of weight * F
//
// Directions are runs of sides between closed corners.  If v belongs to a
// cluster, two runs are one direction when the walk around the cluster's
// boundary from one to the other meets no closed corner and goes around a disk
// without marked vertices.
//
// Legal is a move up to the first closed corner or the first neighbor in S:
// the vertex arrives there exactly, and the branch of the tree or the neighbor there (with which it then forms a
// cluster) determines its next move.  A vertex may leave its cluster if this makes no pole: a part that would become
// one moves along (cluster_move.cpp).  Marked vertices never move.
#include "whitehead.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

Done Rings::build(const Mesh& mesh, const double* weight, Memory& memory, const Parallel& parallel) {
    if (!offset.allocate(memory, mesh.vertex_count + size_t{1}) || !side.allocate(memory, size_t{2} * mesh.edge_count)
        || !neighbor.allocate(memory, size_t{2} * mesh.edge_count) || !weight_sum.allocate(memory, mesh.vertex_count)
        || !monogons.find(mesh, memory))
        return false;
    // The star of v from side `at` on; returns where it ends.
    const auto read = [&](uint32_t v, uint32_t at) {
        double sum = 0;
        uint32_t first = mesh.out[v];
        const bool host = is(v, Monogons::HOST);
        while (host && monogons.edge[edge_of(first)]) first = mesh.rotate_ccw(first);
        uint32_t h = first;
        do {
            const uint32_t across = mesh.next[h];
            uint32_t opposite = edge_of(across);
            sum += weight[edge_of(h)];
            uint32_t ahead = twin(mesh.next[across]);
            if (host && monogons.edge[edge_of(ahead)]) {
                opposite = edge_of(ahead); // 0: both neighbors are one
                while (monogons.edge[edge_of(ahead)]) ahead = mesh.rotate_ccw(ahead);
            }
            side[at] = {h, opposite};
            neighbor[at++] = mesh.target(h);
            h = ahead;
        } while (h != first);
        weight_sum[v] = sum;
        return at;
    };
    // Blocks need degrees first; with monogons these are known only after the walk, and alone the walk is enough.
    const uint32_t n = mesh.vertex_count;
    const bool in_blocks = parallel.slots() > 1 && monogons.vertex.empty();
    if (in_blocks)
        parallel.for_blocks(n, [&](size_t begin, size_t end) {
            for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) offset[v] = mesh.degree(v);
        });
    uint32_t at = 0;
    max_degree = 0;
    for (uint32_t v = 0; v < n; ++v) {
        const uint32_t end = in_blocks ? at + offset[v] : read(v, at);
        offset[v] = at;
        max_degree = std::max(max_degree, end - at);
        at = end;
    }
    offset[n] = at;
    if (in_blocks)
        parallel.for_blocks(n, [&](size_t begin, size_t end) {
            for (uint32_t v = static_cast<uint32_t>(begin); v < end; ++v) read(v, offset[v]);
        });
    return true;
}

Done Star::allocate(Memory& memory, uint32_t max_degree) {
    return F.allocate(memory, max_degree) && corner2.allocate(memory, max_degree) && group.allocate(memory, max_degree)
        && group_pull.allocate(memory, max_degree) && step.allocate(memory, max_degree)
        && end.allocate(memory, max_degree);
}

namespace {

// Walks counter-clockwise around the boundary of the cluster of v, from the
// half-edge `start` of v whose successor is a zero edge, until the walk comes
// back to v.  Returns the half-edge of v where it arrives; NONE if it meets a
// closed corner or a marked vertex first or takes more than `budget` steps (then decided = false).
uint32_t walk_to_next_visit(Foliation& f, uint32_t start, uint32_t budget, bool& decided) {
    const Mesh& mesh = f.mesh;
    const uint32_t v = mesh.origin[start];
    uint32_t g = start;
    for (uint32_t step = 0; step < budget; ++step) {
        ++f.walked;
        const uint32_t ahead = mesh.rotate_ccw(g);
        if (f.at(ahead) > 0) {
            if (f.corner2(g) == 0) return NONE;
            g = ahead;
        } else {
            g = twin(mesh.next[g]); // same neighbor, seen from the other end of the zero edge
            if (mesh.origin[g] == v) return g;
            if (mesh.is_marked(mesh.origin[g])) return NONE;
            if (!f.may_look(mesh.origin[g], 0)) return NONE;
        }
    }
    decided = false;
    return NONE;
}

// A star in two directions without zero edges, as nearly all are; false: another
// one, of which F, corner2 and group are to be read again.
bool read_plain_star(const Foliation& f, const Rings::Side* side, uint32_t degree, const double* weight, Star& star) {
    int64_t* F = star.F.data();
    int64_t* corner2 = star.corner2.data();
    uint32_t* group = star.group.data();
    double pull[2] = {0, 0};
    const uint32_t closed = walk_plain_star(
        f.value, side, degree, [&](uint32_t t, uint32_t direction, int64_t here, int64_t ahead, int64_t opposite) {
            F[t] = here;
            corner2[t] = here + ahead - opposite;
            group[t] = direction;
            pull[direction] += (weight ? weight[edge_of(side[t].half_edge)] : 1.0) * static_cast<double>(here);
        });
    if (closed != 2) return false;
    star.group_count = 2;
    star.group_pull[0] = pull[0];
    star.group_pull[1] = pull[1];
    star.pull = pull[0] + pull[1];
    star.best = pull[1] > pull[0];
    star.best_pull = pull[star.best];
    return true;
}

// Groups are runs of sides between closed corners and zero edges.  Returns the rows of zero edges.
uint32_t read_runs(const Foliation& f, const Rings::Side* side, uint32_t degree, const double* weight, Star& star) {
    int64_t* F = star.F.data();
    uint32_t* group = star.group.data();
    for (uint32_t t = 0; t < degree; ++t) {
        F[t] = f.value[edge_of(side[t].half_edge)];
        star.has_zero |= F[t] == 0;
    }
    uint32_t groups = 0, rows = 0;
    bool open_run = false;
    for (uint32_t t = 0; t < degree; ++t) {
        const uint32_t u = side_after(t, degree);
        star.corner2[t] = F[t] + F[u] - f.value[side[t].opposite];
        rows += F[t] != 0 && F[u] == 0;
        if (F[t] == 0) {
            group[t] = NONE;
            open_run = false;
            continue;
        }
        if (!open_run) star.group_pull[groups++] = 0;
        group[t] = groups - 1;
        const double pull = (weight ? weight[edge_of(side[t].half_edge)] : 1.0) * static_cast<double>(F[t]);
        star.group_pull[groups - 1] += pull;
        star.pull += pull;
        open_run = F[u] > 0 && star.corner2[t] > 0;
    }
    // The last run goes on at side 0.
    if (open_run && groups > 1 && group[0] == 0) {
        const uint32_t last = groups - 1;
        star.group_pull[0] += star.group_pull[last];
        for (uint32_t t = degree; t-- > 0 && group[t] == last;) group[t] = 0;
        --groups;
    }
    star.group_count = groups;
    return rows;
}

// Are the runs on both sides of a row of zero edges one direction?  The row is
// that between sides `before` and `behind`; first_zero is its first.
bool is_one_direction(Foliation& f, const Rings::Side* side, uint32_t degree, uint32_t before, uint32_t first_zero,
                      uint32_t behind, Star& star) {
    const Mesh& mesh = f.mesh;
    if (walk_to_next_visit(f, side[before].half_edge, star.allowance(), star.decided) != side[behind].half_edge)
        return false;
    const uint32_t v = mesh.origin[side[0].half_edge];
    const Cluster part = explore_cluster(f, mesh.target(side[first_zero].half_edge),
                                         ClusterSearch().without_vertex(v).up_to_vertices(star.allowance()));
    star.spend(f.members.size());
    if (part.marked > 0) return false;
    if (!part.complete) {
        star.decided = false;
        return false;
    }
    if (part.euler != 1) return false; // goes around a handle
    bool elsewhere = false;            // the part hangs on v in a second place: around a handle as well
    for (uint32_t s = behind; s != first_zero; s = side_after(s, degree))
        elsewhere |= star.F[s] == 0 && f.stamp[mesh.target(side[s].half_edge)] == f.epoch;
    return !elsewhere;
}

void join_groups(Star& star, uint32_t degree, uint32_t a, uint32_t b) {
    const uint32_t keep = std::min(a, b), drop = std::max(a, b), last = --star.group_count;
    star.group_pull[keep] += star.group_pull[drop];
    star.group_pull[drop] = star.group_pull[last];
    for (uint32_t s = 0; s < degree; ++s) {
        if (star.group[s] == drop) star.group[s] = keep;
        else if (star.group[s] == last) star.group[s] = drop;
    }
}

// Runs on both sides of a row of zero edges that are one direction become one group.
void join_across_zeros(Foliation& f, const Rings::Side* side, uint32_t degree, Star& star) {
    const uint32_t v = f.mesh.origin[side[0].half_edge];
    for (uint32_t t = 0; t < degree && star.group_count > 1; ++t) {
        const uint32_t first_zero = side_after(t, degree);
        if (star.F[t] == 0 || star.F[first_zero] != 0) continue;
        uint32_t u = first_zero;
        bool self_edge = false; // not of a monogon: different directions on its sides
        while (star.F[u] == 0) {
            self_edge |= f.mesh.target(side[u].half_edge) == v;
            u = side_after(u, degree);
        }
        if (star.group[u] == star.group[t] || self_edge) continue;
        if (is_one_direction(f, side, degree, t, first_zero, u, star))
            join_groups(star, degree, star.group[t], star.group[u]);
    }
}

} // namespace

void read_star(Foliation& f, const Rings::Side* side, uint32_t degree, const double* weight, Star& star) {
    star.degree = degree;
    star.decided = true;
    star.has_zero = false;
    star.pull = star.best_pull = 0;
    star.best = 0;
    if (read_plain_star(f, side, degree, weight, star)) return;
    const uint32_t rows = read_runs(f, side, degree, weight, star);
    // One row and two runs are two directions: as one they would be a pole.
    if (star.group_count > 1 && rows > 0 && star.group_count + rows > 3) join_across_zeros(f, side, degree, star);
    for (uint32_t k = 0; k < star.group_count; ++k)
        if (star.group_pull[k] > star.best_pull) {
            star.best_pull = star.group_pull[k];
            star.best = k;
        }
}

namespace {

enum class Outcome : uint8_t { undecided, stays, moves, lands };

// Into one direction, given by its sides as bits: as far as it pulls more than all others, at most to the end of the
// free interval.
struct PlainMove {
    uint64_t sides;
    int64_t room;
    double excess, pull; // pull: of all directions

    Outcome make(Foliation& f, const Rings::Side* side, uint32_t degree, double weight_sum, SweepResult& result) const {
        const double distance = excess / weight_sum;
        if (!(distance >= 1)) return Outcome::stays;
        const bool lands = distance >= static_cast<double>(room);
        const int64_t mu = lands ? room : static_cast<int64_t>(distance);
        for (uint32_t t = 0; t < degree; ++t)
            f.value[edge_of(side[t].half_edge)] += mu - 2 * mu * static_cast<int64_t>(sides >> t & 1);
        const double step = static_cast<double>(mu);
        result.energy_change += step * (step * weight_sum - 2 * excess);
        result.add_move(excess, pull);
        return lands ? Outcome::lands : Outcome::moves;
    }
};

// One move at a vertex without zero edges and with two directions: the
// general way below in one pass and without branches on the values.
Outcome relax_plain_vertex(Foliation& f, const Rings::Side* side, uint32_t degree, const double* weight,
                           double weight_sum, SweepResult& result) {
    if (degree > 64) return Outcome::undecided;
    double pull = 0, pull_of_second = 0;
    int64_t room = INT64_MAX, room_of_second = INT64_MAX;
    uint64_t second = 0; // sides in the second direction
    const uint32_t closed = walk_plain_star(
        f.value, side, degree, [&](uint32_t t, uint32_t direction, int64_t here, int64_t ahead, int64_t opposite) {
            const int64_t corner = (here + ahead - opposite) / 2;
            const int64_t along = corner != 0 ? std::min(here, corner) : here;
            const double p = weight[edge_of(side[t].half_edge)] * static_cast<double>(here);
            pull += p;
            pull_of_second += p * static_cast<double>(direction);
            const int64_t first = direction ? INT64_MAX : along, other = direction ? along : INT64_MAX;
            room = std::min(room, first);
            room_of_second = std::min(room_of_second, other);
            second |= uint64_t{direction} << t;
        });
    if (closed != 2) return Outcome::undecided;
    const bool to_second = 2 * pull_of_second > pull;
    const double excess = to_second ? 2 * pull_of_second - pull : pull - 2 * pull_of_second;
    return PlainMove{to_second ? second : ~second, to_second ? room_of_second : room, excess, pull}.make(
        f, side, degree, weight_sum, result);
}

// The same on the rim of a cluster: one row of zero edges and at most one closed corner beside it, as most vertices
// have after a split.  So there are one or two directions, and the cluster stays in one piece without the vertex.
Outcome relax_rim_vertex(Foliation& f, const Rings::Side* side, uint32_t degree, const double* weight,
                         double weight_sum, SweepResult& result) {
    if (degree > 64) return Outcome::undecided;
    constexpr uint32_t most_runs = 3; // with that which goes on at side 0
    struct Run {
        double pull = 0;
        int64_t room = INT64_MAX;
        uint64_t sides = 0;
    } run[most_runs];
    double pull = 0;
    const uint32_t v = f.mesh.origin[side[0].half_edge];
    const int64_t first = f.value[edge_of(side[0].half_edge)];
    int64_t here = first;
    uint32_t last = 0, rows = 0, closed = 0;
    bool goes_on = false; // the last run at side 0
    for (uint32_t t = 0; t < degree; ++t) {
        const uint32_t h = side[t].half_edge;
        const int64_t ahead = t + 1 < degree ? f.value[edge_of(side[t + 1].half_edge)] : first;
        if (here == 0) {
            if (f.mesh.target(h) == v) return Outcome::undecided;
        } else {
            if (last == most_runs) return Outcome::undecided;
            Run& own = run[last];
            const double p = weight[edge_of(h)] * static_cast<double>(here);
            pull += p;
            own.pull += p;
            own.room = std::min(own.room, here);
            own.sides |= uint64_t{1} << t;
            const int64_t corner2 = here + ahead - f.value[side[t].opposite];
            goes_on = ahead != 0 && corner2 > 0;
            if (goes_on) own.room = std::min(own.room, corner2 / 2);
            else ++(ahead != 0 ? closed : rows), ++last;
        }
        here = ahead;
    }
    if (rows != 1 || closed > 1) return Outcome::undecided;
    if (goes_on && first != 0 && last > 0) {
        run[0].pull += run[last].pull;
        run[0].room = std::min(run[0].room, run[last].room);
        run[0].sides |= run[last].sides;
        run[last].pull = 0;
    }
    const Run* best = &run[0];
    for (const Run& other : run)
        if (other.pull > best->pull) best = &other;
    return PlainMove{best->sides, best->room, 2 * best->pull - pull, pull}.make(f, side, degree, weight_sum, result);
}

} // namespace

bool relax_vertex(Foliation& f, const Rings& rings, const double* weight, uint32_t v, Star& star, SweepResult& result) {
    const Rings::Side* side = &rings.side[rings.offset[v]];
    const uint32_t degree = rings.offset[v + 1] - rings.offset[v];
    if (f.mesh.is_marked(v) || rings.is(v, Monogons::INSIDE)) return false;
    // A monogon has the value 0, unless a flip as printed left a pole inside: then both its ends would move.
    if (rings.is(v, Monogons::HOST))
        for (uint32_t t = 0; t < degree; ++t)
            if (f.mesh.target(side[t].half_edge) == v && f.at(side[t].half_edge) > 0
                && !rings.is(v, Monogons::SELF_EDGE))
                return false;
    bool moved = false;
    // Each round arrives at a branch point or a neighbor and plans the next move from there.
    for (uint32_t round = 0; round < 4; ++round) {
        if (!rings.is(v, Monogons::SELF_EDGE)) {
            Outcome outcome = relax_plain_vertex(f, side, degree, weight, rings.weight_sum[v], result);
            if (outcome == Outcome::undecided)
                outcome = relax_rim_vertex(f, side, degree, weight, rings.weight_sum[v], result);
            moved |= outcome >= Outcome::moves;
            if (outcome == Outcome::lands) continue;
            if (outcome != Outcome::undecided) return moved;
        }
        read_star(f, side, degree, weight, star);
        const double excess = 2 * star.best_pull - star.pull;
        if (f.outside || !(excess > 0)) return moved;
        const bool self_edge = rings.is(v, Monogons::SELF_EDGE);
        const double best = excess / rings.weight_sum[v];
        if (best < 1 && !self_edge) return moved;
        if ((self_edge || star.has_zero) && (!star.decided || !plan_move(f, side, star) || f.outside)) {
            ++result.blocked;
            return moved;
        }
        if (self_edge || (star.has_zero && !f.pushed.empty())) {
            bool lands = false;
            if (!move_together(f, side, weight, star, lands, result.energy_change)) return moved;
            result.add_move(excess, star.pull);
            moved = true;
            if (!lands) return true;
            continue;
        }
        int64_t limit = INT64_MAX;
        for (uint32_t t = 0; t < star.degree; ++t) {
            if (star.group[t] != star.best || star.F[t] == 0) continue;
            limit = std::min(limit, star.F[t]);
            const uint32_t u = side_after(t, star.degree);
            if (star.F[u] != 0 && star.group[u] == star.best) limit = std::min(limit, star.corner2[t] / 2);
        }
        // A closed corner inside S, as around the pole of a flip of HMF_METHOD_PAPER: its neighbors have to move first.
        if (limit == 0) return moved;
        const bool lands = best >= static_cast<double>(limit);
        const int64_t mu = lands ? limit : static_cast<int64_t>(best);
        for (uint32_t t = 0; t < star.degree; ++t)
            f.value[edge_of(side[t].half_edge)] = star.group[t] == star.best ? star.F[t] - mu : star.F[t] + mu;
        const double step = static_cast<double>(mu);
        result.energy_change += step * (step * rings.weight_sum[v] - 2 * excess);
        result.add_move(excess, star.pull);
        moved = true;
        if (!lands) return true;
    }
    return moved;
}

double pull_floor(double total, uint32_t vertex_count) { return 0.01 * 2 * total / static_cast<double>(vertex_count); }

double residual_at(Foliation& f, const Rings& rings, const double* weight, uint32_t v, double floor, Star& star) {
    if (f.mesh.is_marked(v)) return 0; // balanced by the half turn
    const uint32_t sweep_budget = star.budget;
    star.budget = NONE; // every direction is decided here
    read_star(f, &rings.side[rings.offset[v]], rings.offset[v + 1] - rings.offset[v], weight, star);
    star.budget = sweep_budget;
    const double excess = 2 * star.best_pull - star.pull;
    const double scale = std::max(floor, star.pull);
    return excess > 0 && scale > 0 ? excess / scale : 0;
}

ResidualResult residuals(Foliation& f, const Rings& rings, const double* weight, Star& star, double* residual,
                         Call& call) {
    const uint32_t n = f.mesh.vertex_count;
    const double total = call.parallel.sum_blocks<double>(f.mesh.edge_count, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t e = begin; e < end; ++e) sum += weight[e] * static_cast<double>(f.value[e]);
        return sum;
    });
    const double floor = pull_floor(total, n);
    ResidualResult result;
    double sum = 0;
    for (uint32_t v = 0; v < n; ++v) {
        if (v % 256 == 0 && !call.work(8192 + 8 * f.take_walked())) break;
        const double r = residual_at(f, rings, weight, v, floor, star);
        if (residual) residual[v] = r;
        sum += r;
        if (r > result.max) {
            result.max = r;
            result.worst = v;
        }
    }
    result.mean = sum / static_cast<double>(n);
    return result;
}

double energy(const Foliation& f, const double* weight, const Parallel& parallel) {
    return parallel.sum_blocks<double>(f.mesh.edge_count, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t e = begin; e < end; ++e) {
            const double x = static_cast<double>(f.value[e]);
            sum += weight[e] * x * x;
        }
        return sum;
    });
}

} // namespace hmf
