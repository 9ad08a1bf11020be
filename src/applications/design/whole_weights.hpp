// Whole numbers for weights, so that stripes match everywhere; loops of weight 0
// are left out.  A cylinder of height 1 is about 1/44 of the size of the surface,
// or 1/2, 1/4, ... of that where the scale gets less even by it.
#pragma once

#include "../../core/base/memory.hpp"

#include <algorithm>
#include <cmath>

namespace hmf {

// Smallest and largest weight differ by at most this factor.
constexpr double LARGEST_WEIGHT_RATIO = 4096;

// measure(weights, unevenness): HUGE_VAL where there is no solution.  exact: of
// the weights as they are; they stay if nothing is found.
template <class Measure>
hmf_status to_whole_numbers(double exact, double across, Call& call, Array<double>& weights, double& unevenness,
                            Measure measure) {
    constexpr double expected_stripes = 44; // along the diagonal of the box
    constexpr double stretches[3] = {1, 0.87, 1.15};
    const double enough = 1.08 * exact + 0.01; // usually reached in the first round
    constexpr int finest = 16;
    Array<double> rounded;
    if (!rounded.allocate(call.memory, weights.size())) return call.out_of_memory();
    double largest = 0, chosen = 0, least = HUGE_VAL;
    for (const double w : weights) largest = std::max(largest, w);
    for (int finer = 1; finer <= finest && !(least < enough); finer *= 2)
        for (const double stretch : stretches) {
            const double unit = across * largest / expected_stripes * stretch / finer;
            if (!(unit > 0) || largest / unit < 0.5 || largest / unit > LARGEST_WEIGHT_RATIO) continue;
            for (size_t c = 0; c < weights.size(); ++c) rounded[c] = std::floor(weights[c] / unit + 0.5);
            double now = HUGE_VAL;
            if (measure(rounded, now)) return call.status();
            if (now < least) {
                least = now;
                chosen = unit;
            }
        }
    if (!(chosen > 0)) return HMF_OK;
    for (double& w : weights) w = std::floor(w / chosen + 0.5);
    unevenness = least;
    return HMF_OK;
}

} // namespace hmf
