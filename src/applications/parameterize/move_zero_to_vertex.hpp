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
//
// The way is the shortest one.  A step between the centers of two faces is measured
// by du^2 + dv^2, dv the flux across the edge, and by how much it changes the energy:
//
//     weight ((l + r)^2 - (l - r)^2) = 4 weight l r
//
// and the last one, to a vertex at height u, by dv^2 + (sum of its weights) u^2.
#pragma once

#include "../../core/base/nearest_first.hpp"
#include "twisted_form.hpp"

namespace hmf {

class ZeroMoves {
public:
    // taken: per vertex, no zero may come; the others have even turns.  moved: gets what the
    // ways cross; may be NULL.
    ZeroMoves(const Mesh& mesh, const double* weight, SignBundle& bundle, TwistedForm& du, Array<uint8_t>& taken,
              MovedZeros* moved = nullptr) :
        mesh_(mesh),
        weight_(weight), bundle_(bundle), du_(du), taken_(taken), moved_(moved) {}

    // tripods: a half-edge h of each triangle where du is not closed.  The sides are a sum and its two
    // parts up to sign, which is 1 on h and the next one, -1 on the third: the turn around the target of h is
    // odd.  even: vertices whose turn is even although they have a zero or a mark.  One zero of each goes to the
    // nearest vertex that is not taken.  left: how many find none.
    Done move(const Array<uint32_t>& tripods, const Array<uint32_t>& even, Call& call, size_t& left);

private:
    static constexpr uint32_t BARRED = NONE - 1; // a tripod
    void begin();
    void try_corner(uint32_t side, double height);
    Done find_way(uint32_t tripod);
    Done find_way_from_vertex(uint32_t v);
    Done search();
    bool may_end();
    Done refuse();
    void forget_refused();
    // A face on the way, entered across a half-edge from its right end to its left end.
    struct Reached {
        uint32_t crossed = NONE, from = NONE; // from: the one before
        double right = 0, left = 0, apex = 0; // heights
        double center = 0, length = 0;        // mean height, length of the way up to there
        int8_t sheet = 1;                     // of the heights, against the chart of the face
    };
    double distance(double height, uint32_t h) const;
    Done reach(uint32_t crossed, const Reached& before, double right, double left, int8_t sheet);
    bool follow_way();
    Done cross_faces();
    void touch(uint32_t v);
    void move_odd_turn(uint32_t& from, uint32_t to);
    int turn_round(uint32_t v) const;
    void change_chart(uint32_t h);
    void lower(uint32_t h, int64_t height);
    int64_t du(uint32_t h) const { return du_.at(bundle_, h); }

    const Mesh& mesh_;
    const double* weight_;
    SignBundle& bundle_;
    TwistedForm& du_;
    Array<uint8_t>& taken_;
    MovedZeros* moved_;
    Array<uint32_t> settled_; // per face: the way to it is known; NONE: it is not
    Array<Reached> reached_;
    NearestFirst nearest_;    // of reached_
    Array<uint32_t> refused_; // vertices that count as taken until the next zero has come to its place
    // From a tripod to a vertex: its half-edge whose target has the odd turn at first, then those crossed.
    Array<uint32_t> way_;
    uint32_t vertex_ = NONE; // where it ends
    double least_ = 0;       // its length
    uint32_t last_ = NONE;   // of a way without steps
};

} // namespace hmf
