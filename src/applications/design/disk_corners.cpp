// Where to mark a disk: its corners.
#include "disk_corners.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

// Where the square of the boundary is less than this part of the area, a disk is a sphere with a small hole.
constexpr double SHORT_BOUNDARY = 2;
constexpr double CORNER_SHARP = 0.9, LEAST_TURN = 0.35; // sharpness of a corner: turns by 53 and 20 degrees
constexpr double CORNER_NEAR = 0.1;                     // of the length of the boundary
constexpr double JAGS = 3; // mean edges of a boundary to both sides, over which its turns are seen: jags are no corners

// Per vertex of the boundary the next one along it, else NONE, by the caller's numbers; h is the double of the surface.
Done follow_boundary(const hmf_hierarchy& h, Array<uint32_t>& next, Call& call) {
    const size_t m = h.surface_triangles;
    if (!next.allocate_filled(call.memory, h.surface_vertices, NONE)) return false;
    for (size_t t = 0; t < m; ++t)
        for (size_t s = 0; s < 3; ++s) {
            // A side is its own image.
            if (h.triangle_edges[3 * t + s] != h.triangle_edges[3 * (m + t) + 2 - s]) continue;
            next[h.triangle_vertices[3 * t + s]] = h.triangle_vertices[3 * t + (s + 1) % 3];
        }
    return true;
}

// The curve of the boundary that begins at the first vertex from `first` on that is left in `next`, which loses it;
// empty: there is none.
Done take_curve(Array<uint32_t>& next, uint32_t& first, Array<uint32_t>& boundary, Call& call) {
    boundary.start(call.memory);
    while (first < next.size() && next[first] == NONE) ++first;
    for (uint32_t v = first; v < next.size() && next[v] != NONE;) {
        if (!boundary.push(v)) return false;
        const uint32_t w = next[v];
        next[v] = NONE;
        v = w;
    }
    return true;
}

// How sharp a boundary turns at each of its vertices: | a + b | of the directions a and b to its neighbors, or to the
// vertices at the distance of some mean edges along the boundary,
//
//     a     b      0: straight, 1.41: a corner of 90 degrees; 0 also where the
//      \___/       surface lies outside of the angle
//        v
class Sharpness {
public:
    Sharpness(const hmf_hierarchy& h, const Array<uint32_t>& boundary) : h_(h), boundary_(boundary) {}

    Done find(double edges, Memory& memory) {
        const size_t n = boundary_.size();
        Array<uint32_t> place;
        if (!place.allocate_filled(memory, h_.surface_vertices, NONE) || !of.allocate(memory, n)
            || !inward_.allocate_filled(memory, 3 * n, 0.0))
            return false;
        for (size_t k = 0; k < n; ++k) place[boundary_[k]] = static_cast<uint32_t>(k);
        for (size_t t = 0; t < h_.surface_triangles; ++t)
            for (size_t s = 0; s < 3; ++s) add_inward(place, t, s);
        double length = 0;
        for (size_t k = 0; k < n; ++k) length += edge(k);
        reach_ = 0;
        for (size_t k = 0; k < n; ++k) of[k] = measure(k);
        reach_ = edges * length / static_cast<double>(n);
        for (size_t k = 0; k < n && edges > 0; ++k) of[k] = std::min(of[k], measure(k));
        return true;
    }

    // Sharp, and as sharp as any vertex within reach: the first of those that are.
    bool is_corner(size_t k) const {
        const size_t n = of.size(), first = walk(k, n - 1), last = walk(k, 1);
        bool sharpest = of[k] > CORNER_SHARP;
        for (size_t i = first; sharpest && i != k; i = (i + 1) % n) sharpest = of[i] < of[k];
        for (size_t i = k; sharpest && i != last; i = (i + 1) % n) sharpest = of[(i + 1) % n] <= of[k];
        return sharpest;
    }

    Array<double> of; // in the order of the boundary

private:
    const double* at(uint32_t v) const { return h_.levels[0].position + size_t{3} * h_.vertex_internal[v]; }
    void add_inward(const Array<uint32_t>& place, size_t t, size_t s) {
        const uint32_t* triangle = h_.triangle_vertices + 3 * t;
        const uint32_t k = place[triangle[s]];
        if (k == NONE) return;
        for (int c = 0; c < 3; ++c)
            inward_[size_t{3} * k + static_cast<size_t>(c)] +=
                at(triangle[(s + 1) % 3])[c] + at(triangle[(s + 2) % 3])[c] - 2 * at(triangle[s])[c];
    }
    double edge(size_t k) const {
        const double *a = at(boundary_[k]), *b = at(boundary_[(k + 1) % boundary_.size()]);
        double square = 0;
        for (int c = 0; c < 3; ++c) square += (b[c] - a[c]) * (b[c] - a[c]);
        return std::sqrt(square);
    }
    // The vertex within reach of k, one at least and less than half around; step: 1 ahead, or the number of all less 1.
    size_t walk(size_t k, size_t step) const {
        const size_t n = boundary_.size();
        double length = 0;
        for (size_t steps = 0; steps == 0 || (length < reach_ && 2 * steps + 2 < n); ++steps) {
            length += edge(step == 1 ? k : (k + step) % n);
            k = (k + step) % n;
        }
        return k;
    }
    double measure(size_t k) const {
        const size_t n = boundary_.size(), first = walk(k, n - 1), last = walk(k, 1);
        const double *v = at(boundary_[k]), *ends[2] = {at(boundary_[first]), at(boundary_[last])};
        double sum[3] = {0, 0, 0}, inward[3] = {0, 0, 0}, square = 0, along = 0;
        for (size_t i = (first + 1) % n; i != last; i = (i + 1) % n)
            for (size_t c = 0; c < 3; ++c) inward[c] += inward_[3 * i + c];
        for (const double* end : ends) {
            double length = 0;
            for (int c = 0; c < 3; ++c) length += (end[c] - v[c]) * (end[c] - v[c]);
            for (int c = 0; c < 3 && length > 0; ++c) sum[c] += (end[c] - v[c]) / std::sqrt(length);
        }
        for (size_t c = 0; c < 3; ++c) {
            square += sum[c] * sum[c];
            along += sum[c] * inward[c];
        }
        return along > 0 ? std::sqrt(square) : 0;
    }

    const hmf_hierarchy& h_;
    const Array<uint32_t>& boundary_;
    Array<double> inward_; // of each vertex, to the middle of its triangles
    double reach_ = 0;
};

struct Measures {
    double length = 0, area = 0;  // of the boundary, of the disk
    double middle[3] = {0, 0, 0}; // of the vertices of the boundary
};

double point_distance(const double* a, const double* b) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
    return std::sqrt(sum);
}

const double* place_of(const hmf_hierarchy& h, uint32_t v) {
    return h.levels[0].position + size_t{3} * h.vertex_internal[v];
}

Measures measure_disk(const hmf_hierarchy& h, const Array<uint32_t>& boundary) {
    Measures m;
    const size_t n = boundary.size();
    for (size_t k = 0; k < n; ++k) {
        const double* const here = place_of(h, boundary[k]);
        for (int c = 0; c < 3; ++c) m.middle[c] += here[c] / static_cast<double>(n);
        m.length += point_distance(here, place_of(h, boundary[(k + 1) % n]));
    }
    for (size_t t = 0; t < h.surface_triangles; ++t) {
        const double* x[3];
        for (size_t s = 0; s < 3; ++s) x[s] = place_of(h, h.triangle_vertices[3 * t + s]);
        const double a = point_distance(x[0], x[1]), b = point_distance(x[1], x[2]), c = point_distance(x[2], x[0]);
        const double square = (a + b + c) * (b + c - a) * (c + a - b) * (a + b - c);
        m.area += square > 0 ? 0.25 * std::sqrt(square) : 0;
    }
    return m;
}

// Vertices that divide the boundary into about equal lengths, the first as far from its middle as can be,
// and near these places the sharpest.
Done divide_boundary(const hmf_hierarchy& h, const Array<uint32_t>& boundary, const Array<double>& sharpness,
                     const Measures& disk, Memory& memory, Array<uint32_t>& marks) {
    const size_t n = boundary.size();
    const auto at = [&](size_t k) { return place_of(h, boundary[k % n]); };
    size_t first = 0;
    for (size_t k = 1; k < n; ++k)
        if (point_distance(at(k), disk.middle) > point_distance(at(first), disk.middle)) first = k;
    Array<double> along; // from the first vertex
    if (!along.allocate_filled(memory, n, 0.0) || !marks.push(boundary[first])) return false;
    for (size_t k = 1; k < n; ++k) along[k] = along[k - 1] + point_distance(at(first + k - 1), at(first + k));
    size_t from = 1; // behind the one before
    for (size_t m = 1; m < 4; ++m) {
        const auto off = [&](size_t k) { return std::fabs(along[k] / disk.length - 0.25 * static_cast<double>(m)); };
        const auto score = [&](size_t k) {
            const double sharp = sharpness[(first + k) % n];
            return (off(k) < CORNER_NEAR && sharp > LEAST_TURN ? sharp : 0) - off(k);
        };
        size_t best = from;
        for (size_t k = from; k <= n - 4 + m; ++k) // as many are left as marks are missing
            if (score(k) > score(best)) best = k;
        if (!marks.push(boundary[(first + best) % n])) return false;
        from = best + 1;
    }
    return true;
}

} // namespace

Done corners_of_disk(const hmf_hierarchy& h, Array<uint32_t>& marks, Call& call) {
    Array<uint32_t> next, boundary;
    uint32_t first = 0;
    if (!follow_boundary(h, next, call) || !take_curve(next, first, boundary, call)) return false;
    const Measures disk = measure_disk(h, boundary);
    if (boundary.size() < 4 || disk.length * disk.length < SHORT_BOUNDARY * disk.area) return true;
    Sharpness sharpness(h, boundary);
    if (!sharpness.find(0, call.memory)) return false;
    for (size_t k = 0; k < boundary.size(); ++k)
        if (sharpness.of[k] > CORNER_SHARP && !marks.push(boundary[k])) return false;
    if (marks.size() == 4) return true;
    marks.clear();
    return divide_boundary(h, boundary, sharpness.of, disk, call.memory, marks);
}

Done corners_of_boundaries(const hmf_hierarchy& h, size_t most, Array<uint32_t>& marks, Call& call) {
    Array<uint32_t> next, boundary;
    uint32_t first = 0;
    marks.start(call.memory);
    if (!follow_boundary(h, next, call)) return false;
    for (;;) {
        if (!call.tick(0) || !take_curve(next, first, boundary, call)) return false;
        if (boundary.empty()) break;
        Sharpness sharpness(h, boundary);
        const size_t before = marks.size();
        if (!sharpness.find(JAGS, call.memory)) return false;
        for (size_t k = 0; k < boundary.size(); ++k)
            if (sharpness.is_corner(k) && !marks.push(boundary[k])) return false;
        if (marks.size() == before + 1) marks.pop();
    }
    if (marks.size() > most) marks.clear();
    return true;
}

} // namespace hmf
