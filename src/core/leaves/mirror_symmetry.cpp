#include "mirror_symmetry.hpp"

#include "cylinders.hpp"

#include <algorithm>

namespace hmf {

namespace {

constexpr uint32_t MIRROR_STRIDE = 4096;        // steps between two reports
constexpr uint64_t WORK = 8, MOST_WORK = 65536; // half-edges that may be looked at: for each edge, and as many more

class Symmetry {
public:
    Symmetry(Foliation& f, const Reflection& reflection, Call& call) :
        f_(f), mesh_(f.mesh), mirror_(reflection), call_(call) {}

    hmf_status run(Symmetrized& made) {
        bool& exact = made.exact;
        Memory& memory = call_.memory;
        Array<int64_t> before;
        if (!before.allocate(memory, mesh_.edge_count) || !ahead_.allocate_filled(memory, mesh_.vertex_count, NONE)
            || !behind_.allocate_filled(memory, mesh_.vertex_count, NONE)
            || !forward_.allocate_filled(memory, size_t{2} * mesh_.edge_count, uint8_t{0}))
            return call_.out_of_memory();
        circle_.start(memory);
        rings_.start(memory);
        std::memcpy(before.data(), f_.value, mesh_.edge_count * sizeof(int64_t));
        for (uint32_t h = 0; h < 2 * mesh_.edge_count; ++h)
            if (mirror_.on_boundary(h) && mirror_.is_front[h]) {
                ahead_[mesh_.origin[h]] = h;
                behind_[mesh_.target(h)] = twin(h);
            }
        exact = true;
        if (straighten(exact)) return call_.status();
        if (exact && find_rings(exact)) return call_.status();
        for (size_t k = 0; exact && k < rings_.size(); ++k)
            if (shift(rings_[k], exact)) return call_.status();
        if (exact && !reflect(made)) return call_.stopped();
        if (!exact) std::memcpy(f_.value, before.data(), mesh_.edge_count * sizeof(int64_t));
        return HMF_OK;
    }

private:
    // A boundary curve at one point, to be moved to the front or the back.
    struct Ring {
        uint32_t vertex;
        bool to_front;
        int64_t distance;
    };

    bool is_boundary(uint32_t v) const { return ahead_[v] != NONE; }

    // Minima have little to move.  What is far from symmetric (a foliation of a coarser level) may have too much.
    bool may_go_on(size_t vertices) {
        work_ += 6 * uint64_t{vertices} + 6;
        return work_ <= WORK * mesh_.edge_count + MOST_WORK;
    }

    bool reaches(uint32_t from, uint32_t to) const {
        bool closed = false;
        for (uint32_t g = from; g != to;) {
            g = next_round(f_, g, closed);
            if (closed || g == from) return false;
        }
        return true;
    }
    // The part of a boundary curve at one point, from v on: false if it has a marked
    // vertex or turns nowhere.
    bool turns_back(uint32_t v) const {
        uint32_t w = v;
        bool marked = mesh_.is_marked(v);
        while (f_.at(ahead_[w]) == 0) {
            w = mesh_.target(ahead_[w]);
            marked = marked || mesh_.is_marked(w);
        }
        const uint32_t back = behind_[v], on = ahead_[w];
        return !marked && (reaches(back, on) || reaches(on, back));
    }

    // Clusters move until no boundary curve turns back.
    hmf_status straighten(bool& exact) {
        const uint64_t most = 2 * (uint64_t{mesh_.vertex_count} + 2 * uint64_t{mesh_.edge_count});
        uint64_t moves = 0, steps = 0;
        for (bool moved = true; moved && exact;) {
            moved = false;
            for (uint32_t v = 0; v < mesh_.vertex_count && exact; ++v) {
                if (!is_boundary(v)) continue;
                // From the first vertex of those at one point.
                while (exact && f_.at(behind_[v]) > 0 && turns_back(v)) {
                    if (++steps % MIRROR_STRIDE == 0 && !call_.tick(0, true)) return call_.was_cancelled();
                    if (!move_towards(behind_[v], exact)) return call_.out_of_memory();
                    moved = true;
                    if (++moves > most) exact = false;
                }
            }
        }
        return HMF_OK;
    }

    // The cluster of the origin of g, a disk, into the direction of g.
    Done move_towards(uint32_t g, bool& exact) {
        const Cluster cluster = explore_cluster(f_, mesh_.origin[g]);
        if (!cluster.is_disk() || !may_go_on(f_.members.size())) {
            exact = false;
            return true;
        }
        circle_.clear();
        uint32_t h = g;
        bool open = true; // no closed corner since g
        do {
            if (!circle_.push(h)) return false;
            forward_[h] = open;
            bool closed = false;
            h = next_round(f_, h, closed);
            open = open && !closed;
        } while (h != g);
        for (size_t k = circle_.size(); k-- > 1;) { // and clockwise
            bool closed = false;
            next_round(f_, circle_[k], closed);
            if (closed) break;
            forward_[circle_[k]] = 1;
        }
        advance(INT64_MAX, exact);
        for (const uint32_t x : circle_) forward_[x] = 0;
        return true;
    }

    // The cluster in f.members moves by at most `most` over the half-edges with forward_.
    int64_t advance(int64_t most, bool& exact) {
        const auto is_inside = [&](uint32_t h) { return f_.stamp[mesh_.target(h)] == f_.epoch; };
        for (const uint32_t v : f_.members)
            for (const uint32_t h : mesh_.around(v)) {
                if (f_.at(h) == 0 || !forward_[h]) continue;
                if (!is_inside(h)) most = std::min(most, f_.at(h));
                else if (forward_[twin(h)]) most = std::min(most, f_.at(h) / 2);
                const uint32_t ahead = mesh_.rotate_ccw(h);
                if (f_.at(ahead) > 0 && forward_[ahead] && f_.corner2(h) > 0) most = std::min(most, f_.corner2(h) / 2);
            }
        if (most < 1 || most == INT64_MAX) {
            exact = false;
            return 0;
        }
        for (const uint32_t v : f_.members)
            for (const uint32_t h : mesh_.around(v))
                if (f_.at(h) != 0) f_.value[edge_of(h)] += forward_[h] ? -most : most;
        for (const uint32_t v : f_.members)
            for (const uint32_t h : mesh_.around(v))
                for (uint32_t g = h, side = 0; side < 3; ++side, g = mesh_.next[g])
                    if (f_.at(g) < 0 || f_.corner2(g) < 0) exact = false;
        return most;
    }

    // Boundary curves that are a closed leaf, and how far they are from the middle of their cylinder.
    hmf_status find_rings(bool& exact) {
        Array<uint8_t> seen;
        Cylinders cylinders;
        int64_t first = 0; // height of the first ring on a torus without zeros
        if (!seen.allocate_filled(call_.memory, mesh_.vertex_count, uint8_t{0})) return call_.out_of_memory();
        for (uint32_t v = 0; v < mesh_.vertex_count; ++v) {
            if (!is_boundary(v) || seen[v]) continue;
            bool at_one_point = true;
            for (uint32_t w = v; !seen[w]; w = mesh_.target(ahead_[w])) {
                seen[w] = 1;
                at_one_point = at_one_point && f_.at(ahead_[w]) == 0;
            }
            if (!at_one_point || !is_ring(explore_cluster(f_, v))) continue;
            Call part(&call_);
            if (cylinders.list.empty() && cylinders.build(f_, nullptr, nullptr, part)) {
                if (part.cancelled()) return call_.was_cancelled();
                if (call_.memory.failure()) return call_.out_of_memory();
                exact = false; // the leaves do not close
                return HMF_OK;
            }
            const uint32_t ring = explore_ring(v);
            bool front_is_up = false;
            int64_t place = 0, height = 0; // half units; up to the middle
            if (!find_crossing(cylinders, ring, place, height, front_is_up)) {
                exact = false;
                return HMF_OK;
            }
            if (cylinders.graph.zeros.empty()) { // no ends: the second ring lies half-way round from the first
                if (rings_.empty()) {
                    first = place;
                    if (!rings_.push({v, true, 0})) return call_.out_of_memory();
                    continue;
                }
                place -= first;
                if (place < 0) place += 2 * height;
            }
            const int64_t off = place - height; // above the middle
            if (off % 2 != 0) exact = false;
            if (!rings_.push({v, (off < 0) == front_is_up, off < 0 ? -off / 2 : off / 2})) return call_.out_of_memory();
        }
        return HMF_OK;
    }
    static bool is_ring(const Cluster& c) { return c.euler == 0 && c.closed_corners == 0 && c.marked == 0; }

    // On which side of its ring a half-edge out of the cluster in f.members leaves.
    bool leaves_in_front(uint32_t h) const { return mirror_.is_front[h] || mirror_.is_front[twin(h)]; }
    // The stamp of its cluster.
    uint32_t explore_ring(uint32_t v) {
        explore_cluster(f_, v);
        return f_.epoch;
    }
    // Where the path across a cylinder leaves a ring.
    bool find_crossing(const Cylinders& cylinders, uint32_t ring, int64_t& place, int64_t& height,
                       bool& to_front) const {
        for (const Cylinder& c : cylinders.list)
            for (uint64_t i = c.path_begin; i < c.path_end; ++i) {
                const PathPiece& p = cylinders.pieces[i];
                if (p.from != 0 || f_.stamp[mesh_.origin[p.half_edge]] != ring) continue;
                place = p.height;
                height = c.height;
                to_front = leaves_in_front(p.half_edge);
                return true;
            }
        return false;
    }

    hmf_status shift(const Ring& ring, bool& exact) {
        for (int64_t left = ring.distance; left > 0 && exact;) {
            if (!call_.tick(0, true)) return call_.was_cancelled();
            if (!is_ring(explore_cluster(f_, ring.vertex)) || !may_go_on(f_.members.size())) {
                exact = false;
                break;
            }
            set_forward(ring.to_front, true);
            left -= advance(left, exact);
            set_forward(ring.to_front, false);
        }
        return HMF_OK;
    }
    void set_forward(bool to_front, bool value) {
        for (const uint32_t u : f_.members)
            for (const uint32_t h : mesh_.around(u))
                if (leaves_in_front(h) == to_front) forward_[h] = value;
    }

    // The values of the front on the back.
    Done reflect(Symmetrized& made) {
        bool& exact = made.exact;
        for (uint32_t h = 0; h < 2 * mesh_.edge_count; ++h)
            if (mirror_.is_front[h]) f_.value[edge_of(mirror_.half_edge[h])] = f_.at(h);
        Array<uint8_t> is_settled; // in a cluster that was looked at
        if (!is_settled.allocate_filled(call_.memory, mesh_.vertex_count, 0)) return false;
        for (uint32_t v = 0; v < mesh_.vertex_count && exact; ++v) {
            if (!is_boundary(v) || is_settled[v]) continue;
            if (!remove_extremum(f_, v, &call_)) exact = false;
            if (call_.memory.failure()) return false;
            for (const uint32_t u : f_.members) is_settled[u] = 1;
            if (!call_.work(64 * f_.members.size())) return false;
        }
        made.count = count_singularities(f_);
        exact = exact && made.count.poles == 0 && made.count.broken_triangles == 0;
        return true;
    }

    Foliation& f_;
    const Mesh& mesh_;
    const Reflection& mirror_;
    Call& call_;
    Array<uint32_t> ahead_, behind_; // per vertex of the boundary: half-edges to the next one and the one before
    Array<uint8_t> forward_;         // per half-edge: the move makes it shorter
    Array<uint32_t> circle_;
    Array<Ring> rings_;
    uint64_t work_ = 0;
};

} // namespace

hmf_status make_symmetric(Foliation& f, const Reflection& reflection, Call& call, Symmetrized& made) {
    return Symmetry(f, reflection, call).run(made);
}

} // namespace hmf
