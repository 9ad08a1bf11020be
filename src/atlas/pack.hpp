// Packing of shapes into a square, by horizons: the plane is cut into columns, a
// shape is a bottom and a top in each of them, and one after the other is let
// down as far as those below allow [Levy, Petitjean, Ray, Maillot 2002: Least
// squares conformal maps, section 4].  In each column a shape begins above all
// that were there before, so that no two overlap.
//
//     top     _--_
//      |    _-    |         horizon ........     the profile of a shape: made of
//      |   |      |  v   ---.      .---          triangles or boxes that are wider
//     bottom -____|          '----'              by half a margin on all sides
//
// Orders, quarter turns and where to put a shape are searched for a given number
// of steps; the same input gives the same places.
#pragma once

#include "../base/memory.hpp"

namespace hmf {

class Packer {
public:
    // column: width of one.
    void start(Memory& memory, double column, double margin);
    double column() const { return column_; }
    uint32_t count() const { return static_cast<uint32_t>(items_.size()); }

    // A shape: its box, then what it consists of, convex parts of at most four corners inside the box.
    Done begin_shape(double x0, double y0, double x1, double y1);
    void add_part(const double* xy, int corners);
    void add_area(double area) { area_ += area; }

    // Searches so many packings; side is the width of the square then.
    [[nodiscard]] hmf_status search(uint32_t tries, Call& call);
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
        Profile side[4]; // after so many quarter turns
    };
    struct State {
        Array<uint32_t> order;
        Array<uint8_t> turns;
        bool by_waste = false;
        Done copy(const State& from, Memory& memory);
    };
    void add_to(const Profile& profile, double x0, double y0, const double* xy, int corners);
    Done turn_upside_down();
    double let_down(const State& state, uint32_t width, double give_up, Place* places);
    void sort(State& state, int key, bool upright) const;

    Memory* memory_ = nullptr;
    double column_ = 1, margin_ = 0, area_ = 0, side_ = 0;
    Array<Item> items_;
    Array<double> bottom_, top_, horizon_;
    State best_, current_;
    Array<Place> best_places_;
};

} // namespace hmf
