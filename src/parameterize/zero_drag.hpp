// Zeros that are dragged from their triangles to vertices further away, where
// the corners serve other zeros.
//
// An isotopy that drags a zero along a way through triangles carries the
// foliation along and keeps its class, whatever the way.  Heights are those of u
// above the branch point.  On the right of the way charts stay; what lies on the
// left is on the other sheet now, where u changes its sign:
//
//              l                        l  (-u)
//            / ^ \                    / ^ \            du(r -> l) = - u(l) - u(r)
//     zero  .  |  w         ->       .  |  zero        u(w) = 0
//            \ | /                    \ | /
//              r                        r  (u)
#pragma once

#include "twisted_form.hpp"

namespace hmf {

class ZeroDrags {
public:
    // taken: per vertex, no zero may come; the others have even turns.
    ZeroDrags(const Mesh& mesh, SignBundle& bundle, TwistedForm& du, Array<uint8_t>& taken) :
        mesh_(mesh), bundle_(bundle), du_(du), taken_(taken) {}

    // tripods: a half-edge h of each triangle where du is not closed.  The sides are a sum and its two
    // parts up to sign, which is 1 on h and the next one, -1 on the third: the turn round the target of h is
    // odd.  Each zero goes to the nearest vertex that is not taken, across few edges.  left: how many find none.
    Done drag(const Array<uint32_t>& tripods, Call& call, size_t& left);

private:
    static constexpr uint32_t BARRED = NONE - 1; // a tripod
    Done find_way(uint32_t tripod);
    Done cross(uint32_t h);
    bool follow_way();
    void move_odd_turn(uint32_t& from, uint32_t to);
    int turn_round(uint32_t v) const;
    void change_chart(uint32_t h);
    void lower(uint32_t h, int64_t height);
    int64_t du(uint32_t h) const { return du_.at(bundle_, h); }

    const Mesh& mesh_;
    SignBundle& bundle_;
    TwistedForm& du_;
    Array<uint8_t>& taken_;
    Array<uint32_t> reached_from_; // per face: the half-edge that was crossed into it; NONE: not reached
    Array<uint32_t> queue_;        // half-edges crossed, nearest first
    // From a tripod to a vertex: its half-edge whose target has the odd turn at first, then those crossed.
    Array<uint32_t> way_;
    uint32_t vertex_ = NONE; // where it ends
};

} // namespace hmf
