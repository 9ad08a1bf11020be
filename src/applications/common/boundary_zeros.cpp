#include "boundary_zeros.hpp"

#include "../../core/base/heap_sort.hpp"

namespace hmf {

namespace {

class BoundaryDivision {
public:
    BoundaryDivision(const Reflection& reflection, CriticalGraph& graph, const Foliation& f) :
        reflection_(reflection), graph_(graph), f_(f), memory_(graph.zeros.memory()) {}

    // The cluster in f.members.  done: it was divided.
    Done run(int32_t index, int64_t euler, bool& done) {
        const uint32_t before = static_cast<uint32_t>(graph_.zeros.size());
        bool any = false;
        circle_.start(memory_);
        runs_.start(memory_);
        if (!can_be_divided(euler)) return true;
        if (!root_.start(memory_) || !zero_.start(memory_) || !find_roots(any)) return false;
        if (!any) return true;
        if (!find_places(index)) return false;
        done = graph_.zeros.size() > before;
        if (!done) return true;
        if (!read_circles() || !add_sectors_of_runs()) return false;
        for (uint32_t z = before; z < graph_.zeros.size(); ++z) link_sectors(z);
        return true;
    }

private:
    struct Run {
        uint32_t zero;
        uint32_t first, last; // half-edges
        uint32_t sector;
    };

    // Vertices and zero edges of the cluster in f.members are one closed path off the boundary: around a thin tube.
    bool is_closed_path() const {
        for (const uint32_t v : f_.members) {
            if (reflection_.is_boundary[v] || f_.mesh.is_marked(v)) return false;
            uint32_t edges = 0;
            for (const uint32_t h : f_.mesh.around(v)) {
                if (f_.at(h) != 0) continue;
                ++edges;
                if (f_.at(f_.mesh.next[h]) == 0) return false; // a triangle of them is a disk
            }
            if (edges != 2) return false;
        }
        return true;
    }

    // The cluster: a disk, or a ring around a boundary curve without marked vertices, which would keep its two circles
    // apart. A ring across boundaries, the double of a way from one to another, goes around a part of the surface.
    bool can_be_divided(int64_t euler) const {
        if (euler < 0) return false;
        if (euler == 1 || is_closed_path()) return true;
        // Vertices on stretches of boundary that end are met from both ends.
        const auto along = [&](uint32_t v, uint32_t other) {
            for (const uint32_t h : f_.mesh.around(v))
                if (f_.at(h) == 0 && reflection_.on_boundary(h) && h != other) return h;
            return NONE;
        };
        size_t vertices = 0, met = 0;
        for (const uint32_t v : f_.members) {
            if (f_.mesh.is_marked(v)) return false;
            if (!reflection_.is_boundary[v]) continue;
            ++vertices;
            const uint32_t first = along(v, NONE);
            if (first == NONE) ++met; // alone: from both
            if (first != NONE && along(v, first) != NONE) continue;
            ++met;
            for (uint32_t h = first; h != NONE; h = along(f_.mesh.target(h), twin(h))) ++met;
        }
        return met < 2 * vertices;
    }

    // The root of each member of the cluster in f.members; any: there is one.
    Done find_roots(bool& any) {
        circle_.clear();
        const bool is_path = is_closed_path();
        for (const uint32_t v : f_.members)
            if ((reflection_.is_boundary[v] || is_path) && (!root_.set(v, v) || !circle_.push(v))) return false;
        any = !circle_.empty();
        // Of several roots as near the lowest, in front and behind.
        heap_sort(circle_.data(), circle_.size(), [](uint32_t a, uint32_t b) { return a < b; });
        for (size_t at = 0; at < circle_.size(); ++at) {
            const uint32_t v = circle_[at];
            for (const uint32_t h : f_.mesh.around(v)) {
                const uint32_t w = f_.mesh.target(h);
                if (f_.at(h) == 0 && root_.find(w) == SparseMap::ABSENT
                    && (!root_.set(w, root_.find(v)) || !circle_.push(w)))
                    return false;
            }
        }
        return true;
    }

    // Marked vertices of the boundary, and the roots of prongs: each is a new zero.
    Done find_places(int32_t index) {
        const auto add_place = [&](uint32_t v) -> Done {
            if (zero_.find(v) != SparseMap::ABSENT) return true;
            return zero_.set(v, static_cast<uint32_t>(graph_.zeros.size())) && graph_.zeros.push({false, v, index, 1});
        };
        for (const uint32_t v : f_.members)
            if (reflection_.is_boundary[v] && f_.mesh.is_marked(v) && !add_place(v)) return false;
        const auto read = [&](uint32_t g, uint32_t, bool closed) -> Done {
            return graph_.at_vertex.set(g, CriticalGraph::BETWEEN)
                && (!closed || add_place(root_.find(f_.mesh.origin[g])));
        };
        uint32_t circles = 0;
        for (const uint32_t v : f_.members)
            for (const uint32_t h : f_.mesh.around(v)) {
                if (f_.at(h) == 0 || graph_.at_vertex.find(h) != NONE) continue;
                ++circles;
                if (!for_circle(f_, h, read)) return false;
            }
        is_ring_ = circles == 2;
        return true;
    }

    // The runs of the circle that h lies on.  On a disk the way from a place to itself goes around
    // vertices without prongs, which belong to its sector; on a ring it is an arc.
    Done read_circle(uint32_t h) {
        // From behind a closed corner, or from where a place begins.
        uint32_t start = NONE, entry = NONE;
        const auto find_start = [&](uint32_t g, uint32_t ahead, bool closed) -> Done {
            if (closed && start == NONE) start = ahead;
            const uint32_t zero = place_at(ahead);
            if (zero != place_at(g) && zero != SparseMap::ABSENT && entry == NONE) entry = ahead;
            return true;
        };
        if (!for_circle(f_, h, find_start)) return false;
        // On a ring the sectors of a place come together, those of one circle before those of the other.
        if (entry != NONE && (start == NONE || is_ring_)) start = entry;
        if (start == NONE) start = h;
        const size_t first = runs_.size();
        bool joined = false; // to the run before: no closed corner between
        uint32_t previous = NONE;
        const auto add_to_runs = [&](uint32_t g, uint32_t, bool closed) -> Done {
            const uint32_t zero = place_at(g);
            Run* const before = joined ? &runs_.back() : nullptr;
            const bool extends = before && before->zero == zero && (!is_ring_ || before->last == previous);
            if (zero == SparseMap::ABSENT) {
                if (!graph_.at_vertex.set(g, CriticalGraph::BETWEEN)) return false;
            } else if (extends) before->last = g;
            else {
                if (!runs_.push({zero, g, g, NONE})) return false;
                joined = true;
            }
            previous = g;
            joined = joined && !closed;
            return true;
        };
        if (!for_circle(f_, start, add_to_runs)) return false;
        // Without a closed corner the last one may go on in the first.
        if (joined && entry != NONE && start == entry && runs_.size() > first + 1 && !is_ring_
            && runs_.back().zero == runs_[first].zero) {
            runs_[first].first = runs_.back().first;
            runs_.pop();
        }
        return true;
    }

    Done read_circles() {
        SparseMap read; // half-edges of circles that have been read
        if (!read.start(memory_)) return false;
        circle_.clear();
        for (const uint32_t v : f_.members)
            for (const uint32_t h : f_.mesh.around(v))
                if (f_.at(h) > 0 && graph_.at_vertex.find(h) == CriticalGraph::BETWEEN && !circle_.push(h))
                    return false;
        for (const uint32_t h : circle_) {
            if (read.find(h) != SparseMap::ABSENT) continue;
            if (!read_circle(h) || !for_circle(f_, h, [&](uint32_t g, uint32_t, bool) { return read.set(g, 0); }))
                return false;
        }
        return true;
    }

    // One for each run.
    Done add_sectors_of_runs() {
        for (Run& run : runs_) {
            run.sector = static_cast<uint32_t>(graph_.sectors.size());
            if (!graph_.sectors.push({run.zero, run.sector, run.sector, run.last, NONE, NONE})) return false;
            for (uint32_t g = run.first;;) {
                bool closed = false;
                if (!graph_.at_vertex.set(g, run.sector)) return false;
                if (g == run.last) break;
                g = next_round(f_, g, closed);
            }
        }
        return true;
    }

    // The sectors of a zero in the order of the circles.
    void link_sectors(uint32_t zero) {
        uint32_t first = NONE, last = NONE;
        int32_t prongs = 0;
        for (const Run& run : runs_) {
            if (run.zero != zero) continue;
            ++prongs;
            if (first == NONE) first = run.sector;
            else {
                graph_.sectors[last].next = run.sector;
                graph_.sectors[run.sector].previous = last;
            }
            last = run.sector;
        }
        if (first == NONE) return; // marked, with zero edges alone
        graph_.sectors[last].next = first;
        graph_.sectors[first].previous = last;
        graph_.zeros[zero].index = 2 - prongs;
    }

    // The zero of the place that the origin of h belongs to, or absent.
    uint32_t place_at(uint32_t h) const { return zero_.find(root_.find(f_.mesh.origin[h])); }

    const Reflection& reflection_;
    CriticalGraph& graph_;
    const Foliation& f_;
    Memory& memory_;
    SparseMap root_;       // of the vertices of the cluster
    SparseMap zero_;       // of those roots that are places
    bool is_ring_ = false; // the cluster has two circles
    Array<uint32_t> circle_;
    Array<Run> runs_;
};

} // namespace

ClusterDivision division_at_boundary(const Reflection& reflection) {
    return {&reflection,
            [](const void* user, CriticalGraph& graph, const Foliation& f, int32_t index, int64_t euler,
               bool& done) -> Done {
                return BoundaryDivision(*static_cast<const Reflection*>(user), graph, f).run(index, euler, done);
            }};
}

} // namespace hmf
