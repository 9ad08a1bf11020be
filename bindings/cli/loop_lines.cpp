// The shortest curve in a strip of triangles, laid out in the plane, by the funnel algorithm (Lee and Preparata 1984;
// Chazelle 1982):
//
//        l0____l1______l2        The shortest path from an apex to the next edge runs inside a funnel of two chains;
//       /  \    \     /  \       an edge narrows it, and where a chain is crossed the path has a corner.
//   ---o----\----\---/----o---   A closed curve is cut open at a point of an edge; a few rounds, each opened at
//       \____\____\_/____/       another edge, settle.
//           r0    r1    r2
//
// Where such a curve has a corner at a vertex and less than a half turn lies beyond, the strip is led around the other
// side of the vertex (Sharp and Crane 2020, with strips instead of flips):
//
//          . other side .
//       ------.--v--.------     the curve bends around v, below it lies the strip: it is led above v
//            /   |   .
#include "loop_lines.hpp"

#include <algorithm>
#include <cmath>

namespace cli {

namespace {

using PlanePoint = std::array<double, 3>;

PlanePoint place(const Foliation& f, uint32_t vertex) {
    return {f.positions[3 * size_t(vertex)], f.positions[3 * size_t(vertex) + 1], f.positions[3 * size_t(vertex) + 2]};
}

PlanePoint between(const PlanePoint& a, const PlanePoint& b, double t) {
    return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

double distance_of(const PlanePoint& a, const PlanePoint& b) {
    const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return std::sqrt(x * x + y * y + z * z);
}

struct Planar {
    double x = 0, y = 0;
};
double turn(Planar a, Planar b, Planar c) { return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y); }
Planar between(Planar a, Planar b, double t) { return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; }

// An edge that the strip crosses: its ends on the left and on the right, and the triangle behind.
struct Gate {
    uint32_t left, right, behind;
};
using Strip = std::vector<Gate>; // closed

constexpr uint32_t NO_NEIGHBOR = 0xffffffffu;

// The triangles of a mesh across their edges.
class Neighbors {
public:
    explicit Neighbors(const Foliation& f) : f_(f), of_edge_(f.values.size(), {NO_NEIGHBOR, NO_NEIGHBOR}) {
        for (size_t k = 0; k < f.triangle_edges.size(); ++k) {
            auto& pair = of_edge_[f.triangle_edges[k]];
            (pair[0] == NO_NEIGHBOR ? pair[0] : pair[1]) = uint32_t(k / 3);
        }
    }
    // The side of the triangle from corner a to corner b, whichever comes first; 3: none.
    unsigned side(uint32_t triangle, uint32_t a, uint32_t b) const {
        for (unsigned s = 0; s < 3; ++s) {
            const uint32_t x = corner(triangle, s), y = corner(triangle, s + 1);
            if ((x == a && y == b) || (x == b && y == a)) return s;
        }
        return 3;
    }
    uint32_t corner(uint32_t triangle, unsigned c) const { return f_.triangles[3 * size_t{triangle} + c % 3]; }
    uint32_t third(uint32_t triangle, uint32_t a, uint32_t b) const {
        return corner(triangle, side(triangle, a, b) + 2);
    }
    uint32_t across(uint32_t triangle, uint32_t a, uint32_t b) const {
        const auto& pair = of_edge_[f_.triangle_edges[3 * size_t{triangle} + side(triangle, a, b)]];
        return pair[0] == triangle ? pair[1] : pair[0];
    }

private:
    const Foliation& f_;
    std::vector<std::array<uint32_t, 2>> of_edge_;
};

// The third corner of a triangle with two sides known: on the far side of the edge from `left` to `right`.
Planar unfolded(const Foliation& f, Gate gate, Planar left, Planar right, uint32_t third) {
    const PlanePoint l = place(f, gate.left), r = place(f, gate.right), p = place(f, third);
    const double width = distance_of(l, r), to_left = distance_of(l, p), to_right = distance_of(r, p);
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
    // Each corner of the path starts again after it: at most n corners, and each visits gates up to the next one.
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

// Where the shortest closed curve in a strip crosses the gates.
std::vector<double> shortest(const Foliation& f, const Neighbors& beside, const Strip& gates) {
    const size_t n = gates.size();
    std::vector<double> fraction(n, 0.5);
    constexpr int ROUNDS = 4;
    for (int round = 0; round < ROUNDS; ++round) {
        // Opened at another gate each time; its point stays, so that the curve only gets shorter.
        const size_t first = n * size_t(round) / ROUNDS;
        std::vector<Planar> left(n + 1), right(n + 1);
        const double width = distance_of(place(f, gates[first].left), place(f, gates[first].right));
        right[0] = {0, -width};
        for (size_t k = 0; k < n; ++k) {
            const Gate here = gates[(first + k) % n], next = gates[(first + k + 1) % n];
            const uint32_t third = beside.third(here.behind, here.left, here.right);
            const Planar tip = unfolded(f, here, left[k], right[k], third);
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
    return fraction;
}

Line line_of(const Foliation& f, const Strip& gates, const std::vector<double>& fraction) {
    Line line;
    for (size_t k = 0; k < gates.size(); ++k)
        line.push_back(between(place(f, gates[k].left), place(f, gates[k].right), fraction[k]));
    return line;
}

double length_along(const Line& line) {
    double sum = 0;
    for (size_t i = 0; i < line.size(); ++i) sum += distance_of(line[i], line[(i + 1) % line.size()]);
    return sum;
}

// Two gates at one edge, one after the other, are there and back again.
void drop_spurs(Strip& gates) {
    const auto is_same = [](Gate a, Gate b) { return std::minmax(a.left, a.right) == std::minmax(b.left, b.right); };
    Strip kept;
    for (const Gate g : gates)
        if (!kept.empty() && is_same(kept.back(), g)) kept.pop_back();
        else kept.push_back(g);
    size_t cut = 0; // the last and the first
    while (2 * cut + 1 < kept.size() && is_same(kept[cut], kept[kept.size() - 1 - cut])) ++cut;
    gates.assign(kept.begin() + std::ptrdiff_t(cut), kept.end() - std::ptrdiff_t(cut));
}

double angle(const PlanePoint& a, const PlanePoint& v, const PlanePoint& b) {
    const double x = distance_of(v, a), y = distance_of(v, b), z = distance_of(a, b);
    return x > 0 && y > 0 ? std::acos(std::clamp((x * x + y * y - z * z) / (2 * x * y), -1.0, 1.0)) : 0;
}

// The strip around the other side of the vertex v that the gates from a, so many, have on one side; empty where a
// boundary is in the way, or a half turn or more lies on that side.
Strip other_side(const Foliation& f, const Neighbors& beside, const Strip& gates, const Line& line, size_t a,
                 size_t count, bool is_left) {
    const size_t n = gates.size();
    const Gate before = gates[(a + n - 1) % n], last = gates[(a + count - 1) % n];
    const uint32_t v = is_left ? last.left : last.right, end = beside.third(last.behind, last.left, last.right);
    const PlanePoint middle = place(f, v);
    uint32_t x = is_left ? before.left : before.right, triangle = before.behind;
    double turned =
        angle(line[(a + n - 1) % n], middle, place(f, x)) + angle(place(f, end), middle, line[(a + count) % n]);
    Strip strip;
    for (int k = 0; k < 1000; ++k) {
        const uint32_t next = beside.across(triangle, x, v);
        if (next == NO_NEIGHBOR) return {};
        strip.push_back(is_left ? Gate{x, v, next} : Gate{v, x, next});
        triangle = next;
        if (triangle == last.behind) return x == end && turned < 3.14159265 ? strip : Strip{};
        const uint32_t y = beside.third(triangle, x, v);
        turned += angle(place(f, x), middle, place(f, y));
        x = y;
    }
    return {};
}

// Leads the strip around the other side of vertices where its curve has a corner; false: there is none.
bool pass_corners(const Foliation& f, const Neighbors& beside, Strip& gates, const std::vector<double>& fraction,
                  const Line& line) {
    const size_t n = gates.size();
    std::vector<uint8_t> busy(n, 0), gone(n, 0);
    std::vector<Strip> instead(n);
    bool found = false;
    for (const bool is_left : {true, false})
        for (size_t a = 0; a < n; ++a) {
            const auto end_of = [&](size_t k) { return is_left ? gates[k % n].left : gates[k % n].right; };
            const auto touches = [&](size_t k) { return (is_left ? fraction[k % n] : 1 - fraction[k % n]) < 1e-7; };
            if (end_of(a) == end_of(a + n - 1)) continue; // no begin of a run
            size_t count = 0;
            // One is enough: along the curve itself a gate is crossed nowhere or everywhere.
            bool is_corner = false, is_free = !busy[(a + n - 1) % n];
            for (; count < n && end_of(a + count) == end_of(a); ++count) {
                is_corner = is_corner || touches(a + count);
                is_free = is_free && !busy[(a + count) % n];
            }
            if (!is_corner || !is_free || count + 2 > n || busy[(a + count) % n]) continue;
            Strip strip = other_side(f, beside, gates, line, a, count, is_left);
            if (strip.empty()) continue;
            found = true;
            for (size_t k = 0; k < count + 2; ++k) busy[(a + n - 1 + k) % n] = 1;
            for (size_t k = 0; k < count; ++k) gone[(a + k) % n] = 1;
            instead[a] = std::move(strip);
        }
    Strip made;
    for (size_t k = 0; k < n; ++k) {
        made.insert(made.end(), instead[k].begin(), instead[k].end());
        if (!gone[k]) made.push_back(gates[k]);
    }
    gates = std::move(made);
    drop_spurs(gates);
    return found;
}

// The shortest closed curve that is met in so many rounds.
Line straightened(const Foliation& f, const Neighbors& beside, Strip gates, int rounds) {
    drop_spurs(gates);
    Line best;
    for (int round = 0; gates.size() >= 3; ++round) {
        const std::vector<double> fraction = shortest(f, beside, gates);
        const Line line = line_of(f, gates, fraction);
        if (!best.empty() && !(length_along(line) < (1 - 1e-9) * length_along(best))) break;
        best = line;
        if (round == rounds || !pass_corners(f, beside, gates, fraction, line)) break;
    }
    return best;
}

// The strip on the left of a closed path of vertices; empty where there is no triangle.
Strip left_strip(const Foliation& f, const Neighbors& beside, const std::vector<uint32_t>& path) {
    const size_t n = path.size();
    std::vector<uint32_t> place_of(f.positions.size() / 3, NO_NEIGHBOR), left(n, NO_NEIGHBOR);
    for (size_t i = 0; i < n; ++i) place_of[path[i]] = uint32_t(i);
    for (uint32_t t = 0; t < f.triangle_count(); ++t)
        for (unsigned c = 0; c < 3; ++c)
            if (const uint32_t i = place_of[beside.corner(t, c)];
                i != NO_NEIGHBOR && path[(i + 1) % n] == beside.corner(t, c + 1))
                left[i] = t;
    Strip strip;
    for (size_t i = 0; i < n; ++i) {
        const uint32_t v = path[(i + 1) % n], goal = path[(i + 2) % n];
        uint32_t triangle = left[i];
        if (triangle == NO_NEIGHBOR) return {};
        uint32_t x = beside.third(triangle, path[i], v);
        for (int k = 0; x != goal; ++k) {
            triangle = beside.across(triangle, x, v);
            if (triangle == NO_NEIGHBOR || k == 1000) return {};
            strip.push_back({x, v, triangle});
            x = beside.third(triangle, x, v);
        }
    }
    return strip;
}

// The strip of triangles that follow each other; empty where they do not.
Strip triangle_strip(const Foliation& f, const std::vector<uint32_t>& triangles) {
    Strip gates;
    for (size_t i = 0; i < triangles.size(); ++i) {
        const size_t here = triangles[i], next = triangles[(i + 1) % triangles.size()];
        // The side of `next` that it has in common with `here`: seen along the way it runs from left to right.
        for (size_t s = 0; s < 9; ++s) {
            if (f.triangle_edges[3 * here + s / 3] != f.triangle_edges[3 * next + s % 3]) continue;
            const size_t side = s % 3;
            gates.push_back({f.triangles[3 * next + side], f.triangles[3 * next + (side + 1) % 3], uint32_t(next)});
            break;
        }
    }
    return gates.size() == triangles.size() ? gates : Strip{};
}

} // namespace

std::vector<Line> loop_lines(const Foliation& f, const hmf_loop_set& loops) {
    // A caller's loop is drawn where it lies, only without kinks.
    constexpr int OF_CALLER = 8, OF_LIBRARY = 200;
    const Neighbors beside(f);
    std::vector<Line> lines;
    for (size_t c = 0; c < loops.count; ++c) {
        const std::vector<uint32_t> elements(loops.elements + loops.offsets[c], loops.elements + loops.offsets[c + 1]);
        const bool is_arc = loops.arcs && loops.arcs[c], is_path = loops.element_kind == HMF_PATH_VERTICES;
        const size_t count = elements.size();
        Line line, straight;
        for (const uint32_t e : elements) {
            if (is_path) line.push_back(place(f, e));
            else { // through the middles of its triangles
                const uint32_t* const corner = &f.triangles[3 * size_t{e}];
                line.push_back(
                    between(between(place(f, corner[0]), place(f, corner[1]), 0.5), place(f, corner[2]), 1.0 / 3));
            }
        }
        if (is_arc) // there and back
            for (size_t i = count - 1; i-- > 1;) line.push_back(line[i]);
        else if (is_path) straight = straightened(f, beside, left_strip(f, beside, elements), OF_CALLER);
        else straight = straightened(f, beside, triangle_strip(f, elements), OF_LIBRARY);
        lines.push_back(straight.empty() ? line : straight);
    }
    return lines;
}

} // namespace cli
