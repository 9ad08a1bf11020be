#include "necks.hpp"

#include "../../core/base/heap_sort.hpp"
#include "../../core/base/nearest_first.hpp"
#include "../../core/curves/cut_surface.hpp"
#include "../../core/curves/disjoint.hpp"
#include "dual_length.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

namespace {

class Necks {
public:
    Necks(const Mesh& mesh, const double* position, const Loops& cut, ClassLengths& lengths, Call& call) :
        mesh_(mesh), cut_(cut), lengths_(lengths), call_(call), memory_(call.memory), length_(mesh, position) {}

    hmf_status run(Loops& out, bool& crossed) {
        neck_.start(memory_);
        heap_.start(memory_);
        way_.start(memory_);
        walk_.start(memory_);
        if (!out.start(memory_) || !one_.allocate(mesh_, memory_) || !all_.allocate(mesh_, memory_)
            || !loop_length_.allocate(memory_, cut_.count()))
            return call_.out_of_memory();
        double longest = 0;
        for (size_t c = 0; c < cut_.count(); ++c) {
            uint32_t id = 0;
            if (!lengths_.add(cut_.loop(c), cut_.length(c), id) || !lengths_.look_beside(&id, 1))
                return call_.stopped();
            loop_length_[c] = lengths_.length(id);
            longest = std::max(longest, loop_length_[c]);
        }
        for (uint32_t c = 0; c < cut_.count(); ++c) {
            if (!call_.tick(0, true)) return call_.was_cancelled();
            if (!find_way(c)) return call_.stopped();
            if (walk_.empty()) continue;
            uint32_t id = 0;
            if (!lengths_.add(walk_.data(), walk_.size(), id)) return call_.stopped();
            if (lengths_.length(id) < longest && !lengths_.look_beside(&id, 1)) return call_.stopped();
            const double found = lengths_.length(id);
            if (found < longest && !neck_.push({found, id, c})) return call_.out_of_memory();
        }
        heap_sort(neck_.data(), neck_.size(), [](const Neck& a, const Neck& b) {
            return a.length < b.length || (a.length == b.length && a.loop < b.loop);
        });
        return choose(out, crossed) ? HMF_OK : call_.stopped();
    }

private:
    struct Neck {
        double length;
        uint32_t id, loop;
    };

    // walk_: around the handle of a loop, over the shortest way from its left to its right.
    Done find_way(uint32_t c) {
        const uint32_t* const loop = cut_.loop(c);
        const size_t n = cut_.length(c);
        walk_.clear();
        one_.clear();
        if (!one_.add(loop, n) || !one_.trace(mesh_, call_) || !surface_.build(mesh_, one_, true, call_)
            || !distance_.allocate_filled(memory_, surface_.region_count, HUGE_VAL)
            || !from_.allocate_filled(memory_, surface_.region_count, NONE)
            || !left_.allocate_filled(memory_, surface_.region_count, NONE)
            || !right_.allocate_filled(memory_, surface_.region_count, NONE))
            return false;
        if (one_.components.count() != 1) return true;
        // Segments beside each crossing, from the origin of its half-edge: p on the right, p + 1 on the left.
        const uint32_t* const traced = one_.components.loop(0);
        uint32_t h = traced[0], p = one_.begin[0] - one_.first[edge_of(h)];
        if (h & 1u) p = one_.count[edge_of(h)] - 1 - p;
        heap_.clear();
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t e = edge_of(h), count = one_.count[e];
            for (uint32_t is_left = 0; is_left < 2; ++is_left) {
                const uint32_t q = p + is_left, segment = surface_.segment_first[e] + (h & 1u ? count - q : q);
                const uint32_t r = surface_.region[2 * size_t{segment} + (twin(h) & 1u)];
                uint32_t& at = is_left ? left_[r] : right_[r];
                if (at != NONE) continue;
                at = i;
                if (!is_left) continue;
                distance_[r] = 0;
                if (!heap_.push({0, r})) return false;
            }
            one_.step(mesh_, h, p);
        }
        while (!heap_.empty()) {
            const NearestFirst::Entry top = heap_.pop();
            if (top.distance > distance_[top.item]) continue;
            if (right_[top.item] != NONE) return walk_round(traced, n, top.item);
            for (uint32_t i = 0; i < 3; ++i) {
                const uint32_t link = surface_.link[3 * size_t{top.item} + i];
                if (link == NONE) break;
                const uint32_t to = surface_.region[link ^ 1u];
                const double d = top.distance + length_(surface_.segment_edge[link >> 1]);
                if (!(d < distance_[to])) continue;
                distance_[to] = d;
                from_[to] = link;
                if (!heap_.push({d, to})) return false;
            }
        }
        return true; // the loop separates
    }

    // The way ends in this region.
    Done walk_round(const uint32_t* loop, size_t n, uint32_t end) {
        way_.clear();
        uint32_t r = end;
        for (; from_[r] != NONE; r = surface_.region[from_[r]])
            if (!way_.push(surface_.half_edge(from_[r]))) return false;
        std::reverse(way_.begin(), way_.end());
        const size_t i = left_[r], j = right_[end];
        for (size_t k = 1; k <= n; ++k)
            if (!walk_.push(loop[(i + k) % n])) return false;
        for (const uint32_t h : way_)
            if (!walk_.push(h)) return false;
        for (size_t k = 0; k < n; ++k)
            if (!walk_.push(twin(loop[(j + n - k) % n]))) return false;
        for (size_t k = way_.size(); k-- > 0;)
            if (!walk_.push(twin(way_[k]))) return false;
        size_t begin = 0, last = 0;
        remove_backtracking(walk_, begin, last);
        for (size_t k = begin; k < last; ++k) walk_[k - begin] = walk_[k];
        while (walk_.size() > last - begin) walk_.pop();
        return true;
    }

    // Does a neck meet the loops of the cut system that are shorter, or longer, than it, as they lie?
    Done meets(const Neck& neck, bool shorter, bool& answer) {
        Loops together;
        if (!together.start(memory_)) return false;
        for (size_t c = 0; c < cut_.count(); ++c)
            if ((loop_length_[c] < neck.length) == shorter && !together.add(cut_, c)) return false;
        return meets_loops(neck, together, answer);
    }

    Done meets_loops(const Neck& neck, Loops& loops, bool& answer) {
        bool are_disjoint = false;
        if (!loops.add(lengths_.pulled(neck.id), lengths_.pulled_size(neck.id))
            || !last_is_disjoint(mesh_, loops, all_, call_, are_disjoint))
            return false;
        answer = !are_disjoint;
        return true;
    }

    Done choose(Loops& out, bool& crossed) {
        crossed = false;
        for (const Neck& neck : neck_) {
            bool meets_shorter = false, meets_longer = false, meets_necks = false;
            if (!meets(neck, true, meets_shorter) || !meets(neck, false, meets_longer)) return false;
            if (meets_shorter) continue;
            if (!meets_loops(neck, out, meets_necks)) return false;
            if (meets_necks) out.keep_first(out.count() - 1);
            else crossed |= meets_longer;
        }
        return true;
    }

    const Mesh& mesh_;
    const Loops& cut_;
    ClassLengths& lengths_;
    Call& call_;
    Memory& memory_;
    DualLength length_;
    Array<Neck> neck_;
    Array<double> loop_length_;
    Multicurve one_, all_;
    CutSurface surface_;
    NearestFirst heap_;
    Array<double> distance_;                           // per region, from the left of the loop
    Array<uint32_t> from_, left_, right_, way_, walk_; // link to a region; crossing of the loop beside it
};

} // namespace

hmf_status find_necks(const Mesh& mesh, const double* position, const Loops& cut, ClassLengths& lengths, Call& call,
                      Loops& out, bool& crossed) {
    Necks necks(mesh, position, cut, lengths, call);
    return necks.run(out, crossed);
}

} // namespace hmf
