#include "closed_geodesic.hpp"

#include "loop_parameters.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hmf {

ClosedGeodesic::ClosedGeodesic(const Mesh& mesh, const double* position, double scale, Call& call) :
    mesh_(mesh), position_(position), scale_(scale > 0 ? scale : 1), call_(call) {
    double largest = 0;
    for (size_t i = 0; !(scale > 0) && i < 3 * size_t{mesh.vertex_count}; ++i) {
        const double x = position[i] < 0 ? -position[i] : position[i];
        largest = std::max(largest, x);
    }
    if (largest > 0) scale_ = largest;
    portal_.start(call.memory);
    bend_.start(call.memory);
    for (Array<Bend>& chain : chain_) chain.start(call.memory);
    next_.start(call.memory);
    outside_.start(call.memory);
    around_.start(call.memory);
    detour_.start(call.memory);
    best_.start(call.memory);
    pushed_.start(call.memory);
    tried_.start(call.memory);
}

Done ClosedGeodesic::keep_lengths() { return edge_length_.allocate_filled(call_.memory, mesh_.edge_count, -1.0); }

double ClosedGeodesic::measure_edge(uint32_t edge) const {
    const double* const p = position_ + 3 * size_t{mesh_.origin[2 * edge]};
    const double* const q = position_ + 3 * size_t{mesh_.origin[2 * edge + 1]};
    double square = 0;
    for (int c = 0; c < 3; ++c) {
        const double d = p[c] / scale_ - q[c] / scale_;
        square += d * d;
    }
    return std::sqrt(square);
}

// Portal i is crossing i modulo n.  From one to the next one of the ends stays:
//
//        left --- next left         twin(h) runs from left to right, the third
//         |  \      |               corner of its triangle is an end of the next
//         h     \   |               portal.
//        right ----- (or next right)
Done ClosedGeodesic::unfold(const uint32_t* loop, size_t n, size_t portals) {
    portal_.clear();
    if (!portal_.reserve(portals)) return false;
    Portal at = {{0, edge_length(edge_of(loop[0]))}, {0, 0}};
    portal_.add(at);
    for (size_t i = 0, k = 0; i + 1 < portals; ++i) {
        const uint32_t t = twin(loop[k]);
        if (++k == n) k = 0;
        const double a = edge_length(edge_of(mesh_.next[t])), b = edge_length(edge_of(mesh_.prev(t)));
        const double dx = at.left.x - at.right.x, dy = at.left.y - at.right.y, square = dx * dx + dy * dy;
        Point apex = at.right;
        if (square > 0) {
            const double along = (a * a - b * b + square) / (2 * square);
            const double rest = a * a / square - along * along, ahead = rest > 0 ? std::sqrt(rest) : 0;
            apex.x += along * dx + ahead * dy;
            apex.y += along * dy - ahead * dx;
        }
        (loop[k] == mesh_.next[t] ? at.left : at.right) = apex;
        portal_.add(at);
    }
    return true;
}

// The shortest path through the portals first .. last - 1; bend_ has its corners.  The funnel: the shortest paths from
// the last corner, apex, to the two ends of a portal, each of which turns outwards only.
//
//        left \       / right        A new left end cuts corners off the left chain. If it
//              \     /              lies beyond the right one, the path bends at its corners
//               \  /               until that is no longer so.
//               apex
Done ClosedGeodesic::pull(Point from, size_t first, Point to, size_t last) {
    const auto turn = [](Point a, Point b, Point c) { // > 0: c lies on the left of a -> b
        return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    size_t front[2] = {0, 0}; // of the chains, on the left and on the right
    bend_.clear();
    for (Array<Bend>& chain : chain_) chain.clear();
    const auto corner = [this](size_t side, size_t i) { return Point{chain_[side][i].x, chain_[side][i].y}; };
    for (size_t i = first; i <= last; ++i) {
        if (++work_ % 16384 == 0 && !call_.tick(0, true)) return false;
        for (size_t side = 0; side < (i < last ? 2 : 1); ++side) {
            const Point p = i == last ? to : side == 0 ? portal_[i].left : portal_[i].right;
            const double out = side == 0 ? 1 : -1; // the sign of a turn outwards
            Array<Bend>&own = chain_[side], &other = chain_[1 - side];
            while (own.size() > front[side]) {
                const size_t back = own.size() - 1;
                if (out * turn(back > front[side] ? corner(side, back - 1) : from, corner(side, back), p) > 0) break;
                own.pop();
            }
            for (; own.size() == front[side] && other.size() > front[1 - side]; ++front[1 - side]) {
                if (out * turn(from, corner(1 - side, front[1 - side]), p) >= 0) break;
                from = corner(1 - side, front[1 - side]);
                if (!bend_.push(other[front[1 - side]])) return false;
            }
            const bool is_apex = p.x == from.x && p.y == from.y;
            if (!is_apex && !own.push({p.x, p.y, static_cast<uint32_t>(i), side == 0})) return false;
        }
    }
    for (size_t k = front[0]; k + 1 < chain_[0].size(); ++k)
        if (!bend_.push(chain_[0][k])) return false;
    return true;
}

double ClosedGeodesic::pulled_length(Point from, Point to) const {
    const auto distance = [](double x, double y) { return std::sqrt(x * x + y * y); };
    double sum = 0;
    for (const Bend& b : bend_) {
        sum += distance(b.x - from.x, b.y - from.y);
        from = {b.x, b.y};
    }
    return sum + distance(to.x - from.x, to.y - from.y);
}

// Where a line crosses a portal.
double ClosedGeodesic::crossed_at(Point at, Point ahead, const Portal& p) {
    const auto cross = [](Point a, Point b, Point c, Point d) { // (b - a) x (d - c)
        return (b.x - a.x) * (d.y - c.y) - (b.y - a.y) * (d.x - c.x);
    };
    const double down = cross(at, ahead, p.right, p.left), along = cross(at, ahead, p.right, at);
    const double share = down != 0 ? along / down : 0.5;
    return std::min(std::max(share, 0.0), 1.0);
}

// Is the angle outside the strip at a bend less than a half turn?  outside_:
// the crossings on that side, in place of `count` ones from `first` on.
Done ClosedGeodesic::look_outside(const uint32_t* loop, size_t n, size_t bend, Point from, Point to, size_t& first,
                                  size_t& count, bool& shorter) {
    shorter = false;
    const Bend at = bend_[bend];
    const bool left = at.left;
    const auto h = [&](size_t i) { return loop[i % n]; };
    const auto keeps = [&](size_t i) { // the vertex, from portal i to the next
        const uint32_t t = twin(h(i));
        return h(i + 1) == (left ? mesh_.prev(t) : mesh_.next[t]);
    };
    const uint32_t vertex = left ? mesh_.target(h(at.portal)) : mesh_.origin[h(at.portal)];
    if (mesh_.is_marked(vertex)) return true;
    size_t i = at.portal, j = i;
    while (i > 0 && at.portal - i < n && keeps(i - 1)) --i;
    while (j + 1 < portal_.size() && j - at.portal < n && keeps(j)) ++j;
    if (i == 0 || j + 1 >= portal_.size() || j - i + 1 >= n) return true;
    first = i % n;
    count = j - i + 1;
    // The sum of the angles, as a product of rotations.
    double re = 1, im = 0;
    const auto rotate = [&](double dot, double cross) { // false: past a half turn
        const double size = std::sqrt(dot * dot + cross * cross);
        if (!(size > 0)) return true;
        const double c = dot / size, s = (cross < 0 ? -cross : cross) / size;
        const double x = re * c - im * s, y = re * s + im * c;
        re = x;
        im = y;
        return im > 0 || (im == 0 && re > 0);
    };
    const auto between = [&](Point p, Point q) {
        const double px = p.x - at.x, py = p.y - at.y, qx = q.x - at.x, qy = q.y - at.y;
        return rotate(px * qx + py * qy, px * qy - py * qx);
    };
    const Point before = bend > 0 ? Point{bend_[bend - 1].x, bend_[bend - 1].y} : from;
    const Point after = bend + 1 < bend_.size() ? Point{bend_[bend + 1].x, bend_[bend + 1].y} : to;
    if (!between(before, left ? portal_[i - 1].left : portal_[i - 1].right)) return true;
    outside_.clear();
    uint32_t g = left ? mesh_.next[h(i)] : mesh_.prev(h(i));
    const uint32_t end = twin(h(j));
    if (g == end) return true;
    for (;;) {
        if (!outside_.push(g)) return false;
        const uint32_t t = twin(g), ahead = left ? mesh_.next[t] : mesh_.prev(t);
        const uint32_t opposite = left ? mesh_.prev(t) : mesh_.next[t];
        if (ahead == end) break;
        const double p = edge_length(edge_of(g)), q = edge_length(edge_of(ahead)), r = edge_length(edge_of(opposite));
        const double dot = (p * p + q * q - r * r) / 2, rest = p * p * q * q - dot * dot;
        if (!rotate(dot, rest > 0 ? std::sqrt(rest) : 0)) return true;
        g = ahead;
    }
    if (!between(left ? portal_[j + 1].left : portal_[j + 1].right, after)) return true;
    shorter = im > LITTLE || re > 0;
    return true;
}

// All bends that gain, as long as their crossings differ.  The curve goes from one point to another.
Done ClosedGeodesic::go_round(const uint32_t* loop, size_t n, Point from, Point to, bool& changed) {
    changed = false;
    detour_.clear();
    if (!detours_at_.allocate_filled(call_.memory, n, NONE)) return false;
    around_.clear();
    for (size_t b = 0; b < bend_.size(); ++b) {
        size_t first = 0, count = 0;
        bool shorter = false;
        if (!look_outside(loop, n, b, from, to, first, count, shorter) || !call_.work(16 * outside_.size()))
            return false;
        if (!shorter) continue;
        bool taken = false;
        for (size_t k = 0; k < count; ++k) taken |= detours_at_[(first + k) % n] != NONE;
        if (taken) continue;
        for (size_t k = 0; k < count; ++k) detours_at_[(first + k) % n] = static_cast<uint32_t>(detour_.size());
        const size_t outside = around_.size();
        for (const uint32_t g : outside_)
            if (!around_.push(g)) return false;
        if (!detour_.push({first, outside, around_.size(), bend_[b].left})) return false;
        changed = true;
    }
    if (!changed) return true;
    size_t start = 0;
    while (start < n && detours_at_[start] != NONE && detour_[detours_at_[start]].first != start) ++start;
    next_.clear();
    for (size_t k = 0; k < n; ++k) {
        const size_t at = start + k < n ? start + k : start + k - n;
        const uint32_t d = detours_at_[at];
        if (d == NONE) {
            if (!next_.push(loop[at])) return false;
        } else if (detour_[d].first == at) {
            for (size_t i = detour_[d].begin; i < detour_[d].end; ++i)
                if (!next_.push(around_[i])) return false;
        }
    }
    return true;
}

// Where the curve that was pulled from one point to another goes through a portal.
double ClosedGeodesic::share_at(Point from, Point to, size_t portal) const {
    size_t next = 0;
    while (next < bend_.size() && bend_[next].portal < portal) ++next;
    const auto corner = [&](size_t b) { return Point{bend_[b].x, bend_[b].y}; };
    return crossed_at(next > 0 ? corner(next - 1) : from, next < bend_.size() ? corner(next) : to, portal_[portal]);
}

// A point of the curve half a period after the fixed one, on a crossing that stays; if there is none, a vertex that the
// strip goes around.
ClosedGeodesic::Held ClosedGeodesic::held_next(const uint32_t* loop, size_t n, Point from, Point to) const {
    for (size_t away = 0; away <= n / 2; ++away)
        for (const size_t portal : {n / 2 - away, n / 2 + away})
            if (portal < n && detours_at_[portal] == NONE) return {loop[portal], share_at(from, to, portal)};
    const Detour& detour = detour_[detour_.size() / 2];
    return {around_[detour.begin], detour.left ? 0.0 : 1.0};
}

// next_, without ways there and back, instead of the loop; not if nothing is left of it, as it was not essential.
Done ClosedGeodesic::take_next(Array<uint32_t>& loop, bool& taken) {
    size_t begin = 0, end = 0;
    remove_backtracking(next_, begin, end);
    taken = begin < end;
    if (!taken) return true;
    loop.clear();
    for (size_t i = begin; i < end; ++i)
        if (!loop.push(next_[i])) return false;
    return true;
}

// One point of the curve is held while a period is pulled from there, another one, half a period away, the next time:
// roughly first, and to the end if the curve is of interest.
Done ClosedGeodesic::straighten(Array<uint32_t>& loop, size_t rounds, double& length, double interest) {
    double little = CLOSE;
    Held held = {loop[0], 0.5};
    length = HUGE_VAL;
    for (size_t round = 0, still = 0;; ++round) {
        if (!call_.tick(0, true)) return false;
        const size_t n = loop.size();
        size_t at = 0;
        while (at < n && loop[at] != held.crossing) ++at;
        if (at == n) held = {loop[at = 0], 0.5};
        std::rotate(loop.data(), loop.data() + at, loop.data() + n);
        if (!unfold(loop.data(), n, n + 1)) return false;
        const auto on = [&](const Portal& p) {
            return Point{p.right.x + held.share * (p.left.x - p.right.x),
                         p.right.y + held.share * (p.left.y - p.right.y)};
        };
        const Point from = on(portal_[0]), to = on(portal_[n]);
        if (!pull(from, 0, to, n)) return false;
        const double now = pulled_length(from, to);
        bool changed = false, taken = false;
        if (!go_round(loop.data(), n, from, to, changed)) return false;
        still = now < length * (1 - little) ? 0 : still + 1;
        length = now;
        if (still == 2 && little > LITTLE && !(length > interest * (1 + CLOSE))) {
            little = LITTLE;
            still = 0;
        }
        const bool ends = still == 2 || round + 1 == rounds;
        if (!ends) held = held_next(loop.data(), n, from, to);
        if (!ends && changed && !take_next(loop, taken)) return false;
        if (ends || (changed && !taken)) return true;
    }
}

// next_: the strip around the vertices on one side, if there are two and none is marked.
Done ClosedGeodesic::push_aside(const Array<uint32_t>& loop, bool left, bool& moved) {
    moved = false;
    const size_t n = loop.size();
    const auto h = [&](size_t i) { return loop[i % n]; };
    const auto keeps = [&](size_t i) { // the vertex, from crossing i to the next
        const uint32_t t = twin(h(i));
        return h(i + 1) == (left ? mesh_.prev(t) : mesh_.next[t]);
    };
    size_t start = 0;
    while (start < n && keeps(start + n - 1)) ++start;
    if (start == n) return true;
    next_.clear();
    for (size_t i = start; i < start + n;) {
        size_t j = i;
        while (keeps(j)) ++j;
        if (mesh_.is_marked(left ? mesh_.target(h(i)) : mesh_.origin[h(i)])) return true;
        const uint32_t end = twin(h(j));
        for (uint32_t g = left ? mesh_.next[h(i)] : mesh_.prev(h(i)); g != end;) {
            if (!next_.push(g)) return false;
            const uint32_t t = twin(g);
            g = left ? mesh_.next[t] : mesh_.prev(t);
        }
        i = j + 1;
    }
    moved = true;
    return true;
}

Done ClosedGeodesic::straighten_widely(Array<uint32_t>& loop, size_t rounds, double& length) {
    const auto copy = [](Array<uint32_t>& to, const Array<uint32_t>& from) -> Done {
        to.clear();
        if (!to.reserve(from.size())) return false;
        for (const uint32_t x : from) to.add(x);
        return true;
    };
    if (!straighten(loop, rounds, length) || !copy(best_, loop)) return false;
    for (int moves = 0; moves < CHOICE_ROUNDS;) {
        bool shorter = false;
        for (int side = 0; side < 2 && !shorter; ++side) {
            if (!copy(pushed_, best_)) return false;
            for (size_t k = 1; k <= MOST_ASIDE && !shorter; ++k) {
                bool moved = false;
                if (!push_aside(pushed_, side == 0, moved) || !call_.work(32 * next_.size())) return false;
                if (!moved) break;
                size_t begin = 0, end = 0;
                remove_backtracking(next_, begin, end);
                if (begin == end || end - begin > 4 * best_.size() + CANDIDATES) break;
                pushed_.clear();
                for (size_t i = begin; i < end; ++i)
                    if (!pushed_.push(next_[i])) return false;
                if (k != MOST_ASIDE / 4 && k != MOST_ASIDE) continue;
                double found = 0;
                if (!copy(tried_, pushed_) || !straighten(tried_, rounds, found, length)) return false;
                if (!(found < length * (1 - LITTLE))) continue;
                shorter = found < length * (1 - SAME);
                length = found;
                if (!copy(best_, tried_)) return false;
            }
        }
        if (!shorter) break;
        ++moves;
    }
    return copy(loop, best_);
}

} // namespace hmf
