// Each loop of outer sides of the quads runs along one loop of the boundary of the surface, in the same direction.  By
// lengths along that:
//
//     places    p_0 < p_1 < ... < p_0 + L of the vertices, L the length of the loop
//     corners   where the boundary turns by more than 40 degrees from half a side of the quads before to half a side
//               behind, and most
//     takers    pairs of a corner and a vertex, the cheapest first, as long as they come in the same order
//     the rest  between two takers by the linear map of their places
#include "fit_quads.hpp"

#include "../../core/base/heap_sort.hpp"
#include "quad_numbers.hpp"
#include "surface_lines.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

class BoundaryPlaces {
public:
    BoundaryPlaces(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), quads_(quads), call_(call) {}

    hmf_status run() {
        const uint32_t n = quads_.vertex_count();
        Memory& memory = call_.memory;
        for (auto* list : {&loop_, &rim_, &taken_}) list->start(memory);
        for (auto* list : {&start_, &place_, &moved_}) list->start(memory);
        corners_.start(memory);
        pairs_.start(memory);
        Array<uint8_t> seen;
        if (!stars_.build(quads_, memory) || !stars_.follow_boundary(quads_, next_, memory)
            || !seen.allocate_filled(memory, n, uint8_t{0})
            || !number_.allocate_filled(memory, 2 * size_t{mesh_.edge_count}, NONE))
            return call_.out_of_memory();
        for (uint32_t v = 0; v < n; ++v) {
            if (seen[v] || next_[v] == NONE) continue;
            if (!call_.tick(0)) return call_.was_cancelled();
            loop_.clear();
            uint32_t w = v;
            for (; w != NONE && !seen[w]; w = next_[w]) {
                seen[w] = 1;
                if (!loop_.push(w)) return call_.out_of_memory();
            }
            if (w == v && !place_loop()) return call_.out_of_memory();
        }
        return HMF_OK;
    }

private:
    struct Corner {
        double at;  // along the boundary
        size_t rim; // the number of the edge that begins there
        bool is_convex;
    };
    struct Pair {
        double cost;
        uint32_t corner, vertex; // numbers in corners_ and loop_
    };

    Done place_loop() {
        if (!list_rim()) return true;
        if (!find_places() || !find_corners() || !choose_takers()) return false;
        put_all();
        return true;
    }

    // The boundary on which the first vertex lies that lies on one; whether it is found.
    bool list_rim() {
        rim_.clear();
        start_.clear();
        length_ = 0;
        size_t first = 0;
        while (first < loop_.size() && !is_on_rim(mesh_, quads_.sides[loop_[first]])) ++first;
        if (loop_.size() < 3 || first == loop_.size()) return false;
        const uint32_t begin = quads_.sides[loop_[first]];
        uint32_t h = begin;
        do {
            number_[h] = static_cast<uint32_t>(rim_.size());
            if (!rim_.push(h) || !start_.push(length_)) return false;
            length_ += length_of(point(position_, mesh_.target(h)) - point(position_, mesh_.origin[h]));
            h = next_on_rim(mesh_, h);
        } while (h != begin && h != NONE);
        return h == begin && length_ > 0;
    }

    uint32_t count() const { return static_cast<uint32_t>(loop_.size()); }

    // Along this boundary; NaN: the vertex lies on another one.
    double place_of(uint32_t v) const {
        const uint32_t h = quads_.sides[v], k = is_on_rim(mesh_, h) ? number_[h] : NONE;
        if (k >= rim_.size() || rim_[k] != h) return NAN;
        return start_[k] + length_of(at(quads_, v) - point(position_, mesh_.origin[h]));
    }

    // They never go back, and lie apart by a part of the mean side at least.
    Done find_places() {
        const uint32_t n = count();
        if (!place_.allocate(call_.memory, n) || !moved_.allocate(call_.memory, n)) return false;
        double last = NAN, first = 0;
        uint32_t known = 0;
        for (uint32_t i = 0; i < n; ++i) {
            double p = place_of(loop_[i]);
            if (std::isnan(p)) {
                place_[i] = NAN;
                continue;
            }
            if (known++ == 0) first = p;
            else {
                double step = p - (last - std::floor(last / length_) * length_);
                step -= std::floor(step / length_ + 0.25) * length_; // from -1/4 to 3/4 of the loop
                p = last + step;
            }
            place_[i] = last = p;
        }
        // Once around, to the first one again; else evenly.
        const double end = first + length_;
        double low = first;
        const bool fits = known > 0 && std::fabs(last - first) < length_ * 1.25 && last > first;
        for (uint32_t i = 0; i < n; ++i) {
            if (std::isnan(place_[i])) place_[i] = i > 0 ? place_[i - 1] : first;
            low = std::max(low, std::min(place_[i], end));
            const double even = first + length_ * i / n;
            place_[i] = fits ? (1 - SPREAD) * low + SPREAD * even : even;
        }
        return true;
    }

    // The point of the boundary at a length along it, which may be outside 0 and the whole length.
    Point point_at(double p, uint32_t& h) const {
        p -= std::floor(p / length_) * length_;
        size_t low = 0, high = rim_.size();
        while (high - low > 1) {
            const size_t middle = low + (high - low) / 2;
            if (start_[middle] <= p) low = middle;
            else high = middle;
        }
        h = rim_[low];
        const Point a = point(position_, mesh_.origin[h]), way = point(position_, mesh_.target(h)) - a;
        const double whole = length_of(way), part = p - start_[low];
        return part > 0 && whole > 0 ? a + std::min(part / whole, 1.0) * way : a;
    }

    // The vertex before a place, the part of the side behind it that lies before, and the length of that.
    uint32_t vertex_before(double p, double& part, double& gap) const {
        p -= std::floor((p - place_[0]) / length_) * length_;
        uint32_t low = 0, high = count();
        while (high - low > 1) {
            const uint32_t middle = low + (high - low) / 2;
            if (place_[middle] <= p) low = middle;
            else high = middle;
        }
        gap = (low + 1 < count() ? place_[low + 1] : place_[0] + length_) - place_[low];
        part = (p - place_[low]) / gap;
        return low;
    }

    // Half the side of the quads at an edge of the boundary.
    double reach_at(size_t k) const {
        double part = 0, gap = 0;
        vertex_before(start_[k], part, gap);
        return 0.5 * gap;
    }

    Done find_corners() {
        corners_.clear();
        Array<double> turn;
        if (!turn.allocate(call_.memory, rim_.size())) return false;
        uint32_t h = 0;
        const auto ways = [&](size_t k, Point& back, Point& ahead) {
            const Point here = point(position_, mesh_.origin[rim_[k]]);
            const double reach = reach_at(k);
            back = here - point_at(start_[k] - reach, h);
            ahead = point_at(start_[k] + reach, h) - here;
        };
        for (size_t k = 0; k < rim_.size(); ++k) {
            Point a, b;
            ways(k, a, b);
            const double size = std::sqrt(dot(a, a) * dot(b, b));
            turn[k] = size > 0 ? dot(a, b) / size : 1;
        }
        for (size_t k = 0; k < rim_.size(); ++k) {
            if (!(turn[k] < SHARP) || !is_sharpest(k, turn, reach_at(k))) continue;
            Point a, b;
            ways(k, a, b);
            // Seen along the normal of the triangle there.
            const bool convex = dot(cross(a, b), normal_at(mesh_, position_, rim_[k])) > 0;
            if (!corners_.push({start_[k], k, convex})) return false;
        }
        return true;
    }

    // Of those within reach; of two alike the first.
    bool is_sharpest(size_t k, const Array<double>& turn, double reach) const {
        const size_t n = rim_.size();
        for (const bool ahead : {true, false})
            for (size_t i = 1; i < n; ++i) {
                const size_t j = (ahead ? k + i : k + n - i) % n;
                const double off = ahead ? start_[j] - start_[k] : start_[k] - start_[j];
                if ((off < 0 ? off + length_ : off) > reach) break;
                if (ahead ? turn[j] < turn[k] : turn[j] <= turn[k]) return false;
            }
        return true;
    }

    Done choose_takers() {
        const uint32_t n = count();
        const int reach = std::min(REACH, static_cast<int>(n) / 2 - 1);
        pairs_.clear();
        if (!taken_.allocate_filled(call_.memory, corners_.size(), NONE)) return false;
        for (uint32_t c = 0; c < corners_.size(); ++c) {
            double part = 0, gap = 0;
            const uint32_t before = vertex_before(corners_[c].at, part, gap);
            for (int k = -reach; k <= reach + 1; ++k) {
                const uint32_t i = (before + n + static_cast<uint32_t>(k)) % n;
                const double off = k - part;
                const bool fits = corners_[c].is_convex && stars_.end(loop_[i]) - stars_.begin(loop_[i]) == 1;
                if (std::fabs(off) > (fits ? REACH : 1)) continue;
                if (!pairs_.push({off * off - (fits ? REACH * REACH : 0), c, i})) return false;
            }
        }
        heap_sort(pairs_.data(), pairs_.size(), [](const Pair& a, const Pair& b) {
            if (a.cost != b.cost) return a.cost < b.cost;
            return a.corner != b.corner ? a.corner < b.corner : a.vertex < b.vertex;
        });
        Array<uint8_t> used;
        if (!used.allocate_filled(call_.memory, count(), uint8_t{0})) return false;
        for (const Pair& p : pairs_) {
            if (taken_[p.corner] != NONE || used[p.vertex] || !keeps_order(p)) continue;
            taken_[p.corner] = p.vertex;
            used[p.vertex] = 1;
        }
        return true;
    }

    // With the takers of the corners before and behind it.
    bool keeps_order(const Pair& p) const {
        const size_t m = corners_.size();
        uint32_t before = NONE, behind = NONE;
        for (size_t i = 1; i < m && before == NONE; ++i) before = taken_[(p.corner + m - i) % m];
        for (size_t i = 1; i < m && behind == NONE; ++i) behind = taken_[(p.corner + i) % m];
        if (before == NONE || before == behind) return before != p.vertex;
        const uint32_t n = count();
        return (p.vertex + n - before) % n < (behind + n - before) % n && p.vertex != before;
    }

    void put_all() {
        const uint32_t n = count();
        for (uint32_t i = 0; i < n; ++i) {
            moved_[i] = place_[i];
            quads_.held[loop_[i]] = AT_BOUNDARY;
        }
        uint32_t last = NONE, first = NONE;
        for (uint32_t c = 0; c < corners_.size(); ++c) {
            if (taken_[c] == NONE) continue;
            quads_.held[loop_[taken_[c]]] = AT_CORNER;
            if (first == NONE) first = c;
            else spread(last, c);
            last = c;
        }
        if (first != NONE) spread(last, first);
        for (uint32_t i = 0; i < n; ++i) {
            uint32_t h = NONE;
            const Point p = point_at(moved_[i], h);
            quads_.put(loop_[i], p, h);
        }
        for (uint32_t c = 0; c < corners_.size(); ++c) { // without rounding
            if (taken_[c] == NONE) continue;
            const uint32_t h = rim_[corners_[c].rim];
            quads_.put(loop_[taken_[c]], point(position_, mesh_.origin[h]), h);
        }
    }

    // From one corner to the next one, or to itself again.
    void spread(uint32_t from, uint32_t to) {
        const uint32_t n = count(), a = taken_[from], b = taken_[to], between = a == b ? n : (b + n - a) % n;
        const auto wrapped = [&](double x) { return x - std::floor(x / length_) * length_; };
        const double whole = a == b ? length_ : wrapped(place_[b] - place_[a]),
                     goal = a == b ? length_ : wrapped(corners_[to].at - corners_[from].at);
        for (uint32_t k = 0; k < between; ++k) {
            const uint32_t i = (a + k) % n;
            const double part = k == 0 ? 0 : whole > 0 ? wrapped(place_[i] - place_[a]) / whole : 0;
            moved_[i] = corners_[from].at + part * goal;
        }
    }

    const Mesh& mesh_;
    const double* position_;
    QuadMesh& quads_;
    Call& call_;
    QuadStars stars_;
    Array<uint32_t> next_;                // per vertex: the next one along the boundary of the quads; NONE
    Array<uint32_t> number_;              // per half-edge: in a list of those of a boundary
    Array<uint32_t> loop_, rim_;          // vertices of the quads, half-edges of the surface
    Array<double> start_, place_, moved_; // of each half-edge of the rim, each vertex of the loop, and where that goes
    Array<Corner> corners_;
    Array<Pair> pairs_;
    Array<uint32_t> taken_; // per corner: by which vertex of the loop
    double length_ = 0;
};

} // namespace

hmf_status place_on_boundary(const Mesh& mesh, const double* position, QuadMesh& quads, Call& call) {
    return BoundaryPlaces(mesh, position, quads, call).run();
}

} // namespace hmf
