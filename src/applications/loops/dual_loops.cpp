// A basis of the homology from a cut system: one after another, a loop a_j is replaced by a loop b_j that crosses it
// once and meets neither the b before it nor the a that are left. It is a path in the surface cut along all of these,
// from one side of a_j to the other, and exists as they do not separate. So <a_i, b_j> is 0 for i > j and 1 or -1 for
// i = j, in the order of the replacements.
//
// One cut serves for all paths that share no region. Once a_j is replaced, paths may cross it. Those that have the
// shortest way in a tree of the regions come first: then a path is short, as it runs through loops that lie before it,
//
//      _____________________
//     |  | a1 | a2 | a3 |         b3 around one hole, through a2; without that it would go around three.
//     |__|____|____|____|_
#include "../../core/base/heap_sort.hpp"
#include "../../core/curves/cut_surface.hpp"
#include "../../core/curves/disjoint.hpp"
#include "find_loops.hpp"
#include "loop_parameters.hpp"

#include <algorithm>

namespace hmf {

namespace {

class DualLoops {
public:
    DualLoops(const Mesh& mesh, Loops& loops, Loops& out, Call& call) :
        mesh_(mesh), loops_(loops), out_(out), call_(call), memory_(call.memory) {}

    hmf_status run() {
        Loops ordered;
        left_.start(memory_);
        for (uint32_t k = 0; k < loops_.count(); ++k)
            if (!left_.push(k)) return call_.out_of_memory();
        if (!out_.start(memory_) || !ordered.start(memory_) || !curves_.allocate(mesh_, memory_))
            return call_.out_of_memory();
        while (!left_.empty()) {
            if (!call_.tick(0, true)) return call_.was_cancelled();
            if (const hmf_status status = cut()) return status;
            if (!find_dual_loops(ordered)) return call_.stopped();
            if (out_.count() == made_)
                return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, left_[0],
                                  "No dual loop was found. Please report this.");
        }
        loops_.swap(ordered);
        return HMF_OK;
    }

private:
    // Along the dual loops that there are and the loops that are left.
    hmf_status cut() {
        Loops all;
        Array<uint32_t> loop_of;
        made_ = out_.count();
        if (!all.copy_from(out_, memory_)) return call_.out_of_memory();
        for (const uint32_t k : left_)
            if (!all.add(loops_, k)) return call_.out_of_memory();
        bool are_disjoint = false;
        if (!disjoint(mesh_, all, 0, all.count(), curves_, &loop_of, call_, are_disjoint)
            || !component_of_.allocate(memory_, all.count()))
            return call_.out_of_memory();
        if (!are_disjoint)
            return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, made_,
                              "Dual loops are not disjoint. Please report this.");
        for (uint32_t c = 0; c < all.count(); ++c) component_of_[loop_of[c]] = c;
        return cut_.build(mesh_, curves_, true, call_) && order_left() ? HMF_OK : call_.stopped();
    }

    // Those that are left, by the ways from side to side in the tree.
    Done order_left() {
        const uint32_t n = cut_.region_count;
        Array<uint32_t> depth;
        if (!queue_.allocate(memory_, n) || !from_.allocate(memory_, n) || !depth.allocate(memory_, n)
            || !across_.allocate(memory_, n) || !stamped_.allocate_filled(memory_, n, 0u)
            || !is_open_.allocate_filled(memory_, curves_.components.count(), uint8_t{0}))
            return false;
        size_t passed = 0;
        if (!spread(0, NONE, 1, passed)) return false;
        depth[0] = 0;
        for (size_t i = 1; i < passed; ++i) depth[queue_[i]] = depth[from_[queue_[i]]] + 1;
        order_.start(memory_);
        for (uint32_t i = 0; i < left_.size(); ++i) {
            uint32_t r = 0, q = 0, length = 0;
            sides(component_of_[made_ + i], r, q);
            for (; r != q; ++length) {
                uint32_t& deeper = depth[r] > depth[q] ? r : q;
                deeper = from_[deeper];
            }
            if (!order_.push({length, i}) || !call_.work(4 * (size_t{length} + 1))) return false;
        }
        heap_sort(order_.data(), order_.size(), [](const Place& a, const Place& b) {
            return a.length < b.length || (a.length == b.length && a.at < b.at);
        });
        return stamped_.allocate_filled(memory_, n, 0u);
    }

    // Of the loops that are left, until their searches have passed the surface several times.
    Done find_dual_loops(Loops& ordered) {
        Array<uint32_t> later, path;
        later.start(memory_);
        path.start(memory_);
        size_t passed = 0, i = 0;
        for (; i < order_.size() && passed < CHOICE_ROUNDS * cut_.region_count; ++i) {
            const uint32_t k = left_[order_[i].at], component = component_of_[made_ + order_[i].at];
            if (!cross_once(component, static_cast<uint32_t>(i + 1), path, passed) || !call_.work(64 * path.size()))
                return false;
            size_t begin = 0, end = 0;
            remove_backtracking(path, begin, end);
            is_open_[component] = begin != end;
            if (begin == end ? !later.push(k) : !out_.add(path.data() + begin, end - begin) || !ordered.add(loops_, k))
                return false;
        }
        for (; i < order_.size(); ++i)
            if (!later.push(left_[order_[i].at])) return false;
        left_.swap(later);
        return true;
    }

    // The regions on the left and on the right of a component, at its first crossing, on the side where it comes in.
    void sides(size_t component, uint32_t& left, uint32_t& right) const {
        const uint32_t crossing = curves_.begin[component],
                       e = edge_of(curves_.components.crossings[curves_.components.offsets[component]]);
        const size_t segment = cut_.segment_first[e] + (crossing - curves_.first[e]);
        left = cut_.region[2 * segment + 1];
        right = cut_.region[2 * segment + 3];
    }

    // Breadth first, from a region until `to` is reached, across edges and open loops, not through regions of paths.
    Done spread(uint32_t root, uint32_t to, uint32_t stamp, size_t& passed) {
        size_t begin = 0, end = 0;
        const auto reach = [&](uint32_t region, uint32_t from, uint32_t across) {
            if (stamped_[region] == stamp || stamped_[region] == TAKEN) return;
            stamped_[region] = stamp;
            from_[region] = from;
            across_[region] = across;
            queue_[end++] = region;
        };
        reach(root, NONE, NONE);
        while (begin < end && (to == NONE || stamped_[to] != stamp)) {
            const uint32_t r = queue_[begin++];
            for (uint32_t i = 0; i < 3; ++i) {
                const uint32_t link = cut_.link[3 * size_t{r} + i];
                if (link == NONE) break;
                reach(cut_.region[link ^ 1u], r, link);
                // In the triangle, past the loop at either end of the segment.
                const uint32_t e = cut_.segment_edge[link >> 1], place = (link >> 1) - cut_.segment_first[e];
                if (curves_.count[e] == 0) continue;
                const uint32_t crossing = curves_.first[e] + place;
                if (place > 0 && is_open_[curves_.strand[crossing - 1] >> 1]) reach(cut_.region[link - 2], r, NONE);
                if (place < curves_.count[e] && is_open_[curves_.strand[crossing] >> 1])
                    reach(cut_.region[link + 2], r, NONE);
            }
        }
        passed += end;
        return call_.work(8 * end);
    }

    // The shortest path from the left of a component to its right, as crossings; empty: there is none.
    Done cross_once(size_t component, uint32_t stamp, Array<uint32_t>& path, size_t& passed) {
        uint32_t from = 0, to = 0;
        sides(component, from, to);
        path.clear();
        if (stamped_[from] == TAKEN || stamped_[to] == TAKEN) return true;
        if (!spread(from, to, stamp, passed)) return false;
        if (stamped_[to] != stamp) return true;
        for (uint32_t r = to; r != NONE; r = from_[r]) {
            stamped_[r] = TAKEN;
            if (across_[r] != NONE && !path.push(cut_.half_edge(across_[r]))) return false;
        }
        std::reverse(path.begin(), path.end());
        return true;
    }

    static constexpr uint32_t TAKEN = NONE; // stamp of the regions of paths

    const Mesh& mesh_;
    Loops& loops_;
    Loops& out_;
    Call& call_;
    Memory& memory_;
    size_t made_ = 0; // dual loops before this cut
    Multicurve curves_;
    CutSurface cut_;
    Array<uint32_t> left_;         // loops without a dual loop
    Array<uint32_t> component_of_; // of curves_: dual loops, then loops that are left
    struct Place {
        uint32_t length, at;
    };
    Array<Place> order_;     // of left_
    Array<uint8_t> is_open_; // per component: replaced
    // Per region: that before it, and the half-segment between them, or NONE in a triangle.
    Array<uint32_t> queue_, from_, across_, stamped_;
};

} // namespace

hmf_status dual_loops(const Mesh& mesh, Loops& loops, Call& call, Loops& out) {
    DualLoops dual(mesh, loops, out, call);
    return dual.run();
}

} // namespace hmf
