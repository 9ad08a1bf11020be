// Charts on the grid: their triangles in the plane, without overlap, each chart as large as in space.
#pragma once

#include "chart_plan.hpp"
#include "overlaps.hpp"

namespace hmf {

constexpr double GRID = 1 << 28; // units along a square as large as all charts
constexpr int64_t SPECK = 256;   // units: triangles below a millionth of the square are not looked at

class ChartLayout {
public:
    // grid: made; at first in units of the flat surface.
    ChartLayout(const FlatPieces& pieces, const ChartPlan& plan, GridLayout& grid, Call& call) :
        pieces_(pieces), plan_(plan), grid_(grid), call_(call) {}
    Done run();

private:
    Done place_faces();
    Motion over(uint32_t h) const;
    void move_face(uint32_t face, const Motion& m);
    Done smooth_edges();
    Done gather();
    Done find_islands();
    Done found_charts(uint32_t enough);
    // Is it in the largest part of its chart?
    bool stays(uint32_t face) const { return largest_[grid_.chart[face]] == island_[face]; }
    Done find_ways(Array<uint32_t>& way) const;
    Done move_islands(const Array<uint32_t>& way);
    Done number_charts();
    Done scale_to_grid();
    Done take_overlaps_out();
    void lay_as_in_space(uint32_t face);
    Done separate();
    Done dissolve_small();

    const FlatPieces& pieces_;
    const ChartPlan& plan_;
    GridLayout& grid_;
    Call& call_;
    Array<uint32_t> island_, size_; // per face: the first face of its part, and of that how many
    Array<uint32_t> largest_;       // per chart: the first face of its largest part
};

} // namespace hmf
