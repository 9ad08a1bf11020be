#include "graph_points.hpp"

#include "../../core/base/disjoint_sets.hpp"
#include "../lines/polyline.hpp"

namespace hmf {

Done GraphPoints::measure(Array<double>& length) {
    Memory& memory = call_.memory;
    const size_t arcs = in_.graph.arcs.size();
    ruler_.start(memory);
    if (!v_.allocate(memory, in_.graph.crossings.size()) || !from_.allocate(memory, arcs) || !to_.allocate(memory, arcs)
        || !first_vertex_.allocate(memory, arcs) || !length.allocate(memory, arcs)
        || !along_.allocate_filled(memory, arcs, uint8_t{0}))
        return false;
    for (const Boundary& b : in_.graph.boundaries) measure_leaf(b);
    for (size_t a = 0; a < arcs; ++a) length[a] = to_[a] - from_[a];
    return true;
}

// v along the boundary leaf, and of the zeros that it passes.
void GraphPoints::measure_leaf(const Boundary& b) {
    double v = 0;
    for (uint64_t i = b.begin; i < b.end; ++i) {
        v_[i] = i > b.begin ? std::max(v, v_[i - 1]) : v;
        if (i + 1 < b.end) v += in_.conjugate.step(in_.graph.crossings[i]);
    }
    // The middle of a tripod lies half-way before the crossing of its sector.
    const auto middle = [&](uint64_t i) {
        return i > b.begin ? (v_[i - 1] + v_[i]) / 2 : v_[i] - (v_[b.end - 1] - v_[b.end - 2]) / 2;
    };
    for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) {
        const ArcSide& arc = in_.graph.arcs[a];
        from_[a] = in_.tripod(arc.from) ? middle(arc.first) : v_[arc.first];
        to_[a] = in_.tripod(arc.to) ? middle(arc.last) : v_[arc.last];
    }
}

Done GraphPoints::place() {
    if (!place_zeros()) return false;
    if (in_.graph.zeros.empty()) return in_.is_annulus() ? Done(true) : place_ring();
    for (uint32_t a = 0; a < in_.graph.arcs.size(); ++a) {
        const uint32_t other = in_.graph.arcs[a].twin;
        if (a > other) continue;
        const uint32_t seen = in_.part_of_arc(a) == Part::back ? other : a;
        if (in_.part_of_arc(seen) != Part::back && !place_arc(seen)) return false;
    }
    return true;
}

// One vertex for each zero, and one for those that an arc without columns joins.  A marked vertex that shares its
// cluster with others may have no arc, and then no quad.
Done GraphPoints::place_zeros() {
    const uint32_t n = static_cast<uint32_t>(in_.graph.zeros.size());
    Array<uint8_t> has_arc;
    if (!zero_vertex_.allocate(call_.memory, n) || !has_arc.allocate_filled(call_.memory, n, uint8_t{0})) return false;
    for (uint32_t z = 0; z < n; ++z) zero_vertex_[z] = z;
    for (uint32_t a = 0; a < in_.graph.arcs.size(); ++a)
        if (sizes_.columns[a] == 0)
            unite(zero_vertex_.data(), zero_of(in_.graph.arcs[a].from), zero_of(in_.graph.arcs[a].to));
    for (uint32_t z = 0; z < n; ++z) zero_vertex_[z] = find_root(zero_vertex_.data(), z);
    for (const ArcSide& arc : in_.graph.arcs) has_arc[zero_vertex_[zero_of(arc.from)]] = 1;
    if (in_.front) {
        if (!joined_.allocate(call_.memory, n)) return false;
        for (uint32_t z = 0; z < n; ++z) joined_[z] = zero_vertex_[z];
    }
    uint32_t next = 0;
    for (uint32_t z = 0; z < n; ++z) {
        if (zero_vertex_[z] != z) { // joined to one before it
            zero_vertex_[z] = zero_vertex_[zero_vertex_[z]];
            continue;
        }
        uint32_t place = z;
        bool in_front = true, at_boundary = false;
        if (in_.front) find_place(z, place, in_front, at_boundary);
        if (!in_front || !has_arc[z]) {
            zero_vertex_[z] = NONE;
            continue;
        }
        zero_vertex_[z] = next++;
        Point p;
        uint32_t side = zero_point(place, p);
        if (at_boundary && in_.front->zero[place] != Part::on_boundary) side = point_across(z, p);
        if (!out_.add_vertex(p, side, at_boundary ? AT_BOUNDARY : uint8_t{0})) return false;
    }
    return true;
}

// Of the zeros joined to z, which is their lowest: where they are.  Those of both halves meet on the boundary.
void GraphPoints::find_place(uint32_t z, uint32_t& place, bool& in_front, bool& at_boundary) const {
    bool behind = false;
    in_front = at_boundary = false;
    for (uint32_t y = z; y < in_.graph.zeros.size(); ++y) {
        if (joined_[y] != z) continue;
        const Part part = in_.front->zero[y];
        if (part == Part::back) behind = true;
        else if (!at_boundary && (!in_front || part == Part::on_boundary)) place = y;
        if (part == Part::front) in_front = true;
        if (part == Part::on_boundary) in_front = at_boundary = true;
    }
    at_boundary = at_boundary || (in_front && behind);
}

// A side of the triangle it lies in.
uint32_t GraphPoints::zero_point(uint32_t zero, Point& p) const {
    const Zero& z = in_.graph.zeros[zero];
    if (!z.tripod) {
        p = point(in_.position, z.element);
        return in_.f.mesh.out[z.element];
    }
    double middle[3];
    middle_of_tripod(in_.f, in_.position, z.element, middle);
    p = point(middle, 0);
    return z.element;
}

// Where an arc crosses the boundary.
uint32_t GraphPoints::boundary_point(uint32_t a, Point& p) const {
    const Crossing& c = in_.graph.crossings[in_.front->arc_middle[a]];
    p = in_.place_of({c.half_edge, c.at + 1});
    return in_.front->crosses_to_back(c) ? c.half_edge : twin(c.half_edge);
}

// Where the arc without columns crosses the boundary.
uint32_t GraphPoints::point_across(uint32_t z, Point& p) const {
    for (uint32_t a = 0; a < in_.graph.arcs.size(); ++a)
        if (sizes_.columns[a] == 0 && in_.is_half(a) && joined_[zero_of(in_.graph.arcs[a].from)] == z)
            return boundary_point(a, p);
    return zero_point(z, p);
}

Done GraphPoints::push_crossing(uint64_t i) {
    const Crossing& c = in_.graph.crossings[i];
    return ruler_.push(v_[i], in_.place_of({c.half_edge, c.at + 1}), twin(c.half_edge));
}

// The boundary in place of a leaf beside it.
Done GraphPoints::push_boundary_arc(const ArcSide& arc, uint64_t last) {
    const uint32_t from = in_.graph.zeros[zero_of(arc.from)].element, to = in_.graph.zeros[zero_of(arc.to)].element;
    bool left = from != to; // else the arc goes around the whole curve
    if (!ruler_.push_on_boundary(in_, v_[arc.first], from, false)) return false;
    for (uint64_t i = arc.first + 1; i < last; ++i) {
        const uint32_t w = in_.f.mesh.target(in_.graph.crossings[i].half_edge);
        left = left || (in_.front->reflection->is_boundary[w] && w != from);
        if (!ruler_.push_on_boundary(in_, v_[i], w, false)) return false;
    }
    return ruler_.push_on_boundary(in_, v_[last], to, false, !left);
}

// Points that divide an arc, seen from this side.
Done GraphPoints::place_arc(uint32_t a) {
    const ArcSide& arc = in_.graph.arcs[a];
    const bool on_boundary = in_.front && in_.front->arc_mirror[a] == arc.twin;
    Point p;
    ruler_.clear();
    uint32_t side = zero_point(zero_of(arc.from), p);
    if (in_.tripod(arc.from) && !ruler_.push(from_[a], p, side)) return false;
    const uint64_t last = arc.last - in_.tripod(arc.to);
    if (on_boundary && !push_boundary_arc(arc, last)) return false;
    for (uint64_t i = arc.first; i <= last && !on_boundary; ++i)
        if (!push_crossing(i)) return false;
    side = zero_point(zero_of(arc.to), p);
    if (in_.tripod(arc.to) && !ruler_.push(to_[a], p, side)) return false;
    first_vertex_[a] = first_vertex_[arc.twin] = out_.vertex_count();
    along_[a] = 1;
    along_[arc.twin] = 0;
    const int64_t n = sizes_.columns[a];
    for (int64_t i = first_point(a); i <= last_point(a); ++i) {
        const bool across = in_.is_half(a) && 2 * i == n;
        side = across ? boundary_point(a, p) : ruler_.point(on_arc(a, i), p);
        if (!out_.add_vertex(p, side, on_boundary || across ? AT_BOUNDARY : uint8_t{0})) return false;
    }
    return true;
}

// The vertex at a point of an arc, NONE behind.
uint32_t GraphPoints::vertex_on_arc(uint32_t a, int64_t i) const {
    if (i == 0) return zero_vertex_[zero_of(in_.graph.arcs[a].from)];
    const uint32_t seen = along_[a] ? a : in_.graph.arcs[a].twin;
    const int64_t k = seen == a ? i : sizes_.columns[a] - i;
    if (in_.part_of_arc(a) == Part::back || k < first_point(seen) || k > last_point(seen)) return NONE;
    return first_vertex_[a] + static_cast<uint32_t>(k - first_point(seen));
}

// v on its boundary leaf of the i-th point of an arc; one across the boundary is divided there.
double GraphPoints::on_arc(uint32_t a, int64_t i) const {
    const int64_t n = sizes_.columns[a];
    if (in_.is_half(a) && n > 0) {
        const int64_t half = n / 2;
        const double middle = v_[in_.front->arc_middle[a]], parts = static_cast<double>(half);
        if (2 * i == n) return middle;
        return 2 * i < n ? from_[a] + (middle - from_[a]) * static_cast<double>(i) / parts
                         : middle + (to_[a] - middle) * static_cast<double>(i - half) / parts;
    }
    return from_[a] + (to_[a] - from_[a]) * static_cast<double>(i) / static_cast<double>(n);
}

// Without a zero: the closed leaf that counts as critical.
Done GraphPoints::place_ring() {
    const Boundary& b = in_.graph.boundaries[0];
    ruler_.clear();
    for (uint64_t i = b.begin; i < b.end; ++i)
        if (!push_crossing(i)) return false;
    const int64_t n = sizes_.ring;
    for (int64_t i = 0; i < n; ++i) {
        Point p;
        const uint32_t side = ruler_.point(v_[b.end - 1] * static_cast<double>(i) / static_cast<double>(n), p);
        if (!out_.add_vertex(p, side)) return false;
    }
    return true;
}

Done GraphPoints::read_row(uint32_t boundary, PointRow& row) const {
    row.clear();
    const Boundary& b = in_.graph.boundaries[boundary];
    if (in_.graph.zeros.empty()) {
        // The other side runs backwards from the same point.
        const int64_t n = sizes_.ring;
        for (int64_t i = 0; i < n; ++i)
            if (!row.push(static_cast<uint32_t>(boundary == 0 || i == 0 ? i : n - i),
                          v_[b.end - 1] * static_cast<double>(i) / static_cast<double>(n)))
                return false;
        return true;
    }
    for (uint32_t a = b.arcs_begin; a < b.arcs_end; ++a) {
        for (int64_t i = 0; i < sizes_.columns[a]; ++i)
            if (!row.push(vertex_on_arc(a, i), on_arc(a, i))) return false;
    }
    return true;
}

} // namespace hmf
