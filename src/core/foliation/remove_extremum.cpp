// Moves an extremum, a disk with all else in one direction of the tree, until it has a second direction.
//
//      x   x   x            x   x   x
//       \  |  /              \  |  /            u, the nearest neighbor, joins the cluster C.  From there it has
//        \ u /       ->       \ | /             another direction, or it moves on.
//         \|/                  C=u
//          C
//
// Every edge out of the cluster gets shorter by the distance that it has moved, an edge with both ends in it by twice
// that much, and the corner coordinate between two of them by that much.  So the distances at which an edge becomes
// zero or a corner closes are known when the vertex joins, and wait in a queue.  A vertex that joins costs its valence
// times a logarithm, however large the cluster is.  Until the end, values are stored as of distance 0: edges that
// were n times longer before the cluster moved by d are stored with n d added.
#include "foliation.hpp"

namespace hmf {

namespace {

class ExtremumMove {
public:
    ExtremumMove(Foliation& f, Call* call) : f_(f), mesh_(f.mesh), call_(call), oldest_(f.epoch) {}

    // Moves the cluster in f.members, a disk without closed corner and marked vertex, until it may be no extremum.
    // false: it can go no further, out of memory or cancelled.
    bool run(int64_t euler) {
        f_.queue.clear();
        euler_ = euler;
        newest_ = oldest_;
        Done goes_on = scan(0);
        while (goes_on && !is_done_ && !is_stuck_ && !f_.queue.empty())
            goes_on = step() && (!call_ || call_->work(8 * f_.take_walked()));
        for (const uint32_t v : f_.members)
            for (const uint32_t h : mesh_.around(v))
                if (f_.at(h) != 0) f_.value[edge_of(h)] -= moved_;
        return goes_on && is_done_ && moved_ > 0;
    }

private:
    bool is_member(uint32_t v) const { return f_.stamp[v] >= oldest_; }
    bool is_new(uint32_t v) const { return f_.stamp[v] == newest_; }
    int64_t length(uint32_t h) const {
        const int64_t stored = f_.at(h);
        const int64_t ends = is_member(mesh_.origin[h]) + is_member(mesh_.target(h));
        return stored == 0 ? 0 : stored - ends * moved_;
    }

    // To the next distance at which something happens.
    Done step() {
        moved_ = f_.queue.top().distance;
        newest_ = ++f_.epoch;
        const size_t first = f_.members.size();
        while (!f_.queue.empty() && f_.queue.top().distance == moved_) {
            const uint32_t h = f_.queue.pop().item;
            f_.walked += STEPS_OF_QUEUE;
            if (f_.at(h) == 0) continue; // its end has joined
            if (length(h) > 0) {
                if (!wait_for(h, length(h), length(mesh_.rotate_ccw(h)))) return false;
                continue;
            }
            if (!is_member(mesh_.target(h))) join(mesh_.target(h));
            is_done_ |= f_.at(h) != 0; // around a handle
            f_.value[edge_of(h)] = 0;
        }
        return scan(first);
    }

    void join(uint32_t v) {
        for (const uint32_t h : mesh_.around(v)) {
            int64_t& stored = f_.value[edge_of(h)];
            if (length(h) == 0) stored = 0;
            else stored += moved_;
        }
        f_.stamp[v] = newest_;
        f_.members.add(v);
        is_done_ |= mesh_.is_marked(v);
    }

    // Vertices that are new in the cluster, from this one on, and what joins with them.
    Done scan(size_t first) {
        uint64_t edges = 0, triangles = 0; // times 2, and times 6: each is met from all of its ends that are new
        for (size_t i = first; i < f_.members.size(); ++i)
            for (const uint32_t h : mesh_.around(f_.members[i])) {
                ++f_.walked;
                const uint32_t ahead = mesh_.rotate_ccw(h);
                const int64_t here = length(h), there = length(ahead);
                if (here > 0) {
                    if (!wait_for(h, here, there)) return false;
                    continue;
                }
                const uint32_t end = mesh_.target(h), next = mesh_.target(ahead);
                if (!is_member(end)) join(end);
                edges += is_new(end) ? 1 : 2;
                if (there > 0 || length(mesh_.next[h]) > 0) continue;
                if (!is_member(next)) join(next);
                triangles += 6 / (1 + is_new(end) + is_new(next));
            }
        if (first > 0)
            euler_ += static_cast<int64_t>(f_.members.size() - first) - static_cast<int64_t>(edges / 2)
                    + static_cast<int64_t>(triangles / 6);
        is_done_ |= euler_ < 1;
        return true;
    }

    // For the corner between h and the next half-edge, which is closed before either of them is zero, or for h.
    Done wait_for(uint32_t h, int64_t here, int64_t there) {
        const bool both = is_member(mesh_.target(h));
        int64_t left = both ? here / 2 : here;
        if (there > 0) left = (here + there - length(mesh_.next[h])) / 2;
        if (left <= 0) {
            (there > 0 ? is_done_ : is_stuck_) = true; // stuck: half a unit between both ends
            return true;
        }
        f_.walked += STEPS_OF_QUEUE;
        return f_.queue.push({moved_ + left, h});
    }

    static constexpr uint64_t STEPS_OF_QUEUE = 4;

    Foliation& f_;
    const Mesh& mesh_;
    Call* call_;
    uint32_t oldest_, newest_ = 0; // stamps of the members, and of those that came last
    int64_t moved_ = 0, euler_ = 1;
    bool is_done_ = false, is_stuck_ = false;
};

} // namespace

bool remove_extremum(Foliation& f, uint32_t vertex, Call* call) {
    // Each round ends with another cluster.
    for (uint32_t round = 0; round <= f.mesh.vertex_count; ++round) {
        const Cluster cluster = explore_cluster(f, vertex, ClusterSearch().up_to_corners(2));
        if (!cluster.is_pole()) return true;
        if (cluster.closed_corners == 1 || cluster.marked > 0) return false;
        if (!ExtremumMove(f, call).run(cluster.euler)) return false;
    }
    return false;
}

} // namespace hmf
