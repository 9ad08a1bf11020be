// A step of all vertices at once, by the solution d of the model:
//
//     F'_ij = | F_ij - s_ij d_i - s_ji d_j |        d rounded to whole units
//
// with the conditions that have to hold after it: triangles are closed, no vertex is an extremum, and every zero is
// where it was or at the branch point of its triangle. Extrema caused by rounding or by a loose solve are removed by
// moves.
#pragma once

#include "solve.hpp"
#include "twisted_model.hpp"

namespace hmf {

class NewtonUpdate {
public:
    NewtonUpdate(LevelWork& work, TwistedModel& model) :
        work_(work), f_(work.state.foliation), rings_(work.rings), weight_(work.level.weight), call_(work.call),
        model_(model) {}
    Done allocate();

    // Saves the values before the step.
    void begin();
    void restore();
    // The values after the step, times a factor.
    void set_values(double factor);
    // Of the step, computed without the cancellation of two energies.
    double energy_change() const;
    // The step makes the value of h change its sign.
    bool reverses(uint32_t h) const {
        const uint32_t e = edge_of(h);
        return before_[e] - model_.sign[2 * e] * step_[f_.mesh.origin[2 * e]]
                 - model_.sign[2 * e + 1] * step_[f_.mesh.origin[2 * e + 1]]
             < 0;
    }

    // Collects the candidates: vertices whose regularity or singularity has changed. Returns the number of extrema.
    uint64_t find_candidates();
    // Lists the candidates that become valid only by a move.
    void list_invalid(Array<uint32_t>& invalid) const;
    // Removes the extrema among the candidates by moves; false if the step went too far.
    bool remove_extrema();
    // Every zero is where it was, or at the vertex that stopped at its branch
    // point.  Otherwise a zero and an extremum have appeared and vanished in between, and the class may have changed.
    bool zeros_are_in_place();
    // Vertex where the last of these failed; NONE: not yet.
    uint32_t too_far() const { return too_far_; }
    void forget_too_far() { too_far_ = NONE; }

private:
    enum class Shape : uint8_t { kept, misplaced, extremum, has_zero, broken };

    int64_t rounded(uint32_t k, double factor) const;
    void set_value(uint32_t e);
    template <class Visit>
    uint32_t count_closed(uint32_t v, Visit visit) const;
    int32_t index_of(uint32_t v, uint32_t closed) const;
    Shape shape(uint32_t v) const;
    void add_candidate(uint32_t v);
    template <class Check>
    bool check_candidates(Check check);

    // Two steps and a value, and two of these sums, have no more than 63 bits.
    static constexpr double LARGEST_STEP = 2 * static_cast<double>(LARGEST_INNER_VALUE);

    LevelWork& work_;
    Foliation& f_;
    const Rings& rings_;
    const double* weight_;
    Call& call_;
    TwistedModel& model_;
    Array<int64_t> before_, step_; // values per edge, steps per vertex
    Array<int32_t> expected_;      // indices, if every zero is in place
    Array<uint32_t> candidate_;    // vertices that may be invalid after a step,
    bool check_all_ = false;       // unless all may be
    uint32_t too_far_ = NONE;
};

} // namespace hmf
