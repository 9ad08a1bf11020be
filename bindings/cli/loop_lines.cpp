// The shortest curve in a strip of triangles, laid out in the plane, by the funnel algorithm (Lee and Preparata 1984;
// Chazelle 1982):
//
//        l0____l1______l2        The shortest path from an apex to the next edge runs inside a funnel of two chains;
//       /  \    \     /  \       an edge narrows it, and where a chain is crossed the path has a corner.
//   ---o----\----\---/----o---   A closed curve is cut open at a point of an edge; a few rounds, each opened at
//       \____\____\_/____/       another edge, settle.
//           r0    r1    r2
#include "loop_lines.hpp"

#include <cmath>

namespace cli {

namespace {

using Point = std::array<double, 3>;

Point place(const Foliation& f, uint32_t vertex) {
    return {f.positions[3 * size_t(vertex)], f.positions[3 * size_t(vertex) + 1], f.positions[3 * size_t(vertex) + 2]};
}

Point between(const Point& a, const Point& b, double t) {
    return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

double distance(const Point& a, const Point& b) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return std::sqrt(x * x + y * y + z * z);
}

struct Planar {
    double x = 0, y = 0;
};
double turn(Planar a, Planar b, Planar c) { return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y); }
Planar between(Planar a, Planar b, double t) { return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; }

// An edge that the strip crosses: its ends on the left and on the right.
struct Gate {
    uint32_t left, right;
};

// The third corner of a triangle with two sides known: on the far side of the edge from `left` to `right`.
Planar unfolded(const Foliation& f, Gate gate, Planar left, Planar right, uint32_t third) {
    const Point l = place(f, gate.left), r = place(f, gate.right), p = place(f, third);
    const double width = distance(l, r), to_left = distance(l, p), to_right = distance(r, p);
    if (!(width > 0)) return left;
    const double along = (width * width + to_left * to_left - to_right * to_right) / (2 * width);
    const double off = std::sqrt(std::max(0.0, to_left * to_left - along * along));
    const Planar axis{(right.x - left.x) / width, (right.y - left.y) / width};
    return {left.x + along * axis.x - off * axis.y, left.y + along * axis.y + off * axis.x};
}

// Where the shortest path from `start` to `end` crosses each gate, as a fraction from left to right.
std::vector<double> funnel(const std::vector<Planar>& left, const std::vector<Planar>& right, Planar start,
                           Planar end) {
    const size_t n = left.size();
    std::vector<double> fraction(n, 0.5);
    Planar apex = start;
    size_t apex_at = 0, left_at = 0, right_at = 0; // gates
    Planar l = left[0], r = right[0];
    const auto leg = [&](size_t from, size_t to, Planar a, Planar b) {
        for (size_t k = from; k < to; ++k) {
            const double x = turn(a, b, left[k]), y = turn(a, b, right[k]);
            fraction[k] = x - y != 0 ? std::min(1.0, std::max(0.0, x / (x - y))) : 0.5;
        }
    };
    // Each corner of the path starts again behind it: at most n corners, and each looks at gates up to the next one.
    for (size_t k = 0, corners = 0; k <= n && corners <= 2 * n + 2; ++k) {
        const Planar nl = k < n ? left[k] : end, nr = k < n ? right[k] : end;
        const auto corner = [&](Planar at, size_t gate, double value) {
            if (gate >= n) return; // the end itself
            leg(apex_at, gate, apex, at);
            fraction[gate] = value;
            apex = at;
            apex_at = gate + 1;
            left_at = right_at = apex_at;
            l = apex_at < n ? left[apex_at] : end;
            r = apex_at < n ? right[apex_at] : end;
            k = gate; // the loop goes on behind it
            ++corners;
        };
        if (turn(apex, r, nr) >= 0) {
            if (k == right_at || turn(apex, l, nr) <= 0) {
                r = nr;
                right_at = k;
            } else {
                corner(l, left_at, 0);
                continue;
            }
        }
        if (turn(apex, l, nl) <= 0) {
            if (k == left_at || turn(apex, r, nl) >= 0) {
                l = nl;
                left_at = k;
            } else {
                corner(r, right_at, 1);
                continue;
            }
        }
    }
    leg(apex_at, n, apex, end);
    return fraction;
}

// Shortens a closed curve that crosses the gates; third: the corner behind each.
Line shortest(const Foliation& f, std::vector<Gate> gates, std::vector<uint32_t> third) {
    const size_t n = gates.size();
    std::vector<double> fraction(n, 0.5);
    constexpr int ROUNDS = 4;
    for (int round = 0; round < ROUNDS; ++round) {
        // Opened at another gate each time; its point stays, so that the curve only gets shorter.
        const size_t first = n * size_t(round) / ROUNDS;
        std::vector<Planar> left(n + 1), right(n + 1);
        const double width = distance(place(f, gates[first].left), place(f, gates[first].right));
        right[0] = {0, -width};
        for (size_t k = 0; k < n; ++k) {
            const Gate here = gates[(first + k) % n], next = gates[(first + k + 1) % n];
            const Planar tip = unfolded(f, here, left[k], right[k], third[(first + k) % n]);
            left[k + 1] = next.left == here.left ? left[k] : tip;
            right[k + 1] = next.right == here.right ? right[k] : tip;
        }
        const Planar start = between(left[0], right[0], fraction[first]),
                     end = between(left[n], right[n], fraction[first]);
        if (n < 3) break;
        const std::vector<double> inner =
            funnel({left.begin() + 1, left.end() - 1}, {right.begin() + 1, right.end() - 1}, start, end);
        for (size_t k = 1; k < n; ++k) fraction[(first + k) % n] = inner[k - 1];
    }
    Line line;
    for (size_t k = 0; k < n; ++k)
        line.push_back(between(place(f, gates[k].left), place(f, gates[k].right), fraction[k]));
    return line;
}

} // namespace

std::vector<Line> loop_lines(const Foliation& f, const hmf_loop_set& loops) {
    std::vector<Line> lines;
    for (size_t c = 0; c < loops.count; ++c) {
        const size_t first = loops.offsets[c], count = loops.offsets[c + 1] - first;
        const bool is_arc = loops.arcs && loops.arcs[c];
        const auto element = [&](size_t i) { return loops.elements[first + i % count]; };
        Line line;
        if (loops.element_kind == HMF_LOOP_VERTICES) {
            for (size_t i = 0; i < count; ++i) line.push_back(place(f, element(i)));
            if (is_arc) // there and back
                for (size_t i = count - 1; i-- > 1;) line.push_back(place(f, element(i)));
            lines.push_back(line);
            continue;
        }
        if (is_arc) { // through the middles of its triangles, there and back
            for (size_t i = 0; i < 2 * count - 1; ++i) {
                const uint32_t* const corner = &f.triangles[3 * size_t(element(i < count ? i : 2 * count - 2 - i))];
                const Point side = between(place(f, corner[0]), place(f, corner[1]), 0.5);
                line.push_back(between(side, place(f, corner[2]), 1.0 / 3));
            }
            lines.push_back(line);
            continue;
        }
        std::vector<Gate> gates;
        std::vector<uint32_t> third;
        for (size_t i = 0; i < count; ++i) {
            const size_t here = element(i), next = element(i + 1);
            // The side of `next` that it has in common with `here`: seen along the way it runs from left to right.
            for (size_t s = 0; s < 9; ++s) {
                if (f.triangle_edges[3 * here + s / 3] != f.triangle_edges[3 * next + s % 3]) continue;
                const size_t side = s % 3;
                gates.push_back({f.triangles[3 * next + side], f.triangles[3 * next + (side + 1) % 3]});
                third.push_back(f.triangles[3 * next + (side + 2) % 3]);
                break;
            }
        }
        if (gates.size() == count) line = shortest(f, gates, third);
        lines.push_back(line);
    }
    return lines;
}

} // namespace cli
