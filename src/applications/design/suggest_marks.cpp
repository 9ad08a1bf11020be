// Where to mark a sphere: tips of limbs are the maxima of the mean distance to
// all of the surface.
//
//        _____            A maximum counts by its persistence: how deep one has
//       /     \__/\       to go down from it on the way to a higher one.  What
//      | body     limb    remains after small ones are left out are limbs.
//       \_____/--\/       At least two tips: the highest, and what is farthest
//                         from it.
//
// Leaves go around a limb if a loop does, and that must have two marked vertices
// on its far side.  So each tip gets a pair: the ends of a diameter of a small
// disk around it, which does not reach far down a thin limb.
//
// All of this on a coarse level, made by collapses to end points: its vertices
// are vertices of the caller.
#include "suggest_marks.hpp"

#include "../../core/base/disjoint_sets.hpp"
#include "../../core/base/heap_sort.hpp"
#include "../common/caller_lists.hpp"
#include "edge_distances.hpp"
#include "disk_corners.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

constexpr uint64_t MARKS_VERTICES = 4000; // of the level that is looked at
constexpr uint32_t BASES = 32;            // points that distances are taken to
constexpr double PERSISTENCE = 0.08;      // least, in mean distances
constexpr size_t MOST_TIPS = 12;          // those of largest persistence
constexpr size_t MOST_CORNERS = 24;       // of the boundary: a jagged one has no corners
constexpr EdgeDistances::DiskLimit DISK{10, 4e-3, 1.2};

struct MarkTip {
    uint32_t vertex;
    double persistence;
};

class Suggestion {
public:
    Suggestion(const Mesh& mesh, const double* position, size_t most, Call& call) :
        mesh_(mesh), call_(call), memory_(call.memory), distances_(mesh, position, call.memory), most_(most) {}

    // Pairs at the tips that are used, if both ends exist; at least this many marks.
    template <class Takes, class TakesEnd>
    Done find(const Takes& takes, const TakesEnd& takes_end, size_t least, Array<uint32_t>& marks) {
        marks.start(memory_);
        if (!find_limbs()) return false;
        for (const MarkTip& tip : tips_) {
            const size_t before = marks.size();
            if (!takes(tip.vertex)) continue;
            if (!add_pair(tip.vertex, marks)) return false;
            bool stays = true;
            for (size_t k = before; k < marks.size(); ++k) stays = stays && takes_end(marks[k]);
            while (!stays && marks.size() > before) marks.pop();
        }
        while (marks.size() < least && marks.size() < mesh_.vertex_count) // a mesh of a few vertices
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

    const Array<MarkTip>& tips() const { return tips_; }

    // The ends of a diameter of the disk around the tip, if there is one.
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
        heap_sort(tips_.data(), tips_.size(), [](const MarkTip& a, const MarkTip& b) {
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
    Array<MarkTip> tips_;
    double least_ = 0;
    const size_t most_;
};

} // namespace

Done limb_tips(const Mesh& mesh, const double* position, Call& call, Array<uint32_t>& tips, Array<uint32_t>& ends) {
    Suggestion suggestion(mesh, position, MOST_TIPS, call);
    Array<uint32_t> marks;
    tips.start(call.memory);
    ends.start(call.memory);
    marks.start(call.memory);
    if (!suggestion.find_limbs()) return false;
    for (const MarkTip& tip : suggestion.tips()) {
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
    coarse.coarsest = MARKS_VERTICES;
    coarse.mollify = options.mollify;
    coarse.sphere_allowed = true;
    return build_hierarchy(h, positions, vertex_count, stride, triangles, triangle_count, coarse, call);
}

// Limbs of a double come twice. Everywhere: pairs are taken from both halves, as seen from the front.
enum class Pairs { everywhere, of_front, inside_front };

// At the limbs of the coarsest level; vertices of the caller.
hmf_status mark_limbs(const hmf_hierarchy& h, Pairs pairs, Call& call, Array<uint32_t>& marks) {
    const size_t coarsest = h.level_count - 1;
    const Mesh& mesh = coarsest == 0 ? h.input : h.levels[coarsest].mesh;
    Array<uint32_t> caller;
    if (inverse_numbers(h.vertex_internal, h.input.vertex_count, caller, call)) return call.status();
    const size_t most = pairs != Pairs::everywhere && h.is_double() ? 2 * MOST_TIPS : MOST_TIPS;
    Suggestion suggestion(mesh, h.levels[coarsest].position, most, call);
    const auto takes = [&](uint32_t v) {
        return pairs == Pairs::everywhere || !h.is_double() || caller[v] < h.mirror.vertex_count;
    };
    const auto takes_end = [&](uint32_t v) {
        return pairs != Pairs::inside_front || !h.is_double() || !h.mirror.is_boundary(h.mirror.front(caller[v]));
    };
    if (!suggestion.find(takes, takes_end, pairs == Pairs::everywhere ? 4 : 0, marks)) return call.stopped();
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
    return marks.empty() ? mark_limbs(h, Pairs::everywhere, call, marks) : HMF_OK;
}

hmf_status marks_at(MarksAt where, hmf_hierarchy& h, const double* positions, size_t vertex_count, size_t stride,
                    const uint32_t* triangles, size_t triangle_count, const BuildOptions& options, Call& call,
                    Array<uint32_t>& marks) {
    if (build_coarse(h, positions, vertex_count, stride, triangles, triangle_count, options, call))
        return call.status();
    if (where == MarksAt::corners) {
        marks.start(call.memory);
        return !h.is_double() || corners_of_boundaries(h, MOST_CORNERS, marks, call) ? HMF_OK : call.stopped();
    }
    return mark_limbs(h, where == MarksAt::limbs ? Pairs::of_front : Pairs::inside_front, call, marks);
}

} // namespace hmf
