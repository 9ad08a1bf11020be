// The equations of some unknowns alone, the others as they are: what changes there is
// found at a part of the cost of a whole solve.  And the equations of all, where the multigrid of the level fails.
#pragma once

#include "../linear/sparse_factor.hpp"
#include "twisted_model.hpp"

namespace hmf {

enum class Solver { multigrid, direct };

class PartSystem {
public:
    // The unknowns of the model whose number is not NONE, from model.d on; number: one per vertex, is changed.  Sets up
    // the multigrid, or makes the factor, unless that would be too large.  with: one per vertex, or null; the vertex
    // that v moves with, v or one that comes before it, from the same d.
    Done take(const TwistedModel& model, Array<uint32_t>& number, Solver solver, Call& call,
              const uint32_t* with = nullptr);
    // Goes on from what it found last, and sets model.d of the unknowns.
    Done solve(TwistedModel& model, double accuracy, Call& call);

    // Gives back what it holds.
    void release() { *this = PartSystem(); }

private:
    Done list_unknowns(const TwistedModel& model, Array<uint32_t>& number, const uint32_t* with, Memory& memory);
    SignedMatrix matrix() const {
        return {static_cast<uint32_t>(d_.size()), offset_.data(), column_.data(), entry_.data(), diagonal_.data()};
    }

    SignedMultigrid multigrid_;      // its own, so that of the whole level lasts
    SparseFactor factor_;            // instead
    Array<uint32_t> first_, vertex_; // unknown i is that of vertex_[first_[i]] .. vertex_[first_[i + 1] - 1]
    Array<uint32_t> offset_, column_;
    Array<double> entry_, diagonal_, right_, d_;
};

} // namespace hmf
