// The policy of Newton's method on a level: how far to reduce the residual, how accurately to solve for each step, and
// when there is no progress. The numbers are those of parameters.hpp.
#pragma once

#include "parameters.hpp"
#include "solve.hpp"

namespace hmf {

// How accurately the linear system of a step is solved.
struct SolveTolerance {
    double loose;    // relative, while zeros move
    double tight;    // once they stay: a solve that meets no bound is continued to it
    double residual; // of [W] Eq. 4, at which any solve may stop; 0: none

    static SolveTolerance exact() { return {parameters::TIGHTEST, parameters::TIGHTEST, 0}; }
};

// Decides what is no progress.
class StallDetector {
public:
    // Once per round. Progress halves the residual, or lowers the energy by the share `goal`.
    // passes_bounds: the last step met bounds at first and was taken whole; zeros pass one obstacle per round.
    bool is_stalled(double residual, double energy, double goal, bool passes_bounds);
    void restart() { *this = {}; }

private:
    static constexpr double NONE = 1e300;
    double least_residual_ = NONE, least_energy_ = NONE;
    uint32_t without_progress_ = 0; // rounds
};

// The finest level is solved to the minimum; the others only provide a start for the next level.
struct LevelPolicy {
    enum class Role : uint8_t { finest, middle, coarsest, cheap_coarsest } role; // cheap: few of the vertices are on it
    double goal;                                                                 // for the residual
    uint32_t rounds;

    LevelPolicy(const LevelWork& work, double tolerance);
    SolveTolerance tolerance() const;
};

} // namespace hmf
