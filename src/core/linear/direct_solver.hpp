// A direct solve for some of the unknowns of a system, with all others held.
#pragma once

#include "signed_multigrid.hpp"

namespace hmf {

class DirectSolver {
public:
    static constexpr uint32_t HELD = UINT32_MAX;
    // Extracts the unknowns whose number is not HELD and that are not fixed; number: one per unknown, is changed.
    // Computes the factor, or sets up the multigrid if the factor would be too large. with: one per unknown, or
    // null; the one that i moves with, i itself or an earlier one, starting from the same x.
    Done extract(const LinearSystem& system, Array<uint32_t>& number, Call& call, const uint32_t* with = nullptr);
    // Sets x of these unknowns.
    Done solve(const LinearSystem& system, Call& call);

private:
    Done list_unknowns(const LinearSystem& system, Array<uint32_t>& number, const uint32_t* with, Memory& memory);
    SignedMatrix matrix() const {
        return {static_cast<uint32_t>(x_.size()), offset_.data(), column_.data(), entry_.data(), diagonal_.data()};
    }

    SparseFactor factor_;
    Array<uint32_t> first_, member_; // unknown k stands for member_[first_[k]] .. member_[first_[k + 1] - 1]
    Array<uint32_t> offset_, column_;
    Array<double> entry_, diagonal_, right_, x_;
};

} // namespace hmf
