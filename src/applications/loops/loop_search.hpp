// The shortest loop that does not separate, through a region of a cut surface.
//
// Dijkstra from the region, its root, on the dual graph
//
//     regions of triangles = nodes,  segments of edges = links.
//
// A link between two reached regions closes a cycle; the shortest with a
// signature (signatures.hpp), with the way from the root to it and back, is the result, with the shortest loop of each
// other signature that is at most SLACK times as long, because the length of a strip is not that of the curves in it.
// With labels the search runs in the covering where they add up to 0 around each
// loop: its nodes, states, are regions with a sum of labels.
//
// A search bounds the loops through all regions that it reached: if
// none through the root is shorter than L, none through a region at distance d
// is shorter than L - 2 d.  Regions whose bound exceeds the wanted length are not entered.
#pragma once

#include "../../core/base/heap_sort.hpp"
#include "../common/nearest_first_rounded.hpp"
#include "find_loops.hpp"
#include "loop_parameters.hpp"
#include "signatures.hpp"

#include <algorithm>

namespace hmf {

class LoopSearch {
public:
    // edge_length: per edge.  edge_label: of a LoopCondition, or NULL.
    LoopSearch(const CutSurface& cut, const Array<double>& edge_length, const uint64_t* edge_label, Call& call) :
        cut_(cut), edge_length_(edge_length), edge_label_(edge_label), call_(call) {}

    // For a new cut; all bounds become 0.
    Done prepare(const Signatures& signatures, size_t states_per_region);

    // Searches for loops through the root that are shorter than `limit`, including the path from the root to them and
    // back, and updates the bounds. Loops shorter than `kept` are always reported.
    Done search(uint32_t root, double limit, double kept = 0);
    // The loops found, shortest first: cycles of half-segments, not longer.
    size_t count() const { return closings_.size(); }
    Done strip(size_t i, Array<uint32_t>& found);
    uint64_t signature(size_t i) const { return closings_[i].signature; }

    struct Cycle {
        double length;
        size_t first, size; // of its half-segments
    };
    // Short cycles through all segments with a signature, shortest first: shorter than `kept`, or at most SLACK times
    // as long as the best one, whose length becomes `best`, at first that of a known strip.  No search with more than
    // `allowed` regions settled, from a region that is no root, around which all cycles are longer than roots * best
    // and kept, or that is near another root: apart * best.  links: their half-segments are appended.
    template <class IsRoot, class IsWanted>
    Done find_cycles(double roots, double apart, double kept, double allowed, IsRoot is_root, IsWanted is_wanted,
                     double& best, Array<uint32_t>& links, Array<Cycle>& cycles) {
        uint32_t done = NONE;
        cycles.clear();
        for (uint32_t s = 0; s < cut_.segment_count; ++s) {
            if (!call_.work(4)) return false;
            if (!signatures_->of[s]) continue;
            const uint32_t r = cut_.region[2 * size_t{s}];
            if (r == done || !is_root(r) || bound(r) >= std::max(roots * best, kept)
                || nearest_root(r) < apart * std::max(best, kept))
                continue;
            if (static_cast<double>(work_) >= allowed) break;
            done = r;
            if (!search(r, std::max(SLACK * best, kept), kept)) return false;
            for (size_t i = 0; i < count(); ++i) {
                if (!is_wanted(signature(i))) continue;
                if (!strip(i, cycle_)) return false;
                double total = 0;
                for (const uint32_t link : cycle_) total += edge_length_[cut_.segment_edge[link >> 1]];
                best = std::min(best, total);
                if (!(total < std::max(SLACK * best, kept))) continue;
                const size_t first = links.size();
                for (const uint32_t link : cycle_)
                    if (!links.push(link)) return false;
                if (!cycles.push({total, first, cycle_.size()})) return false;
            }
        }
        heap_sort(cycles.data(), cycles.size(), [](const Cycle& a, const Cycle& b) {
            return a.length < b.length || (a.length == b.length && a.first < b.first);
        });
        return true;
    }

    double bound(uint32_t region) const { return bound_[region]; } // no loop through it is shorter
    // Of the nearest root of a search since prepare: its loops are like those through the region.
    double nearest_root(uint32_t region) const { return nearest_root_[region]; }
    uint64_t work() const { return work_; }                     // regions settled
    bool budget_exhausted() const { return budget_exhausted_; } // the states did not suffice, since prepare()

private:
    struct Arc { // from a region; in the order of its links
        double length;
        uint64_t signature;
        uint32_t to, half_segment; // NONE: there is none
    };
    struct SearchState {
        double distance;
        uint64_t signature; // sum on the way from the root
        uint32_t stamp;
        uint32_t region;
        uint32_t before, through; // the state before and the half-segment, seen from there
    };
    struct Closing {
        double length;
        uint64_t signature;
        uint32_t link, from, to; // states
    };
    struct Covered {    // with labels, of a state
        uint64_t label; // sum on the way from the root
        uint32_t place; // in table_
    };

    Done keep(const Closing& closing);
    void raise_bound(uint32_t region, double length) { bound_[region] = std::max(bound_[region], length); }
    uint32_t find_state(uint32_t region, uint64_t label, bool make);
    void clear_states() {
        while (state_count_ > 0) table_[covered_[--state_count_].place] = NONE;
    }
    uint64_t label_after(uint64_t label, uint32_t half_segment) const {
        const uint64_t add = edge_label_[cut_.segment_edge[half_segment >> 1]];
        return half_segment & 1u ? label - add : label + add;
    }

    // 2 * epoch: reached, 2 * epoch + 1: settled.
    bool reached(uint32_t s) const { return state_[s].stamp >= 2 * epoch_; }
    bool settled(uint32_t s) const { return state_[s].stamp > 2 * epoch_; }

    const CutSurface& cut_;
    const Signatures* signatures_ = nullptr;
    const Array<double>& edge_length_;
    const uint64_t* edge_label_;
    Call& call_;
    Array<Arc> arc_;      // three per region
    Array<double> bound_; // per region
    Array<double> nearest_root_;
    Array<SearchState> state_;
    Array<Covered> covered_; // per state
    Array<uint32_t> table_;  // states by region and label, NONE: free
    uint32_t table_shift_ = 0;
    Array<uint32_t> order_; // states as they were settled
    uint32_t state_count_ = 0, epoch_ = 0;
    Array<Closing> closings_;
    Array<uint32_t> cycle_;
    bool budget_exhausted_ = false, exhausted_here_ = false;
    uint64_t work_ = 0;
    NearestFirstRounded heap_;
};

} // namespace hmf
