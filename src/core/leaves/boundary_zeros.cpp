// The zeros of a cluster with vertices of the boundary, and the arcs along it; the
// double is exactly symmetric.
//
// A ring of vertices around a tube, off the boundary, is taken apart in the same way: each is its own root.
//
// Every vertex of the cluster belongs to the vertex of the boundary that is nearest
// along zero edges, its root.  Prongs leave at closed corners; their roots and the
// marked vertices of the boundary are the places of zeros.  A run is a part of the circle
// between closed corners that belongs to one place: a sector there.  Sides that belong to no place lie between two
// runs, beside the arc that joins their places.
#include "../base/heap_sort.hpp"
#include "critical_graph.hpp"

namespace hmf {

struct CriticalGraph::Run {
    uint32_t zero;
    uint32_t first, last; // half-edges
    uint32_t sector;
};

// Which place each vertex of a cluster belongs to.
struct CriticalGraph::Places {
    SparseMap root;       // of vertices
    SparseMap zero;       // of those roots that are places
    bool is_ring = false; // the cluster has two circles
    // The zero at the origin of h, or absent.
    uint32_t at(const Foliation& f, uint32_t h) const { return zero.find(root.find(f.mesh.origin[h])); }
};

// Vertices and zero edges of the cluster in f.members are one closed path off the boundary: around a thin tube.
bool CriticalGraph::is_closed_path(const Foliation& f) const {
    for (const uint32_t v : f.members) {
        if (on_boundary[v] || f.mesh.is_marked(v)) return false;
        uint32_t edges = 0;
        for (const uint32_t h : f.mesh.around(v)) {
            if (f.at(h) != 0) continue;
            ++edges;
            if (f.at(f.mesh.next[h]) == 0) return false; // a triangle of them is a disk
        }
        if (edges != 2) return false;
    }
    return true;
}

// The cluster in f.members: a disk, or a ring around a boundary curve without marked vertices, which would keep its two
// circles apart. A ring across boundaries, the double of a way from one to another, goes around a part of the surface.
bool CriticalGraph::can_be_taken_apart(const Foliation& f, int64_t euler) const {
    if (!on_boundary || euler < 0) return false;
    if (euler == 1 || is_closed_path(f)) return true;
    // Vertices on stretches of boundary that end are met from both ends.
    const auto along = [&](uint32_t v, uint32_t other) {
        for (const uint32_t h : f.mesh.around(v))
            if (f.at(h) == 0 && mirror[h] == h && h != other) return h;
        return NONE;
    };
    size_t vertices = 0, met = 0;
    for (const uint32_t v : f.members) {
        if (f.mesh.is_marked(v)) return false;
        if (!on_boundary[v]) continue;
        ++vertices;
        const uint32_t first = along(v, NONE);
        if (first == NONE) ++met; // alone: from both
        if (first != NONE && along(v, first) != NONE) continue;
        ++met;
        for (uint32_t h = first; h != NONE; h = along(f.mesh.target(h), twin(h))) ++met;
    }
    return met < 2 * vertices;
}

// The root of each member of the cluster in f.members; any: there is one.
Done CriticalGraph::find_roots(const Foliation& f, SparseMap& root, bool& any) {
    circle_.clear();
    const bool is_path = is_closed_path(f);
    for (const uint32_t v : f.members)
        if ((on_boundary[v] || is_path) && (!root.set(v, v) || !circle_.push(v))) return false;
    any = !circle_.empty();
    // Of several roots as near the lowest, in front and behind.
    heap_sort(circle_.data(), circle_.size(), [](uint32_t a, uint32_t b) { return a < b; });
    for (size_t at = 0; at < circle_.size(); ++at) {
        const uint32_t v = circle_[at];
        for (const uint32_t h : f.mesh.around(v)) {
            const uint32_t w = f.mesh.target(h);
            if (f.at(h) == 0 && root.find(w) == SparseMap::ABSENT && (!root.set(w, root.find(v)) || !circle_.push(w)))
                return false;
        }
    }
    return true;
}

// Marked vertices of the boundary, and the roots of prongs: each is a new zero.
Done CriticalGraph::find_places(const Foliation& f, int32_t index, Places& places) {
    const auto add_place = [&](uint32_t v) -> Done {
        if (places.zero.find(v) != SparseMap::ABSENT) return true;
        return places.zero.set(v, static_cast<uint32_t>(zeros.size())) && zeros.push({false, v, index, 1});
    };
    for (const uint32_t v : f.members)
        if (on_boundary[v] && f.mesh.is_marked(v) && !add_place(v)) return false;
    const auto read = [&](uint32_t g, uint32_t, bool closed) -> Done {
        return at_vertex_.set(g, BETWEEN) && (!closed || add_place(places.root.find(f.mesh.origin[g])));
    };
    uint32_t circles = 0;
    for (const uint32_t v : f.members)
        for (const uint32_t h : f.mesh.around(v)) {
            if (f.at(h) == 0 || at_vertex_.find(h) != NONE) continue;
            ++circles;
            if (!for_circle(f, h, read)) return false;
        }
    places.is_ring = circles == 2;
    return true;
}

// The runs of the circle that h lies on.  On a disk the way from a place to itself goes around
// vertices without prongs, which belong to its sector; on a ring it is an arc.
Done CriticalGraph::read_circle(const Foliation& f, uint32_t h, const Places& places, Array<Run>& runs) {
    // From behind a closed corner, or from where a place begins.
    uint32_t start = NONE, entry = NONE;
    const auto find_start = [&](uint32_t g, uint32_t ahead, bool closed) -> Done {
        if (closed && start == NONE) start = ahead;
        const uint32_t zero = places.at(f, ahead);
        if (zero != places.at(f, g) && zero != SparseMap::ABSENT && entry == NONE) entry = ahead;
        return true;
    };
    if (!for_circle(f, h, find_start)) return false;
    // On a ring the sectors of a place come together, those of one circle before those of the other.
    if (entry != NONE && (start == NONE || places.is_ring)) start = entry;
    if (start == NONE) start = h;
    const size_t first = runs.size();
    bool joined = false; // to the run before: no closed corner between
    uint32_t previous = NONE;
    const auto add_to_runs = [&](uint32_t g, uint32_t, bool closed) -> Done {
        const uint32_t zero = places.at(f, g);
        Run* const before = joined ? &runs.back() : nullptr;
        const bool extends = before && before->zero == zero && (!places.is_ring || before->last == previous);
        if (zero == SparseMap::ABSENT) {
            if (!at_vertex_.set(g, BETWEEN)) return false;
        } else if (extends) before->last = g;
        else {
            if (!runs.push({zero, g, g, NONE})) return false;
            joined = true;
        }
        previous = g;
        joined = joined && !closed;
        return true;
    };
    if (!for_circle(f, start, add_to_runs)) return false;
    // Without a closed corner the last one may go on in the first.
    if (joined && entry != NONE && start == entry && runs.size() > first + 1 && !places.is_ring
        && runs.back().zero == runs[first].zero) {
        runs[first].first = runs.back().first;
        runs.pop();
    }
    return true;
}

Done CriticalGraph::read_circles(const Foliation& f, const Places& places, Array<Run>& runs) {
    SparseMap read; // half-edges of circles that have been read
    runs.start(*memory_);
    if (!read.start(*memory_)) return false;
    circle_.clear();
    for (const uint32_t v : f.members)
        for (const uint32_t h : f.mesh.around(v))
            if (f.at(h) > 0 && at_vertex_.find(h) == BETWEEN && !circle_.push(h)) return false;
    for (const uint32_t h : circle_) {
        if (read.find(h) != SparseMap::ABSENT) continue;
        if (!read_circle(f, h, places, runs)
            || !for_circle(f, h, [&](uint32_t g, uint32_t, bool) { return read.set(g, 0); }))
            return false;
    }
    return true;
}

// One for each run.
Done CriticalGraph::add_sectors_of_runs(const Foliation& f, Array<Run>& runs) {
    for (Run& run : runs) {
        run.sector = static_cast<uint32_t>(sectors.size());
        if (!sectors.push({run.zero, run.sector, run.sector, run.last, NONE, NONE})) return false;
        for (uint32_t g = run.first;;) {
            bool closed = false;
            if (!at_vertex_.set(g, run.sector)) return false;
            if (g == run.last) break;
            g = next_round(f, g, closed);
        }
    }
    return true;
}

// The sectors of a zero in the order of the circles.
void CriticalGraph::link_sectors(uint32_t zero, const Array<Run>& runs) {
    uint32_t first = NONE, last = NONE;
    int32_t prongs = 0;
    for (const Run& run : runs) {
        if (run.zero != zero) continue;
        ++prongs;
        if (first == NONE) first = run.sector;
        else {
            sectors[last].next = run.sector;
            sectors[run.sector].previous = last;
        }
        last = run.sector;
    }
    if (first == NONE) return; // marked, with zero edges alone
    sectors[last].next = first;
    sectors[first].previous = last;
    zeros[zero].index = 2 - prongs;
}

Done CriticalGraph::add_zeros_on_boundary(Foliation& f, int32_t index, bool& done) {
    const uint32_t before = static_cast<uint32_t>(zeros.size());
    Places places;
    Array<Run> runs;
    bool any = false;
    if (!places.root.start(*memory_) || !places.zero.start(*memory_) || !find_roots(f, places.root, any)) return false;
    if (!any) return true;
    if (!find_places(f, index, places)) return false;
    done = zeros.size() > before;
    if (!done) return true;
    if (!read_circles(f, places, runs) || !add_sectors_of_runs(f, runs)) return false;
    for (uint32_t z = before; z < zeros.size(); ++z) link_sectors(z, runs);
    return true;
}

} // namespace hmf
