// A tree of boxes over things in a spatial order, to find those near a point.
//
//     1                 node i has the children 2i and 2i + 1; each of the last ones has a few things
//     2       3
//     4   5   6   7
#pragma once

#include "../../core/base/memory.hpp"
#include "point.hpp"

#include <algorithm>
#include <utility>

namespace hmf {

class BoxTree {
public:
    // corner(i, k): corners of thing i, `corners` each.
    template <class Corner>
    Done build(size_t count, int corners, const Corner& corner, Memory& memory) {
        count_ = count;
        for (leaves_ = 1; leaves_ * EACH < count;) leaves_ *= 2;
        if (!boxes_.allocate_filled(memory, 2 * leaves_, Box{})) return false;
        for (size_t i = 0; i < count; ++i)
            for (int k = 0; k < corners; ++k) boxes_[leaves_ + i / EACH].add(corner(i, k), corner(i, k));
        for (size_t i = leaves_ - 1; i > 0; --i)
            for (const Box& child : {boxes_[2 * i], boxes_[2 * i + 1]}) boxes_[i].add(child.low, child.high);
        return true;
    }

    // visit(i), which gives the new bound, for each thing whose box is nearer to p than that; squared distances.
    template <class Visit>
    void search(const Point& p, double bound, const Visit& visit) const {
        struct Waiting {
            size_t node;
            double square;
        } waiting[DEEPEST];
        size_t waits = 0;
        waiting[waits++] = {1, boxes_[1].square_distance(p)};
        while (waits > 0) {
            const Waiting now = waiting[--waits];
            if (!(now.square < bound)) continue;
            if (now.node < leaves_) {
                Waiting near{2 * now.node, boxes_[2 * now.node].square_distance(p)};
                Waiting far{2 * now.node + 1, boxes_[2 * now.node + 1].square_distance(p)};
                if (far.square < near.square) std::swap(near, far);
                waiting[waits++] = far;
                waiting[waits++] = near;
                continue;
            }
            const size_t first = (now.node - leaves_) * EACH;
            for (size_t i = first; i < std::min(first + EACH, count_); ++i) bound = visit(i);
        }
    }

private:
    static constexpr size_t EACH = 4;         // things of a box without children
    static constexpr size_t DEEPEST = 2 * 32; // nodes that wait, of a tree over 2^32 things

    struct Box {
        Point low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

        void add(const Point& l, const Point& h) {
            low = {std::min(low.x, l.x), std::min(low.y, l.y), std::min(low.z, l.z)};
            high = {std::max(high.x, h.x), std::max(high.y, h.y), std::max(high.z, h.z)};
        }
        double square_distance(const Point& p) const {
            const auto off = [](double a, double x, double b) { return std::max(std::max(a - x, x - b), 0.0); };
            return square_of({off(low.x, p.x, high.x), off(low.y, p.y, high.y), off(low.z, p.z, high.z)});
        }
    };

    Array<Box> boxes_;
    size_t leaves_ = 1, count_ = 0;
};

} // namespace hmf
