#include "check_lines.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

class PairCheck {
public:
    PairCheck(const Lines& lines, const Foliation& f, const double* position) :
        lines_(lines), f_(f), position_(position) {}

    void compare(size_t p, size_t q, LineCheck& out) const {
        const uint32_t e = lines_.edges[p], g = lines_.edges[q];
        if (e == NONE || g == NONE) return;
        ++out.pairs;
        Difference best;
        for (uint32_t side = 2 * g; side < 2 * g + 2; ++side) {
            const uint32_t next = f_.mesh.next[side], previous = f_.mesh.next[next];
            // The corner that both edges share is the target of `side`, or its origin.
            if (edge_of(next) == e) best.take(around({p, next}, {q, twin(side)}));
            if (edge_of(previous) == e) best.take(around({p, twin(previous)}, {q, side}));
        }
        if (!best.within() && !passes_vertex(p, q, best)) ++out.wrong;
        else if (best.value < HUGE_VAL) out.deviation = std::max(out.deviation, best.value);
    }

private:
    struct Difference {
        double value = HUGE_VAL, tolerance = 0; // units
        bool within() const { return value <= tolerance; }
        void take(const Difference& other) {
            if (!within()) *this = other;
        }
    };
    struct OnSide {
        size_t point;
        uint32_t side;
    };
    const double* at(uint32_t v) const { return position_ + size_t{3} * v; }
    double value(uint32_t h) const { return static_cast<double>(f_.at(h)); }

    // From the origin of the half-edge, in F.
    double distance(const OnSide& place) const {
        const double *a = at(f_.mesh.origin[place.side]), *b = at(f_.mesh.target(place.side));
        const double* p = &lines_.points[3 * place.point];
        const double x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
        const double square = x * x + y * y + z * z;
        if (!(square > 0)) return 0;
        return value(place.side) * (((p[0] - a[0]) * x + (p[1] - a[1]) * y + (p[2] - a[2]) * z) / square);
    }
    // How far rounding can move it: 2^-52 of the coordinates, and a unit for the place itself.
    double rounding(const OnSide& place) const {
        constexpr double bits = 0x1p-46;
        const double *a = at(f_.mesh.origin[place.side]), *b = at(f_.mesh.target(place.side));
        double square = 0, size = 0;
        for (int k = 0; k < 3; ++k) {
            square += (b[k] - a[k]) * (b[k] - a[k]);
            size += std::fabs(a[k]) + std::fabs(b[k]);
        }
        return 1 + value(place.side) * (square > 0 ? bits * (1 + size / std::sqrt(square)) : 1);
    }

    // Both on half-edges out of one corner of a triangle, of which the coordinate is that of p.side or q.side.
    Difference around(const OnSide& p, const OnSide& q) const {
        const uint32_t inside = f_.mesh.prev(p.side) == twin(q.side) ? p.side : q.side;
        const double a = distance(p), b = distance(q);
        const double beyond = std::max(a, b) - static_cast<double>(f_.corner2(inside)) / 2;
        const Difference coarse{std::max(std::fabs(a - b), beyond), 1};
        return coarse.within() ? coarse : Difference{coarse.value, rounding(p) + rounding(q)};
    }

    bool is_at(size_t point, uint32_t v) const {
        const double *a = at(v), *p = &lines_.points[3 * point];
        return a[0] == p[0] && a[1] == p[1] && a[2] == p[2];
    }
    bool is_at_vertex(const OnSide& p) const {
        return is_at(p.point, f_.mesh.origin[p.side]) || is_at(p.point, f_.mesh.target(p.side));
    }

    // A critical leaf can come through a vertex, on any edge there, and cross the opposite side.
    bool passes_vertex(size_t p, size_t q, Difference& best) const {
        const OnSide a{p, 2 * lines_.edges[p]}, b{q, 2 * lines_.edges[q]};
        const bool at_a = is_at_vertex(a), at_b = is_at_vertex(b);
        if (at_a && at_b) return true;
        if (!at_a && !at_b) return false;
        const OnSide from = at_a ? a : b, to = at_a ? b : a;
        for (const uint32_t side : {to.side, twin(to.side)}) {
            const uint32_t previous = f_.mesh.prev(side);
            if (!is_at(from.point, f_.mesh.origin[previous])) continue;
            const OnSide there{to.point, side};
            best.take({std::fabs(distance(there) - value(previous)), rounding(there)});
        }
        return best.within();
    }

    const Lines& lines_;
    const Foliation& f_;
    const double* position_;
};

} // namespace

hmf_status check_lines(const Lines& lines, const Foliation& f, const double* position, uint64_t most_pairs,
                       LineCheck& out, Call& call) {
    const PairCheck pairs(lines, f, position);
    const size_t n = lines.edges.size(), stride = n / static_cast<size_t>(std::max<uint64_t>(most_pairs, 1)) + 1;
    size_t p = 0;
    for (size_t k = 0; k < lines.list.size(); ++k) {
        const size_t begin = static_cast<size_t>(lines.offsets[k]), end = static_cast<size_t>(lines.offsets[k + 1]);
        for (; p + 1 < end; p += stride) {
            pairs.compare(p, p + 1, out);
            if (!call.work(64, 0.94, false)) return call.was_cancelled();
        }
        if (lines.list[k].closed && end > begin) pairs.compare(end - 1, begin, out);
        p = std::max(p, end);
        if (!call.work(64, 0.94, false)) return call.was_cancelled();
    }
    return HMF_OK;
}

namespace {

// From the origin of h, as a part of it.
double part_of_side(const Mesh& mesh, const double* position, uint32_t h, const double* p) {
    const double *a = position + size_t{3} * mesh.origin[h], *b = position + size_t{3} * mesh.target(h);
    double along = 0, square = 0;
    for (int k = 0; k < 3; ++k) {
        along += (p[k] - a[k]) * (b[k] - a[k]);
        square += (b[k] - a[k]) * (b[k] - a[k]);
    }
    return square > 0 ? along / square : 0;
}

// Change of u between points on two sides of one triangle; HUGE_VAL if there is none.
double change_of_u(const Lines& lines, const Mesh& mesh, const FlatConeMetric& flat, const double* position, size_t p,
                   size_t q) {
    const auto du = [&](uint32_t h) { return static_cast<double>(flat.du.at(flat.bundle, h)); };
    for (uint32_t side = 2 * lines.edges[q], end = side + 2; side < end; ++side)
        for (uint32_t other = mesh.next[side]; other != side; other = mesh.next[other]) {
            if (edge_of(other) != lines.edges[p]) continue;
            // u at both, against the origin of `side`.
            const double to_q = du(side) * part_of_side(mesh, position, side, &lines.points[3 * q]);
            const double on_other = du(other) * part_of_side(mesh, position, other, &lines.points[3 * p]);
            const double to_p = other == mesh.next[side] ? du(side) + on_other : on_other - du(other);
            return std::fabs(to_p - to_q);
        }
    return HUGE_VAL;
}

// The widest side of both triangles next to an edge, in u.
double widest_beside(const Mesh& mesh, const FlatConeMetric& flat, uint32_t edge) {
    double widest = 0;
    for (const uint32_t side : {2 * edge, 2 * edge + 1})
        for (const uint32_t h : {side, mesh.next[side], mesh.prev(side)})
            widest = std::max(widest, std::fabs(static_cast<double>(flat.du.value[edge_of(h)])));
    return widest;
}

} // namespace

hmf_status check_crossings(const Lines& lines, const Mesh& mesh, const FlatConeMetric& flat, const double* position,
                           const Array<double>& height, uint64_t most_points, uint64_t& wrong, Call& call) {
    uint64_t points = 0, looked_at = 0;
    for (size_t k = 0; k < lines.list.size(); ++k) {
        const hmf_line& line = lines.list[k];
        size_t begin = static_cast<size_t>(lines.offsets[k]), end = static_cast<size_t>(lines.offsets[k + 1]);
        points += end - begin;
        const bool crosses = line.kind == HMF_LINE_LEVEL && line.begin == HMF_END_CRITICAL
                          && line.end == HMF_END_CRITICAL && end - begin > 3;
        if (!crosses || looked_at * lines.edges.size() > points * most_points) continue;
        looked_at += end - begin;
        if (!call.work(64 * (end - begin), 0.94, false)) return call.was_cancelled();
        while (begin < end && lines.edges[begin] == NONE) ++begin;
        while (begin < end && lines.edges[end - 1] == NONE) --end;
        if (begin == end) continue;
        double sum = 0;
        for (size_t p = begin; p + 1 < end; ++p) sum += change_of_u(lines, mesh, flat, position, p, p + 1);
        const double most = height[line.cylinder] * (1 + 1e-6);
        const double ends =
            widest_beside(mesh, flat, lines.edges[begin]) + widest_beside(mesh, flat, lines.edges[end - 1]);
        wrong += !(sum <= most && sum + ends >= height[line.cylinder] * (1 - 1e-6));
    }
    return HMF_OK;
}

} // namespace hmf
