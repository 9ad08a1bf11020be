#include "flat_polygons.hpp"

#include "polygon_delaunay.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// A polygon may turn to the right at a corner by this sine, and by this sum in all: below 180 degrees together, so
// that its boundary cannot meet itself and its triangulations are those of one surface.
constexpr double MOST_CONCAVE = 0.125, MOST_CONCAVE_IN_ALL = 2.5;
constexpr double STRAIGHT_SINE = 1e-9; // a smaller sine is rounding
// Corners of a polygon are known up to this part of the least height of its triangles.  A side that is short beside the
// triangle beyond it passes its error on many times as large, so that chains of needles end there.
constexpr double MOST_ERROR = 1e-13;
constexpr double ROUNDING = 0x1p-50, FINE_ROUNDING = 0x1p-100; // of a few operations

struct FlatCorner {
    PlanePoint point;
    uint32_t vertex;
    uint32_t side;     // half-edge inside that goes to the next corner
    uint32_t next;     // corner
    uint32_t previous; // corner
    uint32_t edges;    // inside, that end here
    double concave;    // sine of the turn to the right, or 0
    double error;      // bound of that of the point
};

// Of a diagonal of the polygon in order: the spoke to `corner` is flipped and joins `from` and `to`.
struct SpokeFlip {
    uint32_t corner, from, to;
};

class FlatPolygons {
public:
    FlatPolygons(Mesh& mesh, Metric& metric, double* sum, FlipLog& flips, Call& call) :
        mesh_(mesh), metric_(metric), sum_(sum), flips_(flips), call_(call) {}

    Done run(double fraction) {
        Memory& memory = call_.memory;
        if (!is_taken_.allocate_filled(memory, mesh_.face_count, 0)
            || !is_inside_.allocate_filled(memory, mesh_.edge_count, 0)
            || !is_corner_.allocate_filled(memory, mesh_.vertex_count, 0))
            return false;
        corners_.start(memory);
        edges_.start(memory);
        queue_.start(memory);
        ring_.start(memory);
        points_.start(memory);
        spoke_flips_.start(memory);
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) {
            if (e % 65536 == 0 && !call_.tick(fraction)) return false;
            if (!needs_flip(mesh_, sum_, e)) continue;
            if (is_taken_[mesh_.face[2 * e]] || is_taken_[mesh_.face[2 * e + 1]]) continue;
            if (!grow(e)) return false;
            if (edges_.size() > 1 && !triangulate()) return false;
            clear();
        }
        return true;
    }

private:
    // Breadth first from the two triangles of an edge.
    Done grow(uint32_t edge) {
        const uint32_t h = 2 * edge, jk = mesh_.next[h], ki = mesh_.next[jk];
        const TwoDoubles ij = metric_.square_of(edge), ik2 = metric_.square_of(edge_of(ki)),
                         jk2 = metric_.square_of(edge_of(jk)), length = square_root(ij);
        const PlanePoint j = {length, {}},
                         k = {0.5 * ((ij + ik2 - jk2) / length), 0.5 * (metric_.area_of(mesh_.face[h]) / length)};
        if (mesh_.origin[h] == mesh_.origin[jk] || mesh_.origin[jk] == mesh_.origin[ki]
            || mesh_.origin[ki] == mesh_.origin[h])
            return true;
        const double error = rounding() * std::max({ij.high, ik2.high, jk2.high}) / length.high;
        if (!is_exact_enough(mesh_.face[h], longest_side(h), error)) return true;
        if (!add_corner({}, 0, mesh_.origin[h], h) || !add_corner(j, error, mesh_.origin[jk], jk)
            || !add_corner(k, error, mesh_.origin[ki], ki))
            return false;
        for (uint32_t c = 0; c < 3; ++c) {
            corners_[c].next = c == 2 ? 0 : c + 1;
            corners_[c].previous = c == 0 ? 2 : c - 1;
            if (!queue_.push(c)) return false;
        }
        is_taken_[mesh_.face[h]] = 1;
        for (size_t i = 0; i < queue_.size(); ++i) {
            if (++steps_ % 4096 == 0 && !call_.tick(0)) return false;
            if (!add_triangle(queue_[i])) return false;
        }
        return true;
    }

    Done add_corner(const PlanePoint& point, double error, uint32_t vertex, uint32_t side) {
        is_corner_[vertex] = 1;
        return corners_.push({point, vertex, side, 0, 0, 0, 0, error});
    }

    // The corner beyond the side that begins at `corner`, in the triangle there; false: the triangle cannot be added.
    bool find_apex(uint32_t corner, PlanePoint& apex, double& error) const {
        const FlatCorner &p = corners_[corner], &q = corners_[p.next];
        const uint32_t t = twin(p.side), face = mesh_.face[t];
        if (is_taken_[face] || is_corner_[mesh_.origin[mesh_.prev(t)]]) return false;
        // From q to p the triangle lies on the left.
        const TwoDoubles pq = metric_.square_of(edge_of(t)), pr = metric_.square_of(edge_of(mesh_.next[t])),
                         qr = metric_.square_of(edge_of(mesh_.prev(t)));
        const PlanePoint d = p.point - q.point;
        const TwoDoubles along = 0.5 * ((pq + qr - pr) / pq), up = 0.5 * (metric_.area_of(face) / pq);
        apex = {q.point.x + along * d.x - up * d.y, q.point.y + along * d.y + up * d.x};
        const double side = std::sqrt(pq.high), longest = std::max({pq.high, pr.high, qr.high});
        error = q.error + (p.error + q.error) * (std::sqrt(qr.high) / side) + rounding() * (longest / side);
        return true;
    }

    // With the corner that the triangle adds, are the triangles large beside the errors?
    bool is_exact_enough(uint32_t face, double longest, double error) {
        const double height = std::min(least_height_, 0.5 * metric_.area_of(face).high / longest);
        const double largest = std::max(largest_error_, error);
        if (!(largest <= MOST_ERROR * height)) return false;
        least_height_ = height;
        largest_error_ = largest;
        return true;
    }

    // The triangle beyond the side that begins at `corner`, if the polygon stays nearly convex.
    Done add_triangle(uint32_t corner) {
        PlanePoint apex;
        double error = 0;
        if (!find_apex(corner, apex, error)) return true;
        const uint32_t p = corner, q = corners_[p].next, t = twin(corners_[p].side);
        bool sharp = false;
        const PlanePoint to_p = corners_[p].point - corners_[corners_[p].previous].point,
                         pq = corners_[q].point - corners_[p].point,
                         from_q = corners_[corners_[q].next].point - corners_[q].point;
        const double at_p = concave(to_p, pq, to_p, apex - corners_[p].point, sharp);
        const double at_q = concave(pq, from_q, corners_[q].point - apex, from_q, sharp);
        const double all = concave_in_all_ - corners_[p].concave - corners_[q].concave + at_p + at_q;
        if (sharp || all > MOST_CONCAVE_IN_ALL) return true;
        if (!is_exact_enough(mesh_.face[t], longest_side(t), error)) return true;
        const uint32_t r = static_cast<uint32_t>(corners_.size()), edge = edge_of(t);
        if (!add_corner(apex, error, mesh_.origin[mesh_.prev(t)], mesh_.prev(t)) || !edges_.push(edge)
            || !queue_.push(p) || !queue_.push(r))
            return false;
        concave_in_all_ = all;
        corners_[p].concave = at_p;
        corners_[q].concave = at_q;
        corners_[p].side = mesh_.next[t];
        corners_[p].next = r;
        corners_[r].previous = p;
        corners_[r].next = q;
        corners_[q].previous = r;
        ++corners_[p].edges;
        ++corners_[q].edges;
        is_inside_[edge] = 1;
        is_taken_[mesh_.face[t]] = 1;
        return true;
    }

    // Sine of the turn to the right from u to v at a corner whose interior angle was that from `u_before` to `v_before`
    // and has grown by less than 180 degrees.
    static double concave(const PlanePoint& u_before, const PlanePoint& v_before, const PlanePoint& u,
                          const PlanePoint& v, bool& sharp) {
        const double right_before = -cross(u_before, v_before).high, right = -cross(u, v).high;
        const double size = std::sqrt(dot(u, u).high) * std::sqrt(dot(v, v).high);
        sharp |= right > MOST_CONCAVE * size;
        sharp |= right >= 0 && dot(u, v).high < 0; // beyond 270 degrees
        sharp |= right <= 0 && right_before >= 0;  // beyond 360 degrees: it was 180 or more
        return right > STRAIGHT_SINE * size ? right / size : 0;
    }

    Done triangulate() {
        const uint32_t count = static_cast<uint32_t>(corners_.size());
        if (!order_corners() || !delaunay_.triangulate(call_.memory, points_.data(), count)) return false;
        if (!delaunay_.is_valid()) return true;
        uint32_t hub = 0;
        for (uint32_t n = 1; n < count; ++n)
            if (corners_[ring_[n]].edges > corners_[ring_[hub]].edges) hub = n;
        if (!to_fan(hub) || !list_spoke_flips(hub) || !from_fan(hub)) return false;
        for (const uint32_t edge : edges_) sum_[edge] = cotangent_sum(mesh_, metric_, edge);
        for (const FlatCorner& c : corners_) sum_[edge_of(c.side)] = cotangent_sum(mesh_, metric_, edge_of(c.side));
        return true;
    }

    Done order_corners() {
        const uint32_t count = static_cast<uint32_t>(corners_.size());
        if (!spoke_.allocate(call_.memory, count)) return false;
        for (uint32_t n = 0, c = 0; n < count; ++n, c = corners_[c].next)
            if (!ring_.push(c) || !points_.push(corners_[c].point)) return false;
        return true;
    }

    void flip_edge(uint32_t edge) {
        flip(mesh_, edge);
        flips_.add(edge);
    }

    // Flips until every edge inside ends at the hub, corner 0 of the ring when it begins there.
    Done to_fan(uint32_t hub) {
        const uint32_t count = static_cast<uint32_t>(ring_.size());
        uint32_t h = corners_[ring_[hub]].side, at = hub;
        for (;;) {
            if (++steps_ % 4096 == 0 && !call_.tick(0)) return false;
            at = at + 1 == count ? 0 : at + 1;
            while (is_inside_[edge_of(mesh_.next[h])]) flip_edge(edge_of(mesh_.next[h]));
            const uint32_t after = at + 1 == count ? 0 : at + 1, back = mesh_.prev(h);
            set_face(mesh_.face[h], hub, at, after);
            if (!is_inside_[edge_of(back)]) return true;
            spoke_[after] = edge_of(back);
            set_edge(edge_of(back), hub, after);
            h = twin(back);
        }
    }

    // The flips from the Delaunay triangulation to the fan; their reverse leads from the fan to it.
    Done list_spoke_flips(uint32_t hub) {
        spoke_flips_.clear();
        queue_.clear();
        uint32_t side = delaunay_.side_from(hub);
        for (;;) {
            const uint32_t opposite = PolygonDelaunay::after(side), last = PolygonDelaunay::after(opposite);
            if (!queue_.push(delaunay_.across(opposite))) return false;
            if (delaunay_.across(last) == PolygonDelaunay::OUTSIDE) break;
            side = delaunay_.across(last);
        }
        while (!queue_.empty()) {
            if (++steps_ % 4096 == 0 && !call_.tick(0)) return false;
            const uint32_t far = queue_.back();
            queue_.pop();
            if (far == PolygonDelaunay::OUTSIDE) continue;
            const uint32_t first = PolygonDelaunay::after(far), second = PolygonDelaunay::after(first);
            if (!spoke_flips_.push({delaunay_.apex(far), delaunay_.begin(first), delaunay_.begin(far)})
                || !queue_.push(delaunay_.across(first)) || !queue_.push(delaunay_.across(second)))
                return false;
        }
        return true;
    }

    Done from_fan(uint32_t hub) {
        const uint32_t vertex = corners_[ring_[hub]].vertex;
        for (size_t n = spoke_flips_.size(); n-- > 0;) {
            if (++steps_ % 4096 == 0 && !call_.tick(0)) return false;
            const SpokeFlip& at = spoke_flips_[n];
            const uint32_t edge = spoke_[at.corner], h = 2 * edge;
            flip_edge(edge);
            const bool left = mesh_.origin[mesh_.prev(h)] == vertex;
            set_edge(edge, at.from, at.to);
            set_face(mesh_.face[left ? h : twin(h)], hub, at.from, at.to);
            set_face(mesh_.face[left ? twin(h) : h], at.from, at.corner, at.to);
        }
        return true;
    }

    void clear() {
        for (const FlatCorner& c : corners_) is_corner_[c.vertex] = 0;
        for (const uint32_t edge : edges_) is_inside_[edge] = 0;
        corners_.clear();
        edges_.clear();
        queue_.clear();
        ring_.clear();
        points_.clear();
        concave_in_all_ = largest_error_ = 0;
        least_height_ = HUGE_VAL;
    }

    double longest_side(uint32_t h) const {
        return std::sqrt(std::max({metric_.square_of(edge_of(h)).high, metric_.square_of(edge_of(mesh_.next[h])).high,
                                   metric_.square_of(edge_of(mesh_.prev(h))).high}));
    }
    double rounding() const { return metric_.is_fine() ? FINE_ROUNDING : ROUNDING; }

    void set_edge(uint32_t edge, uint32_t a, uint32_t b) {
        const PlanePoint d = points_[b] - points_[a];
        const TwoDoubles square = dot(d, d);
        if (!metric_.square.empty()) metric_.square[edge] = square;
        metric_.length[edge] = std::sqrt(square.value());
    }

    void set_face(uint32_t face, uint32_t a, uint32_t b, uint32_t c) {
        const TwoDoubles area = 2 * cross(points_[b] - points_[a], points_[c] - points_[a]);
        if (!metric_.fine_area.empty()) metric_.fine_area[face] = area;
        metric_.four_areas[face] = area.value();
    }

    Mesh& mesh_;
    Metric& metric_;
    double* sum_;
    FlipLog& flips_;
    Call& call_;
    Array<uint8_t> is_taken_;  // per face: in a polygon
    Array<uint8_t> is_inside_; // per edge: of the polygon at hand
    Array<uint8_t> is_corner_; // per vertex: of the polygon at hand
    Array<FlatCorner> corners_;
    Array<uint32_t> edges_, queue_, ring_, spoke_;
    Array<PlanePoint> points_;
    Array<SpokeFlip> spoke_flips_;
    PolygonDelaunay delaunay_;
    double concave_in_all_ = 0, largest_error_ = 0, least_height_ = HUGE_VAL;
    uint64_t steps_ = 0;
};

// The angles around a vertex, added: half turns, and a direction in the half plane where they end.
struct AngleSum {
    double x = 1, y = 0;
    int32_t half_turns = 0;

    // An angle between 0 and 180 degrees, by multiples of its cosine and sine.
    void add(double cosine, double sine) {
        const double size = std::sqrt(cosine * cosine + sine * sine), c = cosine / size, s = sine / size;
        const double next_y = x * s + y * c;
        x = x * c - y * s;
        half_turns += (y >= 0) != (next_y >= 0);
        y = next_y;
    }
    // Up to rounding, which is far below 90 degrees.
    bool is_near(const AngleSum& other) const {
        const int32_t turned = half_turns - other.half_turns;
        return x * other.x + y * other.y > 0 && turned <= 1 && turned >= -1;
    }
};

Done add_angles(const Mesh& mesh, const Metric& metric, Array<AngleSum>& sums, Call& call) {
    if (!sums.allocate_filled(call.memory, mesh.vertex_count, AngleSum())) return false;
    const auto square = [&](uint32_t h) { return metric.square_of(edge_of(h)); };
    for (uint32_t h = 0; h < 2 * mesh.edge_count; ++h) {
        if (h % 65536 == 0 && !call.tick(0)) return false;
        const uint32_t face = mesh.face[h];
        sums[mesh.origin[h]].add((square(h) + square(mesh.prev(h)) - square(mesh.next[h])).high,
                                 metric.area_of(face).high);
    }
    return true;
}

} // namespace

hmf_status triangulate_polygons(Mesh& mesh, Metric& metric, double* sum, FlipLog& flips, Call& call, double fraction) {
    Array<AngleSum> before, after;
    if (!add_angles(mesh, metric, before, call) || !FlatPolygons(mesh, metric, sum, flips, call).run(fraction)
        || !add_angles(mesh, metric, after, call))
        return call.stopped();
    for (uint32_t v = 0; v < mesh.vertex_count; ++v)
        if (!after[v].is_near(before[v]))
            return call.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_NONE, 0,
                             "Flips have changed the angles around vertices. Please report it.");
    return HMF_OK;
}

} // namespace hmf
