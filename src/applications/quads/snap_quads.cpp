// Sharp edges are sampled, the samples kept in cells of a grid; each vertex finds
// the nearest one.  A vertex is snapped if a side of a quad joins it to another one
// that is near a sharp edge as well, and the side has the direction of both edges:
//
//     o---o---o---o       the row on both sides of which the faces lie
//     |   |   |   |
//     x---x---x---x       x: near the sharp edge, joined along it
//    ==================   sharp edge
//     |   |   |   |
//     o---o---o---o
#include "snap_quads.hpp"

#include "quad_shape.hpp"
#include "sharp_edges.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr double ALONG = 0.85;            // cosine of 32 degrees
constexpr double SNAP_REACH = 0.5;        // of the mean side at the vertex
constexpr double SNAP_LEAST_CORNER = 0.3; // sine, of the quads around a vertex that is snapped
constexpr size_t SAMPLES_PER_SIDE = 8, MOST_CELLS = size_t{1} << 22, MOST_SAMPLES = size_t{1} << 24;

struct Sample {
    double at[3];
    uint32_t half_edge;
};

double square_distance(const double* a, const double* b) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

// Of two at the same distance up to rounding, the one with the smaller number.
bool is_nearer(double d, uint32_t i, double best, uint32_t found) {
    constexpr double same_distance = 1e-9;
    return found == NONE || d < (1 - same_distance) * best || (i < found && d <= (1 + same_distance) * best);
}

// Samples by cells of a grid over the box of all.
class Grid {
public:
    Done build(const Array<Sample>& samples, double size, Memory& memory) {
        for (int k = 0; k < 3; ++k) low_[k] = high_[k] = samples[0].at[k];
        for (const Sample& s : samples)
            for (int k = 0; k < 3; ++k) {
                low_[k] = std::min(low_[k], s.at[k]);
                high_[k] = std::max(high_[k], s.at[k]);
            }
        for (cell_ = size;; cell_ *= 2) {
            double cells = 1;
            for (int k = 0; k < 3; ++k) cells *= std::floor((high_[k] - low_[k]) / cell_) + 1;
            if (cells <= static_cast<double>(MOST_CELLS)) break;
        }
        size_t cells = 1;
        for (int k = 0; k < 3; ++k) {
            count_[k] = static_cast<int64_t>(std::floor((high_[k] - low_[k]) / cell_)) + 1;
            cells *= static_cast<size_t>(count_[k]);
        }
        if (!first_.allocate_filled(memory, cells + 1, 0u) || !order_.allocate(memory, samples.size())) return false;
        for (const Sample& s : samples) ++first_[cell_of(s.at) + 1];
        for (size_t c = 0; c < cells; ++c) first_[c + 1] += first_[c];
        Array<uint32_t> next;
        if (!next.allocate(memory, cells)) return false;
        for (size_t c = 0; c < cells; ++c) next[c] = first_[c];
        for (uint32_t i = 0; i < samples.size(); ++i) order_[next[cell_of(samples[i].at)]++] = i;
        return true;
    }

    // The nearest sample within a distance of at most the size of a cell; NONE: there is none.
    uint32_t nearest(const Array<Sample>& samples, const double* p, double within) const {
        int64_t from[3], to[3];
        for (int k = 0; k < 3; ++k) {
            if (p[k] < low_[k] - within || p[k] > high_[k] + within) return NONE;
            from[k] = std::max<int64_t>(0, place(p[k] - within, k));
            to[k] = std::min<int64_t>(count_[k] - 1, place(p[k] + within, k));
        }
        uint32_t found = NONE;
        double best = 0;
        for (int64_t z = from[2]; z <= to[2]; ++z)
            for (int64_t y = from[1]; y <= to[1]; ++y)
                for (int64_t x = from[0]; x <= to[0]; ++x) {
                    const size_t c = static_cast<size_t>((z * count_[1] + y) * count_[0] + x);
                    for (uint32_t i = first_[c]; i < first_[c + 1]; ++i) {
                        const double d = square_distance(p, samples[order_[i]].at);
                        if (d > within * within || !is_nearer(d, order_[i], best, found)) continue;
                        best = d;
                        found = order_[i];
                    }
                }
        return found;
    }

private:
    int64_t place(double x, int k) const { return static_cast<int64_t>(std::floor((x - low_[k]) / cell_)); }
    size_t cell_of(const double* p) const {
        int64_t at[3];
        for (int k = 0; k < 3; ++k) at[k] = std::min(std::max<int64_t>(place(p[k], k), 0), count_[k] - 1);
        return static_cast<size_t>((at[2] * count_[1] + at[1]) * count_[0] + at[0]);
    }

    double low_[3], high_[3], cell_ = 1;
    int64_t count_[3];
    Array<uint32_t> first_, order_;
};

double length_of_edge(const Mesh& mesh, const double* position, uint32_t h) {
    return std::sqrt(square_distance(position + size_t{3} * mesh.origin[h], position + size_t{3} * mesh.target(h)));
}

class Snap {
public:
    Snap(const Mesh& mesh, const double* position, const SurfaceSearch& surface, const Reflection* front,
         QuadMesh& quads, Call& call) :
        mesh_(mesh),
        position_(position), surface_(surface), front_(front), quads_(quads), call_(call) {}

    hmf_status run(size_t& snapped) {
        snapped = 0;
        samples_.start(call_.memory);
        edges_.start(call_.memory);
        if (!measure_sides() || !find_sharp_edges()) return call_.stopped();
        double sum = 0;
        for (const uint32_t h : edges_) sum += length_of_edge(mesh_, position_, h);
        const double parts = static_cast<double>(SAMPLES_PER_SIDE) * sum / mean_ + static_cast<double>(edges_.size());
        if (edges_.empty() || parts > static_cast<double>(MOST_SAMPLES)) return HMF_OK;
        if (!sample() || !find_nearest() || !choose() || !stars_.build(quads_, call_.memory)) return call_.stopped();
        if (!put(snapped) || !take_corners(snapped)) return call_.stopped();
        return HMF_OK;
    }

private:
    const double* place(uint32_t v) const { return &quads_.positions[size_t{3} * v]; }

    // The mean side at each vertex, and of all.
    Done measure_sides() {
        Array<uint32_t> degree;
        const uint32_t n = quads_.vertex_count();
        if (!length_.allocate_filled(call_.memory, n, 0.0) || !degree.allocate_filled(call_.memory, n, 0u))
            return false;
        for (size_t i = 0; i < quads_.quads.size(); ++i) {
            const uint32_t a = quads_.quads[i], b = next_corner(i);
            const double l = std::sqrt(square_distance(place(a), place(b)));
            mean_ += l / static_cast<double>(quads_.quads.size());
            length_[a] += l;
            length_[b] += l;
            ++degree[a];
            ++degree[b];
        }
        for (uint32_t v = 0; v < n; ++v) length_[v] /= static_cast<double>(degree[v]);
        return call_.tick(0);
    }

    Done find_sharp_edges() {
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) {
            const uint32_t h = 2 * e;
            if (e % 16384 == 0 && !call_.tick(0)) return false;
            if (front_ && (front_->on_boundary(h) || !front_->is_front[h])) continue;
            if (is_sharp(mesh_, position_, h) && !edges_.push(h)) return false;
        }
        return true;
    }

    Done sample() {
        for (const uint32_t h : edges_) {
            const double parts =
                std::floor(static_cast<double>(SAMPLES_PER_SIDE) * length_of_edge(mesh_, position_, h) / mean_) + 1;
            for (uint32_t i = 0; i + 0.5 < parts; ++i)
                if (!samples_.push(sample_at(h, (i + 0.5) / parts))) return false;
        }
        return true;
    }

    // From the nearest sample on, the nearest point.
    Done find_nearest() {
        Grid grid;
        const uint32_t n = quads_.vertex_count();
        if (!on_line_.allocate_filled(call_.memory, n, Sample{{}, NONE}) || !grid.build(samples_, mean_, call_.memory))
            return false;
        for (uint32_t v = 0; v < n; ++v) {
            if (v % 1024 == 0 && !call_.tick(0)) return false;
            if (quads_.held[v] && quads_.held[v] != ON_CREASE) continue;
            const uint32_t i = grid.nearest(samples_, place(v), SNAP_REACH * length_[v]);
            if (i == NONE) continue;
            Sample& s = on_line_[v];
            s.half_edge = walk_along_sharp_edges(mesh_, position_, samples_[i].half_edge, place(v), s.at);
        }
        return true;
    }

    Done choose() {
        if (!snaps_.allocate_filled(call_.memory, quads_.vertex_count(), 0)) return false;
        for (size_t i = 0; i < quads_.quads.size(); ++i) {
            const uint32_t a = quads_.quads[i], b = next_corner(i);
            if (follows(a, b)) snaps_[a] = snaps_[b] = 1;
        }
        return call_.tick(0);
    }

    // Whether the side between the places where both would be runs along sharp edges.
    bool follows(uint32_t a, uint32_t b) const {
        if (on_line_[a].half_edge == NONE || on_line_[b].half_edge == NONE) return false;
        const double* const from = on_line_[a].at;
        const double* const to = on_line_[b].at;
        return square_distance(from, to) >= 0.25 * square_distance(place(a), place(b)) && runs_along(a, from, to)
            && runs_along(b, from, to);
    }

    // Whether the sharp edge next to v has the direction from one place to the other.
    bool runs_along(uint32_t v, const double* from, const double* to) const {
        const uint32_t h = on_line_[v].half_edge;
        const double* const a = position_ + size_t{3} * mesh_.origin[h];
        const double* const b = position_ + size_t{3} * mesh_.target(h);
        double dot = 0;
        for (int k = 0; k < 3; ++k) dot += (b[k] - a[k]) * (to[k] - from[k]);
        return std::fabs(dot) >= ALONG * std::sqrt(square_distance(from, to) * square_distance(a, b));
    }

    // The vertex nearest to a corner, where three or more sharp edges meet, goes there and stays.
    Done take_corners(size_t& taken) {
        Array<uint8_t> lines;
        Array<Sample> corners;
        Array<uint32_t> taker;
        Grid grid;
        corners.start(call_.memory);
        if (!lines.allocate_filled(call_.memory, mesh_.vertex_count, uint8_t{0})) return false;
        for (const uint32_t e : edges_)
            for (const uint32_t h : {e, twin(e)})
                if (lines[mesh_.origin[h]] < 3 && ++lines[mesh_.origin[h]] == 3 && !corners.push(sample_at(h, 0)))
                    return false;
        if (corners.empty()) return true;
        if (!grid.build(corners, mean_, call_.memory) || !taker.allocate_filled(call_.memory, corners.size(), NONE))
            return false;
        for (uint32_t v = 0; v < quads_.vertex_count(); ++v) {
            if (v % 1024 == 0 && !call_.tick(0)) return false;
            if (quads_.held[v] && quads_.held[v] != ON_CREASE) continue;
            const uint32_t c = grid.nearest(corners, place(v), SNAP_REACH * length_[v]);
            if (c == NONE) continue;
            const double before = taker[c] == NONE ? 0 : square_distance(place(taker[c]), corners[c].at);
            if (is_nearer(square_distance(place(v), corners[c].at), v, before, taker[c])) taker[c] = v;
        }
        for (size_t c = 0; c < corners.size(); ++c) {
            if (taker[c] == NONE) continue;
            if (!put(taker[c], corners[c])) continue;
            quads_.held[taker[c]] = AT_SHARP_CORNER;
            ++taken;
        }
        return true;
    }

    Done put(size_t& snapped) {
        for (uint32_t v = 0; v < quads_.vertex_count(); ++v) {
            if (!call_.work(256, 0, false)) return false;
            if (!snaps_[v] || quads_.held[v]) continue;
            if (!put(v, on_line_[v])) continue;
            quads_.held[v] = ON_CREASE;
            ++snapped;
        }
        return true;
    }

    // False if a corner of its quads would get too flat or too sharp: it stays where it was.
    bool put(uint32_t v, const Sample& s) {
        const Point from = at(quads_, v);
        const uint32_t side = quads_.sides[v];
        quads_.put(v, s.at, s.half_edge);
        if (stars_.worst_corner(surface_, quads_, v) > SNAP_LEAST_CORNER) return true;
        const double back[3] = {from.x, from.y, from.z};
        quads_.put(v, back, side);
        return false;
    }

    // At t of the edge of h.
    Sample sample_at(uint32_t h, double t) const {
        Sample s{{}, h};
        const double* const a = position_ + size_t{3} * mesh_.origin[h];
        const double* const b = position_ + size_t{3} * mesh_.target(h);
        for (int k = 0; k < 3; ++k) s.at[k] = a[k] + (b[k] - a[k]) * t;
        return s;
    }

    uint32_t next_corner(size_t i) const { return quads_.quads[i / 4 * 4 + (i + 1) % 4]; }

    const Mesh& mesh_;
    const double* position_;
    const SurfaceSearch& surface_;
    const Reflection* front_;
    QuadMesh& quads_;
    Call& call_;
    double mean_ = 0;
    Array<double> length_;  // per vertex of the quads
    Array<uint32_t> edges_; // sharp
    Array<Sample> samples_; // of them
    Array<Sample> on_line_; // the place nearest to each vertex
    Array<uint8_t> snaps_;
    QuadStars stars_;
};

} // namespace

hmf_status snap_to_sharp_edges(const Mesh& mesh, const double* position, const SurfaceSearch& surface,
                               const Reflection* front, QuadMesh& quads, size_t& snapped, Call& call) {
    return Snap(mesh, position, surface, front, quads, call).run(snapped);
}

} // namespace hmf
