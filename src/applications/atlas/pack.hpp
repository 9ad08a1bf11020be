// Packing of shapes into a square.  The plane is cut into columns; a shape is a bottom
// and a top in each of them, as in the horizons of [Levy, Petitjean, Ray, Maillot
// 2002: Least squares conformal maps, section 4].  One after the other goes to the
// lowest place where each of its columns is free, also below others.  In no column do
// two shapes overlap; heights are whole numbers, so that this is exact.
//
//     top     _--_
//      |    _-    |             the profile of a shape: made of triangles or boxes
//      |   |      |             that are wider by half a margin on all sides
//     bottom -____|
//
// Orders and quarter turns are searched for a given number of steps; the same input
// gives the same places.
#pragma once

#include "../../core/base/memory.hpp"

namespace hmf {

class Packer {
public:
    // column: width of one, at least 1.  Shapes are in units of which a fraction does not matter.
    void start(Memory& memory, double column, double margin);
    uint32_t count() const { return static_cast<uint32_t>(items_.size()); }

    // A shape: its box, then what it consists of, convex parts of at most four corners inside the box.
    Done begin_shape(double x0, double y0, double x1, double y1);
    uint64_t add_part(const double* xy, int corners); // returns how many columns it meets

    // coarser: one of the same shapes with wider columns, with whose arrangement the search begins; or NULL.
    // Searches until about so many steps are taken, columns of shapes that were looked at; side is the width of the
    // square then.
    [[nodiscard]] hmf_status search(uint64_t effort, const Packer* coarser, Call& call);
    uint64_t steps() const { return steps_; }
    double side() const { return side_; }
    // Where the point (x, y) of a shape lies, for 0 <= turns < 4 quarter turns counter-clockwise:
    // turned about 0, then moved.
    struct Place {
        uint32_t turns = 0;
        double x = 0, y = 0;
    };
    const Place& place(uint32_t shape) const { return best_places_[shape]; }

private:
    struct Profile {
        size_t first = 0; // in bottom_ and top_
        uint32_t columns = 0;
        double height = 0;
    };
    struct Item {
        double x0, y0, x1, y1;
        Profile side[4]; // after the given number of quarter turns
    };
    struct Arrangement {
        Array<uint32_t> order;
        Array<uint8_t> turns; // or ANY
        Done copy(const Arrangement& from, Memory& memory);
    };
    // What lies in a column, from below.
    struct Interval {
        double bottom, top;
        uint32_t next;
    };
    bool lowest(const Profile& p, uint32_t x, double most, uint32_t& hint, double& y);
    void occupy(const Profile& p, uint32_t x, double y);
    uint64_t add_to(const Profile& profile, double x0, double y0, const double* xy, int corners);
    Done turn_upside_down();
    double let_down(const Arrangement& state, uint32_t width, double most, Place* places, Call& call);
    void sort(Arrangement& state, int key, bool upright) const;

    // Of the square, in columns.
    struct Widths {
        uint32_t now = 1, least = 1, row = 1; // row: all shapes side by side
    };
    [[nodiscard]] hmf_status prepare(Arrangement& state, Widths& width, Call& call);
    [[nodiscard]] hmf_status find_first(uint64_t effort, const Packer* coarser, Arrangement& state, Widths& width,
                                        Call& call);
    [[nodiscard]] hmf_status narrow(uint64_t effort, Arrangement& state, Widths& width, Call& call);
    void change(Arrangement& state, uint32_t missed);

    Memory* memory_ = nullptr;
    double column_ = 1, margin_ = 0, side_ = 0;
    uint64_t steps_ = 0, random_ = 0, reported_ = 0; // reported_: steps before the last report
    double narrowest_ = 0;                           // height of the thinnest column of a shape
    uint32_t missed_ = 0;                            // place in the order of a shape that did not fit
    Array<Item> items_;
    Array<double> bottom_, top_;
    Array<uint32_t> column_first_; // of intervals_
    Array<Interval> intervals_;
    Arrangement best_, current_;
    Array<Place> best_places_;
};

} // namespace hmf
