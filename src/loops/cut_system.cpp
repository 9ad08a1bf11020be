// A cut system: genus many disjoint loops that cut the surface into one planar
// piece, each the shortest found (the default loops of [W] 3.3).
//
// Erickson, Whittlesey: Greedy optimal homotopy and homology generators, 2005,
// on the dual graph of the surface cut along the loops found before:
//
//     regions of triangles = nodes,  segments of edges = links.
//
// A cycle in it that visits no region twice is simple and meets no earlier
// loop, however narrow the mesh: loops may run side by side through a triangle.
//
//  1. A spanning tree of the regions and one of the points (vertices, and the
//     shrunk sides of the earlier loops) that crosses none of its links leave
//     2 * genus segments.  Each closes a cycle of points; the set of these that a
//     segment lies on, as the exclusive or of one random word per cycle, is
//     its signature.  The signatures along a cycle of regions cancel if it
//     separates; if they do not, it does not separate.
//  2. Dijkstra from a root, to half the length of the best loop so far.  A link
//     between two reached regions closes a cycle; the shortest with a signature
//     is the shortest non-separating loop through the root.
//     With labels the search runs in the covering where they add up to 0 round
//     each loop: its nodes, states, are regions with a sum of labels.
//  3. Cutting only makes loops longer, so the length found at a root is a lower
//     bound for it later: roots are tried in that order, and mostly few.
#include "../base/disjoint_sets.hpp"
#include "../base/nearest_first.hpp"
#include "cut_surface.hpp"
#include "disjoint.hpp"
#include "dual_length.hpp"
#include "heap_sort.hpp"

#include <cmath>

namespace hmf {

namespace {

constexpr double UNREACHED = HUGE_VAL;
constexpr size_t MOST_STATES = 256; // per region

uint64_t mix(uint64_t x) { // splitmix64
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

struct Root {
    double bound; // no loop through it is shorter
    uint32_t face;
};

class CutSystem {
public:
    CutSystem(const Mesh& mesh, const uint64_t* label, Call& call) : mesh_(mesh), edge_label_(label), call_(call), memory_(call.memory) {}

    hmf_status run(const double* position, Loops& out) {
        const uint32_t genus = (2 + mesh_.edge_count - mesh_.vertex_count - mesh_.face_count) / 2;
        out_ = &out;
        out.offsets.start(memory_);
        out.crossings.start(memory_);
        loop_.start(memory_);
        try_.start(memory_);
        if (!out.offsets.push(0) || !curves_.allocate(mesh_, memory_) || !length_.allocate(memory_, mesh_.edge_count) || !roots_.allocate(memory_, mesh_.face_count) || (edge_label_ && !test_.allocate(mesh_, memory_)))
            return call_.out_of_memory();
        const DualLength length(mesh_, position);
        for (uint32_t e = 0; e < mesh_.edge_count; ++e) length_[e] = length(e);
        spread_roots();
        // Regions settled in all searches: linear in the faces on large meshes.
        const double faces = mesh_.face_count, most = 8e6 + 20 * faces;
        const double wanted = faces * (400 + 6.0 * genus), budget = wanted < most ? wanted : most;
        for (uint32_t k = 0; k < genus; ++k) {
            if (!call_.tick(static_cast<double>(k) / genus, true)) return cancelled();
            if (!curves_.trace(mesh_, memory_) || !cut_.build(mesh_, curves_, true, memory_) || !sign() || !prepare_search())
                return call_.cancelled() ? cancelled() : call_.out_of_memory();
            found_ = false;
            best_ = UNREACHED;
            const double part = static_cast<double>(k + 1) / genus;
            bool searched = search_roots(budget * (0.3 + 0.7 * part), k == 0);
            // A loop that winds a lot needs more room in its covering.
            while (searched && !found_ && starved_ && states_per_region_ < MOST_STATES) {
                states_per_region_ *= 4;
                if (!prepare_search()) return call_.out_of_memory();
                searched = search_roots(budget * (0.3 + 0.7 * part), k == 0);
            }
            if (!searched) return cancelled();
            if (memory_.failure()) return call_.out_of_memory(); // while a loop was tried
            // Labels of a surface that meets itself may leave no loop without crossings.
            if (!found_ && edge_label_)
                return call_.fail(HMF_ERROR_MESH_NOT_EMBEDDED, HMF_ELEMENT_NONE, 0,
                                  "There are no such loops: the surface meets itself. Repair the mesh, or use HMF_LOOPS_CUT or HMF_LOOPS_PANTS.");
            if (!found_) return call_.fail(HMF_ERROR_INTERNAL, HMF_ELEMENT_LOOP, k, "No further loop was found. Please report this.");
            tighten();
            if (call_.cancelled()) return cancelled();
            const size_t begin = out.crossings.size();
            for (uint32_t half_segment : loop_)
                if (!out.crossings.push(cut_.half_edge(half_segment))) return call_.out_of_memory();
            if (!out.offsets.push(out.crossings.size()) || !curves_.add(out.crossings.data() + begin, out.crossings.size() - begin)) return call_.out_of_memory();
            if (curves_.total >= MULTICURVE_LIMIT)
                return call_.fail(HMF_ERROR_UNSUPPORTED, HMF_ELEMENT_LOOP, k, "The loops cross more than 2^29 edges. Use a coarser level.");
        }
        return HMF_OK;
    }

private:
    hmf_status cancelled() { return call_.fail(HMF_CANCELLED, HMF_ELEMENT_NONE, 0, "Cancelled by the progress callback."); }

    // All faces, in an order whose beginnings are spread over the mesh.
    void spread_roots() {
        const uint64_t n = mesh_.face_count;
        uint64_t step = n * 618 / 1000 + 1;
        for (bool again = true; again; step += again) {
            uint64_t a = n, b = step;
            while (b) { const uint64_t c = a % b; a = b; b = c; }
            again = a != 1;
        }
        uint64_t face = 0;
        for (uint64_t i = 0; i < n; ++i, face = (face + step) % n) roots_[i] = {0, static_cast<uint32_t>(face)};
        root_count_ = static_cast<size_t>(n);
    }

    // Step 1: signature_ of every segment.  False: out of memory or cancelled.
    bool sign() {
        const uint32_t regions = cut_.region_count, segments = cut_.segment_count, points = cut_.point_count;
        Array<uint32_t> queue, parent, degree, last;
        Array<uint8_t> kind; // 0: generator or none, 1: tree of regions, 2: tree of points
        Array<uint64_t> value;
        if (!signature_.allocate_filled(memory_, segments, uint64_t{0}) || !queue.allocate(memory_, regions > points ? regions : points) ||
            !parent.allocate(memory_, points) || !degree.allocate_filled(memory_, points, 0u) || !last.allocate_filled(memory_, points, 0u) ||
            !kind.allocate_filled(memory_, segments, uint8_t{0}) || !value.allocate_filled(memory_, points, uint64_t{0}))
            return false;
        Array<uint8_t> reached;
        if (!reached.allocate_filled(memory_, regions, uint8_t{0})) return false;
        size_t begin = 0, end = 0;
        queue[end++] = 0;
        reached[0] = 1;
        while (begin < end) {
            if (begin % 65536 == 0 && !call_.tick(0, true)) return false;
            const uint32_t r = queue[begin++];
            for (uint32_t i = 0; i < 3; ++i) {
                const uint32_t link = cut_.link[3 * size_t{r} + i];
                if (link == NONE) continue;
                const uint32_t to = cut_.region[link ^ 1u];
                if (reached[to]) continue;
                reached[to] = 1;
                kind[link >> 1] = 1;
                queue[end++] = to;
            }
        }
        for (uint32_t p = 0; p < points; ++p) parent[p] = p;
        uint64_t word = 0;
        for (uint32_t s = 0; s < segments; ++s) {
            if (s % 65536 == 0 && !call_.tick(0, true)) return false;
            if (kind[s]) continue;
            const uint32_t p = cut_.point[2 * size_t{s}], q = cut_.point[2 * size_t{s} + 1];
            if (unite(parent.data(), p, q)) {
                kind[s] = 2;
                ++degree[p];
                ++degree[q];
                last[p] ^= s; // once the degree is one, this is the segment left
                last[q] ^= s;
            } else {
                signature_[s] = mix(++word) | 1u;
                value[p] ^= signature_[s];
                value[q] ^= signature_[s];
            }
        }
        // Strip leaves: a segment lies on the cycles that end behind it.
        begin = end = 0;
        for (uint32_t p = 0; p < points; ++p)
            if (degree[p] == 1) queue[end++] = p;
        while (begin < end) {
            if (begin % 65536 == 0 && !call_.tick(0, true)) return false;
            const uint32_t p = queue[begin++];
            if (degree[p] != 1) continue;
            const uint32_t s = last[p];
            const uint32_t q = cut_.point[2 * size_t{s}] == p ? cut_.point[2 * size_t{s} + 1] : cut_.point[2 * size_t{s}];
            signature_[s] = value[p];
            value[q] ^= value[p];
            last[q] ^= s;
            degree[p] = 0;
            if (--degree[q] == 1) queue[end++] = q;
        }
        return true;
    }

    bool prepare_search() {
        const size_t n = cut_.region_count;
        heap_.start(memory_);
        epoch_ = 0;
        starved_ = false;
        const size_t states = edge_label_ ? states_per_region_ * n : n;
        return distance_.allocate(memory_, states) && from_.allocate(memory_, states) && label_.allocate(memory_, states) &&
               stamp_.allocate_filled(memory_, states, 0u) && heap_.reserve(3 * states + 1) && loop_.reserve(states + 1) && try_.reserve(states + 1) &&
               before_.allocate(memory_, states) && sum_.allocate(memory_, states) && next_.allocate(memory_, states) &&
               region_.allocate(memory_, states) && visited_.allocate_filled(memory_, n, 0u);
    }

    // The state of a region with a sum of labels, NONE if there is no room.  A
    // region is its own first state; others follow in a list.
    uint32_t find_state(uint32_t region, uint64_t sum) {
        uint32_t s = region;
        if (!reached(s)) {
            region_[s] = region;
            sum_[s] = sum;
            next_[s] = NONE;
            return s;
        }
        while (sum_[s] != sum) {
            if (next_[s] == NONE) {
                if (state_count_ == region_.size()) {
                    starved_ = true;
                    return NONE;
                }
                const uint32_t made = state_count_++;
                next_[s] = made;
                region_[made] = region;
                sum_[made] = sum;
                next_[made] = NONE;
                stamp_[made] = 0;
            }
            s = next_[s];
        }
        return s;
    }

    // Sum of labels after a link.
    uint64_t sum_after(uint64_t sum, uint32_t link) const {
        if (!edge_label_) return sum;
        const uint64_t label = edge_label_[cut_.segment_edge[link >> 1]];
        return link & 1u ? sum - label : sum + label;
    }

    // 2 * epoch: reached, 2 * epoch + 1: settled.
    bool reached(uint32_t r) const { return stamp_[r] >= 2 * epoch_; }
    bool settled(uint32_t r) const { return stamp_[r] > 2 * epoch_; }

    // Step 2: the shortest non-separating loop through a region, if it is
    // shorter than best_, with the tail to the root stripped, as loop_.
    // Returns the length with the tail, or best_ as it was.
    double search(uint32_t root) {
        ++epoch_;
        heap_.clear();
        state_count_ = cut_.region_count;
        find_state(root, 0);
        distance_[root] = 0;
        from_[root] = NONE;
        label_[root] = 0;
        stamp_[root] = 2 * epoch_;
        heap_.push({0, root}); // within the reserve: at most one for each link
        double shortest = best_;
        uint32_t closing = NONE, closing_from = NONE, closing_to = NONE;
        while (!heap_.empty()) {
            const NearestFirst::Entry entry = heap_.pop();
            const uint32_t s = entry.item, r = region_[s];
            if (settled(s)) continue;
            if (2 * entry.distance >= shortest) break;
            stamp_[s] = 2 * epoch_ + 1;
            if (++work_ % 16384 == 0 && !call_.tick(0, true)) return best_;
            for (uint32_t i = 0; i < 3; ++i) {
                const uint32_t link = cut_.link[3 * size_t{r} + i];
                if (link == NONE) break;
                const uint32_t to = find_state(cut_.region[link ^ 1u], sum_after(sum_[s], link));
                if (to == NONE) continue;
                const double d = entry.distance + length_[cut_.segment_edge[link >> 1]];
                const uint64_t label = label_[s] ^ signature_[link >> 1];
                if (!settled(to)) {
                    if (reached(to) && !(d < distance_[to])) continue;
                    stamp_[to] = 2 * epoch_;
                    distance_[to] = d;
                    from_[to] = link;
                    before_[to] = s;
                    label_[to] = label;
                    heap_.push({d, to});
                } else if (label != label_[to] && d + distance_[to] < shortest) {
                    shortest = d + distance_[to];
                    closing = link;
                    closing_from = s;
                    closing_to = to;
                }
            }
        }
        if (closing == NONE) return shortest;
        strip(closing, closing_from, closing_to);
        return shortest;
    }

    // The cycle of a link in the search tree:  root ---- o===r
    //                                                     \\  | closing
    //                                                       `=to
    void strip(uint32_t closing, uint32_t r, uint32_t to) {
        ++epoch_; // marks the way from r to the root
        uint32_t meet = r;
        for (;;) {
            stamp_[meet] = 2 * epoch_;
            if (from_[meet] == NONE) break;
            meet = before_[meet];
        }
        meet = to;
        while (!reached(meet)) meet = before_[meet];
        try_.clear();
        double total = length_[cut_.segment_edge[closing >> 1]];
        for (uint32_t at = r; at != meet; at = before_[at]) try_.push(from_[at]);
        for (size_t i = 0, j = try_.size(); i + 1 < j; ++i) {
            --j;
            const uint32_t link = try_[i];
            try_[i] = try_[j];
            try_[j] = link;
        }
        try_.push(closing);
        for (uint32_t at = to; at != meet; at = before_[at]) try_.push(from_[at] ^ 1u);
        for (uint32_t link : try_) total += length_[cut_.segment_edge[link >> 1]];
        total -= length_[cut_.segment_edge[closing >> 1]];
        if (found_ && !(total < best_)) return;
        if (edge_label_ && !is_simple()) return;
        found_ = true;
        best_ = total;
        loop_.swap(try_);
    }

    // A loop is simple in the covering; is it so here?  It may run through a
    // region twice as long as it can be pushed apart.
    bool is_simple() {
        const Loops& earlier = *out_;
        bool once = true;
        for (uint32_t link : try_) {
            uint32_t& visited = visited_[cut_.region[link]];
            once = once && visited != epoch_;
            visited = epoch_;
        }
        if (once) return true;
        Loops all;
        all.offsets.start(memory_);
        all.crossings.start(memory_);
        for (const uint64_t at : earlier.offsets)
            if (!all.offsets.push(at)) return false;
        for (const uint32_t h : earlier.crossings)
            if (!all.crossings.push(h)) return false;
        for (const uint32_t link : try_)
            if (!all.crossings.push(cut_.half_edge(link))) return false;
        return all.offsets.push(all.crossings.size()) && disjoint(mesh_, all, 0, all.count(), test_, nullptr, memory_) == Answer::yes;
    }

    // Step 3.  The first time the roots are only those that a quarter of the
    // work allows.  False: cancelled.
    bool search_roots(double allowed, bool first) {
        if (!first)
            heap_sort(roots_.data(), root_count_, [](const Root& a, const Root& b) { return a.bound < b.bound || (a.bound == b.bound && a.face < b.face); });
        for (size_t i = 0; i < root_count_; ++i) {
            if (found_ && roots_[i].bound >= best_) break;
            const double limit = first ? allowed * 0.7 : allowed;
            if (found_ && static_cast<double>(work_) >= limit) {
                if (first) root_count_ = i;
                break;
            }
            if (starved_ && !found_ && i >= 4 && states_per_region_ < MOST_STATES) break;
            if (i % 16 == 0 && !call_.tick(0, true)) return false;
            const double bound = search(cut_.region_first[roots_[i].face]);
            if (call_.cancelled()) return false;
            if (bound > roots_[i].bound) roots_[i].bound = bound;
        }
        return true;
    }

    // Again from roots round the loop itself, until none of them gains.
    void tighten() {
        size_t eighth = 1;
        for (int i = 0; i < 24 && eighth < 8; ++i) {
            const double before = best_;
            search(cut_.region[loop_[loop_.size() * eighth / 8]]);
            eighth = best_ < before ? 1 : eighth + 1;
        }
    }

    const Mesh& mesh_;
    const uint64_t* edge_label_; // or NULL
    Call& call_;
    Memory& memory_;
    const Loops* out_ = nullptr; // the loops so far
    Multicurve curves_, test_;
    CutSurface cut_;
    Array<double> length_;       // per edge
    Array<Root> roots_;
    size_t root_count_ = 0;
    Array<uint64_t> signature_;  // per segment
    Array<double> distance_;     // per state, as all below
    Array<uint32_t> from_;       // the half-segment it was reached through, seen from the region before
    Array<uint32_t> before_;     // the state before
    Array<uint64_t> sum_;        // of labels on the way from the root
    Array<uint32_t> region_, next_;
    Array<uint32_t> visited_;    // per region
    uint32_t state_count_ = 0;
    size_t states_per_region_ = 4;
    bool starved_ = false;       // the states did not suffice
    Array<uint64_t> label_;      // signatures on the way from the root
    Array<uint32_t> stamp_;
    uint32_t epoch_ = 0;
    NearestFirst heap_;
    Array<uint32_t> loop_, try_; // half-segments
    double best_ = UNREACHED;    // length of loop_
    bool found_ = false;
    uint64_t work_ = 0;          // regions settled
};

} // namespace

hmf_status cut_system(const Mesh& mesh, const double* position, const uint64_t* label, Call& call, Loops& out) {
    CutSystem system(mesh, label, call);
    return system.run(position, out);
}

} // namespace hmf
