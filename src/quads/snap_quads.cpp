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

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr double SHARP = 0.766, ALONG = 0.9; // cosines of 40 and 26 degrees
constexpr double REACH = 0.4;                // of the mean side at the vertex
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
        double best = within * within;
        for (int64_t z = from[2]; z <= to[2]; ++z)
            for (int64_t y = from[1]; y <= to[1]; ++y)
                for (int64_t x = from[0]; x <= to[0]; ++x) {
                    const size_t c = static_cast<size_t>((z * count_[1] + y) * count_[0] + x);
                    for (uint32_t i = first_[c]; i < first_[c + 1]; ++i) {
                        const double d = square_distance(p, samples[order_[i]].at);
                        if (d > best || (d == best && found != NONE)) continue;
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

// The cosine of the angle between the faces of an edge, 1 where they lie in one plane.
double fold(const Mesh& mesh, const double* position, uint32_t h) {
    double normal[2][3];
    for (uint32_t side = 0; side < 2; ++side, h = twin(h)) {
        const double* const o = position + size_t{3} * mesh.origin[h];
        const double* const a = position + size_t{3} * mesh.target(h);
        const double* const b = position + size_t{3} * mesh.origin[mesh.prev(h)];
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            normal[side][k] = (a[i] - o[i]) * (b[j] - o[j]) - (a[j] - o[j]) * (b[i] - o[i]);
        }
    }
    double dot = 0, one = 0, two = 0;
    for (int k = 0; k < 3; ++k) {
        dot += normal[0][k] * normal[1][k];
        one += normal[0][k] * normal[0][k];
        two += normal[1][k] * normal[1][k];
    }
    return one > 0 && two > 0 ? dot / std::sqrt(one * two) : 1;
}

class Snapping {
public:
    Snapping(const Mesh& mesh, const double* position, const Reflection* front, QuadMesh& quads, Call& call) :
        mesh_(mesh), position_(position), front_(front), quads_(quads), call_(call) {}

    hmf_status run(size_t& snapped) {
        bool too_many = false;
        if (!measure_sides()) return call_.stopped();
        if (!sample_edges(too_many)) return call_.stopped();
        if (too_many || samples_.empty()) return HMF_OK;
        if (!find_nearest()) return call_.stopped();
        choose();
        snapped = move();
        return HMF_OK;
    }

private:
    const double* at(uint32_t v) const { return &quads_.positions[size_t{3} * v]; }
    // The vertex after corner i of all quads, in its quad.
    uint32_t next(size_t i) const { return quads_.quads[i / 4 * 4 + (i + 1) % 4]; }

    // The mean side, of all and at each vertex.
    Done measure_sides() {
        const uint32_t n = quads_.vertex_count();
        Array<uint32_t> degree;
        if (!length_.allocate_filled(call_.memory, n, 0.0) || !degree.allocate_filled(call_.memory, n, 0u))
            return false;
        for (size_t i = 0; i < quads_.quads.size(); ++i) {
            const uint32_t a = quads_.quads[i], b = next(i);
            const double l = std::sqrt(square_distance(at(a), at(b)));
            mean_ += l / static_cast<double>(quads_.quads.size());
            length_[a] += l;
            length_[b] += l;
            ++degree[a];
            ++degree[b];
        }
        for (uint32_t v = 0; v < n; ++v) length_[v] /= static_cast<double>(degree[v]);
        return call_.tick(0);
    }

    // too_many: there are too many samples to go on.
    Done sample_edges(bool& too_many) {
        samples_.start(call_.memory);
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) {
            const uint32_t h = 2 * e;
            if (e % 16384 == 0 && !call_.tick(0)) return false;
            if (front_ && (front_->on_boundary(h) || !front_->is_front[h])) continue;
            if (fold(mesh_, position_, h) > SHARP) continue;
            const double* const a = position_ + size_t{3} * mesh_.origin[h];
            const double* const b = position_ + size_t{3} * mesh_.target(h);
            const double parts =
                std::floor(static_cast<double>(SAMPLES_PER_SIDE) * std::sqrt(square_distance(a, b)) / mean_) + 1;
            too_many = static_cast<double>(samples_.size()) + parts > static_cast<double>(MOST_SAMPLES);
            if (too_many) return true;
            for (uint32_t i = 0; i + 0.5 < parts; ++i) {
                Sample s{{}, h};
                for (int k = 0; k < 3; ++k) s.at[k] = a[k] + (b[k] - a[k]) * ((i + 0.5) / parts);
                if (!samples_.push(s)) return false;
            }
        }
        return true;
    }

    Done find_nearest() {
        const uint32_t n = quads_.vertex_count();
        Grid grid;
        if (!nearest_.allocate_filled(call_.memory, n, NONE) || !snaps_.allocate_filled(call_.memory, n, 0)
            || !grid.build(samples_, mean_, call_.memory))
            return false;
        for (uint32_t v = 0; v < n; ++v) {
            if (v % 1024 == 0 && !call_.tick(0)) return false;
            if (!quads_.held[v]) nearest_[v] = grid.nearest(samples_, at(v), REACH * length_[v]);
        }
        return true;
    }

    // Those that a side joins along a sharp edge.
    void choose() {
        for (size_t i = 0; i < quads_.quads.size(); ++i) {
            const uint32_t a = quads_.quads[i], b = next(i);
            if (nearest_[a] == NONE || nearest_[b] == NONE) continue;
            // Between the places where they would be.
            const double *const from = samples_[nearest_[a]].at, *const to = samples_[nearest_[b]].at;
            const double size = std::sqrt(square_distance(from, to));
            double side[3];
            for (int k = 0; k < 3; ++k) side[k] = to[k] - from[k];
            if (size < 0.5 * std::sqrt(square_distance(at(a), at(b))) || !runs_along(a, side, size)
                || !runs_along(b, side, size))
                continue;
            snaps_[a] = snaps_[b] = 1;
        }
    }

    // A side in the direction of the edge that is nearest to v.
    bool runs_along(uint32_t v, const double* side, double size) const {
        const uint32_t h = samples_[nearest_[v]].half_edge;
        const double* const a = position_ + size_t{3} * mesh_.origin[h];
        const double* const b = position_ + size_t{3} * mesh_.target(h);
        double dot = 0;
        for (int k = 0; k < 3; ++k) dot += (b[k] - a[k]) * side[k];
        return std::fabs(dot) >= ALONG * size * std::sqrt(square_distance(a, b));
    }

    size_t move() {
        size_t moved = 0;
        for (uint32_t v = 0; v < quads_.vertex_count(); ++v) {
            if (!snaps_[v]) continue;
            const Sample& s = samples_[nearest_[v]];
            for (size_t k = 0; k < 3; ++k) quads_.positions[size_t{3} * v + k] = s.at[k];
            quads_.sides[v] = s.half_edge;
            quads_.held[v] = 1;
            ++moved;
        }
        return moved;
    }

    const Mesh& mesh_;
    const double* position_;
    const Reflection* front_; // of a double, or NULL
    QuadMesh& quads_;
    Call& call_;
    double mean_ = 0;         // of the sides
    Array<double> length_;    // mean side at a vertex
    Array<Sample> samples_;   // of the sharp edges
    Array<uint32_t> nearest_; // per vertex: the nearest sample, or NONE
    Array<uint8_t> snaps_;    // per vertex
};

} // namespace

hmf_status snap_to_sharp_edges(const Mesh& mesh, const double* position, const Reflection* front, QuadMesh& quads,
                               size_t& snapped, Call& call) {
    snapped = 0;
    return Snapping(mesh, position, front, quads, call).run(snapped);
}

} // namespace hmf
