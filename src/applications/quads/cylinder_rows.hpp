// The rows of a cylinder: leaves at equal distances, divided where its columns meet them.
//
// Columns follow the conjugate direction: v is known along each leaf.  Each row is turned so that the columns from the
// row before are short and meet it at right angles in the mean, the upper boundary as well; the difference between its
// points and the columns is divided among the rows.
//
// Of a double the part in front: all of a cylinder, the rows below the boundary curve in its middle (a ring), those
// between two such curves (an annulus), or the half of each row between two points of the boundary (a strip).
#pragma once

#include "graph_points.hpp"

namespace hmf {

class CylinderRows {
public:
    CylinderRows(const QuadInput& in, const GridSizes& sizes, const GraphPoints& points, QuadMesh& out, Call& call);

    // The vertices inside a cylinder and its quads, as far as it lies in front.
    [[nodiscard]] hmf_status fill(uint32_t cylinder);

private:
    [[nodiscard]] hmf_status fill_closed(uint32_t cylinder);
    [[nodiscard]] hmf_status fill_ring(uint32_t cylinder);
    [[nodiscard]] hmf_status fill_annulus(uint32_t cylinder);
    [[nodiscard]] hmf_status fill_strip(uint32_t cylinder);

    int64_t height_of_row(uint32_t cylinder, int64_t k) const;
    Done set_heights(uint32_t cylinder, int64_t rows);
    [[nodiscard]] hmf_status find_leaf(uint32_t cylinder, int64_t height);
    [[nodiscard]] hmf_status read_leaf_at(uint32_t cylinder, int64_t height, int64_t shift);
    [[nodiscard]] hmf_status read_row(uint32_t cylinder, size_t k);
    Done read_upper(uint32_t boundary);
    [[nodiscard]] hmf_status align_rows(uint32_t cylinder);
    template <class Slant>
    [[nodiscard]] hmf_status place_rows(uint32_t cylinder, const Slant& slant);
    template <class Vertex>
    [[nodiscard]] hmf_status add_grid(int64_t rows, int64_t columns, const Vertex& vertex);
    [[nodiscard]] hmf_status add_rings(uint32_t cylinder);
    Done set_places(double length);
    void points_of_row(double here);
    double align_row() const;
    uint32_t place_on_strip(double place, bool begins, bool ends, Point& p) const;
    [[nodiscard]] hmf_status start_strip_of_annulus(uint32_t cylinder);
    [[nodiscard]] hmf_status read_front_row(uint32_t cylinder, uint32_t boundary, PointRow& row);
    [[nodiscard]] hmf_status rule_front(uint32_t cylinder);
    [[nodiscard]] hmf_status torn(uint32_t cylinder);

    const QuadInput& in_;
    const GridSizes& sizes_;
    const GraphPoints& points_;
    QuadMesh& out_;
    Call& call_;
    BoundaryRuler ruler_;
    Array<Crossing> leaf_;
    Array<double> place_;           // of the points of the lower row, from 0 to 1
    Array<int64_t> height_;         // per row inside, of the leaf: half units above the lower side
    bool ends_at_boundary_ = false; // the last of them lies on the boundary
    Array<double> here_;            // per row inside: where its leaf begins in the places of the columns
    Array<Point> before_;           // points of the row before
    PointRow lower_, upper_, all_;
};

} // namespace hmf
