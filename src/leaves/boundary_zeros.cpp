// The zeros of a cluster with vertices of the boundary, and the arcs along it; the
// double is exactly symmetric.
//
// Every vertex of the cluster belongs to the vertex of the boundary that is nearest
// along zero edges, its root.  Prongs leave at closed corners; their roots and the
// marked vertices of the boundary are the places of zeros.  A piece is a run of the circle
// between closed corners that belongs to one place: a sector there.  What belongs
// to no place lies between two pieces, beside the arc that joins their places.
#include "../base/heap_sort.hpp"
#include "critical_graph.hpp"

namespace hmf {

struct CriticalGraph::Piece {
    uint32_t zero;
    uint32_t first, last; // half-edges
    uint32_t sector;
};

// The cluster in f.members: a disk, or a ring round a boundary curve without marked vertices, which would keep its two
// circles apart. A ring across boundaries, the double of a way from one to another, goes round a part of the surface.
bool CriticalGraph::can_be_taken_apart(const Foliation& f, int64_t euler) const {
    if (!on_boundary || euler < 0) return false;
    if (euler == 1) return true;
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
    for (const uint32_t v : f.members)
        if (on_boundary[v] && (!root.set(v, v) || !circle_.push(v))) return false;
    any = !circle_.empty();
    // Of several roots as near the lowest, in front and behind.
    heap_sort(circle_.data(), circle_.size(), [](uint32_t a, uint32_t b) { return a < b; });
    for (size_t at = 0; at < circle_.size(); ++at) {
        const uint32_t v = circle_[at];
        for (const uint32_t h : f.mesh.around(v)) {
            const uint32_t w = f.mesh.target(h);
            if (f.at(h) == 0 && root.find(w) == SparseMap::absent && (!root.set(w, root.find(v)) || !circle_.push(w)))
                return false;
        }
    }
    return true;
}

// Those of the circle that h lies on.  On a disk the way from a place to itself goes round
// vertices without prongs, which belong to its sector; on a ring it is an arc.
Done CriticalGraph::read_pieces(const Foliation& f, uint32_t h, const SparseMap& root, const SparseMap& place,
                                bool is_ring, Array<Piece>& pieces) {
    const auto place_of = [&](uint32_t g) { return place.find(root.find(f.mesh.origin[g])); };
    // From behind a closed corner, or from where a place begins.
    uint32_t start = NONE, entry = NONE, g = h;
    do {
        bool closed = false;
        const uint32_t ahead = next_round(f, g, closed);
        if (closed && start == NONE) start = ahead;
        if (place_of(ahead) != place_of(g) && place_of(ahead) != SparseMap::absent && entry == NONE) entry = ahead;
        g = ahead;
    } while (g != h);
    // On a ring the sectors of a place come together, those of one circle before those of the other.
    if (entry != NONE && (start == NONE || is_ring)) start = entry;
    if (start == NONE) start = h;
    const size_t first = pieces.size();
    bool joined = false; // to the piece before: no closed corner between
    uint32_t previous = NONE;
    g = start;
    do {
        const uint32_t zero = place_of(g);
        Piece* const before = joined ? &pieces.back() : nullptr;
        const bool extends = before && before->zero == zero && (!is_ring || before->last == previous);
        if (zero == SparseMap::absent) {
            if (!at_vertex_.set(g, BETWEEN)) return false;
        } else if (extends) before->last = g;
        else {
            if (!pieces.push({zero, g, g, NONE})) return false;
            joined = true;
        }
        bool closed = false;
        previous = g;
        g = next_round(f, g, closed);
        joined = joined && !closed;
    } while (g != start);
    // Without a closed corner the last one may go on in the first.
    if (joined && entry != NONE && start == entry && pieces.size() > first + 1 && !is_ring
        && pieces.back().zero == pieces[first].zero) {
        pieces[first].first = pieces.back().first;
        pieces.pop();
    }
    return true;
}

Done CriticalGraph::add_zeros_on_boundary(Foliation& f, int32_t index, bool& done) {
    Memory& memory = *memory_;
    const uint32_t before = static_cast<uint32_t>(zeros.size());
    SparseMap root, place; // of vertices; the zero of a root
    Array<Piece> pieces;
    bool any = false, is_ring = false;
    pieces.start(memory);
    if (!root.start(memory) || !place.start(memory) || !find_roots(f, root, any)) return false;
    if (!any) return true;
    const auto add_place = [&](uint32_t v) -> Done {
        if (place.find(v) != SparseMap::absent) return true;
        return place.set(v, static_cast<uint32_t>(zeros.size())) && zeros.push({false, v, index, 1});
    };
    uint32_t circles = 0;
    for (const uint32_t v : f.members)
        if (on_boundary[v] && f.mesh.is_marked(v) && !add_place(v)) return false;
    for (const uint32_t v : f.members)
        for (const uint32_t h : f.mesh.around(v)) {
            if (f.at(h) == 0 || at_vertex_.find(h) != NONE) continue;
            ++circles;
            uint32_t g = h;
            do {
                bool closed = false;
                if (!at_vertex_.set(g, BETWEEN)) return false;
                const uint32_t ahead = next_round(f, g, closed);
                if (closed && !add_place(root.find(f.mesh.origin[g]))) return false;
                g = ahead;
            } while (g != h);
        }
    is_ring = circles == 2;
    done = zeros.size() > before;
    if (!done) return true;
    circle_.clear();
    for (const uint32_t v : f.members)
        for (const uint32_t h : f.mesh.around(v))
            if (f.at(h) > 0 && at_vertex_.find(h) == BETWEEN && !circle_.push(h)) return false;
    // One half-edge of each circle: marked as read by a place of their own.
    SparseMap read;
    if (!read.start(memory)) return false;
    for (const uint32_t h : circle_) {
        if (read.find(h) != SparseMap::absent) continue;
        if (!read_pieces(f, h, root, place, is_ring, pieces)) return false;
        uint32_t g = h;
        do {
            bool closed = false;
            if (!read.set(g, 0)) return false;
            g = next_round(f, g, closed);
        } while (g != h);
    }
    // The sectors of a place come in the order of the circles.
    for (Piece& piece : pieces) {
        piece.sector = static_cast<uint32_t>(sectors.size());
        if (!sectors.push({piece.zero, piece.sector, piece.sector, piece.last, NONE, NONE})) return false;
        for (uint32_t g = piece.first;;) {
            bool closed = false;
            if (!at_vertex_.set(g, piece.sector)) return false;
            if (g == piece.last) break;
            g = next_round(f, g, closed);
        }
    }
    for (uint32_t z = before; z < zeros.size(); ++z) {
        uint32_t first = NONE, last = NONE;
        int32_t prongs = 0;
        for (const Piece& piece : pieces) {
            if (piece.zero != z) continue;
            ++prongs;
            if (first == NONE) first = piece.sector;
            else {
                sectors[last].next = piece.sector;
                sectors[piece.sector].previous = last;
            }
            last = piece.sector;
        }
        if (first == NONE) continue; // marked, with zero edges alone
        sectors[last].next = first;
        sectors[first].previous = last;
        zeros[z].index = 2 - prongs;
    }
    return true;
}

} // namespace hmf
