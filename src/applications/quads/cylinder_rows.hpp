// The rows of a cylinder: leaves at equal distances, divided where its columns meet them.
//
// Columns follow the conjugate direction.  Within a triangle u is linear, and
// along a leaf the conjugate v grows by |grad u| times the length.  On a leaf it
// is measured from where the path across the cylinder meets it; along the path
// the conjugate of u is integrated as well, which gives the twist between both
// boundaries; each row then corrects it, so that columns from the row before meet it at right angles
// in the mean.  The rows between take the mean of both boundaries, weighted by height.
//
// How far a row turns against the one before depends on these two leaves alone, so that some rows at a
// time are read and turned on the threads of the host; the sum of the turns is where each one lies.
#pragma once

#include "graph_points.hpp"
#include "leaf_rows.hpp"

namespace hmf {

class CylinderRows {
public:
    CylinderRows(const QuadInput& in, const GridSizes& sizes, const GraphPoints& points, QuadMesh& out, Call& call);

    // The vertices inside a cylinder and its quads, as far as it lies in front.
    [[nodiscard]] hmf_status fill(uint32_t cylinder);

private:
    [[nodiscard]] hmf_status fill_closed(uint32_t cylinder);
    [[nodiscard]] hmf_status align_rows(uint32_t cylinder, double whole, double& turn);
    Done read_path(const Cylinder& c);
    double twist_at(const Cylinder& c, uint64_t piece, int64_t height) const;
    double arrival(const Cylinder& c) const;
    int64_t height_of_row(uint32_t cylinder, int64_t k) const;
    [[nodiscard]] hmf_status find_leaf(uint32_t cylinder, int64_t height, uint64_t& piece);
    [[nodiscard]] hmf_status read_leaf_at(uint32_t cylinder, int64_t height, int64_t shift, double& twist);
    [[nodiscard]] hmf_status read_rows(uint32_t cylinder, int64_t first, uint32_t count);
    [[nodiscard]] hmf_status place_rows(uint32_t cylinder, double turn, double upper_length, double arrived,
                                        int64_t& offset);
    Done set_places(double length);
    Done start_rows(uint32_t rows);
    void points_of_row(const Ruler& row, double here, double* points) const;
    double align_row(const Ruler& row, const double* before, double here) const;
    double coarse_turn(const Ruler& row, const double* before, double here) const;

    // Of a double (front_rows.cpp).
    [[nodiscard]] hmf_status fill_ring(uint32_t cylinder);
    [[nodiscard]] hmf_status fill_annulus(uint32_t cylinder);
    [[nodiscard]] hmf_status fill_strip(uint32_t cylinder);
    template <class Height>
    [[nodiscard]] hmf_status stack_rows(uint32_t cylinder, int64_t rows, double whole, const Height& height);
    [[nodiscard]] hmf_status add_strip_rows(uint32_t cylinder, int64_t columns);
    [[nodiscard]] hmf_status start_strip(uint32_t cylinder);
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
    Array<double> twist_;  // v along the path across a cylinder, per piece
    Array<double> place_;  // of the points of the lower row, from 0 to 1
    Array<double> here_;   // per row: where the path meets it
    Array<double> before_; // points of the row before; for each of some rows
    LeafRows leaves_;      // the last one of those before comes first
    PointRow lower_, upper_, all_;
    Array<uint32_t> row_; // two rows of vertices
};

} // namespace hmf
