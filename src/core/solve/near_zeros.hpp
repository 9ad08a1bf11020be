// Single moves near the zeros of a model, where it is not smooth: after a step of all vertices, and where a level has
// stalled.
#pragma once

#include "solve.hpp"
#include "twisted_model.hpp"

namespace hmf {

// Some vertices, and how many rings each is from the first of them. Room that several searches share.
struct Neighborhood {
    Array<uint32_t> list, distance; // nearest first; per vertex, NONE: not in the list

    Done allocate(Memory& memory, size_t n) {
        list.start(memory);
        return list.reserve(n + 1) && distance.allocate(memory, n);
    }
};

class NearZeros {
public:
    NearZeros(LevelWork& work, const TwistedModel& model, Neighborhood& room) :
        w_(work), f_(work.state.foliation), weight_(work.level.weight), model_(model), picked_(room.list),
        distance_(room.distance) {}

    // Passes of moves over the vertices within some rings of the zeros. Later passes visit only those with a reason to
    // move.
    void relax();
    // Most vertices are within these rings; as of the last call.
    bool are_everywhere() const { return everywhere_; }
    // Moves of the vertices of zeros whose residual is above this value, as in a sweep; false: none moved.
    bool move_zeros(double residual);
    // The zeros of the model, for the certificate.
    Done list(ZeroList& zeros) const;

private:
    void pick();

    LevelWork& w_;
    Foliation& f_;
    const double* weight_;
    const TwistedModel& model_;
    Array<uint32_t>&picked_, &distance_;
    bool everywhere_ = false;
};

} // namespace hmf
