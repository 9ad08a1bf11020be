// Twists of cylinders.
//
//   second side  --o-----------B1----o----      B0, B1: base corners
//                  :            |               twist: from the point opposite
//                  to B0 to B1, along the leaves,
//   first side   --B0------o-----------o--             modulo the circumference
//
// Places along the leaves are integrals of the flux weight * F across edges,
// the discrete conjugate of u.  It is constant in each triangle, and closed
// around every vertex where F is harmonic.  Along a side it is read off the
// boundary leaf of the critical graph, across a cylinder off its path
// (core/leaves/cylinders.hpp).
#include "cylinder_measures.hpp"

#include "../common/caller_lists.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// Where a boundary leaf passes a zero.
struct Corner {
    uint32_t vertex, toward; // of the caller: origin and target of the last
                             // half-edge of its sector
    double place;            // along the boundary leaf
};

bool is_before(const Corner& a, const Corner& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.toward < b.toward;
}

double modulo(double place, double whole) {
    const double rest = place - whole * std::floor(place / whole);
    return rest >= whole ? 0 : rest;
}

class TwistMeter {
public:
    TwistMeter(const State& solved, const Cylinders& cylinders, const uint32_t* caller) :
        f_(solved.foliation), weight_(solved.hierarchy->levels[solved.level].weight), cylinders_(cylinders),
        graph_(cylinders.graph), caller_(caller) {}

    // Places before the crossings of boundary leaves, and the flux of each
    // sector.
    Done measure_boundaries(Memory& memory) {
        first_.start(memory);
        second_.start(memory);
        if (!place_.allocate(memory, graph_.crossings.size())
            || !flux_.allocate_filled(memory, graph_.sectors.size(), 0.0))
            return false;
        for (const Boundary& b : graph_.boundaries) {
            place_[b.begin] = 0;
            for (uint64_t i = b.begin; i + 1 < b.end; ++i)
                place_[i + 1] = place_[i] + flux(graph_.crossings[i].half_edge);
            for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) {
                const bool is_first = a == b.arcs_begin;
                const ArcSide &out = graph_.arcs[a], &in = graph_.arcs[is_first ? b.arcs_end - 1 : a - 1];
                const double end = place_[out.first + 1] + (is_first ? place_[b.end - 1] : 0);
                if (!is_tripod(out.from)) flux_[out.from] = end - place_[in.last];
            }
        }
        return true;
    }

    Done add(const Cylinder& c, double circumference, double unit, Twists& out) {
        // The boundary leaves run in opposite directions: places of points opposite
        // to each other have this sum.
        const double sum = across(c, circumference);
        if (!read_corners(c.lower, first_) || !read_corners(c.upper, second_)) return false;
        if (std::isnan(sum) || first_.empty() || second_.empty()) {
            first_.clear();
            second_.clear();
        } else {
            if (is_before(second_[0], first_[0])) first_.swap(second_);
            std::reverse(second_.begin() + 1, second_.end());
        }
        double base = 0, other = NAN;
        if (!first_.empty()) {
            base = first_[0].place;
            other = second_[0].place;
        } else if (graph_.zeros.empty())
            other = place_[graph_.boundaries[c.upper].begin + 1]; // both sides are one leaf
        if (!out.twist.push(modulo(sum - other - base, circumference) * unit)) return false;
        for (const Array<Corner>* side : {&first_, &second_}) {
            for (const Corner& at : *side) {
                const double place = (side == &first_ ? at.place : sum - at.place) - base;
                if (!out.vertices.push(at.vertex) || !out.places.push(modulo(place, circumference) * unit))
                    return false;
            }
            if (!out.offsets.push(out.places.size())) return false;
        }
        return true;
    }

private:
    double flux(uint32_t h) const { return weight_[edge_of(h)] * static_cast<double>(f_.at(h)); }
    bool is_tripod(uint32_t sector) const { return graph_.zeros[graph_.sectors[sector].zero].tripod; }
    uint32_t number(uint32_t v) const { return caller_ ? caller_[v] : v; }

    // Of a corner at a vertex, before the end of its sector.  Of sector s let
    // l(s) be the distance from the vertex to the triangle where its prong
    // begins.  Then l(s) + l(s - 1) is the flux of s.  For an odd number of
    // prongs this has one solution, else this is the shortest one.  Returns l(s).
    double before_end(uint32_t sector) const {
        uint32_t n = 1, k = 1;
        double sum = flux_[sector], sign = 1;
        for (uint32_t s = graph_.sectors[sector].next; s != sector; s = graph_.sectors[s].next) ++n;
        for (uint32_t s = graph_.sectors[sector].next; s != sector; s = graph_.sectors[s].next, ++k, sign = -sign)
            sum += sign * (n % 2 == 1 ? 1 : 1 - 2.0 * k / n) * flux_[s];
        return sum / 2;
    }

    // In the order of the leaf; the first is the base.
    Done read_corners(uint32_t boundary, Array<Corner>& corners) const {
        const Boundary& b = graph_.boundaries[boundary];
        corners.clear();
        for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) {
            const ArcSide& arc = graph_.arcs[a];
            const uint32_t h = graph_.sectors[arc.from].last;
            const double place = is_tripod(arc.from) ? place_[arc.first] : place_[arc.first + 1] - before_end(arc.from);
            if (!corners.push({number(f_.mesh.origin[h]), number(f_.mesh.target(h)), place})) return false;
        }
        std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), is_before), corners.end());
        return true;
    }

    // Counter-clockwise around a side of a cluster, from the triangle left of one
    // half-edge to the one right of another.  sign: -1 if `from` leads down. NAN:
    // the other one is not there.
    double around(uint32_t from, uint32_t to, double sign) const {
        double place = 0;
        bool closed = false;
        for (uint32_t g = next_round(f_, from, closed); g != to; g = next_round(f_, g, closed)) {
            if (g == from) return NAN;
            if (closed) sign = 1;
            place += sign * flux(g);
        }
        return place;
    }

    // The same across a closed leaf of edges of value 0, where no flux crosses.
    double through(uint32_t from, uint32_t to) const {
        double place = 0;
        uint32_t g = from;
        do {
            const uint32_t zero = f_.mesh.prev(g), up = f_.mesh.next[twin(zero)];
            if (f_.at(zero) == 0 && f_.at(up) > 0) {
                const double rest = up == to ? -flux(up) : around(up, to, 1);
                if (!std::isnan(rest)) return place + rest;
            }
            bool closed = false;
            g = next_round(f_, g, closed);
            place -= flux(g);
        } while (g != from);
        return NAN;
    }

    // Follows the path in the triangles right of it, from place 0 of the lower
    // boundary leaf.  Returns the sum of the places of opposite points.  NAN:
    // flux is lost between a side and the middle leaf, or the path is blocked.
    double across(const Cylinder& c, double circumference) const {
        constexpr double largest = 1e-4; // as of the sum of areas
        for (const uint32_t side : {c.lower, c.upper})
            if (std::fabs(place_[graph_.boundaries[side].end - 1] / circumference - 1) > largest) return NAN;
        double place = 0;
        for (uint64_t i = c.path_begin + 1; i < c.path_end; ++i) {
            const uint32_t from = twin(cylinders_.pieces[i - 1].half_edge), to = cylinders_.pieces[i].half_edge;
            const double passed = around(from, to, -1);
            place += std::isnan(passed) ? through(from, to) : passed;
        }
        const PathPiece& last = cylinders_.pieces[c.path_end - 1];
        uint64_t i = graph_.boundaries[c.upper].begin;
        while (i + 2 < graph_.boundaries[c.upper].end && !(graph_.crossings[i] == Crossing{last.half_edge, last.to}))
            ++i; // leads to the right of the path
        return place + place_[i + 1];
    }

    const Foliation& f_;
    const double* weight_;
    const Cylinders& cylinders_;
    const CriticalGraph& graph_;
    const uint32_t* caller_;
    Array<double> place_, flux_; // per crossing, per sector
    Array<Corner> first_, second_;
};

} // namespace

hmf_status measure_twists(const State& solved, const Cylinders& measured, const Array<uint32_t>& found,
                          const Array<hmf_cylinder>& list, double unit, Twists& out, Call& call) {
    Array<uint32_t> numbers;
    const hmf_hierarchy& h = *solved.hierarchy;
    if (solved.level == 0 && inverse_numbers(h.vertex_internal, h.input.vertex_count, numbers, call))
        return call.status();
    out.twist.start(call.memory);
    out.places.start(call.memory);
    out.offsets.start(call.memory);
    out.vertices.start(call.memory);
    TwistMeter meter(solved, measured, solved.level == 0 ? numbers.data() : nullptr);
    if (!meter.measure_boundaries(call.memory) || !out.offsets.push(0)) return call.out_of_memory();
    for (size_t c = 0; c < list.size(); ++c) {
        if (!call.tick(0)) return call.was_cancelled();
        if (!meter.add(measured.list[found[c]], list[c].circumference / unit, unit, out)) return call.out_of_memory();
    }
    return HMF_OK;
}

} // namespace hmf
