// Relaxation (relax_quads.hpp) goes to the mean of squares, and what is left is uneven: rows askew to a sharp edge,
// quads round a tip.  Here vertex by vertex goes down in the sum over the corners round it of
//
//          b |          c^2 (c^2 + EVEN) + ASPECT r^2 (r^2 + EVEN)
//            |____          c = e.b / |e x b|, the cotangent
//              e            r = (|e|^2 - |b|^2) / (|e|^2 + |b|^2)
//
// so that the worst corners count most and pass on to those round about, less GROWTH times the area of the quads: these
// still go where they cover more (relax_quads.cpp).
//
// What cannot be had both is given up from the worst quad on, as far as it is needed: vertices leave sharp edges, and
// those at tips move, first on a leash.
#include "square_corners.hpp"

#include "boundary_walk.hpp"
#include "quad_shape.hpp"
#include "sharp_edges.hpp"
#include "surface_walk.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr double ASPECT = 0.55, EVEN = 0.15, GROWTH = 1.1;
constexpr double AGREE = 0.7, FLAT = 0.3; // growth as in relax_quads.cpp
constexpr double SQUARE_ENOUGH = 0.309;   // sine of 18 degrees
constexpr double OFF = 0.25;              // cosine of a corner from which on the vertices round about move
constexpr int RINGS = 4;                  // of them
constexpr size_t SHARE = 20;              // one corner in so many may be farther off than is enough
// Sines of corners of quads that give up what holds them, one after the other; those still worse by MUCH their tips.
constexpr double GIVES_UP[] = {0.4, 0.5, 0.6, 0.65, 0.7, 0.75, 0.8};
constexpr double MUCH = 0.1;
constexpr int SWEEPS_AFTER = 4;
// In mean sides: the way of a vertex in one step, and from its tip.
constexpr double FIRST_STEP = 0.1, LONGEST_STEP = 0.3, SHORTEST_STEP = 1e-4, LEASH = 0.4;
constexpr double LONGER = 1.5, SHORTER = 0.4;      // the next step after one that was good, or not
constexpr double ENOUGH = 0.1, LEAST_SLOPE = 1e-5; // of the slope is to be had, and its least by sides
constexpr int ATTEMPTS = 3;                        // of steps, each shorter
constexpr double LEAST_CORNER = 0.3;               // sine, below which no corner gets worse

class Squaring {
public:
    Squaring(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), quads_(quads), call_(call) {}

    hmf_status run(int sweeps, double leave) {
        if (sweeps < 1 || !is_off(leave)) return HMF_OK;
        Memory& memory = call_.memory;
        const uint32_t n = quads_.vertex_count();
        if (!stars_.build(quads_, memory) || !home_.allocate(memory, n) || !step_.allocate_filled(memory, n, FIRST_STEP)
            || !on_leash_.allocate_filled(memory, n, uint8_t{0}))
            return call_.out_of_memory();
        for (uint32_t v = 0; v < n; ++v) home_[v] = at(quads_, v);
        if (move_all(sweeps)) return call_.status();
        for (const double sine : GIVES_UP) {
            if (!is_off(SQUARE_ENOUGH)) break;
            give_up(sine);
            if (move_all(std::min(sweeps, SWEEPS_AFTER))) return call_.status();
        }
        return HMF_OK;
    }

private:
    uint32_t corner(size_t q, size_t k) const { return quads_.quads[4 * q + k % 4]; }

    double cosine(size_t q, size_t k) const {
        const Point p = at(quads_, corner(q, k)), e = at(quads_, corner(q, k + 1)) - p,
                    b = at(quads_, corner(q, k + 3)) - p;
        const double size = dot(e, e) * dot(b, b);
        return size > 0 ? std::fabs(dot(e, b)) / std::sqrt(size) : 1;
    }

    // Whether more corners than are allowed have a larger cosine.
    bool is_off(double than) const {
        size_t off = 0;
        for (size_t i = 0; i < quads_.quads.size(); ++i) off += cosine(i / 4, i % 4) > than;
        return off * SHARE > quads_.quads.size();
    }

    void give_up(double sine) {
        for (size_t q = 0; q < quads_.quad_count(); ++q) {
            const double worst = worst_corner(quads_, q);
            if (!(worst < sine)) continue;
            for (size_t k = 0; k < 4; ++k) {
                const uint32_t v = corner(q, k);
                uint8_t& held = quads_.held[v];
                if (held == ON_CREASE || (on_leash_[v] && worst < sine - MUCH)) held = 0;
                on_leash_[v] = is_for_tip(held);
            }
        }
    }

    hmf_status move_all(int sweeps) {
        if (!list_moving()) return call_.out_of_memory();
        for (int k = 0; k < sweeps; ++k)
            for (size_t i = 0; i < moving_.size(); ++i) {
                if (i % 4096 == 0 && !call_.tick(0)) return call_.was_cancelled();
                descend(moving_[i]);
            }
        return HMF_OK;
    }

    // In rings round quads with a corner that is off.
    Done list_moving() {
        Array<uint32_t> near;
        Array<uint8_t> inside;
        near.start(call_.memory);
        moving_.start(call_.memory);
        if (!inside.allocate_filled(call_.memory, quads_.vertex_count(), uint8_t{0})) return false;
        const auto add = [&](size_t q) -> Done {
            for (size_t k = 0; k < 4; ++k) {
                const uint32_t v = corner(q, k);
                if (inside[v]) continue;
                inside[v] = 1;
                if (!near.push(v)) return false;
            }
            return true;
        };
        for (size_t q = 0; q < quads_.quad_count(); ++q)
            for (size_t k = 0; k < 4; ++k)
                if (cosine(q, k) > OFF && !add(q)) return false;
        size_t begin = 0;
        for (int ring = 0; ring < RINGS; ++ring)
            for (const size_t end = near.size(); begin < end; ++begin)
                for (const uint32_t* q = stars_.begin(near[begin]); q != stars_.end(near[begin]); ++q)
                    if (!add(*q)) return false;
        for (const uint32_t v : near) {
            const uint8_t held = quads_.held[v];
            step_[v] = FIRST_STEP;
            if ((!held || can_slide(held) || on_leash_[v]) && !moving_.push(v)) return false;
        }
        return true;
    }

    struct Slope {
        double energy = 0, area = 0; // HUGE_VAL where a corner has no angle; twice
        Point gradient, growth;      // of both
        Point normals;               // sum
    };

    // Of the quads round v, with it at `here`.
    Slope slope_at(uint32_t v, const Point& here) const {
        Slope sum;
        for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q) {
            Point p[4]; // v first
            size_t turn = 0;
            while (corner(*q, turn) != v) ++turn;
            for (size_t k = 0; k < 4; ++k) p[k] = k == 0 ? here : at(quads_, corner(*q, turn + k));
            const Point n = cross(p[2] - p[0], p[3] - p[1]);
            const double length = std::sqrt(dot(n, n));
            if (!(length > 0)) return {HUGE_VAL, 0, {}, {}, {}};
            const Point normal = (1 / length) * n;
            sum.area += length;
            sum.growth = sum.growth + cross(normal, p[3] - p[1]);
            sum.normals = sum.normals + normal;
            for (const size_t k : {size_t{0}, size_t{1}, size_t{3}}) {
                Point by_e, by_b;
                sum.energy += of_corner(p[(k + 1) % 4] - p[k], p[(k + 3) % 4] - p[k], by_e, by_b);
                sum.gradient = sum.gradient + (k == 0 ? -1 * (by_e + by_b) : k == 1 ? by_b : by_e);
            }
        }
        return sum;
    }

    static double of_corner(const Point& e, const Point& b, Point& by_e, Point& by_b) {
        const Point n = cross(e, b);
        const double x = dot(e, e), y = dot(b, b), s = x + y, d2 = dot(n, n);
        if (!(d2 > 1e-12 * x * y)) return HUGE_VAL;
        const double d = std::sqrt(d2), c = dot(e, b) / d, r = (x - y) / s;
        const double by_c = c * (4 * c * c + 2 * EVEN) / d, by_r = ASPECT * r * (4 * r * r + 2 * EVEN) * 4 / (s * s);
        const Point normal = (c / d) * n; // times the cotangent
        by_e = by_c * (b - cross(b, normal)) + (by_r * y) * e;
        by_b = by_c * (e - cross(normal, e)) - (by_r * x) * b;
        return c * c * (c * c + EVEN) + ASPECT * r * r * (r * r + EVEN);
    }

    double least_sine(uint32_t v) const {
        double least = 1;
        for (const uint32_t* q = stars_.begin(v); q != stars_.end(v); ++q)
            least = std::min(least, worst_corner(quads_, *q));
        return least;
    }

    // Down the slope, as far as it went the last time.
    void descend(uint32_t v) {
        const Point from = at(quads_, v);
        const Slope before = slope_at(v, from);
        const double sine = least_sine(v), count = static_cast<double>(stars_.end(v) - stars_.begin(v));
        if (!(sine > 0) || !(before.energy < HUGE_VAL)) return; // inverted
        // What is folded over would be folded more.
        const bool grows = sine >= FLAT && dot(before.normals, before.normals) >= AGREE * AGREE * count * count
                        && dot(before.normals, normal_at(mesh_, position_, quads_.sides[v])) > 0;
        const double area = before.area / (2 * count), side = std::sqrt(area), by_area = grows ? GROWTH / area : 0;
        const Point slope = before.gradient - by_area * before.growth;
        const double steep = std::sqrt(dot(slope, slope));
        if (!(steep * side > LEAST_SLOPE)) return;
        const uint32_t start = quads_.sides[v];
        const uint8_t held = quads_.held[v];
        const auto walk = held == ON_CREASE   ? walk_along_sharp_edges
                        : held == AT_BOUNDARY ? walk_along_rim
                                              : walk_to_nearest;
        for (int k = 0; k < ATTEMPTS; ++k) {
            Point to = from - (step_[v] * side / steep) * slope;
            if (on_leash_[v]) {
                const Point off = to - home_[v];
                const double far = std::sqrt(dot(off, off));
                if (far > LEASH * side) to = home_[v] + (LEASH * side / far) * off;
            }
            const double p[3] = {to.x, to.y, to.z}, back[3] = {from.x, from.y, from.z};
            double nearest[3];
            const uint32_t there = walk(mesh_, position_, start, p, nearest);
            const Slope after = slope_at(v, point(nearest, 0));
            const double change = after.energy - before.energy - by_area * (after.area - before.area);
            if (change < ENOUGH * dot(slope, point(nearest, 0) - from)) {
                quads_.put(v, nearest, there);
                if (least_sine(v) > std::min(sine, LEAST_CORNER)) {
                    step_[v] = std::min(step_[v] * LONGER, LONGEST_STEP);
                    return;
                }
                quads_.put(v, back, start);
            }
            step_[v] = std::max(step_[v] * SHORTER, SHORTEST_STEP);
        }
    }

    const Mesh& mesh_;
    const double* position_;
    QuadMesh& quads_;
    Call& call_;
    QuadStars stars_;
    Array<uint32_t> moving_;
    // Per vertex: where it was, its last step in sides, and whether it is at a tip that it may leave a little.
    Array<Point> home_;
    Array<double> step_;
    Array<uint8_t> on_leash_;
};

} // namespace

hmf_status square_corners(const Mesh& mesh, const double* position, int sweeps, double leave, QuadMesh& quads,
                          Call& call) {
    return Squaring(mesh, position, quads, call).run(sweeps, leave);
}

} // namespace hmf
