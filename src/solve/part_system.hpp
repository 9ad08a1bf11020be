// The equations of some unknowns alone, the others as they are: what changes there is
// found at a part of the cost of a whole solve.
#pragma once

#include "twisted_model.hpp"

namespace hmf {

class PartSystem {
public:
    // The unknowns of the model whose number is not NONE; number: one per vertex, is changed.  Sets up the multigrid.
    Done take(const TwistedModel& model, Array<uint32_t>& number, Call& call);
    // Goes on from what it found last, at first from 0, and sets model.d of the unknowns.
    Done solve(TwistedModel& model, double accuracy, Call& call);

    // Gives back what it holds.
    void release() { *this = PartSystem(); }

private:
    Done list_unknowns(const TwistedModel& model, Array<uint32_t>& number, Memory& memory);
    SignedMatrix matrix() const {
        return {static_cast<uint32_t>(unknown_.size()), offset_.data(), column_.data(), entry_.data(),
                diagonal_.data()};
    }

    SignedMultigrid multigrid_; // its own, so that of the whole level lasts
    Array<uint32_t> unknown_, offset_, column_;
    Array<double> entry_, diagonal_, right_, d_;
};

} // namespace hmf
