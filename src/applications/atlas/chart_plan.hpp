// Which pieces are joined to one chart, and where charts are cut again, so that the
// square is well used and there are few of them.
#pragma once

#include "charts.hpp"
#include "flat_pieces.hpp"

namespace hmf {

// Part of a chart: what lies in a box of its plane.
struct ChartPart {
    uint32_t chart;
    Box box;
    double scale; // with which areas are as in space, the whole being the same
};

class ChartPlan {
public:
    ChartPlan(const FlatPieces& pieces, Call& call) : pieces_(pieces), call_(call) {}
    [[nodiscard]] hmf_status run();

    Charts charts;
    Array<ChartPart> parts; // the charts to be

private:
    struct FaceInChart {
        double u, v, area, image;
    };
    // A join of pieces, and its value.
    struct Join {
        JoinWish wish;
        double cost;
    };
    // A cut of a part, and the value of the packing with it.
    struct Cut {
        uint32_t part = NONE;
        bool in_u = false;
        double where = 0, cost = 0, side = 0;
    };

    hmf_status try_packing(uint64_t effort, double& side);
    hmf_status try_joins(Array<Join>& joins);
    hmf_status whole_charts();
    double scale_of(double area, double image) const;
    double cost_of(double side, size_t charts) const;
    hmf_status cut_charts(double& cost);
    Done cut_long_parts();
    hmf_status try_cuts(uint32_t part, Array<Cut>& cuts);
    hmf_status try_cut(uint64_t effort, Cut& cut);
    hmf_status choose_cut(Array<Cut>& cuts, Cut& best);
    uint32_t next_shorter(uint32_t last) const;
    double length_of(const ChartPart& part) const;
    Done cut_part(uint32_t i, bool in_u, double where);
    Done list_faces();

    const FlatPieces& pieces_;
    Call& call_;
    Array<uint32_t> of_chart_; // first in faces_
    Array<FaceInChart> faces_;
    uint64_t planned_ = 0; // steps of packing
};

} // namespace hmf
