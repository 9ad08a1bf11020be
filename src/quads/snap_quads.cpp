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

} // namespace

hmf_status snap_to_sharp_edges(const Mesh& mesh, const double* position, const Reflection* front, QuadMesh& quads,
                               size_t& snapped, Call& call) {
    Memory& memory = call.memory;
    const uint32_t n = quads.vertex_count();
    snapped = 0;
    Array<double> length; // mean side at a vertex
    Array<uint32_t> degree, sample_of;
    Array<uint8_t> snaps;
    if (!length.allocate_filled(memory, n, 0.0) || !degree.allocate_filled(memory, n, 0u)
        || !sample_of.allocate_filled(memory, n, NONE) || !snaps.allocate_filled(memory, n, 0))
        return call.out_of_memory();
    const auto at = [&](uint32_t v) { return &quads.positions[size_t{3} * v]; };
    double largest = 0, mean = 0;
    for (size_t i = 0; i < quads.quads.size(); ++i) {
        const uint32_t a = quads.quads[i], b = quads.quads[i / 4 * 4 + (i + 1) % 4];
        const double l = std::sqrt(square_distance(at(a), at(b)));
        mean += l / static_cast<double>(quads.quads.size());
        length[a] += l;
        length[b] += l;
        ++degree[a];
        ++degree[b];
    }
    for (uint32_t v = 0; v < n; ++v) {
        length[v] /= static_cast<double>(degree[v]);
        largest = std::max(largest, length[v]);
    }
    if (!call.tick(0)) return call.was_cancelled();
    Array<Sample> samples;
    samples.start(memory);
    for (uint32_t e = 0; e < mesh.edge_count; ++e) {
        const uint32_t h = 2 * e;
        if (e % 16384 == 0 && !call.tick(0)) return call.was_cancelled();
        if (front && (front->on_boundary(h) || !front->is_front[h])) continue;
        if (fold(mesh, position, h) > SHARP) continue;
        const double* const a = position + size_t{3} * mesh.origin[h];
        const double* const b = position + size_t{3} * mesh.target(h);
        const double parts =
            std::floor(static_cast<double>(SAMPLES_PER_SIDE) * std::sqrt(square_distance(a, b)) / mean) + 1;
        if (static_cast<double>(samples.size()) + parts > static_cast<double>(MOST_SAMPLES)) return HMF_OK;
        for (uint32_t i = 0; i + 0.5 < parts; ++i) {
            Sample s{{}, h};
            for (int k = 0; k < 3; ++k) s.at[k] = a[k] + (b[k] - a[k]) * ((i + 0.5) / parts);
            if (!samples.push(s)) return call.out_of_memory();
        }
    }
    if (samples.empty()) return HMF_OK;
    Grid grid;
    if (!grid.build(samples, mean, memory)) return call.out_of_memory();
    for (uint32_t v = 0; v < n; ++v) {
        if (v % 1024 == 0 && !call.tick(0)) return call.was_cancelled();
        if (!quads.held[v]) sample_of[v] = grid.nearest(samples, at(v), REACH * length[v]);
    }
    const auto along = [&](uint32_t v, const double* side, double size) {
        const uint32_t h = samples[sample_of[v]].half_edge;
        const double* const a = position + size_t{3} * mesh.origin[h];
        const double* const b = position + size_t{3} * mesh.target(h);
        double dot = 0;
        for (int k = 0; k < 3; ++k) dot += (b[k] - a[k]) * side[k];
        return std::fabs(dot) >= ALONG * size * std::sqrt(square_distance(a, b));
    };
    for (size_t i = 0; i < quads.quads.size(); ++i) {
        const uint32_t a = quads.quads[i], b = quads.quads[i / 4 * 4 + (i + 1) % 4];
        if (sample_of[a] == NONE || sample_of[b] == NONE) continue;
        // Between the places where they would be.
        double side[3];
        const double size = std::sqrt(square_distance(samples[sample_of[a]].at, samples[sample_of[b]].at));
        for (int k = 0; k < 3; ++k) side[k] = samples[sample_of[b]].at[k] - samples[sample_of[a]].at[k];
        if (size < 0.5 * std::sqrt(square_distance(at(a), at(b))) || !along(a, side, size) || !along(b, side, size))
            continue;
        snaps[a] = snaps[b] = 1;
    }
    for (uint32_t v = 0; v < n; ++v) {
        if (!snaps[v]) continue;
        const Sample& s = samples[sample_of[v]];
        for (size_t k = 0; k < 3; ++k) quads.positions[size_t{3} * v + k] = s.at[k];
        quads.sides[v] = s.half_edge;
        quads.held[v] = 1;
        ++snapped;
    }
    return HMF_OK;
}

} // namespace hmf
