// Polygons in space as triangles.
//
//     project     onto the coordinate plane that the polygon faces most; coordinates are not rounded
//     cut ears    from a polygon whose diagonals lie inside, the ear with the shortest diagonal first:
//
//            b               the triangle a b c is an ear if b is convex and no other corner lies in it or on it.
//           / \              Corners that are not convex are in a tree of boxes; it answers in O(sqrt n) time
//       ---a---c---          whether one of them does.  A simple polygon has two ears with area until one is left.
//
//     flip        diagonals until the triangles are Delaunay, measured in space
//
// Whether a corner is an ear changes only when one beside it is cut.  What crosses itself, or is no polygon in the
// plane, loses the best corner where there is no ear.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <queue>
#include <unordered_map>

#include "polygon.hpp"

namespace readers {

namespace {

constexpr uint32_t most_in_fan = 8; // corners; beyond, the first one has many thin triangles
constexpr double thinnest = 0.01;   // triangle in a fan: height over longest side

struct Point {
    double x, y;
};

// Twice the area of a b c, 0 where rounding hides its sign.
double turn(const Point& a, const Point& b, const Point& c) {
    const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x), area = left - right;
    return std::fabs(area) <= 4e-16 * (std::fabs(left) + std::fabs(right)) ? 0 : area;
}

bool is_same(const Point& a, const Point& b) { return a.x == b.x && a.y == b.y; }

bool is_in(const Point& p, const Point& a, const Point& b, const Point& c) {
    return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

// Points in a balanced tree of boxes.  They can be taken out.
class PointTree {
public:
    PointTree(const std::vector<Point>& points, std::vector<uint32_t> members) :
        points_(points), order_(std::move(members)), leaf_of_(points.size(), NONE) {
        if (!order_.empty()) build(0, static_cast<uint32_t>(order_.size()), NONE);
    }
    void remove(uint32_t point) {
        for (uint32_t node = leaf_of_[point]; node != NONE; node = nodes_[node].parent) --nodes_[node].count;
        leaf_of_[point] = NONE;
    }
    bool has(uint32_t point) const { return leaf_of_[point] != NONE; }

    // Whether one lies in the triangle or on it, but not at a corner.
    bool any_in(const Point& a, const Point& b, const Point& c) const {
        if (nodes_.empty()) return false;
        std::array<uint32_t, 96> stack;
        size_t size = 0;
        stack[size++] = 0;
        while (size > 0) {
            const Node& node = nodes_[stack[--size]];
            if (node.count == 0 || is_apart(node, a, b, c)) continue;
            if (node.left != NONE) {
                stack[size++] = node.left;
                stack[size++] = node.right;
                continue;
            }
            for (uint32_t i = node.begin; i < node.end; ++i) {
                const Point& p = points_[order_[i]];
                if (has(order_[i]) && is_in(p, a, b, c) && !is_same(p, a) && !is_same(p, b) && !is_same(p, c))
                    return true;
            }
        }
        return false;
    }

private:
    struct Node {
        Point low, high;
        uint32_t begin, end, count, parent, left, right; // in order_; children NONE of a leaf
    };
    static constexpr uint32_t leaf_size = 8;

    uint32_t build(uint32_t begin, uint32_t end, uint32_t parent) {
        const uint32_t number = static_cast<uint32_t>(nodes_.size());
        Node node{points_[order_[begin]], points_[order_[begin]], begin, end, end - begin, parent, NONE, NONE};
        for (uint32_t i = begin; i < end; ++i) {
            const Point& p = points_[order_[i]];
            node.low = {std::min(node.low.x, p.x), std::min(node.low.y, p.y)};
            node.high = {std::max(node.high.x, p.x), std::max(node.high.y, p.y)};
        }
        nodes_.push_back(node);
        if (end - begin <= leaf_size) {
            for (uint32_t i = begin; i < end; ++i) leaf_of_[order_[i]] = number;
            return number;
        }
        const bool along_x = node.high.x - node.low.x > node.high.y - node.low.y;
        const uint32_t middle = begin + (end - begin) / 2;
        std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                         [&](uint32_t i, uint32_t j) {
                             const double p = along_x ? points_[i].x : points_[i].y;
                             const double q = along_x ? points_[j].x : points_[j].y;
                             return p < q || (p == q && i < j);
                         });
        const uint32_t left = build(begin, middle, number), right = build(middle, end, number);
        nodes_[number].left = left;
        nodes_[number].right = right;
        return number;
    }

    // The box lies outside a side of the triangle, or outside its box.
    static bool is_apart(const Node& n, const Point& a, const Point& b, const Point& c) {
        if (std::min({a.x, b.x, c.x}) > n.high.x || std::max({a.x, b.x, c.x}) < n.low.x) return true;
        if (std::min({a.y, b.y, c.y}) > n.high.y || std::max({a.y, b.y, c.y}) < n.low.y) return true;
        const auto outside = [&](const Point& p, const Point& q) {
            // The corner of the box that lies furthest to the left of p q.
            return turn(p, q, {q.y > p.y ? n.low.x : n.high.x, q.x > p.x ? n.high.y : n.low.y}) < 0;
        };
        return outside(a, b) || outside(b, c) || outside(c, a);
    }

    const std::vector<Point>& points_;
    std::vector<uint32_t> order_, leaf_of_;
    std::vector<Node> nodes_;
};

using Corners = std::array<uint32_t, 3>;

class Triangulation {
public:
    // Corners of one polygon, as vertices of the mesh.
    Triangulation(const std::vector<double>& positions, std::vector<uint32_t> vertices) :
        vertex_(std::move(vertices)), count_(static_cast<uint32_t>(vertex_.size())) {
        scale(positions);
        project();
    }

    // A fan that has to stay: all corners lie on a line.
    bool is_line() const {
        for (uint32_t i = 0; i < count_; ++i)
            if (turn(point_[before(i)], point_[i], point_[after(i)]) != 0) return false;
        return true;
    }

    bool is_good_fan() const {
        if (count_ > most_in_fan) return false;
        for (uint32_t i = 0; i < count_; ++i)
            if (turn(point_[before(i)], point_[i], point_[after(i)]) <= 0) return false;
        for (uint32_t i = 2; i < count_; ++i) {
            // A star goes around its first corner more than once.
            if (turn(point_[0], point_[1], point_[i]) <= 0) return false;
            const double longest =
                std::max({square_distance(0, i - 1), square_distance(i - 1, i), square_distance(0, i)});
            if (turn(point_[0], point_[i - 1], point_[i]) < thinnest * longest) return false;
        }
        return true;
    }

    // Their corners are vertices of the mesh.
    std::vector<Corners> go() {
        cut_ears();
        flip();
        for (Corners& t : triangles_)
            for (uint32_t& c : t) c = vertex_[c];
        return std::move(triangles_);
    }

private:
    struct Candidate {
        bool is_convex; // and perhaps an ear
        double length;  // of the diagonal, squared; of what is no ear its shape
        uint32_t corner, version;
        // The last one of the queue comes first.
        bool operator<(const Candidate& other) const {
            if (is_convex != other.is_convex) return !is_convex;
            return length != other.length ? length > other.length : corner > other.corner;
        }
    };

    uint32_t before(uint32_t i) const { return i == 0 ? count_ - 1 : i - 1; }
    uint32_t after(uint32_t i) const { return i + 1 == count_ ? 0 : i + 1; }
    const double* place(uint32_t corner) const { return &place_[size_t{3} * corner]; }

    double square_distance(uint32_t i, uint32_t j) const {
        double sum = 0;
        for (int k = 0; k < 3; ++k) sum += (place(i)[k] - place(j)[k]) * (place(i)[k] - place(j)[k]);
        return sum;
    }

    // By a power of two, so that no product of coordinates overflows.
    void scale(const std::vector<double>& positions) {
        place_.reserve(size_t{3} * count_);
        double largest = 0;
        for (const uint32_t v : vertex_)
            for (size_t k = 0; k < 3; ++k) {
                place_.push_back(positions[size_t{3} * v + k]);
                largest = std::max(largest, std::fabs(place_.back()));
            }
        int exponent = 0;
        std::frexp(largest, &exponent);
        if (std::abs(exponent) < 100) return;
        for (double& x : place_) x = std::ldexp(x, -exponent);
    }

    // Newell's normal, relative to the first corner; the polygon turns to the left afterwards.
    void project() {
        double normal[3] = {0, 0, 0};
        const double* const first = place(0);
        for (uint32_t i = 1; i + 1 < count_; ++i) {
            double p[3], q[3];
            for (int k = 0; k < 3; ++k) {
                p[k] = place(i)[k] - first[k];
                q[k] = place(i + 1)[k] - first[k];
            }
            for (int k = 0; k < 3; ++k) normal[k] += p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
        }
        int axis = 0;
        for (int k = 1; k < 3; ++k)
            if (std::fabs(normal[k]) > std::fabs(normal[axis])) axis = k;
        const int x = (axis + 1) % 3, y = (axis + 2) % 3;
        point_.resize(count_);
        for (uint32_t i = 0; i < count_; ++i)
            point_[i] = normal[axis] < 0 ? Point{place(i)[y], place(i)[x]} : Point{place(i)[x], place(i)[y]};
    }

    double turn_at(uint32_t i) const { return turn(point_[previous_[i]], point_[i], point_[next_[i]]); }

    void offer(uint32_t i) {
        const Point &a = point_[previous_[i]], &b = point_[i], &c = point_[next_[i]];
        const double area = turn(a, b, c), diagonal = square_distance(previous_[i], next_[i]);
        queue_.push({area > 0, area > 0 ? diagonal : -area, i, ++version_[i]});
    }

    // Whether corners lie in the triangle is asked of the shortest diagonal only: an answer for a long one may take
    // a walk along all corners beside it.  Where there is no ear: what turns most to the left.
    bool may_cut(const Candidate& best) {
        const uint32_t i = best.corner;
        const Point &a = point_[previous_[i]], &b = point_[i], &c = point_[next_[i]];
        if (!best.is_convex || !tree_->any_in(a, b, c)) return true;
        queue_.push({false, -turn(a, b, c), i, best.version});
        return false;
    }

    void cut_ears() {
        previous_.resize(count_);
        next_.resize(count_);
        version_.assign(count_, 0);
        for (uint32_t i = 0; i < count_; ++i) {
            previous_[i] = before(i);
            next_[i] = after(i);
        }
        std::vector<uint32_t> reflex;
        for (uint32_t i = 0; i < count_; ++i)
            if (turn_at(i) <= 0) reflex.push_back(i);
        PointTree tree(point_, std::move(reflex));
        tree_ = &tree;
        for (uint32_t i = 0; i < count_; ++i) offer(i);
        triangles_.reserve(count_ - 2);
        while (triangles_.size() + 2 < count_) {
            const Candidate best = queue_.top();
            queue_.pop();
            const uint32_t i = best.corner;
            if (best.version != version_[i] || !may_cut(best)) continue;
            const uint32_t a = previous_[i], c = next_[i];
            triangles_.push_back({a, i, c});
            version_[i] = NONE;
            if (tree.has(i)) tree.remove(i);
            next_[a] = c;
            previous_[c] = a;
            for (const uint32_t j : {a, c})
                if (tree.has(j) && turn_at(j) > 0) tree.remove(j);
            for (const uint32_t j : {a, c}) offer(j);
        }
    }

    // A side of a triangle is 3 * triangle + corner; it leads to the next corner.
    uint32_t from(uint32_t side) const { return triangles_[side / 3][side % 3]; }
    static uint32_t beyond(uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
    uint32_t apex(uint32_t side) const { return from(beyond(beyond(side))); }

    // Of the angle at the corner opposite to the side, times twice the area.
    struct Angle {
        double cosine, sine;
    };
    Angle angle_at_apex(uint32_t side) const {
        const double *p = place(apex(side)), *q = place(from(side)), *r = place(from(beyond(side)));
        double u[3], v[3], dot = 0, square = 0;
        for (int k = 0; k < 3; ++k) {
            u[k] = q[k] - p[k];
            v[k] = r[k] - p[k];
            dot += u[k] * v[k];
        }
        for (int k = 0; k < 3; ++k) {
            const double x = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
            square += x * x;
        }
        return {dot, std::sqrt(square)};
    }

    // The angles opposite to the diagonal have more than pi together, and the other diagonal lies inside.
    bool wants_flip(uint32_t side, uint32_t other) const {
        const Angle p = angle_at_apex(side), q = angle_at_apex(other);
        const double sine = p.sine * q.cosine + p.cosine * q.sine;
        const double size = std::fabs(p.sine * q.cosine) + std::fabs(p.cosine * q.sine);
        if (!(sine < -1e-12 * size)) return false;
        const Point &a = point_[from(side)], &b = point_[from(other)], &c = point_[apex(side)],
                    &d = point_[apex(other)];
        return turn(c, d, b) > 0 && turn(d, c, a) > 0;
    }

    void link(uint32_t side, uint32_t other) {
        twin_[side] = other;
        if (other != NONE) twin_[other] = side;
    }

    void pair_sides() {
        twin_.assign(3 * triangles_.size(), NONE);
        std::unordered_map<uint64_t, uint32_t> open;
        open.reserve(twin_.size());
        for (uint32_t side = 0; side < twin_.size(); ++side) {
            const uint64_t a = from(side), b = from(beyond(side));
            if (b == (a + 1 == count_ ? 0 : a + 1)) continue; // of the polygon
            const auto found = open.find(b << 32 | a);
            if (found == open.end()) open[a << 32 | b] = side;
            else link(side, found->second);
        }
    }

    void flip() {
        pair_sides();
        std::vector<uint32_t> waiting;
        for (uint32_t side = 0; side < twin_.size(); ++side)
            if (twin_[side] != NONE && side < twin_[side]) waiting.push_back(side);
        // Delaunay flips end; rounding must not make them go round.
        for (size_t left = 64 * triangles_.size(); left > 0 && !waiting.empty(); --left) {
            const uint32_t side = waiting.back(), other = twin_[side];
            waiting.pop_back();
            if (other == NONE || !wants_flip(side, other)) continue;
            //      c                c
            //     / \              /|\          side a -> b of triangle t, other b -> a of u:
            //    a---b     ->     a | b         t becomes c a d, u becomes d b c
            //     \ /              \|/
            //      d                d
            const uint32_t t = side / 3, u = other / 3;
            const uint32_t a = from(side), b = from(other), c = apex(side), d = apex(other);
            const uint32_t bc = twin_[beyond(side)], ca = twin_[beyond(beyond(side))], ad = twin_[beyond(other)],
                           db = twin_[beyond(beyond(other))];
            triangles_[t] = {c, a, d};
            triangles_[u] = {d, b, c};
            link(3 * t, ca);
            link(3 * t + 1, ad);
            link(3 * u, db);
            link(3 * u + 1, bc);
            link(3 * t + 2, 3 * u + 2);
            waiting.insert(waiting.end(), {3 * t, 3 * t + 1, 3 * u, 3 * u + 1});
        }
    }

    const std::vector<uint32_t> vertex_;
    const uint32_t count_;
    std::vector<double> place_; // 3 for each corner
    std::vector<Point> point_;
    std::vector<uint32_t> previous_, next_, version_; // NONE: cut
    std::priority_queue<Candidate> queue_;
    PointTree* tree_ = nullptr; // of the corners that are not convex
    std::vector<Corners> triangles_;
    std::vector<uint32_t> twin_;
};

// Keeps one of equal corners in a row; the others are in a triangle that names a vertex twice.
std::vector<uint32_t> without_repeats(const std::vector<uint32_t>& corners, std::vector<Corners>& repeats) {
    std::vector<uint32_t> kept;
    for (size_t i = 0; i < corners.size(); ++i) {
        const uint32_t next = corners[i + 1 == corners.size() ? 0 : i + 1];
        if (corners[i] != next) kept.push_back(corners[i]);
        else repeats.push_back({corners[i], corners[i], corners[i]});
    }
    return kept;
}

} // namespace

void triangulate_polygons(TriangleMesh& mesh) {
    const Origin& origin = mesh.origin;
    if (!origin.has_polygons()) return;
    std::vector<uint32_t> corners;
    for (size_t face = 0; face < origin.face_count(); ++face) {
        const size_t first = origin.start_of(face), count = origin.start_of(face + 1) - first;
        if (count < 2) continue;
        uint32_t* const triangle = &mesh.triangles[3 * first];
        corners.assign(triangle, triangle + 2);
        for (size_t t = 0; t < count; ++t) corners.push_back(triangle[3 * t + 2]);
        std::vector<Corners> triangles;
        corners = without_repeats(corners, triangles);
        if (corners.size() < 3) continue;
        Triangulation polygon(mesh.positions, corners);
        if (triangles.empty() && (polygon.is_good_fan() || polygon.is_line())) continue;
        const std::vector<Corners> good = polygon.go();
        triangles.insert(triangles.end(), good.begin(), good.end());
        for (size_t t = 0; t < count; ++t) std::copy_n(triangles[t].begin(), 3, triangle + 3 * t);
    }
}

} // namespace readers
