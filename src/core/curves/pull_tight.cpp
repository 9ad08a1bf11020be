// Removes bigons from loops.  A loop that is simple and disjoint from the others may still form a bigon with an edge:
// it crosses the edge twice and could be pulled off it.
//
//      \   ________   /          A cluster of vertices that no loop separates,
//       \ / a--b   \ /           a disk, with one closed corner (or none that
//        /  |\ |   |             another loop holds): the innermost loop comes
//       (   | \|   )             through the edge opposite to that corner,
//     ---\--c--d--/---           crosses every edge that leaves the cluster,
//         \_|  |_/               and goes back through the same edge.
//           :  :
//
// Its index is positive, so it would be a pole of the initial foliation
// ([W] Eq. 1): the numbers of crossings would be no distances in a tree.  The bigon is removed; each time the number of
// crossings decreases.
//
// Bigons around one cluster are nested. All of them are removed at once: removing an outer one alone would make it
// cross the inner one, and crossing loops are not determined by their numbers of crossings.
//
// A disk without a closed corner would have a loop around it that is not
// essential, so bigons are found at closed corners: opposite to an edge
// that is crossed more than once.
#include "../foliation/foliation.hpp"
#include "../base/heap_sort.hpp"
#include "loops.hpp"

#include <algorithm>

namespace hmf {

namespace {

class Tightener {
public:
    Tightener(const Mesh& mesh, Loops& loops, Call& call) :
        mesh_(mesh), loops_(loops), call_(call), memory_(call.memory) {}

    hmf_status run() {
        if (!weight_.allocate_filled(memory_, loops_.count(), int64_t{2}) || !value_.allocate(memory_, mesh_.edge_count)
            || !foliation_.allocate_scratch(mesh_.vertex_count, memory_))
            return call_.out_of_memory();
        foliation_.mesh = mesh_;
        foliation_.value = value_.data();
        poles_.start(memory_);
        bigon_.start(memory_);
        loop_.start(memory_);
        for (;;) {
            if (!call_.tick(0, true)) return call_.was_cancelled();
            initial_foliation(mesh_, loops_, weight_.data(), value_.data());
            if (!find_poles()) return call_.out_of_memory();
            if (poles_.empty()) return HMF_OK;
            bool removed = false;
            for (const uint32_t v : poles_) {
                bool found = false;
                if (!trace_bigon(v) || !remove_bigon(found)) return call_.out_of_memory();
                removed |= found;
            }
            if (!removed)
                return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, 0,
                                  "The loops could not be pulled tight. Please report this.");
        }
    }

private:
    // The lowest vertices of clusters with positive index.
    Done find_poles() {
        poles_.clear();
        const uint32_t before = foliation_.epoch;
        for (const uint32_t crossing : loops_.crossings) {
            if (foliation_.at(crossing) < 4) continue; // 2 for each crossing
            const uint32_t both[2] = {crossing, twin(crossing)};
            for (const uint32_t h : both) {
                const uint32_t g = mesh_.prev(h), v = mesh_.origin[g];
                if (foliation_.at(g) == 0 || foliation_.at(mesh_.next[h]) == 0 || foliation_.corner2(g) != 0
                    || foliation_.stamp[v] > before)
                    continue;
                const Cluster cluster = explore_cluster(foliation_, v, ClusterSearch().up_to_corners(2));
                if (!cluster.is_pole()) continue;
                uint32_t lowest = v;
                for (const uint32_t u : foliation_.members) lowest = std::min(lowest, u);
                if (!poles_.push(lowest)) return false;
            }
        }
        heap_sort(poles_.data(), poles_.size(), [](uint32_t a, uint32_t b) { return a < b; });
        return true;
    }

    // The half-edges that leave the cluster of v, counter-clockwise from the
    // closed corner, turned round: as the innermost loop crosses them.
    Done trace_bigon(uint32_t v) {
        explore_cluster(foliation_, v);
        bigon_.clear();
        uint32_t first = NONE;
        for (const uint32_t u : foliation_.members) {
            for (const uint32_t h : mesh_.around(u)) {
                const uint32_t ahead = mesh_.rotate_ccw(h);
                if (foliation_.at(h) > 0 && foliation_.at(ahead) > 0 && foliation_.corner2(h) == 0) first = ahead;
            }
        }
        if (first == NONE) return true;
        uint32_t g = first;
        do {
            if (!bigon_.push(twin(g))) return false;
            const uint32_t ahead = mesh_.rotate_ccw(g);
            g = foliation_.at(ahead) > 0 ? ahead : twin(mesh_.next[g]);
        } while (g != first);
        return true;
    }

    // Whether the loop crosses the edges of the bigon from place i on, in either direction.
    bool matches(const uint32_t* loop, size_t n, size_t i) const {
        const size_t m = bigon_.size();
        if (m == 0 || m >= n) return false;
        if (loop[i] == bigon_[0] && matches(loop, n, i, false)) return true;
        return loop[i] == twin(bigon_[m - 1]) && matches(loop, n, i, true);
    }
    bool matches(const uint32_t* loop, size_t n, size_t i, bool reversed) const {
        const size_t m = bigon_.size();
        for (size_t k = 0; k < m; ++k)
            if (loop[i + k < n ? i + k : i + k - n] != (reversed ? twin(bigon_[m - 1 - k]) : bigon_[k])) return false;
        return true;
    }

    // Removes the bigon from all loops that have it.
    Done remove_bigon(bool& found) {
        const size_t m = bigon_.size();
        uint64_t begin = 0, kept = 0; // of the loop; of what is left of the earlier ones
        for (size_t c = 0; c < loops_.count(); ++c) {
            const uint32_t* const loop = loops_.crossings.data() + begin;
            const uint64_t end = loops_.offsets[c + 1];
            const size_t n = static_cast<size_t>(end - begin);
            size_t first = 0;
            while (first < n && !matches(loop, n, first)) ++first;
            size_t from = 0, to = n;
            const uint32_t* left = loop;
            if (first < n) {
                loop_.clear();
                for (size_t k = m; k < n;) {
                    const size_t i = first + k < n ? first + k : first + k - n;
                    if (k + m <= n && matches(loop, n, i)) {
                        k += m;
                        continue;
                    }
                    if (!loop_.push(loop[i])) return false;
                    ++k;
                }
                remove_backtracking(loop_, from, to);
                left = loop_.data();
                found = true;
            }
            if (first < n || kept < begin)
                for (size_t k = from; k < to; ++k) loops_.crossings[kept + (k - from)] = left[k];
            kept += to - from;
            loops_.offsets[c + 1] = kept;
            begin = end;
        }
        while (loops_.crossings.size() > kept) loops_.crossings.pop();
        return true;
    }

    const Mesh& mesh_;
    Loops& loops_;
    Call& call_;
    Memory& memory_;
    Foliation foliation_;
    Array<int64_t> weight_, value_;
    Array<uint32_t> poles_, bigon_, loop_;
};

} // namespace

hmf_status pull_tight(const Mesh& mesh, Call& call, Loops& loops) {
    Tightener tightener(mesh, loops, call);
    return tightener.run();
}

} // namespace hmf
