// A basis of the homology from a cut system: one after another, a loop a_j is replaced by a loop b_j that crosses it
// once and meets neither the b before it nor the a that are left. It is a path in the surface cut along all of these,
// from one side of a_j to the other, and exists as they do not separate. So <a_i, b_j> is 0 for i > j and 1 or -1 for
// i = j, in the order of the replacements.
//
// One cut serves for all paths that share no region.
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
        if (!cut_.build(mesh_, curves_, true, call_) || !queue_.allocate(memory_, cut_.region_count)
            || !reached_.allocate(memory_, cut_.region_count)
            || !stamped_.allocate_filled(memory_, cut_.region_count, 0u))
            return call_.stopped();
        return HMF_OK;
    }

    // Of the loops that are left, until their searches have passed the surface several times.
    Done find_dual_loops(Loops& ordered) {
        Array<uint32_t> later, path;
        later.start(memory_);
        path.start(memory_);
        size_t passed = 0, i = 0;
        for (; i < left_.size() && passed < CHOICE_ROUNDS * cut_.region_count; ++i) {
            const uint32_t k = left_[i];
            if (!cross_once(component_of_[made_ + i], static_cast<uint32_t>(i + 1), path, passed)
                || !call_.work(64 * path.size()))
                return false;
            size_t begin = 0, end = 0;
            remove_backtracking(path, begin, end);
            if (begin == end ? !later.push(k) : !out_.add(path.data() + begin, end - begin) || !ordered.add(loops_, k))
                return false;
        }
        for (; i < left_.size(); ++i)
            if (!later.push(left_[i])) return false;
        left_.swap(later);
        return true;
    }

    // The shortest path from the left of a component to its right through regions that no other path of this cut
    // passes, as crossings; empty: there is none.
    Done cross_once(size_t component, uint32_t stamp, Array<uint32_t>& path, size_t& passed) {
        // At its first crossing, on the side where it comes in.
        const uint32_t crossing = curves_.begin[component],
                       e = edge_of(curves_.components.crossings[curves_.components.offsets[component]]);
        const size_t segment = cut_.segment_first[e] + (crossing - curves_.first[e]);
        const uint32_t from = cut_.region[2 * segment + 1], to = cut_.region[2 * segment + 3];
        path.clear();
        if (stamped_[from] == TAKEN || stamped_[to] == TAKEN) return true;
        size_t begin = 0, end = 0;
        bool found = false;
        queue_[end++] = from;
        stamped_[from] = stamp;
        while (begin < end && !found) {
            const uint32_t r = queue_[begin++];
            for (uint32_t i = 0; i < 3; ++i) {
                const uint32_t link = cut_.link[3 * size_t{r} + i];
                if (link == NONE) break;
                const uint32_t next = cut_.region[link ^ 1u];
                if (stamped_[next] == stamp || stamped_[next] == TAKEN) continue;
                stamped_[next] = stamp;
                reached_[next] = link;
                queue_[end++] = next;
                found |= next == to;
            }
        }
        passed += end;
        if (!call_.work(8 * end)) return false;
        if (stamped_[to] != stamp) return true;
        stamped_[from] = TAKEN;
        for (uint32_t r = to; r != from; r = cut_.region[reached_[r]]) {
            stamped_[r] = TAKEN;
            if (!path.push(reached_[r])) return false;
        }
        std::reverse(path.begin(), path.end());
        for (uint32_t& link : path) link = cut_.half_edge(link);
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
    Array<uint32_t> queue_, reached_, stamped_;
};

} // namespace

hmf_status dual_loops(const Mesh& mesh, Loops& loops, Call& call, Loops& out) {
    DualLoops dual(mesh, loops, out, call);
    return dual.run();
}

} // namespace hmf
