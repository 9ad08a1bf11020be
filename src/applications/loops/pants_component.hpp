// Where a pants decomposition can change: take some of its curves out, and what
// the others leave around those is a surface of its own, a component.
//
//      cut along all curves                 without c
//
//        |  |                                 |
//     ---+--+---  an edge, 3 segments      ---+------  2
//      r | s| t   regions                   r |  s
//        |  c                                 |
//
// It has the regions of its pairs of pants, joined across the curves that were
// taken out, and serves as a CutSurface (without numbers by edge and by face) with
// only these: a search in it costs as much as the component is large.
#pragma once

#include "../../core/curves/cut_surface.hpp"

namespace hmf {

// A surface with holes: sides of the curves around it, and marked vertices.
struct Component {
    CutSurface surface;
    Array<uint8_t> is_hole; // per point

    // Cut along a cycle of half-segments that visits no region twice: two holes more.
    Done cut_along(const Mesh& mesh, const Array<uint32_t>& cycle, Component& out, Memory& memory) const;
};

class PantsComponents {
public:
    explicit PantsComponents(const Mesh& mesh) : mesh_(mesh) {}
    // Cuts the mesh along all loops, which must be disjoint.
    [[nodiscard]] hmf_status start(const Loops& loops, Call& call);

    size_t pants_count() const { return regions_.first.size() - 1; }
    // The pair of pants on the right (0) or left (1) of a loop.
    uint32_t pants(size_t loop, size_t left) const { return side_[2 * loop + left]; }
    bool touch(size_t k, size_t l) const { // a pair of pants has both on its boundary
        return pants(k, 0) == pants(l, 0) || pants(k, 0) == pants(l, 1) || pants(k, 1) == pants(l, 0)
            || pants(k, 1) == pants(l, 1);
    }
    // Around these loops, taken out.
    Done build(const uint32_t* loops, size_t count, Component& out, Memory& memory);

private:
    struct Lists { // of each pair of pants
        Array<uint32_t> first, items;
    };
    struct Numbers { // of the elements in the component
        Array<uint32_t> local, listed, parent;
        uint32_t count = 0;
    };
    Done list_pants(Call& call);
    Done number(Numbers& numbers, const Lists& lists, Memory& memory);
    Done add_point(uint32_t point, Component& out, uint32_t& number);

    const Mesh& mesh_;
    Multicurve curves_;
    CutSurface cut_;
    Array<uint32_t> component_of_; // of curves_, per loop
    Array<uint32_t> side_;         // per loop two
    Lists regions_, segments_;
    Array<uint32_t> chosen_; // pairs of pants
    Numbers region_, segment_;
    Array<uint32_t> point_local_, point_listed_;
};

} // namespace hmf
