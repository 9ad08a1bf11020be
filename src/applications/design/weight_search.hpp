// Weights for the loops of a surface with boundary, for which the scale of the
// harmonic foliation is as even as it gets.  Searched on its double.
#pragma once

#include "../../core/curves/loops.hpp"
#include "../../core/solve/solve.hpp"
#include "conformal_scale.hpp"

namespace hmf {

class WeightSearch {
public:
    WeightSearch(const hmf_hierarchy& hierarchy, Call& call) : h_(hierarchy), call_(call) {}
    hmf_status start();

    // loops: of the double on level 0, whatever their weights.
    // Of weights, one for each loop of the surface, 0: left out.  HUGE_VAL: there is no solution to be had.
    [[nodiscard]] hmf_status measure(const WeightedLoops& loops, const Array<double>& weights, double& unevenness);
    // Whole numbers.
    [[nodiscard]] hmf_status run(const WeightedLoops& loops, uint64_t solves, Array<double>& weights,
                                 double& unevenness);

    // Loops that were left out get the weight 1 if, on the finest level, a part without them would carry no quads.
    // bare: there is such a part nevertheless.
    [[nodiscard]] hmf_status keep_all_if_bare(const WeightedLoops& loops, Array<double>& weights, double& unevenness,
                                              bool& bare);

    uint64_t solves = 0;
    double from = 0, to = 1; // progress

private:
    hmf_status find_means(const WeightedLoops& loops, bool& known);
    hmf_status find_if_bare(const WeightedLoops& loops, const Array<double>& weights, bool& bare);
    hmf_status find_bare_parts(bool& any); // in what was measured last, on level 0

    const hmf_hierarchy& h_;
    Call& call_;
    size_t level_ = 0; // of the search
    State state_;
    ConformalScale scale_;
    double unit_ = 1, tolerance_ = 0;
    Array<int64_t> integers_; // per loop of the double
    Array<double> mean_;      // per loop of the surface: log scale of its cylinders
};

} // namespace hmf
