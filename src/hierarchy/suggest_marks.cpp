// Where to mark a sphere: tips of limbs are the maxima of the mean distance to
// all of the surface.
//
//        _____            A maximum counts by its persistence: how deep one has
//       /     \__/\       to go down from it on the way to a higher one.  What
//      | body     limb    remains after small ones are left out are limbs.
//       \_____/--\/       At least two tips: the highest, and what is farthest
//                         from it.
//
// Leaves go round a limb if a loop does, and that must have two marked vertices
// on its far side.  So each tip gets a pair: the ends of a diameter of a small
// disk round it, which does not reach far down a thin limb.
//
// All of this on a coarse level, made by collapses to end points: its vertices
// are vertices of the caller.
#include "suggest_marks.hpp"

#include "../base/disjoint_sets.hpp"
#include "../base/heap_sort.hpp"
#include "../mesh/edge_distances.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr uint64_t VERTICES = 4000;  // of the level that is looked at
constexpr uint32_t BASES = 32;       // points that distances are taken to
constexpr double PERSISTENCE = 0.08; // least, in mean distances
constexpr size_t MOST_TIPS = 12;     // those of largest persistence
constexpr EdgeDistances::DiskLimit DISK{10, 4e-3, 1.2};

struct Tip {
    uint32_t vertex;
    double persistence;
};

class Suggestion {
public:
    Suggestion(const Mesh& mesh, const double* position, size_t most, Call& call) :
        mesh_(mesh), call_(call), memory_(call.memory), distances_(mesh, position, call.memory), most_(most) {}

    template <class Takes>
    Done find(const Takes& takes, Array<uint32_t>& marks) {
        marks.start(memory_);
        if (!find_limbs()) return false;
        for (const Tip& tip : tips_)
            if (takes(tip.vertex) && !add_pair(tip.vertex, marks)) return false;
        while (marks.size() < 4 && marks.size() < mesh_.vertex_count) // a mesh of a few vertices
            if (!add(first_unused(), marks)) return false;
        return true;
    }

    Done find_limbs() {
        const uint32_t n = mesh_.vertex_count;
        tips_.start(memory_);
        if (!distances_.start() || !nearest_.allocate_filled(memory_, n, HUGE_VAL)
            || !height_.allocate_filled(memory_, n, 0.0) || !used_.allocate_filled(memory_, n, uint8_t{0}))
            return false;
        return measure_heights() && find_tips() && add_far_tip();
    }

    const Array<Tip>& tips() const { return tips_; }

    // The ends of a diameter of the disk round the tip, where there is one.
    Done add_pair(uint32_t tip, Array<uint32_t>& marks) {
        uint32_t ends[2];
        return distances_.diameter(tip, DISK, used_.data(), ends) && add(ends[0], marks) && add(ends[1], marks);
    }

private:
    // Mean distance to bases that are far from each other.
    Done measure_heights() {
        uint32_t base = 0;
        if (!distances_.search(0, nullptr, base)) return false;
        for (uint32_t b = 0; b < BASES; ++b) {
            uint32_t last = 0;
            if (!call_.tick(0.5 + 0.01 * b) || !distances_.search(base, nullptr, last)) return false;
            for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
                height_[v] += distances_.distance(v) / BASES;
                nearest_[v] = std::min(nearest_[v], distances_.distance(v));
                if (nearest_[v] > nearest_[base]) base = v;
            }
        }
        double sum = 0;
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) sum += distances_.area(v) * height_[v];
        const double whole = distances_.whole_area();
        least_ = whole > 0 ? PERSISTENCE * sum / whole : 0;
        return true;
    }

    // From the highest vertex down; a component of what has been passed knows its highest one.
    Done find_tips() {
        const uint32_t n = mesh_.vertex_count;
        Array<uint32_t> falling, part, top;
        Array<uint8_t> passed;
        if (!falling.allocate(memory_, n) || !part.allocate(memory_, n) || !top.allocate(memory_, n)
            || !passed.allocate_filled(memory_, n, uint8_t{0}))
            return false;
        const auto higher = [this](uint32_t a, uint32_t b) {
            return height_[a] != height_[b] ? height_[a] > height_[b] : a < b;
        };
        for (uint32_t v = 0; v < n; ++v) falling[v] = part[v] = top[v] = v;
        heap_sort(falling.data(), n, higher);
        for (const uint32_t v : falling) {
            passed[v] = 1;
            for (const uint32_t h : mesh_.around(v)) {
                const uint32_t w = mesh_.target(h);
                if (passed[w]) {
                    const uint32_t a = find_root(part.data(), v), b = find_root(part.data(), w);
                    const uint32_t x = top[a], y = top[b];
                    if (a != b) {
                        const uint32_t ends = higher(x, y) ? y : x, stays = higher(x, y) ? x : y;
                        const double persistence = height_[ends] - height_[v];
                        if (persistence > least_ && !tips_.push({ends, persistence})) return false;
                        unite(part.data(), a, b);
                        top[find_root(part.data(), a)] = stays;
                    }
                }
            }
        }
        if (!tips_.push({falling[0], HUGE_VAL})) return false;
        heap_sort(tips_.data(), tips_.size(), [](const Tip& a, const Tip& b) {
            return a.persistence != b.persistence ? a.persistence > b.persistence : a.vertex < b.vertex;
        });
        while (tips_.size() > most_) tips_.pop();
        return true;
    }

    Done add_far_tip() {
        uint32_t last = 0;
        if (tips_.size() > 1) return true;
        return distances_.search(tips_[0].vertex, nullptr, last) && tips_.push({last, 0});
    }

    Done add(uint32_t v, Array<uint32_t>& marks) {
        if (v == NONE || used_[v]) return true;
        used_[v] = 1;
        return marks.push(v);
    }

    uint32_t first_unused() const {
        uint32_t v = 0;
        while (used_[v]) ++v;
        return v;
    }

    const Mesh& mesh_;
    Call& call_;
    Memory& memory_;
    EdgeDistances distances_;
    Array<double> nearest_, height_; // per vertex
    Array<uint8_t> used_;
    Array<Tip> tips_;
    double least_ = 0;
    const size_t most_;
};

// Where the square of the boundary is less than this part of the area, a disk is a sphere with a small hole.
constexpr double SHORT_BOUNDARY = 2;

// The boundary of a disk in order, by the caller's numbers; h is its double.
Done boundary_of_disk(const hmf_hierarchy& h, Array<uint32_t>& boundary, Call& call) {
    const size_t m = h.surface_triangles;
    Array<uint32_t> next;
    if (!next.allocate_filled(call.memory, h.surface_vertices, NONE)) return false;
    uint32_t first = NONE;
    for (size_t t = 0; t < m; ++t)
        for (size_t s = 0; s < 3; ++s) {
            // A side is its own image.
            if (h.triangle_edges[3 * t + s] != h.triangle_edges[3 * (m + t) + 2 - s]) continue;
            const uint32_t v = h.triangle_vertices[3 * t + s];
            next[v] = h.triangle_vertices[3 * t + (s + 1) % 3];
            first = std::min(first, v);
        }
    boundary.start(call.memory);
    uint32_t v = first;
    do {
        if (!boundary.push(v)) return false;
        v = next[v];
    } while (v != first);
    return true;
}

// Four vertices that divide the boundary of a disk into about equal lengths, the
// first as far from its middle as can be.  None if the boundary is short.
Done corners_of_disk(const hmf_hierarchy& h, Array<uint32_t>& marks, Call& call) {
    Array<uint32_t> boundary;
    if (!boundary_of_disk(h, boundary, call)) return false;
    const size_t n = boundary.size();
    const auto at = [&](size_t k) { return h.levels[0].position + size_t{3} * h.vertex_internal[boundary[k % n]]; };
    const auto distance = [](const double* a, const double* b) {
        double sum = 0;
        for (int c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
        return std::sqrt(sum);
    };
    double middle[3] = {0, 0, 0}, length = 0, area = 0;
    for (size_t k = 0; k < n; ++k) {
        for (int c = 0; c < 3; ++c) middle[c] += at(k)[c] / static_cast<double>(n);
        length += distance(at(k), at(k + 1));
    }
    for (size_t t = 0; t < h.surface_triangles; ++t) {
        const double* x[3];
        for (size_t s = 0; s < 3; ++s)
            x[s] = h.levels[0].position + size_t{3} * h.vertex_internal[h.triangle_vertices[3 * t + s]];
        const double a = distance(x[0], x[1]), b = distance(x[1], x[2]), c = distance(x[2], x[0]);
        const double square = (a + b + c) * (b + c - a) * (c + a - b) * (a + b - c);
        area += square > 0 ? 0.25 * std::sqrt(square) : 0;
    }
    if (n < 4 || length * length < SHORT_BOUNDARY * area) return true;
    size_t first = 0;
    for (size_t k = 1; k < n; ++k)
        if (distance(at(k), middle) > distance(at(first), middle)) first = k;
    double sum = 0;
    for (size_t k = 0; k < n && marks.size() < 4; ++k) {
        // As many vertices are left as marks are missing, or the next vertex is farther from the place.
        const double side = distance(at(first + k), at(first + k + 1));
        const double place = 0.25 * length * static_cast<double>(marks.size());
        if (n - k <= 4 - marks.size() || sum + 0.5 * side >= place)
            if (!marks.push(boundary[(first + k) % n])) return false;
        sum += side;
    }
    return true;
}

} // namespace

Done limb_tips(const Mesh& mesh, const double* position, Call& call, Array<uint32_t>& tips, Array<uint32_t>& ends) {
    Suggestion suggestion(mesh, position, MOST_TIPS, call);
    Array<uint32_t> marks;
    tips.start(call.memory);
    ends.start(call.memory);
    marks.start(call.memory);
    if (!suggestion.find_limbs()) return false;
    for (const Tip& tip : suggestion.tips()) {
        const size_t n = marks.size();
        if (!suggestion.add_pair(tip.vertex, marks) || !tips.push(tip.vertex)) return false;
        const bool found = marks.size() == n + 2;
        if (!ends.push(found ? marks[n] : NONE) || !ends.push(found ? marks[n + 1] : NONE)) return false;
    }
    return true;
}

namespace {

// A level with few vertices, all of them the caller's.
hmf_status build_coarse(hmf_hierarchy& h, const double* positions, size_t vertex_count, size_t stride,
                        const uint32_t* triangles, size_t triangle_count, const BuildOptions& options, Call& call) {
    BuildOptions coarse;
    coarse.collapse = HMF_COLLAPSE_ENDPOINT;
    coarse.ratio = 0.25;
    coarse.coarsest = VERTICES;
    coarse.mollify = options.mollify;
    coarse.sphere_allowed = true;
    return build_hierarchy(h, positions, vertex_count, stride, triangles, triangle_count, coarse, call);
}

// Limbs of a double come twice. both: their pairs are taken from both halves, as seen from the front.
enum class Halves { both, front };

// At the limbs of the coarsest level; vertices of the caller.
hmf_status mark_limbs(const hmf_hierarchy& h, Halves halves, Call& call, Array<uint32_t>& marks) {
    const size_t coarsest = h.level_count - 1;
    const Mesh& mesh = coarsest == 0 ? h.input : h.levels[coarsest].mesh;
    Array<uint32_t> caller;
    const uint32_t vertices = h.input.vertex_count;
    if (!caller.allocate(call.memory, vertices)) return call.out_of_memory();
    for (uint32_t v = 0; v < vertices; ++v) caller[h.vertex_internal[v]] = v;
    const size_t most = halves == Halves::front && h.is_double() ? 2 * MOST_TIPS : MOST_TIPS;
    Suggestion suggestion(mesh, h.levels[coarsest].position, most, call);
    const auto takes = [&](uint32_t v) {
        return halves == Halves::both || !h.is_double() || caller[v] < h.mirror.vertex_count;
    };
    if (!suggestion.find(takes, marks)) return call.stopped();
    size_t count = 0;
    for (size_t k = 0; k < marks.size(); ++k) {
        const uint32_t v = h.mirror.front(caller[marks[k]]);
        bool is_new = true;
        for (size_t i = 0; i < count; ++i) is_new = is_new && marks[i] != v;
        if (is_new) marks[count++] = v;
    }
    while (marks.size() > count) marks.pop();
    return HMF_OK;
}

} // namespace

hmf_status suggest_marks(hmf_hierarchy& h, const double* positions, size_t vertex_count, size_t stride,
                         const uint32_t* triangles, size_t triangle_count, const BuildOptions& options, Call& call,
                         Array<uint32_t>& marks) {
    if (build_coarse(h, positions, vertex_count, stride, triangles, triangle_count, options, call))
        return call.status();
    marks.start(call.memory);
    if (h.genus > 0) return HMF_OK;
    if (h.is_double() && !corners_of_disk(h, marks, call)) return call.out_of_memory();
    return marks.empty() ? mark_limbs(h, Halves::both, call, marks) : HMF_OK;
}

hmf_status marks_at_limbs(hmf_hierarchy& h, const double* positions, size_t vertex_count, size_t stride,
                          const uint32_t* triangles, size_t triangle_count, const BuildOptions& options, Call& call,
                          Array<uint32_t>& marks) {
    if (build_coarse(h, positions, vertex_count, stride, triangles, triangle_count, options, call))
        return call.status();
    return mark_limbs(h, Halves::front, call, marks);
}

} // namespace hmf
