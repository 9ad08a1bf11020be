// After Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021, Foldover-free maps in 50 lines of code.
// Each corner of a quad has an energy,
//
//     shape + size = (|e|^2 + |b|^2) / (2 c) + (D^2 + d^2) / (2 D c)
//
//          b |
//            |____     d = (e x b) . n, n the normal of the surface,
//              e       D the area of the quads round about
//
//     c = (d + root(E^2 + d^2)) / 2:  d itself where it is large, small where the corner is folded over
//
// so that a folded corner costs much, but not infinitely much as long as E > 0.  Vertex by vertex goes down in
// the energy of its quads, on the surface, while E falls to the size of the worst corner.  What makes the worst
// corner better alone would stop where two corners are equally bad.
#include "unfold_quads.hpp"

#include "boundary_walk.hpp"
#include "quad_shape.hpp"
#include "surface_walk.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr double WELL = 0.1;    // sine of a corner that needs no care
constexpr double CLEARLY = 0.5; // length of the sum of four normals that have a common side
constexpr double SIZE = 0.5;    // weight of sizes beside shapes
constexpr int RINGS = 2;        // round bad quads, in the first round; in each further one twice as many
constexpr int ROUNDS = 4, SWEEPS = 60, EVEN = 6;
// Off the surface: as many rings more in each round, the weight of the pull and how it changes, and ways back.  From
// round CORNERS_SLIDE on corners slide along the boundary, which no vertex of it leaves.
constexpr int ROUNDS_OFF = 5, WAYS_BACK = 8, CORNERS_SLIDE = 1;
constexpr uint64_t MORE_OFF = 4; // times as many moves
constexpr double PULL = 10, WEAKER = 0.3;
constexpr uint64_t MOVES = 200000, MOVES_EACH = 20; // after which no other round begins; and for each quad

struct Bad {
    size_t inverted = 0, inwards = 0, corners = 0; // as they are, as seen from outside, and nearly
    bool operator<(const Bad& b) const {
        if (inverted != b.inverted) return inverted < b.inverted;
        return inwards != b.inwards ? inwards < b.inwards : corners < b.corners;
    }
};

class Unfolding {
public:
    Unfolding(const Mesh& mesh, const double* position, Unfold where, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), leaves_(where == Unfold::off_surface), quads_(quads), call_(call) {}

    hmf_status run(Unfolded& unfolded) {
        unfolded = {};
        QuadPlaces best;
        Bad least, now;
        bad_.start(call_.memory);
        if (!count_bad(least)) return call_.stopped();
        unfolded.inverted = least.inverted;
        if (least.corners == 0) return HMF_OK;
        const uint64_t most = (leaves_ ? MORE_OFF : 1) * (MOVES + MOVES_EACH * quads_.quad_count());
        if (!stars_.build(quads_, call_.memory) || !best.keep(quads_, call_.memory)) return call_.out_of_memory();
        if (leaves_ && !left_.allocate_filled(call_.memory, quads_.vertex_count(), uint8_t{0}))
            return call_.out_of_memory();
        bool is_best = true;
        for (int round = 0; round < (leaves_ ? ROUNDS_OFF : ROUNDS) && moves_ < most; ++round) {
            if (list_region(round)) return call_.status();
            for (int k = 0; k < SWEEPS; ++k)
                if (!sweep(k)) return call_.was_cancelled();
            if (leaves_) go_back();
            if (!count_bad(now)) return call_.stopped();
            is_best = now < least;
            if (is_best) {
                least = now;
                unfolded = {true, now.inverted};
                if (!best.keep(quads_, call_.memory)) return call_.out_of_memory();
            }
            if (least.corners == 0 || (leaves_ && least.inverted == 0)) break;
        }
        if (!is_best) best.give_back(quads_);
        return HMF_OK;
    }

private:
    Done count_bad(Bad& bad) {
        bad = {};
        bad_.clear();
        for (size_t q = 0; q < quads_.quad_count(); ++q) {
            if (q % 16384 == 0 && !call_.tick(0)) return false;
            double lies = 0, seen = 0;
            if (leaves_) lies = seen = worst_corner(quads_, q);
            else seen = worst_corner_from_outside(mesh_, position_, quads_, q, &lies);
            bad.inverted += !(lies > 0);
            bad.inwards += !(seen > 0);
            bad.corners += !(seen >= WELL);
            if (!(seen >= WELL) && !bad_.push(static_cast<uint32_t>(q))) return false;
        }
        return true;
    }

    // Rings of vertices round bad quads that may move, their quads, and how large these are to be.
    hmf_status list_region(int round) {
        Memory& memory = call_.memory;
        Array<uint8_t> inside, listed;
        moving_.start(memory);
        region_.start(memory);
        pull_ = PULL;
        for (int k = 0; k < round; ++k) pull_ *= WEAKER; // not std::pow, whose last bit is each library's own
        if (!inside.allocate_filled(memory, quads_.vertex_count(), uint8_t{0})
            || !listed.allocate_filled(memory, quads_.quad_count(), uint8_t{0}))
            return call_.out_of_memory();
        const auto add = [&](uint32_t q) -> Done {
            if (listed[q]) return true;
            listed[q] = 1;
            return region_.push(q);
        };
        for (const uint32_t q : bad_)
            if (!add(q)) return call_.out_of_memory();
        for (int ring = 0, rings = leaves_ ? RINGS * (1 + round) : RINGS << round; ring < rings; ++ring) {
            if (!call_.tick(0)) return call_.was_cancelled();
            for (size_t i = 0, n = region_.size(); i < n; ++i)
                for (size_t k = 0; k < 4; ++k) {
                    const uint32_t v = quads_.quads[4 * size_t{region_[i]} + k];
                    if (inside[v]) continue;
                    inside[v] = 1;
                    uint8_t& held = quads_.held[v];
                    if ((leaves_ || round > 0) && !is_at_boundary(held)) held = 0; // with them it did not help
                    if (leaves_ && round >= CORNERS_SLIDE && held == AT_CORNER) held = AT_BOUNDARY;
                    if (leaves_ && !held) left_[v] = 1;
                    if ((!held || held == AT_BOUNDARY) && !moving_.push(v)) return call_.out_of_memory();
                    for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q)
                        if (!add(*q)) return call_.out_of_memory();
                }
        }
        return find_sizes() ? HMF_OK : call_.stopped();
    }

    // Areas of quads, the same number of times the mean of those round about.
    Done find_sizes() {
        const uint32_t n = quads_.vertex_count();
        Array<double> sum, count;
        if (!size_.allocate_filled(call_.memory, quads_.quad_count(), 0.0)
            || !normal_.allocate_filled(call_.memory, quads_.quad_count(), Point{})
            || !sum.allocate_filled(call_.memory, n, 0.0) || !count.allocate_filled(call_.memory, n, 0.0))
            return false;
        for (const uint32_t q : region_) size_[q] = std::sqrt(dot(diagonals(q), diagonals(q))) / 2;
        for (int k = 0; k < EVEN; ++k) {
            for (const uint32_t q : region_)
                for (size_t c = 0; c < 4; ++c) sum[corner(q, c)] = count[corner(q, c)] = 0;
            for (const uint32_t q : region_)
                for (size_t c = 0; c < 4; ++c) {
                    sum[corner(q, c)] += size_[q];
                    count[corner(q, c)] += 1;
                }
            for (const uint32_t q : region_) {
                size_[q] = 0;
                for (size_t c = 0; c < 4; ++c) size_[q] += 0.25 * sum[corner(q, c)] / count[corner(q, c)];
            }
        }
        return call_.tick(0);
    }

    uint32_t corner(uint32_t q, size_t k) const { return quads_.quads[4 * size_t{q} + k]; }
    Point diagonals(uint32_t q) const {
        return cross(at(quads_, corner(q, 2)) - at(quads_, corner(q, 0)),
                     at(quads_, corner(q, 3)) - at(quads_, corner(q, 1)));
    }

    // Of the surface where the corners lie; of the quad where these have no common side, or off the surface.
    void find_normal(uint32_t q) {
        Point outwards = outwards_at(mesh_, position_, quads_, &quads_.quads[4 * size_t{q}]);
        if (leaves_ || !(dot(outwards, outwards) > CLEARLY * CLEARLY)) outwards = diagonals(q);
        const double length = std::sqrt(dot(outwards, outwards));
        normal_[q] = length > 0 ? (1 / length) * outwards : Point{};
    }

    Done sweep(int k) {
        if (!call_.tick(0)) return false;
        for (const uint32_t q : region_) find_normal(q);
        // From 1 to 1e-3, then as it is.
        regular_ = std::ldexp(1.0, -std::min(k, SWEEPS / 2) / 3);
        for (const uint32_t v : moving_) descend(v);
        return true;
    }

    struct Slope {
        double energy = 0, bend = 0; // and a bound of the second derivative
        Point gradient;
        void add(const Slope& other) {
            energy += other.energy;
            bend += other.bend;
            gradient = gradient + other.gradient;
        }
    };

    // Of the quads round v, with it at p; without slope only the energy, as far as it is less than `most`.
    template <bool WITH_SLOPE>
    Slope energy(uint32_t v, const Point& here, double most) const {
        Slope sum;
        for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q) {
            Point p[4];
            size_t at_v = 0;
            for (size_t k = 0; k < 4; ++k) {
                const uint32_t c = corner(*q, k);
                if (c == v) at_v = k;
                p[k] = c == v ? here : at(quads_, c);
            }
            for (size_t k = 0; k < 4; ++k) {
                if (k == (at_v + 2) % 4) continue;
                const size_t role = (k + 4 - at_v) % 4; // 0: v is the corner, 3: ahead of it, 1: behind
                add_corner<WITH_SLOPE>(p[(k + 1) % 4] - p[k], p[(k + 3) % 4] - p[k], *q, role, sum);
            }
            if (!(sum.energy < most)) break;
        }
        return sum;
    }

    template <bool WITH_SLOPE>
    void add_corner(const Point& e, const Point& b, uint32_t q, size_t role, Slope& sum) const {
        const Point& n = normal_[q];
        const double D = size_[q], E = regular_ * D;
        if (!(D > 0)) return;
        const double d = dot(cross(e, b), n), root = std::sqrt(E * E + d * d);
        const double c = d > 0 ? (d + root) / 2 : E * E / (2 * (root - d));
        const double s = (dot(e, e) + dot(b, b)) / 2, a = SIZE * (D * D + d * d) / (2 * D);
        sum.energy += (s + a) / c;
        if constexpr (!WITH_SLOPE) return;
        const Point bn = cross(b, n), ne = cross(n, e);
        const Point ds = role == 3 ? e : role == 1 ? b : -1 * (e + b);
        const Point dd = role == 3 ? bn : role == 1 ? ne : -1 * (bn + ne);
        const double dc = c / root; // (1 + d / root) / 2
        const double by_d = SIZE * d / (D * c) - (s + a) * dc / (c * c);
        sum.gradient = sum.gradient + (1 / c) * ds + by_d * dd;
        sum.bend += (role == 0 ? 2 : 1) / c + dot(dd, dd) * (SIZE / (D * c) + 2 * (s + a) * dc * dc / (c * c * c));
    }

    bool may_leave(uint32_t v) const { return leaves_ && left_[v]; }

    // Onto the surface, or its boundary.
    uint32_t walk(uint32_t v, const Point& to, double* nearest) const {
        const double p[3] = {to.x, to.y, to.z};
        return (is_at_boundary(quads_.held[v]) ? walk_along_rim : walk_to_nearest)(mesh_, position_, quads_.sides[v], p,
                                                                                   nearest);
    }

    // Of the pull to the surface, at p.
    Slope pull(uint32_t v, const Point& p) const {
        double size = 0, nearest[3];
        for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q) size += size_[*q];
        if (!(size > 0)) return {};
        walk(v, p, nearest);
        const double weight = pull_ * static_cast<double>(stars_.end(v) - stars_.begin(v)) / size;
        const Point off = p - point(nearest, 0);
        return {weight * dot(off, off), 2 * weight, 2 * weight * off};
    }

    // Some way along the slope, whichever is best.
    void descend(uint32_t v) {
        const Point from = at(quads_, v);
        Slope slope = energy<true>(v, from, HUGE_VAL);
        if (may_leave(v)) slope.add(pull(v, from));
        if (!(slope.bend > 0) || !std::isfinite(slope.bend)) return;
        double least = slope.energy, best[3] = {from.x, from.y, from.z};
        uint32_t best_side = quads_.sides[v];
        for (const double t : {8.0, 3.0, 1.0, 0.3, 0.1}) {
            const Point to = from - (t / slope.bend) * slope.gradient;
            double place[3];
            const uint32_t there = walk(v, to, place);
            if (may_leave(v)) put(to, place);
            const double e = energy<false>(v, point(place, 0), least).energy + (may_leave(v) ? pull(v, to).energy : 0);
            ++moves_;
            if (!(e < least)) {
                if (least < slope.energy) break;
                continue;
            }
            least = e;
            best_side = there;
            std::copy(place, place + 3, best);
        }
        quads_.put(v, best, best_side);
    }

    static void put(const Point& p, double* place) {
        place[0] = p.x;
        place[1] = p.y;
        place[2] = p.z;
    }

    double worst_round(uint32_t v) const {
        double least = 1;
        for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q)
            least = std::min(least, worst_corner(quads_, *q));
        return least;
    }

    void go_back() {
        for (int k = 0; k < WAYS_BACK; ++k)
            for (uint32_t v = 0; v < quads_.vertex_count(); ++v) {
                if (!left_[v]) continue;
                const Point from = at(quads_, v);
                const uint32_t side = quads_.sides[v];
                const double enough = std::min(worst_round(v), WELL);
                double nearest[3], place[3];
                const uint32_t there = walk(v, from, nearest);
                for (const double t : {1.0, 0.5, 0.2, 0.0}) {
                    put(from + t * (point(nearest, 0) - from), place);
                    quads_.put(v, place, t > 0 ? there : side);
                    if (worst_round(v) >= enough) break;
                }
            }
    }

    const Mesh& mesh_;
    const double* position_;
    const bool leaves_; // the surface
    QuadMesh& quads_;
    Call& call_;
    QuadStars stars_;
    Array<uint32_t> moving_, region_; // vertices, and quads round them
    Array<uint32_t> bad_;             // quads that were counted as such
    Array<double> size_;              // D of the quads of the region
    Array<Point> normal_;
    Array<uint8_t> left_; // per vertex: it may have left the surface
    double regular_ = 1;  // E / D
    double pull_ = 0;
    uint64_t moves_ = 0;
};

} // namespace

hmf_status unfold_quads(const Mesh& mesh, const double* position, Unfold where, QuadMesh& quads, Unfolded& unfolded,
                        Call& call) {
    return Unfolding(mesh, position, where, quads, call).run(unfolded);
}

} // namespace hmf
