#include "check_atlas.hpp"

#include "chart_layout.hpp"

#include "../../core/base/heap_sort.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

struct GridPoint {
    int64_t x = 0, y = 0;
};
bool is_same(const GridPoint& a, const GridPoint& b) { return a.x == b.x && a.y == b.y; }

// Twice the area of a triangle, positive if c lies on the left; not wider than 2^30.
int64_t twice_signed_area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// With the inside on its left.
struct RimEdge {
    GridPoint from, to;
    int64_t low(bool vertical) const { return vertical ? std::min(from.y, to.y) : std::min(from.x, to.x); }
    int64_t high(bool vertical) const { return vertical ? std::max(from.y, to.y) : std::max(from.x, to.x); }
};

int sign_of(int64_t x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

// Inner points of both, one line through the other; or on one line with the same direction.
bool is_crossing(const RimEdge& a, const RimEdge& b) {
    for (const bool vertical : {false, true})
        if (std::min(a.high(vertical), b.high(vertical)) < std::max(a.low(vertical), b.low(vertical))) return false;
    const int c = sign_of(twice_signed_area(a.from, a.to, b.from)), d = sign_of(twice_signed_area(a.from, a.to, b.to));
    const int e = sign_of(twice_signed_area(b.from, b.to, a.from)), f = sign_of(twice_signed_area(b.from, b.to, a.to));
    if (c != 0 || d != 0) return c * d < 0 && e * f < 0;
    const bool vertical = a.from.x == a.to.x;
    const auto rises = [&](const RimEdge& edge) {
        return vertical ? edge.to.y > edge.from.y : edge.to.x > edge.from.x;
    };
    return rises(a) == rises(b)
        && std::min(a.high(vertical), b.high(vertical)) > std::max(a.low(vertical), b.low(vertical));
}

class WindingCheck {
public:
    WindingCheck(const Atlas& atlas, const Mesh& mesh, Call& call) : atlas_(atlas), mesh_(mesh), call_(call) {}

    hmf_status run(const Array<uint32_t>& sides, AtlasCheck& out) {
        if (!find_rim(sides, out)) return call_.stopped();
        out.edges = rim_.size();
        if (out.edges == 0 || out.turned > 0) return HMF_OK;
        return sort_into_rows() && check_rows(out) ? HMF_OK : call_.stopped();
    }

private:
    GridPoint corner(uint32_t h) const {
        const double *uv = &atlas_.uv[2 * size_t{h}], side = atlas_.side;
        return {static_cast<int64_t>(uv[0] * side + 0.5), static_cast<int64_t>(uv[1] * side + 0.5)};
    }

    Done find_rim(const Array<uint32_t>& sides, AtlasCheck& out) {
        rim_.start(call_.memory);
        Array<uint8_t> speck;
        if (!speck.allocate_filled(call_.memory, mesh_.face_count, uint8_t{1})) return false;
        for (const uint32_t h : sides) {
            const GridPoint p[3] = {corner(h), corner(mesh_.next[h]), corner(mesh_.prev(h))};
            const int64_t wide = std::max({p[0].x, p[1].x, p[2].x}) - std::min({p[0].x, p[1].x, p[2].x}),
                          high = std::max({p[0].y, p[1].y, p[2].y}) - std::min({p[0].y, p[1].y, p[2].y});
            const int64_t area = twice_signed_area(p[0], p[1], p[2]);
            speck[mesh_.face[h]] = area == 0 || std::max(wide, high) < SPECK;
            out.specks += speck[mesh_.face[h]];
            out.turned += area < 0 && !speck[mesh_.face[h]];
        }
        for (const uint32_t first : sides) {
            if (!call_.work(16, 0.98, false)) return false;
            if (speck[mesh_.face[first]]) continue;
            uint32_t h = first;
            for (int k = 0; k < 3; ++k, h = mesh_.next[h]) {
                const uint32_t beyond = twin(h);
                const RimEdge edge{corner(h), corner(mesh_.next[h])};
                const bool is_joined = !speck[mesh_.face[beyond]] && is_same(corner(beyond), edge.to)
                                    && is_same(corner(mesh_.next[beyond]), edge.from);
                if (!is_joined && !rim_.push(edge)) return false;
            }
        }
        return true;
    }

    size_t row_of(int64_t y) const { return static_cast<size_t>((y - low_) / row_height_); }

    // Rows of the square, each with the edges that pass through it.
    Done sort_into_rows() {
        constexpr size_t edges_in_row = 16;
        int64_t high = rim_[0].high(true);
        low_ = rim_[0].low(true);
        for (const RimEdge& edge : rim_) {
            low_ = std::min(low_, edge.low(true));
            high = std::max(high, edge.high(true));
        }
        const size_t rows = rim_.size() / edges_in_row + 1;
        row_height_ = (high - low_) / static_cast<int64_t>(rows) + 1;
        if (!begin_.allocate_filled(call_.memory, rows + 1, size_t{0})) return false;
        for (const RimEdge& edge : rim_) {
            if (!call_.work(row_of(edge.high(true)) - row_of(edge.low(true)) + 1, 0.98, false)) return false;
            for (size_t r = row_of(edge.low(true)); r <= row_of(edge.high(true)); ++r) ++begin_[r + 1];
        }
        for (size_t r = 0; r < rows; ++r) begin_[r + 1] += begin_[r];
        if (!content_.allocate(call_.memory, begin_[rows])) return false;
        for (const RimEdge& edge : rim_) {
            if (!call_.work(row_of(edge.high(true)) - row_of(edge.low(true)) + 1, 0.98, false)) return false;
            for (size_t r = row_of(edge.low(true)); r <= row_of(edge.high(true)); ++r) content_[begin_[r]++] = edge;
        }
        for (size_t r = rows; r-- > 0;) begin_[r + 1] = begin_[r];
        begin_[0] = 0;
        return true;
    }

    Done check_rows(AtlasCheck& out) {
        const auto is_before = [](const RimEdge& a, const RimEdge& b) { return a.low(false) < b.low(false); };
        const auto go_on = [this] { return call_.work(64, 0.98, false); };
        for (size_t r = 0; r + 1 < begin_.size(); ++r) {
            RimEdge* const row = content_.data() + begin_[r];
            const size_t n = begin_[r + 1] - begin_[r];
            if (!heap_sort(row, n, is_before, go_on)) return false;
            for (size_t i = 0; i < n; ++i) {
                size_t steps = 1;
                for (size_t k = i + 1; k < n && row[k].low(false) <= row[i].high(false); ++k, ++steps)
                    out.crossings += is_crossing(row[i], row[k]);
                if (row_of((row[i].from.y + row[i].to.y) / 2) == r) out.crossings += is_wound_wrongly(row, n, row[i]);
                if (!call_.work(4 * (steps + n), 0.98, false)) return false;
            }
        }
        return true;
    }

    // By the edges left of the middle of one.  Not told where another one passes through that, or it is level.
    static bool is_wound_wrongly(const RimEdge* row, size_t n, const RimEdge& edge) {
        if (edge.from.y == edge.to.y) return false;
        const auto doubled = [](const GridPoint& p) { return GridPoint{2 * p.x, 2 * p.y}; };
        const GridPoint middle{edge.from.x + edge.to.x, edge.from.y + edge.to.y};
        int winding = 0, through = 0;
        for (size_t k = 0; k < n && 2 * row[k].low(false) <= middle.x; ++k) {
            const RimEdge& other = row[k];
            if (middle.y < 2 * other.low(true) || middle.y >= 2 * other.high(true)) continue;
            const bool up = other.to.y > other.from.y, is_left = 2 * other.high(false) < middle.x;
            const int64_t left = is_left ? 0 : twice_signed_area(doubled(other.from), doubled(other.to), middle);
            through += left == 0 && !is_left;
            if (is_left || (up ? left < 0 : left > 0)) winding += up ? -1 : 1;
        }
        return through == 1 && winding != (edge.to.y > edge.from.y);
    }

    const Atlas& atlas_;
    const Mesh& mesh_;
    Call& call_;
    Array<RimEdge> rim_, content_; // content_: row by row
    Array<size_t> begin_;          // of the rows
    int64_t low_ = 0, row_height_ = 1;
};

} // namespace

hmf_status check_atlas(const Atlas& atlas, const Mesh& mesh, const Array<uint32_t>& sides, AtlasCheck& out,
                       Call& call) {
    return WindingCheck(atlas, mesh, call).run(sides, out);
}

} // namespace hmf
