// The vertices on the critical graph: the zeros, and the points that divide the arcs between
// them, which the grids on both sides share.
#pragma once

#include "grid_sizes.hpp"

namespace hmf {

// The columns of a boundary in the direction of its leaf, with v from its first crossing.
struct PointRow {
    Array<uint32_t> vertex; // NONE: behind
    Array<double> v;
    void start(Memory& memory) {
        vertex.start(memory);
        v.start(memory);
    }
    void clear() {
        vertex.clear();
        v.clear();
    }
    Done push(uint32_t point, double at) { return vertex.push(point) && v.push(at); }
};

class GraphPoints {
public:
    GraphPoints(const QuadInput& in, const GridSizes& sizes, QuadMesh& out, Call& call) :
        in_(in), sizes_(sizes), out_(out), call_(call) {}

    // Along the conjugate: places on the boundary leaves, and the length of each side of an arc.
    Done measure(Array<double>& length);
    double v(uint64_t crossing) const { return v_[crossing]; }
    double length(uint32_t boundary) const { return v_[in_.graph.boundaries[boundary].end - 1]; }

    // All vertices on the graph that lie in front.
    Done place();
    Done read_row(uint32_t boundary, PointRow& row) const;

private:
    void measure_leaf(const Boundary& b);
    Done place_zeros();
    void find_place(uint32_t z, uint32_t& place, bool& in_front, bool& at_boundary) const;
    uint32_t zero_point(uint32_t zero, Point& p) const;
    uint32_t boundary_point(uint32_t a, Point& p) const;
    uint32_t point_across(uint32_t z, Point& p) const;
    Done push_crossing(uint64_t i);
    Done push_boundary_arc(const ArcSide& arc, uint64_t last);
    Done place_arc(uint32_t a);
    Done place_ring();
    uint32_t vertex_on_arc(uint32_t a, int64_t i) const;
    double on_arc(uint32_t a, int64_t i) const;
    // The points within an arc that lie in front.
    int64_t first_point(uint32_t a) const {
        return in_.part_of_arc(a) == Part::second_half ? sizes_.columns[a] / 2 : 1;
    }
    int64_t last_point(uint32_t a) const {
        return in_.part_of_arc(a) == Part::first_half ? sizes_.columns[a] / 2 : sizes_.columns[a] - 1;
    }
    uint32_t zero_of(uint32_t sector) const { return in_.graph.sectors[sector].zero; }

    const QuadInput& in_;
    const GridSizes& sizes_;
    QuadMesh& out_;
    Call& call_;
    BoundaryRuler ruler_;
    Array<double> v_;              // per crossing of the boundary leaves
    Array<double> from_, to_;      // per side of an arc: v of its ends on its boundary leaf
    Array<uint32_t> zero_vertex_;  // per zero
    Array<uint32_t> first_vertex_; // per side: the first one within the arc
    Array<uint8_t> along_;         // per side: its points were placed from this side
    Array<uint32_t> joined_;       // per zero of a double: the lowest one that arcs without columns join it to
};

} // namespace hmf
