// The equations of some unknowns, with all others fixed: a local solve costs less than one of the whole level. Also the
// equations of all unknowns, for a direct solve if the multigrid of the level fails.
#pragma once

#include "../linear/sparse_factor.hpp"
#include "twisted_model.hpp"

namespace hmf {

enum class Solver { multigrid, direct };

class SubdomainSolver {
public:
    // Extracts the unknowns of the model whose number is not NONE, starting from model.d; number: one per vertex, is
    // changed. Sets up the multigrid, or computes the factor unless it would be too large. with: one per vertex, or
    // null; the vertex that v moves with, v itself or an earlier one, starting from the same d.
    Done extract(const TwistedModel& model, Array<uint32_t>& number, Solver solver, Call& call,
                 const uint32_t* with = nullptr);
    // Continues from its last solution, and sets model.d of the unknowns.
    Done solve(TwistedModel& model, double accuracy, Call& call);

    // Frees its memory.
    void release() { *this = SubdomainSolver(); }

private:
    Done list_unknowns(const TwistedModel& model, Array<uint32_t>& number, const uint32_t* with, Memory& memory);
    SignedMatrix matrix() const {
        return {static_cast<uint32_t>(d_.size()), offset_.data(), column_.data(), entry_.data(), diagonal_.data()};
    }

    SignedMultigrid multigrid_;      // separate from that of the whole level, which stays valid
    SparseFactor factor_;            // instead
    Array<uint32_t> first_, vertex_; // unknown i is that of vertex_[first_[i]] .. vertex_[first_[i + 1] - 1]
    Array<uint32_t> offset_, column_;
    Array<double> entry_, diagonal_, right_, d_;
};

} // namespace hmf
