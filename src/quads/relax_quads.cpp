// The square nearest to a quad p0 .. p3 with the middle c and the normal n of its
// diagonals (least squares; R turns by 90 degrees about n):
//
//     p3 ---- p2        corners c + R^k d,  4 d = sum of R^-k (p_k - c)
//      \      |                                 = (p0 - p2) - n x (p1 - p3)
//       p0 -- p1
//
// A vertex goes to the mean of its corners in these squares (after the
// shape-up steps of Bouaziz et al. 2012), so that angles and sides even out while
// sizes stay: a grid of squares, conformal as the quads are, is at rest.
//
// Quads with their corners on a surface are smaller than it where it is bent.  So a
// vertex also goes where the quads round it get larger, the gradient of their area:
// nowhere in a plane, towards the ridge beside a ridge.
//
//     o-----o              o-----o
//           ridge    ->          ridge
//        x                       x          x: on the far side of the ridge
//
// Each step goes on with a part of the one before (Polyak's heavy ball; the mean of
// projections has eigenvalues from 0 to 1): 40 steps do what 200 did.
#include "relax_quads.hpp"

#include <algorithm>
#include <cmath>

#include "boundary_walk.hpp"
#include "quad_shape.hpp"
#include "sharp_edges.hpp"
#include "surface_walk.hpp"

namespace hmf {

namespace {

constexpr uint32_t SLICE = 16384;    // vertices between ticks
constexpr size_t SLICE_OF_BAD = 256; // quads whose corners are improved, likewise
constexpr double WELL = 0.1;         // sine of a corner that needs no care
constexpr double NEAR_CREASE = 0.25; // of the side whose middle lies on it
constexpr double MOMENTUM = 0.8;
constexpr double CLEARLY = 0.5; // inwards: of the sum of four normals of the surface
// Towards a larger area: of the gradient, at most of the sides, and only where the normals of the quads agree
// (their mean is as long) and no sine of a corner is less; else what is folded over would be folded more.
constexpr double GROWTH = 0.6, MOST_GROWTH = 0.09, AGREE = 0.7, FLAT = 0.3;
constexpr int RINGS = 4, ROUNDS = 8, FIRST_ROUNDS = 2, STEPS_ROUND_BAD = 20, IMPROVEMENTS = 30;
constexpr uint64_t MOST_STEPS = 60, MORE_MOVES = 250000; // of all vertices, and of single ones, to untangle bad quads

class Relaxation {
public:
    Relaxation(const Mesh& mesh, const double* position, bool outwards, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), outwards_(outwards), quads_(quads), call_(call) {}

    hmf_status run(int steps, Untangle most) {
        const uint32_t n = quads_.vertex_count();
        if (!pull_.allocate(call_.memory, n) || !before_.allocate(call_.memory, n)) return call_.out_of_memory();
        for (uint32_t v = 0; v < n; ++v) before_[v] = at(quads_, v);
        list_.start(call_.memory);
        for (int k = 0; k < steps; ++k)
            if (!step(quads_.quad_count())) return call_.was_cancelled();
        return untangle(most == Untangle::all ? ROUNDS : FIRST_ROUNDS);
    }

private:
    // What the quads round a vertex want of it.
    struct Pull {
        Point corners, growth, normals; // sums: its places in the squares, gradients of areas, normals
        double sides = 0, quads = 0;    // sum of roots of areas, and the number; 0: done, or no quad
        bool flat = false;              // one of them has a flat corner
    };

    // Of the quads on the list (empty: of all) and the vertices with a mark (empty: all).
    Done step(size_t count) {
        const auto quad = [&](size_t i) { return &quads_.quads[4 * (list_.empty() ? i : size_t{list_[i]})]; };
        for (size_t i = 0; i < count; ++i)
            for (size_t k = 0; k < 4; ++k) pull_[quad(i)[k]] = {};
        for (size_t i = 0; i < count; ++i) {
            if (i % SLICE == 0 && !call_.tick(0)) return false;
            add_pulls(quad(i));
        }
        for (size_t i = 0; i < count; ++i) {
            if (i % SLICE == 0 && !call_.tick(0)) return false;
            for (size_t k = 0; k < 4; ++k) {
                const uint32_t v = quad(i)[k];
                if (is_fixed(v) || is_at_boundary(quads_.held[v]) || !(pull_[v].quads > 0)
                    || (!region_.empty() && !region_[v]))
                    continue;
                follow(v);
                pull_[v].quads = 0; // once
            }
        }
        return true;
    }

    void add_pulls(const uint32_t* corner) {
        Point p[4];
        for (int k = 0; k < 4; ++k) p[k] = at(quads_, corner[k]);
        Point normal = cross(p[2] - p[0], p[3] - p[1]);
        const double length = std::sqrt(dot(normal, normal)), side = std::sqrt(0.5 * length);
        if (!(length > 0)) return;
        normal = (1 / length) * normal;
        if (outwards_ && dot(normal, outwards_at(mesh_, position_, quads_, corner)) < -CLEARLY) normal = -1 * normal;
        const Point middle = 0.25 * ((p[0] + p[1]) + (p[2] + p[3]));
        const Point d = 0.25 * ((p[0] - p[2]) - cross(normal, p[1] - p[3])), e = cross(normal, d);
        const Point square[4] = {middle + d, middle + e, middle - d, middle - e};
        const Point first = 0.5 * cross(normal, p[3] - p[1]), second = 0.5 * cross(normal, p[0] - p[2]);
        const Point growth[4] = {first, second, -1 * first, -1 * second};
        bool flat = false;
        for (int k = 0; k < 4; ++k) {
            const Point ahead = p[(k + 1) % 4] - p[k], back = p[(k + 3) % 4] - p[k];
            const double sine = dot(cross(ahead, back), normal); // times both lengths
            flat |= !(sine > 0) || sine * sine < FLAT * FLAT * dot(ahead, ahead) * dot(back, back);
        }
        for (int k = 0; k < 4; ++k) {
            Pull& pull = pull_[corner[k]];
            pull.corners = pull.corners + square[k];
            pull.growth = pull.growth + growth[k];
            pull.normals = pull.normals + normal;
            pull.sides += side;
            pull.quads += 1;
            pull.flat |= flat;
        }
    }

    void follow(uint32_t v) {
        const Pull& pull = pull_[v];
        const Point here = at(quads_, v);
        Point to = (1 / pull.quads) * pull.corners;
        if (!pull.flat && dot(pull.normals, pull.normals) >= AGREE * AGREE * pull.quads * pull.quads) {
            const Point grow = (GROWTH / pull.quads) * pull.growth;
            const double most = MOST_GROWTH * pull.sides / pull.quads, length = std::sqrt(dot(grow, grow));
            to = to + (length > most ? most / length : 1) * grow;
        }
        if (list_.empty()) {
            to = to + MOMENTUM * (here - before_[v]);
            before_[v] = here;
        }
        move(v, to);
    }

    double worst(size_t q) const { return worst_corner(quads_, q); }

    bool is_fixed(uint32_t v) const { return quads_.held[v] && !can_slide(quads_.held[v]); }

    bool may_move() const { return moves_ < MOST_STEPS * quads_.quad_count() + MORE_MOVES; }

    void move(uint32_t v, const Point& to) {
        ++moves_;
        const double p[3] = {to.x, to.y, to.z};
        const uint8_t held = quads_.held[v];
        const auto walk = held == ON_CREASE   ? walk_along_sharp_edges
                        : held == AT_BOUNDARY ? walk_along_rim
                                              : walk_to_nearest;
        quads_.sides[v] = walk(mesh_, position_, quads_.sides[v], p, &quads_.positions[size_t{3} * v]);
    }

    // Where quads have a corner of nearly 180 degrees or more, some rings round them
    // are relaxed further, and then vertices moved where that helps the worst corner.
    // Each round that was not enough is followed by one with more rings and steps, until the moves are used up: a
    // corner of a boundary between two leaves stays as it is. What was best is kept.
    hmf_status untangle(int rounds) {
        QuadPlaces best;
        Bad least = {SIZE_MAX, SIZE_MAX}, now;
        moves_ = 0;
        for (int round = 0;; ++round) {
            if (!count_bad(now)) return call_.was_cancelled();
            if (now < least) {
                least = now;
                if (now.corners > 0 && !best.keep(quads_, call_.memory)) return call_.out_of_memory();
            }
            if (now.corners == 0 || round == rounds || !may_move()) break;
            if (list_round_bad(round)) return call_.status();
            for (int k = 0; k < STEPS_ROUND_BAD * (round + 1); ++k)
                if (!step(list_.size())) return call_.was_cancelled();
            if (improve_worst()) return call_.status();
        }
        if (least < now) best.give_back(quads_);
        return HMF_OK;
    }

    struct Bad {
        size_t inverted = 0, corners = 0; // quads with a corner of at least 180 degrees, or nearly
        bool operator<(const Bad& b) const {
            return inverted != b.inverted ? inverted < b.inverted : corners < b.corners;
        }
    };
    Done count_bad(Bad& bad) {
        bad = {};
        for (size_t q = 0; q < quads_.quad_count(); ++q) {
            if (q % SLICE == 0 && !call_.tick(0)) return false;
            const double w = worst(q);
            bad.inverted += !(w > 0);
            bad.corners += !(w >= WELL);
        }
        return true;
    }

    // Vertices in rings round bad quads get a mark, their quads go on the list.
    hmf_status list_round_bad(int round) {
        Memory& memory = call_.memory;
        const uint32_t n = quads_.vertex_count();
        const size_t count = quads_.quad_count();
        Array<uint8_t> next;
        if (!region_.allocate_filled(memory, n, 0) || !next.allocate(memory, n)) return call_.out_of_memory();
        for (size_t q = 0; q < count; ++q) {
            if (q % SLICE == 0 && !call_.tick(0)) return call_.was_cancelled();
            if (!(worst(q) < WELL)) continue;
            for (size_t k = 0; k < 4; ++k) {
                region_[quads_.quads[4 * q + k]] = 1;
                uint8_t& held = quads_.held[quads_.quads[4 * q + k]];
                if (round > 0 && !is_at_boundary(held)) held = 0; // without them it did not help
            }
        }
        list_.clear();
        const int rings = RINGS * (round + 1);
        for (int ring = 0; ring <= rings; ++ring) {
            if (!call_.tick(0)) return call_.was_cancelled();
            for (uint32_t v = 0; v < n; ++v) next[v] = region_[v];
            for (size_t q = 0; q < count; ++q) {
                const uint32_t* const c = &quads_.quads[4 * q];
                if (!(region_[c[0]] | region_[c[1]] | region_[c[2]] | region_[c[3]])) continue;
                if (ring < rings)
                    for (size_t k = 0; k < 4; ++k) next[c[k]] = 1;
                else if (!list_.push(static_cast<uint32_t>(q))) return call_.out_of_memory();
            }
            region_.swap(next);
        }
        return HMF_OK;
    }

    hmf_status improve_worst() {
        Memory& memory = call_.memory;
        Array<uint32_t> first, corners, filled; // the corners of each vertex, of quads on the list
        const uint32_t n = quads_.vertex_count();
        if (!first.allocate_filled(memory, size_t{n} + 1, 0u) || !corners.allocate(memory, 4 * list_.size())
            || !filled.allocate_filled(memory, n, 0u))
            return call_.out_of_memory();
        for (const uint32_t q : list_)
            for (size_t k = 0; k < 4; ++k) ++first[size_t{quads_.quads[4 * size_t{q} + k]} + 1];
        for (uint32_t v = 0; v < n; ++v) first[size_t{v} + 1] += first[v];
        for (const uint32_t q : list_)
            for (uint32_t k = 0; k < 4; ++k) {
                const uint32_t v = quads_.quads[4 * size_t{q} + k];
                corners[first[v] + filled[v]++] = 4 * q + k;
            }
        for (int k = 0; k < IMPROVEMENTS && may_move(); ++k) {
            bool moved = false;
            for (size_t i = 0; i < list_.size(); ++i) {
                if (i % SLICE_OF_BAD == 0 && !call_.tick(0)) return call_.was_cancelled();
                const uint32_t q = list_[i];
                if (worst(q) >= WELL) continue;
                for (size_t c = 0; c < 4; ++c) {
                    const uint32_t v = quads_.quads[4 * size_t{q} + c];
                    if (region_[v] && !is_fixed(v)) moved |= improve(v, &corners[first[v]], filled[v]);
                }
            }
            if (!moved) break;
        }
        return HMF_OK;
    }

    // Moves a vertex where that makes the worst corner of its quads best: to the mean
    // of its neighbours, or some way to one of them or from it.
    bool improve(uint32_t v, const uint32_t* corners, uint32_t count) {
        const auto worst_here = [&] {
            double w = 1;
            for (uint32_t i = 0; i < count; ++i) {
                const double x = worst(corners[i] / 4);
                if (x < w) w = x;
            }
            return w;
        };
        const Point from = at(quads_, v);
        const uint32_t side = quads_.sides[v];
        double* const p = &quads_.positions[size_t{3} * v];
        Point best = from, middle;
        uint32_t best_side = side;
        double best_worst = worst_here() + 1e-9;
        const double before = best_worst;
        const auto attempt = [&](const Point& to) {
            move(v, to);
            const double w = worst_here();
            if (w > best_worst) {
                best_worst = w;
                best = at(quads_, v);
                best_side = quads_.sides[v];
            }
            quads_.sides[v] = side;
            p[0] = from.x;
            p[1] = from.y;
            p[2] = from.z;
        };
        for (uint32_t i = 0; i < count; ++i) {
            const Point to = at(quads_, quads_.quads[size_t{corners[i]} / 4 * 4 + (corners[i] + 1) % 4]);
            middle = middle + (1 / static_cast<double>(count)) * to;
            for (const double t : {0.5, 0.2, 0.05, -0.05, -0.2, -0.5}) attempt(from + t * (to - from));
        }
        for (const double t : {1.0, 0.5, 0.25}) attempt(from + t * (middle - from));
        p[0] = best.x;
        p[1] = best.y;
        p[2] = best.z;
        quads_.sides[v] = best_side;
        return best_worst > before;
    }

    const Mesh& mesh_;
    const double* position_;
    const bool outwards_;
    QuadMesh& quads_;
    Call& call_;
    Array<Pull> pull_;      // per vertex
    Array<Point> before_;   // where it was a step ago
    Array<uint32_t> list_;  // quads round bad ones
    Array<uint8_t> region_; // vertices that may move there
    uint64_t moves_ = 0;    // since untangling began
};

} // namespace

hmf_status relax_quads(const Mesh& mesh, const double* position, int steps, Untangle most, bool outwards,
                       QuadMesh& quads, Call& call) {
    return Relaxation(mesh, position, outwards, quads, call).run(steps, most);
}

namespace {

// Every edge gets a vertex in its middle, every quad one in its own:
//
//     d---o---c
//     |   |   |
//     o---o---o
//     |   |   |
//     a---o---b
class Refinement {
public:
    Refinement(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), quads_(quads), call_(call) {}

    Done run() {
        const size_t count = quads_.quad_count(), vertices = quads_.vertex_count() + 3 * count + 2;
        if (!list_edges() || !fine_.allocate(call_.memory, 16 * count) || !quads_.positions.reserve(3 * vertices)
            || !quads_.sides.reserve(vertices) || !quads_.held.reserve(vertices))
            return false;
        for (size_t q = 0; q < count; ++q) {
            if (q % SLICE == 0 && !call_.tick(0)) return false;
            if (!divide(q)) return false;
        }
        quads_.quads.swap(fine_);
        return true;
    }

private:
    struct Edge {
        uint32_t other, middle;
    };

    // Room for the edges of each vertex to those of larger numbers.
    Done list_edges() {
        const uint32_t n = quads_.vertex_count();
        if (!first_.allocate_filled(call_.memory, size_t{n} + 1, 0u) || !filled_.allocate_filled(call_.memory, n, 0u))
            return false;
        for (size_t i = 0; i < quads_.quads.size(); ++i)
            ++first_[size_t{std::min(quads_.quads[i], quads_.quads[i / 4 * 4 + (i + 1) % 4])} + 1];
        for (uint32_t v = 0; v < n; ++v) first_[size_t{v} + 1] += first_[v];
        return edges_.allocate(call_.memory, first_[n]);
    }

    // A vertex near p, where the surface is nearest.
    Done add(const double* p, uint32_t side) {
        double nearest[3];
        const uint32_t found = walk_to_nearest(mesh_, position_, side, p, nearest);
        return quads_.add_vertex(nearest, found);
    }

    // The last vertex, if the line on which one end lies passes near the middle.
    void stay_on_crease(const double* p, uint32_t low, uint32_t high) {
        double nearest[3];
        const uint32_t found = walk_along_sharp_edges(mesh_, position_, quads_.sides[low], p, nearest);
        const Point off = point(nearest, 0) - point(p, 0), side = at(quads_, high) - at(quads_, low);
        if (dot(off, off) > NEAR_CREASE * NEAR_CREASE * dot(side, side)) return;
        const uint32_t v = quads_.vertex_count() - 1;
        quads_.put(v, nearest, found);
        quads_.held[v] = ON_CREASE;
    }

    // The vertex in the middle of an edge, made where it is met first.
    Done find_middle(uint32_t a, uint32_t b, uint32_t& middle) {
        const uint32_t low = std::min(a, b), high = std::max(a, b);
        uint32_t i = first_[low];
        while (i < first_[low] + filled_[low] && edges_[i].other != high) ++i;
        if (i == first_[low] + filled_[low]) {
            edges_[i] = {high, quads_.vertex_count()};
            ++filled_[low];
            double p[3];
            for (size_t c = 0; c < 3; ++c)
                p[c] = 0.5 * (quads_.positions[size_t{3} * low + c] + quads_.positions[size_t{3} * high + c]);
            if (!add(p, quads_.sides[low])) return false;
            if (quads_.held[low] == ON_CREASE && quads_.held[high] == ON_CREASE) stay_on_crease(p, low, high);
        }
        middle = edges_[i].middle;
        return true;
    }

    Done divide(size_t q) {
        uint32_t middle[4];
        for (size_t k = 0; k < 4; ++k)
            if (!find_middle(quads_.quads[4 * q + k], quads_.quads[4 * q + (k + 1) % 4], middle[k])) return false;
        double p[3] = {0, 0, 0};
        for (size_t c = 0; c < 3; ++c)
            for (size_t k = 0; k < 4; ++k) p[c] += 0.25 * quads_.positions[size_t{3} * middle[k] + c];
        const uint32_t centre = quads_.vertex_count();
        if (!add(p, quads_.sides[middle[0]])) return false;
        for (size_t k = 0; k < 4; ++k) {
            const uint32_t quad[4] = {quads_.quads[4 * q + k], middle[k], centre, middle[(k + 3) % 4]};
            // a-d and b-c lie on leaves, as before.
            for (size_t c = 0; c < 4; ++c) fine_[16 * q + 4 * k + c] = quad[(c + 4 - k) % 4];
        }
        return true;
    }

    const Mesh& mesh_;
    const double* position_;
    QuadMesh& quads_;
    Call& call_;
    Array<uint32_t> first_, filled_; // per vertex: of edges_, and how many there are
    Array<Edge> edges_;              // of each vertex those to vertices of larger numbers
    Array<uint32_t> fine_;           // the new quads
};

} // namespace

hmf_status refine_quads(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call) {
    return Refinement(mesh, position, quads, call).run() ? HMF_OK : call.stopped();
}

} // namespace hmf
