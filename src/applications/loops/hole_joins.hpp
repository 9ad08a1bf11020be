// Curves around two holes of a planar surface, each along a short path between them:
//
//        A ---- way ---- B        along A, over to B, along B and back
//
// The paths connect the cells of the Voronoi diagram of the holes, one for each piece of the border between two cells.
// Curves around different holes are disjoint: each lies in the cells of its own.
#pragma once

#include "../../core/base/nearest_first.hpp"
#include "../../core/base/disjoint_sets.hpp"
#include "cell_borders.hpp"

namespace hmf {

enum HoleKind : uint8_t { NO_HOLE, HOLE_JOINED, HOLE_LEFT_ALONE };

class HoleJoins {
public:
    HoleJoins(const Mesh& mesh, const Array<double>& edge_length) : mesh_(mesh), length_(edge_length) {}

    struct Join {
        double length; // estimated
        uint32_t hole[2];
        uint32_t corner[2]; // half-segments that begin at the holes, where the way begins and ends
        uint32_t middle;    // half-segment that the way crosses between the cells; NONE: the corners lie in one region
    };
    // Shortest first, none longer than the first one by more than the factor SLACK. In a piece with three holes
    // they would go around the third one, and there is none. holes: per point HoleKind.
    Done find(const CutSurface& surface, const Array<uint8_t>& holes, Array<Join>& found, Call& call);
    // Holes of the piece in which a region lies.
    uint32_t holes_around(uint32_t region) { return holes_[find_root(piece_.data(), region)]; }
    // The half-edges that the curve crosses, at the end of strip.
    Done walk(const Join& join, Array<uint32_t>& strip, Memory& memory) const;

private:
    uint32_t begin_of(uint32_t half_segment) const { return surface_->point[half_segment]; }
    uint32_t owner(uint32_t region) const { return begin_of(corner_[region]); }
    uint32_t next_in_region(uint32_t half_segment) const;
    double measure_round(uint32_t corner) const;
    bool is_joined(uint32_t point) const { return (*is_hole_)[point] == HOLE_JOINED; }
    Done count_holes(Call& call);
    Done spread(Call& call);
    Done grow_cells(double least, Call& call);
    Done find_borders(Array<Join>& found, Call& call);
    Join contact(uint32_t segment) const;
    Done go_round(uint32_t corner, Array<uint32_t>& walk) const;

    const Mesh& mesh_;
    const Array<double>& length_; // per edge
    const CutSurface* surface_ = nullptr;
    const Array<uint8_t>* is_hole_ = nullptr;
    Array<double> around_;          // per point, if it is a hole
    Array<uint32_t> piece_, holes_; // per region
    Array<double> distance_;        // per region, to the next hole
    Array<uint32_t> corner_, from_; // per region: where the way to it begins, and the half-segment that it ends with
    CellBorders borders_;
    NearestFirst heap_;
};

} // namespace hmf
